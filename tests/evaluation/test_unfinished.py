"""Work that was stopped goes on where it was, to the same bits, and never as something else."""

import sqlite3
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import refused
from typer.testing import CliRunner

from camring.cli.app import app
from camring.evaluation import built_motors
from camring.evaluation.answers import forget, remembered_problem
from camring.evaluation.interrupt import EXIT_CODE, Interrupted
from camring.evaluation.unfinished import Request, Unfinished, done, out_of, place_of, request_of
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.search.pareto.front import FrontProblem, trace_front
from camring.search.problem import Problem
from camring.search.scatter.robust import Scattered, ScatteredSlopes
from camring.search.scatter.statistic import MeanPlus
from camring.studies import robust

MILL = (Path(__file__).parents[1] / "derivation" / "mill_motor.toml").read_text()
TOLERANT = f"""{MILL}
[tolerances]
"motor.valve_plate.shift" = "0.2 deg"
"motor.bore" = {{ plus_minus = "20 um", distribution = "normal" }}
"""
REQUEST = Request("pareto", "a motor", "motor.toml", {"points": 3})
ODD = np.array([1 / 3, -0.0, np.inf, np.nan, 5e-324])


class Stop(BaseException):
    """What a kill is to the code below it, as near as Python comes."""


class Counted:
    """A function that is stopped at one of its calls."""

    def __init__(self, function, stop=None, by=Stop):
        self.function, self.calls, self.stop, self.by = function, 0, stop, by

    def __call__(self, at):
        self.calls += 1
        if self.calls == self.stop:
            raise self.by()
        return self.function(at)


def odd(at):
    return ODD * at[0], np.array("failed, or not"), np.arange(6).reshape(2, 3)


def run(out, function, points=5, request=REQUEST):
    with Unfinished(out, request) as work:
        asked = work.remember("odd", function)
        return [asked(np.array([k + 0.1])) for k in range(points)]


def same(one, other):
    assert [[(a.dtype, a.shape, a.tobytes()) for a in each] for each in one] == [
        [(b.dtype, b.shape, b.tobytes()) for b in each] for each in other
    ]


@pytest.mark.parametrize("stop", [1, 2, 5])
def test_what_was_computed_is_not_computed_again(tmp_path, stop):
    whole = run(tmp_path / "whole", odd)
    with pytest.raises(Stop):
        run(tmp_path / "out", Counted(odd, stop))
    assert place_of(tmp_path / "out").exists() == (stop > 1)
    rest = Counted(odd)
    same(run(tmp_path / "out", rest), whole)
    assert rest.calls == 6 - stop
    assert request_of(tmp_path / "out") == REQUEST
    done(tmp_path / "out")
    assert request_of(tmp_path / "out") is None


def test_what_ends_in_a_sentence_for_the_user_is_not_kept(tmp_path):
    with pytest.raises(InputError):
        run(tmp_path / "out", Counted(odd, 3, lambda: InputError("this", "is wrong", "change it")))
    assert not list(tmp_path.iterdir())


def test_ctrl_c_says_how_it_goes_on_if_there_is_anything_to_go_on_with(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "out", Counted(odd, 1, KeyboardInterrupt))
    assert not list(tmp_path.iterdir())
    with pytest.raises(Interrupted, match=r"camring resume .*out"):
        run(tmp_path / "out", Counted(odd, 2, KeyboardInterrupt))
    assert [each.name for each in tmp_path.iterdir()] == ["out.unfinished"]
    assert out_of(tmp_path / "out.unfinished") == out_of(tmp_path / "out") == tmp_path / "out"


@pytest.mark.parametrize(
    "other",
    [
        replace(REQUEST, motor="another motor"),
        replace(REQUEST, options={"points": 4}),
        replace(REQUEST, command="robust"),
    ],
)
def test_another_request_is_refused_and_harms_nothing(tmp_path, other):
    with pytest.raises(Stop):
        run(tmp_path / "out", Counted(odd, 3))
    before = place_of(tmp_path / "out").read_bytes()
    with pytest.raises(InputError, match="another command, or of this motor file before it chang"):
        run(tmp_path / "out", odd, request=other)
    assert place_of(tmp_path / "out").read_bytes() == before


def test_the_work_of_another_camring_is_refused(tmp_path):
    with pytest.raises(Stop):
        run(tmp_path / "out", Counted(odd, 3), request=replace(REQUEST, version="0.0.1"))
    with pytest.raises(InputError, match=r"begun by camring 0\.0\.1"):
        request_of(tmp_path / "out")


