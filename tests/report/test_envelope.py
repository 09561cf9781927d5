"""The report's envelope: every point is a cell, what is broken is framed, nothing stays unsaid."""

import json
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
import report_example as example

from camring.presentation.envelope import envelope_of, read_envelope
from camring.report.page import render
from camring.report.pictures.envelope import letters, margin_figures, ripple_figures
from camring.report.verdicts import verdict_of

SPEEDS, PRESSURES = (30.0, 95.0, 300.0), (70.0, 210.0, 350.0)
RANGE = "70 to 350 bar, 30 to 300 rpm, at 10 bar charge"


def design(count, lift, ripple, sentence="runs without lift-off or cavitation from " + RANGE):
    """Contact force as given, all else kept by a tenth; compared with itself to the letter."""
    limits = {
        "min_contact_force": lift,
        "max_contact_stress": [-0.1] * count,
        "max_ripple_ratio": [0.0] * count,
    }
    broken = [not max(each) <= 0 for each in zip(*limits.values(), strict=True)]
    return {
        "limits": {name: [None if np.isnan(g) else g for g in v] for name, v in limits.items()},
        "torque_ripple": [ripple * (1 + 0.1 * k) for k in range(count)],
        "efficiency": [0.92] * count,
        "broken": broken,
        "sentence": sentence,
    }


def document(best=None, *, asked=True, ways=1, warning=""):
    pairs = [(s * np.pi / 30, p * 1e5) for s in SPEEDS for p in PRESSURES] * ways
    count = len(pairs)
    own = [-0.05] * count
    return {
        "asked": asked,
        "range": RANGE,
        "speed": [speed for speed, _ in pairs],
        "supply_pressure": [pressure for _, pressure in pairs],
        "return_pressure": [1e6] * count,
        "backwards": [k >= 9 for k in range(count)],
        "fluid": [0] * count,
        "designs": {
            "given": design(count, own, 0.08),
            "best": design(count, own if best is None else best, 0.01),
        },
        "second_solver": [{"point": 0, "limit": "max_contact_stress", "g": -0.1}],
        "warning": warning,
    }


def cells(picture):
    """Frame colour, letter with number, and what each cell tells, of one picture."""
    space = "{http://www.w3.org/2000/svg}"
    return [
        (
            cell.find(f"{space}rect").get("stroke"),
            " ".join(text.text for text in cell.iter(f"{space}text")),
            cell.get("data-words"),
        )
        for cell in ElementTree.fromstring(picture).iter(f"{space}g")
        if cell.get("class") == "cell"
    ]


@pytest.fixture(scope="module")
def study():
    return example.make_report()


def test_each_point_is_a_cell_with_the_letter_of_its_limit_and_its_margin():
    lift = [-0.01 * (k + 2) for k in range(9)]
    envelope = envelope_of(document(lift))
    (condition,), same = envelope.conditions()
    given, best = margin_figures(envelope, 0, condition)
    drawn = cells(best.picture)
    # At 0 the ripple stands on the given motor's own: the tightest of the best motor.
    assert [text for _, text, _ in drawn] == ["R 0"] * 9
    assert [text for _, text, _ in cells(given.picture)] == ["L 5.0"] * 9
    assert letters(envelope) == {"min_contact_force": "L", "max_ripple_ratio": "R"}
    assert same == ""
    assert "30 rpm, 70 bar" in drawn[0][2]
    assert "second solver" in drawn[0][2]
    assert "second solver" not in drawn[1][2]


def test_a_broken_point_is_framed_and_counted():
    lift = [0.2, 0.1, *[-0.04] * 6, float("nan")]
    said = document(lift)
    said["designs"]["best"]["limits"].pop("max_ripple_ratio")
    envelope = envelope_of(said)
    condition = envelope.conditions()[0][0]
    _, best = margin_figures(envelope, 0, condition)
    drawn = cells(best.picture)
    frames = [frame for frame, _, _ in drawn]
    assert len(set(frames[:2] + frames[8:])) == 1
    assert set(frames[2:8]).isdisjoint(frames[:2])
    assert [text for _, text, _ in drawn][:3] == ["L −20", "L −10", "L 4.0"]
    assert "broken at 3 of 9 points" in best.sentence
    assert "broken" in drawn[0][2]


def test_the_given_motor_is_not_held_against_itself():
    said = document()
    said["designs"]["given"]["limits"]["max_ripple_ratio"] = [1.0] * 9
    said["designs"]["given"]["broken"] = [True] * 9
    given, _ = envelope_of(said).designs
    assert not given.broken.any()
    assert set(given.binding) == {"min_contact_force"}


