"""A quieter or more efficient design that a search has seen and left is reported."""

import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

from camring.cli.app import app
from camring.evaluation.outcome import Outcome, failed
from camring.evaluation.record import Record, best_of
from camring.studies.given_up import given_up, sentences
from camring.studies.pareto import traded_results

WEIGHTS = (0.75, 0.25)


def record(trial, objective, ripples, efficiencies=(0.9, 0.9), margin=-0.1):
    pairs = zip(ripples, efficiencies, strict=True)
    results = [{"torque_ripple": ripple, "efficiency": share} for ripple, share in pairs]
    outcome = Outcome(objective, {"max_pressure": margin}, objective, results=results)
    return Record(trial, "descent 1", np.zeros(1), outcome)


def left(*records):
    return given_up(records, best_of(records), WEIGHTS)


def test_the_quietest_is_named_with_trial_ripple_and_objective():
    """As seen: 0.02 % at evaluation 16 was given up for 0.141 % at the end."""
    (found,) = left(
        record(0, 0.2, (0.08, 0.08)),
        record(16, 0.0312, (0.0002, 0.0002)),
        record(17, 0.0311, (0.0004, 0.0004)),
        record(299, 0.0279, (0.0012, 0.00204)),
    )
    assert (found.name, found.trial, found.best_trial) == ("torque_ripple", 16, 299)
    assert found.kept == pytest.approx(0.75 * 0.0012 + 0.25 * 0.00204)
    for words in ("Trial 16", "0.0200 %", "0.0312", "trial 299", "0.141 %", "0.0279", "quieter"):
        assert words in found.sentence


def test_the_most_efficient_shows_from_half_a_point():
    (found,) = left(record(0, 0.2, (0.01, 0.01), (0.93, 0.93)), record(1, 0.1, (0.01, 0.01)))
    assert (found.name, found.trial, found.value) == ("efficiency", 0, pytest.approx(0.93))
    assert "more efficient" in found.sentence
    assert not left(record(0, 0.2, (0.01, 0.01), (0.904, 0.904)), record(1, 0.1, (0.01, 0.01)))


@pytest.mark.parametrize(
    "other",
    [
        record(0, 0.2, (0.0001, 0.0001), margin=0.01),  # breaks a limit
        record(0, 0.2, (0.0007, 0.0007)),  # more than half
        record(0, 0.2, (np.nan, 0.0001)),
        Record(0, "initial", np.zeros(1), failed("no orbit", ("max_pressure",))),
    ],
)
def test_what_is_not_much_better_or_breaks_a_limit_is_nothing_to_tell_of(other):
    assert left(other, record(1, 0.1, (0.001, 0.001))) == []


def test_differences_that_no_bench_can_tell_are_nothing_to_tell_of():
    assert left(record(0, 0.2, (0.0001, 0.0001)), record(1, 0.1, (0.0005, 0.0005))) == []
    assert given_up([record(0, 0.2, (1, 1))], None, WEIGHTS) == []


def test_the_command_that_shows_the_front_is_one():
    found = left(record(0, 0.2, (0.0001, 0.0001)), record(1, 0.1, (0.05, 0.05)))
    *_, last = sentences(found, Path("my study/given.toml"))
    words = shlex.split(last.split("`")[1])
    assert words[:3] == ["camring", "pareto", "my study/given.toml"]
    assert traded_results(words[words.index("--of") + 1]) == ("torque_ripple", "efficiency")
    command = get_command(app).commands["pareto"]
    known = {name for each in command.params for name in each.opts}
    assert {word for word in words if word.startswith("--")} <= known
    assert sentences([], Path("given.toml")) == []
