"""Long work shows that it lives, also where no bar can be drawn."""

import io
import time

import numpy as np
import pytest
from rich.console import Console

from camring.evaluation.outcome import Outcome, failed
from camring.evaluation.progress import LINE_EVERY, SIMULATING, SearchProgress, Spoken
from camring.evaluation.record import Record

EVERY = 0.05


def record(trial, objective):
    outcome = Outcome(objective, {"limit": -1.0}, results=({"torque_ripple": 0.05},))
    return Record(trial, "descent 1", np.zeros(1), outcome)


@pytest.fixture
def page():
    """Whatever is written where no terminal is, forty letters wide."""
    return Console(file=io.StringIO(), width=40, force_terminal=False)


def lines_of(console):
    return console.file.getvalue().splitlines()


def wait_for_line(console, words):
    for _ in range(400):
        if any(words in line for line in lines_of(console)):
            return
        time.sleep(0.01)
    pytest.fail(f"no line with {words!r} in {lines_of(console)}")


def test_a_search_says_where_it_is_while_nothing_comes(page):
    with SearchProgress([], 30, page, every=EVERY) as progress:
        wait_for_line(
            page, "the given motor first; 0 s so far. Programs for motors of this kind that never"
        )
        progress(record(0, 0.25))
        wait_for_line(
            page,
            "1 of 30 evaluations, best objective 0.25, torque ripple 5.00 %, 1 feasible; "
            "0 s since the last.",
        )
        progress(Record(1, "x", np.zeros(1), failed("the mesh tangled")))
        wait_for_line(page, "Evaluation 1 failed: the mesh tangled. The search goes on; further")
    count = len(lines_of(page))
    time.sleep(3 * EVERY)
    assert len(lines_of(page)) == count  # and is silent when it has ended


def test_other_long_work_says_what_it_is_at(page):
    with Spoken("Reading the file.", page, every=EVERY) as say:
        wait_for_line(page, "Reading the file: 0 s so far.")
        say("Tracing the front from 12 starts.")
        assert lines_of(page)[-1] == "Tracing the front from 12 starts."
        wait_for_line(page, "Tracing the front from 12 starts: 0 s so far.")


def test_short_work_says_no_more_than_it_was_asked_to(page):
    with Spoken("Reading the file.", page) as say:
        say("Done.")
    with SearchProgress([], 3, page) as progress:
        for trial in range(3):
            progress(record(trial, 1.0))
    assert lines_of(page) == ["Done."]
    assert 5 <= LINE_EVERY <= 20


def test_a_terminal_gets_a_bar_and_no_lines():
    console = Console(file=io.StringIO(), force_terminal=True)
    with SearchProgress([], 3, console, every=EVERY):
        time.sleep(3 * EVERY)
    with Spoken("Reading.", console, every=EVERY):
        time.sleep(3 * EVERY)
    assert "so far" not in console.file.getvalue()


def test_a_command_without_a_bar_says_on_a_terminal_too_that_it_works():
    console = Console(file=io.StringIO(), force_terminal=True, width=200)
    with Spoken(SIMULATING, console, every=EVERY, terminals=True):
        wait_for_line(console, "never ran here are compiled, for some minutes: 0 s so far.")