def test_a_point_without_result_stays_broken_for_the_given_motor():
    said = document()
    said["designs"]["given"]["broken"][4] = True
    given, _ = envelope_of(said).designs
    assert list(np.flatnonzero(given.broken)) == [4]


def test_both_ways_are_one_row_until_they_differ():
    said = document(ways=2)
    for each in said["designs"].values():
        each["torque_ripple"] = each["torque_ripple"][:9] * 2
    found, same = envelope_of(said).conditions()
    assert [condition.words for condition in found] == [""]
    assert "same as forwards" in same
    said["designs"]["best"]["limits"]["min_contact_force"][10] = 0.1
    said["designs"]["best"]["broken"][10] = True
    envelope = envelope_of(said)
    found, same = envelope.conditions()
    assert [condition.words for condition in found] == ["forwards", "backwards"]
    assert same == ""
    names = [
        figure.name
        for row, each in enumerate(found)
        for figure in margin_figures(envelope, row, each)
    ]
    assert len(set(names)) == 4


def test_oils_and_return_pressures_have_a_row_each():
    said = document(ways=4)
    said["backwards"] = [False] * 36
    said["fluid"] = [0] * 18 + [1] * 18
    said["return_pressure"] = ([8e5] * 9 + [2e6] * 9) * 2
    found, _ = envelope_of(said).conditions()
    assert [condition.words for condition in found] == [
        "cold oil, return 8 bar",
        "cold oil, return 20 bar",
        "hot oil, return 8 bar",
        "hot oil, return 20 bar",
    ]
    assert all(len(condition.points) == 9 for condition in found)


def test_a_single_speed_still_has_cells():
    said = document()
    said["speed"] = [31.4] * 9
    said["supply_pressure"] = list(np.linspace(70e5, 350e5, 9))
    envelope = envelope_of(said)
    condition = envelope.conditions()[0][0]
    for figure in (
        *margin_figures(envelope, 0, condition),
        *ripple_figures(envelope, 0, condition),
    ):
        assert len(cells(figure.picture)) == 9


def test_the_ripple_is_reported_in_the_mean_and_at_its_worst():
    envelope = envelope_of(document())
    _, best = ripple_figures(envelope, 0, envelope.conditions()[0][0])
    assert "1.40 % in the mean" in best.sentence
    assert "1.80 % at 300 rpm, 350 bar" in best.sentence


def test_the_head_tells_where_given_and_best_run(study):
    page = render(replace(study, envelope=envelope_of(document())))
    head = page.split("<nav")[0]
    for name in ("given", "best"):
        assert f"<b>{name}: </b>runs without lift-off or cavitation from {RANGE}." in head
    # The tightest margin of the tiles is that of the envelope where it is the least.
    assert "Torque ripple against the given motor, in the envelope" in head
    assert 'id="envelope"' in page


def test_without_an_envelope_the_warning_is_the_first_thing_said(study):
    warning = "Outside its operating points the best design is worse than the given motor."
    said = document(asked=False, warning=warning)
    page = render(replace(study, envelope=envelope_of(said), warnings=(warning, *study.warnings)))
    head, _, rest = page.partition("<nav")
    assert warning in head
    assert "<b>best: </b>" not in head
    assert "The motor file has no [envelope]" in rest


def test_a_report_without_the_key_has_no_such_section(study):
    assert 'id="envelope"' not in render(study)


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "not json",
        '{"envelope": {}}',
        '{"envelope": 3}',
        json.dumps({"envelope": document() | {"speed": [1.0]}}),
        json.dumps({"envelope": document() | {"designs": {}}}),
    ],
)
def test_an_old_or_damaged_validation_has_no_envelope(tmp_path, text):
    path = tmp_path / "validation.json"
    path.write_text(text)
    assert read_envelope(path) is None
    path.write_text(json.dumps({"envelope": document()}))
    assert read_envelope(path).designs[1].label == "best"


def test_the_margins_of_checks_are_per_cent():
    checks = [
        ("max_pressure in the envelope", "margin 0.1655 at 30 rpm, 350 bar, the least of 126"),
        ("the envelope by SciPy's stiff solver", "least margin 0.002, of max_efficiency_loss"),
    ]
    found = verdict_of(
        {"checks": [{"name": n, "passed": True, "detail": d} for n, d in checks]}
    ).checks
    assert found[0].detail == "margin 16.6 % at 30 rpm, 350 bar, the least of 126"
    assert re.match("least margin 0.200 %, of efficiency lost", found[1].detail)