@pytest.mark.parametrize("content", [b"", b"not a database", "a database"])
def test_a_file_of_somebody_else_is_refused_and_stays(tmp_path, content):
    place = place_of(tmp_path / "out")
    if isinstance(content, bytes):
        place.write_bytes(content)
    else:
        with sqlite3.connect(place) as other:
            other.execute("CREATE TABLE request (content TEXT)")
        other.close()
    before = place.read_bytes()
    assert "remove it to begin anew" in refused("resume", tmp_path / "out")
    with pytest.raises(InputError, match="holds no work of camring"):
        run(tmp_path / "out", odd)
    assert place.read_bytes() == before


def test_an_answer_that_was_altered_is_computed_again(tmp_path):
    whole = run(tmp_path / "whole", odd)
    with pytest.raises(Stop):
        run(tmp_path / "out", Counted(odd, 4))
    place = place_of(tmp_path / "out")
    with sqlite3.connect(place) as spoilt:
        [(question, content)] = spoilt.execute("SELECT question, content FROM answer LIMIT 1")
        altered = content[:200] + bytes([content[200] ^ 1]) + content[201:]
        spoilt.execute("UPDATE answer SET content = ? WHERE question = ?", (altered, question))
    spoilt.close()
    again = Counted(odd)
    same(run(tmp_path / "out", again), whole)
    assert again.calls == 5 - 3 + 1


def test_two_at_one_place_do_not_mix(tmp_path):
    with Unfinished(tmp_path / "out", REQUEST) as first:
        first.remember("odd", odd)(np.ones(1))
        with pytest.raises(InputError, match="in use by another process"):
            Unfinished(tmp_path / "out", REQUEST)


def test_who_comes_second_takes_nothing_from_who_came_first(tmp_path):
    with Unfinished(tmp_path / "out", REQUEST) as first:

        def both(at):
            first.remember("odd", odd)(at)
            return odd(at)

        with pytest.raises(InputError, match="in use by another process"):
            run(tmp_path / "out", both)  # begun before there was a file
        first.remember("odd", odd)(np.full(1, 3.0))
    with Unfinished(tmp_path / "out", REQUEST) as again:
        assert again.known == 2


def test_a_disk_that_takes_no_more_costs_the_memory_and_not_the_work(tmp_path, monkeypatch):
    whole = run(tmp_path / "whole", odd)
    place = tmp_path / "gone"
    with Unfinished(place / "out", REQUEST) as work:  # a folder that is not there
        asked = work.remember("odd", odd)
        same([asked(np.array([k + 0.1])) for k in range(5)], whole)
    assert not place.exists()


def test_evaluations_of_a_search_come_back_as_they_were(tmp_path):
    given = [(0.5, np.array([-1.0, ODD[0]]), 0.25, None), (np.nan, np.full(2, np.nan), 1.0, "why")]
    searched = Problem(1, 2, lambda points: [given[int(points[0, 0])]])
    points = np.array([[0.0], [1.0]])
    for again in (searched, Problem(1, 2, lambda points: pytest.fail("computed again"))):
        with Unfinished(tmp_path / "out", REQUEST) as work:
            found = remembered_problem(work.remember, "searched", again).evaluate(points)
        for mine, theirs in zip(found, given, strict=True):
            np.testing.assert_array_equal(mine[1], theirs[1])
            assert repr(mine[0::2]) == repr(theirs[0::2])
            assert mine[3] == theirs[3]


def test_a_front_that_was_stopped_is_the_front(tmp_path):
    """Of two squares, over a disc; see `tests/search/test_pareto.py` for what is right."""

    def values(x):
        return np.stack([np.sum(x**2, 1), np.sum((x - 1) ** 2, 1)], 1), np.sum(x, 1)[:, None] - 1.9

    def slopes(x):
        return np.stack([2 * x, 2 * (x - 1)], 1), np.ones((len(x), 1, x.shape[1]))

    def front(work, first, second):
        problem = FrontProblem(work.remember("values", first), work.remember("slopes", second))
        return trace_front(problem, [np.array([0.3, 0.7])], 12)

    with Unfinished(tmp_path / "whole", REQUEST) as work:
        counted = Counted(values), Counted(slopes)
        whole = front(work, *counted)
    half = counted[0].calls // 2
    with pytest.raises(Stop), Unfinished(tmp_path / "out", REQUEST) as work:
        front(work, Counted(values, half), slopes)
    with Unfinished(tmp_path / "out", REQUEST) as work:
        rest = Counted(values)
        again = front(work, rest, slopes)
    assert rest.calls == counted[0].calls - half + 1
    assert np.array(again.points).tobytes() == np.array(whole.points).tobytes()
    assert again.evaluations == whole.evaluations


LIMITS = len(parse_motor_file(TOLERANT).goal.constraints.names())


