"""Four quadrants: both signs of speed and of pressure difference, each as it is by itself."""

import jax
import numpy as np
import pytest
from motor_files import SOUND
from typer.testing import CliRunner

from camring.analyses import quadrants as module
from camring.analyses.operating_map import operating_map
from camring.analyses.quadrants import quadrants
from camring.cli.app import app
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.programs.compiled import simulate, summarise

FILE = parse_motor_file(SOUND)


def one_by_one(motors, fluids, points, harmonics):
    """`results_of_many` by the program for one motor, which other tests have compiled already."""
    found = []
    for place in range(len(points.shaft_speed)):
        case = jax.tree.map(
            lambda leaf, k=place: np.asarray(leaf)[..., k], (motors, fluids, points)
        )
        cycle = simulate(*case)
        found.append((summarise(cycle, harmonics), cycle.verdict.code))
    return jax.tree.map(lambda *leaves: np.stack(leaves), *jax.device_get(found))


@pytest.fixture(scope="module")
def found():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "results_of_many", one_by_one)
        return quadrants(FILE, speed="60..200 rpm", pressure="110..260 bar", points="4x4")


def test_axes_are_mirrored_and_hold_no_zero(found):
    speeds, drops = (axis.shown for axis in found.axes)
    np.testing.assert_allclose(speeds, [-200, -60, 60, 200])
    low = float(FILE.system.operating_points[0].return_pressure) / 1e5
    np.testing.assert_allclose(drops, [low - 260, low - 110, 110 - low, 260 - low])


def test_the_load_drives_in_the_second_and_the_fourth(found):
    np.testing.assert_array_equal(found.mode[:2, :2], "motor")
    np.testing.assert_array_equal(found.mode[2:, 2:], "motor")
    np.testing.assert_array_equal(found.mode[:2, 2:], "pump")
    np.testing.assert_array_equal(found.mode[2:, :2], "pump")


def test_each_point_is_the_operating_point_that_it_stands_for(found):
    """Forwards at 200 rpm the other port has the pressure: supply low, return high."""
    motor, fluid = FILE.system.motor, FILE.system.fluid
    first = FILE.system.operating_points[0]
    low = float(first.return_pressure)
    at = type(first)(200 * np.pi / 30, low, 260e5, float(first.case_pressure))
    alone = summarise(simulate(motor, fluid, at), FILE.goal.harmonics)
    for name in ("mean_torque", "supply_flow", "efficiency", "torque_ripple"):
        expected = float(getattr(alone, name))
        assert found.results[name][3, 0] == pytest.approx(expected, rel=1e-9), name


def test_a_picture_names_all_four(found):
    from camring import plots

    figure = plots.quadrant_map(found, "efficiency")
    said = [text.get_text().replace("\n", " ") for text in figure.axes[0].texts]
    for words in ("drives forwards", "brakes forwards", "drives backwards", "brakes backwards"):
        assert words in said
    with pytest.raises(InputError, match="both signs"):
        plots.quadrant_map(module.replace(found, quadrants=False), "efficiency")


def test_what_cannot_be_is_refused_in_a_sentence(tmp_path):
    path = tmp_path / "motor.toml"
    path.write_text(SOUND)
    arguments = ["map", str(path), "--quadrants", "--points", "5x4", "--out", str(tmp_path / "q")]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert "even numbers" in done.stderr
    braking = SOUND.replace('return_pressure = "10 bar"', 'return_pressure = "300 bar"', 1)
    assert braking != SOUND
    with pytest.raises(InputError, match=r"add --quadrants"):
        operating_map(parse_motor_file(braking))
