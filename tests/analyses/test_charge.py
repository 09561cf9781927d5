"""The least return pressure at each speed: sought by all speeds together, found by hand."""

import jax
import motor_files
import numpy as np
import pytest
from motors import STRUCTURES, sound_case

from camring.analyses import charge
from camring.analyses.charge import ATMOSPHERE, ChargeCurve, _least, charge_pressures
from camring.physics.operating_point import OperatingPoint
from camring.presentation.charge import charge_document, print_charge
from camring.presentation.console import console
from camring.programs.compiled import simulate, summarise


def test_zeros_of_rising_margins_are_found_together_and_each_by_itself():
    """Straight, bent, kept at once, never kept, not to be simulated."""
    asked = []

    def margin(back):
        asked.append(back)
        x = back / 1e5
        bent = np.minimum(2 * (x - 30), np.sqrt(np.maximum(x, 0)) - 5)
        return 1e5 * np.stack([x - 7, bent, x + 4, 0 * x - 1, np.nan * x], axis=0).diagonal()

    found = _least(margin, np.full(5, 1e5))
    np.testing.assert_allclose(found[:3] / 1e5, [7, 30, 1], atol=1e-3)
    assert np.all(np.isnan(found[3:]))
    assert len(asked) < 20


def one_by_one(motors, fluids, points, **_):
    """`results_of_many` by the program for one motor, which other tests have compiled already."""
    found = []
    for place in range(len(points.shaft_speed)):
        case = jax.tree.map(lambda leaf, k=place: leaf[..., k], (motors, fluids, points))
        cycle = simulate(*case)
        found.append((summarise(cycle), cycle.verdict.code))
    return jax.tree.map(lambda *leaves: np.stack(leaves), *jax.device_get(found))


@pytest.fixture(scope="module")
def found():
    """A motor whose pistons are so heavy that rollers would lift, and its charge pressures."""
    case = sound_case(0, STRUCTURES[0])
    mass = float(case.motor.piston.mass)
    motor, fluid, point = case.changed(lambda c: c.motor.piston.mass, 60 * mass)
    speeds = float(point.shaft_speed) * np.array([0.2, 1.5, 3.0])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(charge, "results_of_many", one_by_one)
        pressures, by_contact = charge_pressures(motor, fluid, point, speeds, ATMOSPHERE)
    return motor, fluid, point, speeds, pressures, by_contact


def test_at_the_charge_pressure_the_margin_is_kept_and_no_more_than_that_above_the_atmosphere(
    found,
):
    motor, fluid, point, speeds, pressures, by_contact = found
    drop = float(point.pressure_drop)
    for speed, back, contact in zip(speeds, pressures, by_contact, strict=True):
        at = OperatingPoint(speed, back + drop, back, ATMOSPHERE)
        results = summarise(simulate(motor, fluid, at))
        kept = float(results.min_contact_force) / float(motor.piston.area)
        released = float(results.air_release_margin)
        assert min(kept, released) > -200.0
        if back > 1.01 * ATMOSPHERE:  # what throttling at the return port does not give
            assert min(kept, released) == pytest.approx(0, abs=200.0)
        assert contact == (kept <= released)


def test_the_curve_is_reported_in_words_and_numbers(found, capsys):
    _, _, point, speeds, pressures, by_contact = found
    curve = ChargeCurve(speeds, pressures, by_contact, float(point.pressure_drop), 1e5, True)
    assert charge_document(curve)["min_charge_pressure"] == pressures.tolist()
    print_charge(curve, console())
    said = capsys.readouterr().out
    assert "rollers" in said
    assert f"{pressures[-1] / 1e5:.4g}" in said
    assert "as the file gives it" in " ".join(said.split())


def test_a_map_names_its_charge_files_before_it_simulates(tmp_path):
    from command_line import refused

    path = tmp_path / "motor.toml"
    path.write_text(motor_files.SOUND)
    (tmp_path / "charge.csv").write_text("")
    said = refused("map", path, "--out", tmp_path, "--charge", "--format", "none")
    assert "charge.csv exists; give another --out" in said