class Bowl:
    """In place of a motor: a paraboloid with limits alike, and three samples of it."""

    names_by_point = ("limit",) * LIMITS

    def __init__(self, *given):
        self.lowest = 0.3 + 0.02 * np.arange(3)[:, None]

    def outcome(self, point):
        return float(np.sum((point - 0.3) ** 2)), np.full(LIMITS, 0.2 - point[0]), np.nan, None

    def slopes(self, point):
        by_limit = np.zeros((LIMITS, len(point)))
        by_limit[:, 0] = -1
        return 2 * (point - 0.3), by_limit

    def scattered(self, point):
        limits = np.full((LIMITS, 3), -point[0])
        return Scattered(np.sum((point - self.lowest) ** 2, axis=1), limits)


class BuiltBowl(Bowl):
    def slopes(self, point):
        by_limit = Bowl().slopes(point)[1][:, :, None] * np.ones(3)
        return ScatteredSlopes(2 * (point - self.lowest).T, by_limit)


def test_a_robust_design_that_was_stopped_is_the_design(tmp_path, monkeypatch):
    file, request = parse_motor_file(TOLERANT), replace(REQUEST, command="robust")
    for name, fake in {
        "MotorEvaluator": Bowl,
        "BuiltDesigns": BuiltBowl,
        "evaluate_or_fail": lambda evaluator, names, point: evaluator.outcome(point),
        "as_seen_by_search": lambda outcome, names: outcome,
        "built": lambda *given: None,
    }.items():
        monkeypatch.setattr(robust, name, fake)
    counts = Counter()

    def design(remember, stop=None):
        def counted(name, function):
            def each(at):
                counts[name] += 1
                if (name, counts[name]) == stop:
                    raise Stop
                return function(at)

            return remember(name, each)

        counts.clear()
        statistic = MeanPlus(1.0)
        return robust.robust_design(file, statistic, statistic, budget=60, remember=counted)

    whole = design(forget)
    with Unfinished(tmp_path / "whole", request) as work:
        design(work.remember)
    assert set(counts) == {"nominal", "nominal slopes", "robust", "robust slopes"}
    asked = dict(counts)
    for name, count in asked.items():
        with pytest.raises(Stop), Unfinished(tmp_path / name, request) as work:
            design(work.remember, (name, count))
        first = dict(counts)
        with Unfinished(tmp_path / name, request) as work:
            again = design(work.remember)
        assert {each: first.get(each, 0) + counts[each] for each in asked} == {
            each: asked[each] + (each == name) for each in asked
        }
        for design_name, point in whole.points.items():
            assert np.asarray(again.points[design_name]).tobytes() == np.asarray(point).tobytes()
        assert again.promised == whole.promised


def camring(*words):
    return CliRunner().invoke(app, list(map(str, words)))


def files(folder):
    return {each.name: each.read_bytes() for each in sorted(folder.iterdir())}


def test_resume_knows_what_was_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr(built_motors, "TOGETHER", 8)
    (tmp_path / "motor.toml").write_text(TOLERANT)
    words = ["tolerance", tmp_path / "motor.toml", "--samples", 32, "--out"]
    assert camring(*words, tmp_path / "whole").exit_code == 0
    assert not place_of(tmp_path / "whole").exists()
    built = built_motors.evaluate_many
    monkeypatch.setattr(built_motors, "evaluate_many", StoppedAt(3, built))
    ended = camring(*words, tmp_path / "out")
    assert ended.exit_code == EXIT_CODE
    assert "camring resume" in ended.stderr
    assert place_of(tmp_path / "out").exists()
    assert not (tmp_path / "out").exists()
    (tmp_path / "motor.toml").unlink()  # what was asked stands in the file
    said = refused("resume", tmp_path / "out", "--budget", 3)
    assert "are for a study" in said
    assert "camring tolerance" in said
    rest = StoppedAt(None, built)
    monkeypatch.setattr(built_motors, "evaluate_many", rest)
    ended = camring("resume", tmp_path / "out")
    assert ended.exit_code == 0, ended.stderr
    assert rest.calls == 5 - 2
    assert files(tmp_path / "out") == files(tmp_path / "whole")
    assert not place_of(tmp_path / "out").exists()


class StoppedAt:
    """A function of any arguments to which Ctrl-C comes at one of its calls."""

    def __init__(self, stop, function):
        self.calls, self.stop, self.function = 0, stop, function

    def __call__(self, *given, **named):
        self.calls += 1
        if self.calls == self.stop:
            raise KeyboardInterrupt
        return self.function(*given, **named)


def test_a_folder_that_stands_whole_has_nothing_left_to_do(tmp_path):
    with pytest.raises(Stop):
        run(tmp_path / "out", Counted(odd, 3))
    (tmp_path / "out").mkdir()  # killed between the one and the other
    ended = camring("resume", tmp_path / "out")
    assert ended.exit_code == 0
    assert "stands whole" in ended.stdout
    assert not place_of(tmp_path / "out").exists()
