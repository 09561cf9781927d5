"""A function that fails, stalls and lies is minimised all the same."""

import math

import pytest

import camring
from camring.files.errors import InputError

BOUNDS = {"width": (0.0, 4.0), "height": (-1.0, 1.0)}


def bowl(width, height):
    """Lowest where width is 1; the limit asks for 2."""
    return {
        "objective": (width - 1) ** 2 + height**2,
        "too_narrow": (2 - width) / 2,
        "area": width * height,
    }


def minimised(function, *, constraints=("too_narrow",), budget=6, **settings):
    return camring.minimise_function(function, BOUNDS, constraints, budget=budget, **settings)


def test_the_best_lies_on_the_limit():
    found = minimised(bowl, method="nelder-mead", budget=90)
    assert found.feasible
    assert found.best["width"] == pytest.approx(2.0, abs=0.01)
    assert found.best["objective"] == pytest.approx(1.0, abs=0.02)
    assert found.best is found.history[found.best["trial"]]


def test_the_history_is_a_table():
    found = minimised(bowl)
    assert [row["trial"] for row in found.history] == list(range(6))
    for row in found.history:
        assert row["objective"] == bowl(row["width"], row["height"])["objective"]
        assert row["area"] == row["width"] * row["height"]
        assert 0 <= row["width"] <= 4
        assert row["failure"] is None
    assert "budget of 6" in found.stop_reason


def test_the_same_seed_is_the_same_search():
    assert minimised(bowl, seed=2).history == minimised(bowl, seed=2).history
    assert minimised(bowl, seed=2).history != minimised(bowl, seed=3).history


def test_a_pair_and_a_number_will_do_too():
    by_order = minimised(lambda width, height: (width, [1 - width]))
    by_name = minimised(lambda width, height: (width, {"too_narrow": 1 - width}))
    alone = minimised(lambda width, height: width, constraints=())
    assert by_order.history == by_name.history
    assert [row["objective"] for row in alone.history] == [row["width"] for row in alone.history]


def fails(width, height):
    raise RuntimeError("mesh tangled")


@pytest.mark.parametrize(
    ("function", "reason"),
    [
        (fails, "RuntimeError: mesh tangled"),
        (lambda width, height: (math.nan, [0.0]), "objective is nan"),
        (lambda width, height: (1.0, [math.inf]), "too_narrow is inf"),
        (lambda width, height: (1.0, [0.0, 0.0]), "2 constraints, not 1"),
        (lambda width, height: 1.0, "0 constraints, not 1"),
        (lambda width, height: {"objective": 1.0}, "no too_narrow"),
        (lambda width, height: {"too_narrow": 1.0}, 'no "objective"'),
        (lambda width, height: None, "no number"),
        (lambda width, height: ("low", [0.0]), "no number"),
        (lambda width, height: (1.0, ["much"]), "could not convert"),
        (lambda width: (1.0, [0.0]), "unexpected keyword argument 'height'"),
    ],
)
def test_a_useless_answer_is_noted_and_survived(function, reason):
    found = minimised(function, budget=2)
    if reason == "no number":
        assert all("number" in row["failure"] or "constraints" in row["failure"]
                   for row in found.history)  # fmt: skip
    else:
        assert all(reason in row["failure"] for row in found.history)
    assert found.best is None
    assert not found.feasible


def test_some_failures_do_not_end_a_search_but_nothing_else_does():
    def sometimes(width, height):
        return bowl(width, height) if width < 3 else fails(width, height)

    found = minimised(sometimes, budget=12)
    assert len(found.history) == 12
    assert found.feasible
    assert any(row["failure"] for row in found.history)
    assert "first 20" in minimised(fails, budget=40).stop_reason


MOODS = """
import os, time
def moods(width, height):
    if width > 3:
        time.sleep(60)
    if width < 1:
        os._exit(7)
    if height > 0.9:
        raise RuntimeError("mesh tangled")
    return {"objective": width, "process": os.getpid()}
"""


def test_a_function_that_stalls_or_crashes_costs_its_own_evaluation_only(tmp_path, monkeypatch):
    (tmp_path / "moods_of_a_model.py").write_text(MOODS)
    monkeypatch.syspath_prepend(str(tmp_path))
    from moods_of_a_model import moods

    designs = [(2, 0), (3.5, 0), (2, 1), (2.5, 0), (0.5, 0), (1.5, 0)]
    found = minimised(
        moods,
        constraints=(),
        given=[{"width": width, "height": height} for width, height in designs],
        timeout=1.0,
    )
    failures = [row["failure"] for row in found.history]
    assert failures[0] is failures[3] is failures[5] is None
    assert "longer than 1 s" in failures[1]
    assert failures[2] == "RuntimeError: mesh tangled"
    assert "exit code 7" in failures[4]
    assert len({found.history[place]["process"] for place in (0, 3, 5)}) == 3
    assert found.best["width"] == 1.5


@pytest.mark.parametrize(
    ("settings", "failures"),
    [
        ({"variables": {}}, "variables is empty"),
        ({"variables": {"width": (1.0, 0.0)}}, "the lower first"),
        ({"variables": {"width": 3.0}}, "no pair"),
        ({"constraints": ("width",)}, "name in use"),
        ({"budget": 0}, "budget is 0"),
        ({"method": "gradient"}, "choose automatic"),
        ({"timeout": -1.0}, "above zero"),
        ({"timeout": 1.0}, "top of a file"),
        ({"given": [{"width": 9.0, "height": 0.0}]}, "is 9, outside 0 to 4"),
        ({"given": [{"width": 1.0}]}, "every variable"),
    ],
)
def test_what_cannot_be_used_is_reported_in_a_sentence(settings, failures):
    with pytest.raises(InputError, match=failures):
        camring.minimise_function(lambda **_: 1.0, **{"variables": BOUNDS, **settings})
