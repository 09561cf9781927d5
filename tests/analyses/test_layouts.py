"""Motors of other counts keep what they are said to keep, and impossible ones say why."""

import csv
import io
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from camring.analyses.layouts.derived import Original, Unbuildable
from camring.analyses.layouts.layout import Layout, layouts_of
from camring.evaluation.outcome import Outcome
from camring.evaluation.record import Record
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file, read_motor_file
from camring.geometry.sampling import sample_spline
from camring.presentation.layouts import csv_text
from camring.workflows import layouts as study

WHEEL = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"


@pytest.fixture(scope="module")
def original() -> Original:
    return Original(read_motor_file(WHEEL))


def radii_of(text: str):
    system = parse_motor_file(text).system
    control = np.asarray(system.motor.cam.control_radii)
    return system, sample_spline(control, 2 * pi / system.motor.lobes, system.motor.cam.degree, 64)


@pytest.mark.parametrize("layout", [Layout(7, 6), Layout(7, 4), Layout(6, 8)], ids=str)
def test_displacement_and_outer_radius_stay_and_windows_keep_their_share_of_the_pitch(
    original, layout
):
    (given, before), (system, after) = (
        radii_of(original.file.text),
        radii_of(original.derived(layout)),
    )
    cylinders = [motor.pistons * motor.lobes for motor in (given.motor, system.motor)]
    swept = [count * np.ptp(r.value) for count, r in zip(cylinders, (before, after), strict=True)]
    assert swept[1] == pytest.approx(swept[0], rel=2e-5)
    assert after.value.max() == pytest.approx(before.value.max(), abs=1e-7)
    assert (system.motor.pistons, system.motor.lobes) == (layout.pistons, layout.lobes)
    plates = given.motor.valve_plate, system.motor.valve_plate
    for port in ("supply", "return_"):
        shares = [getattr(plate, port).width / plate.pitch for plate in plates]
        assert float(shares[1]) == pytest.approx(float(shares[0]), rel=1e-8)
    assert float(system.motor.piston.bore) == float(given.motor.piston.bore)


def test_a_spline_of_every_layout_could_hold_a_cam_of_zero_ripple(original):
    for layout in layouts_of("5,7", "6,8"):
        count = len(radii_of(original.derived(layout))[0].motor.cam.control_radii)
        assert count % 2 == 0
        assert count % layout.phases == 0


def test_the_given_counts_are_the_given_file_to_the_letter(original):
    assert original.derived(Layout(8, 6)) == WHEEL.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("layout", "reason"),
    [
        (Layout(5, 4), "needs a stroke of 28.3 mm"),
        (Layout(8, 4), "has 2 distinct piston phases"),
        (Layout(9, 4), "of block between the bores"),
    ],
    ids=str,
)
def test_what_cannot_be_built_says_its_number_and_the_limit(original, layout, reason):
    with pytest.raises(Unbuildable, match=reason):
        original.derived(layout)


def test_rollers_that_would_undercut_the_ring_are_refused():
    text = WHEEL.read_text(encoding="utf-8").replace('"12 mm"', '"33 mm"')
    text = text.replace("min_undercut_factor = 0.25\n", "")
    thick = Original(replace(parse_motor_file(text), text=text))
    with pytest.raises(Unbuildable, match="undercut"):
        thick.derived(Layout(7, 8))


def test_counts_are_lists_and_ranges_or_refused():
    assert layouts_of("5,7..8", "6") == [Layout(5, 6), Layout(7, 6), Layout(8, 6)]
    for text in ("", "five", "8..5", "1", "5,,6"):
        with pytest.raises(InputError, match="--pistons"):
            layouts_of(text, "6")
    with pytest.raises(InputError, match="make 100 layouts"):
        layouts_of("5..14", "3..12")


def test_load_on_the_shaft_is_balanced_and_orders_survive_as_counts_say():
    assert Layout(8, 6).balanced
    assert Layout(8, 6).surviving_order == 24
    assert not Layout(7, 6).balanced
    assert Layout(7, 6).surviving_order == 42


def test_finished_layouts_stay_and_the_stopped_one_goes_on(tmp_path, monkeypatch):
    """The loop alone: searching and its folders have tests of their own."""
    asked = list[str]()

    def optimise(motor, place, **_):
        asked.append(f"new {place.name}")
        place.mkdir()

    def resume(place, **_):
        asked.append(f"on {place.name}")

    def kept(layout, place):
        results = [dict.fromkeys(study_results, 1.0 / layout.pistons)]
        outcome = Outcome(1.0 / layout.pistons, physical_objective=0.1, results=results)
        record = Record(0, "given", np.zeros(1), outcome)
        return study.Studied(layout, place, record, record, True, "Validated.", 1)

    study_results = (
        "torque_ripple",
        "efficiency",
        "max_contact_stress",
        "max_pressure_angle",
        "stroke",
    )
    monkeypatch.setattr(study, "optimise", optimise)
    monkeypatch.setattr(study, "resume", resume)
    monkeypatch.setattr(study, "_kept", kept)
    monkeypatch.setattr(study, "_finished", lambda place, budget: place.name == "7x6")
    out, silent = tmp_path / "out", lambda sentence: None
    study.layouts(WHEEL, out, layouts_of("7,8", "6"), budget=9, say=silent)
    found = study.layouts(WHEEL, out, layouts_of("5,7,8,9", "6"), budget=9, say=silent)
    assert asked == ["new 7x6", "new 8x6", "new 5x6", "on 8x6"]
    assert [str(each.layout) for each in found.ranked] == ["8x6", "7x6", "5x6"]
    rows = list(csv.reader(io.StringIO(csv_text(found))))
    assert len({len(row) for row in rows}) == 1
    assert [row[1] for row in rows[1:]] == ["8", "7", "5", "9"]

    other = tmp_path / "other.toml"
    other.write_text(WHEEL.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    with pytest.raises(InputError, match="another motor file"):
        study.layouts(other, out, layouts_of("7", "6"), say=silent)
