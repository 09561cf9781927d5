"""What is said of motors that have modes."""

from collections import defaultdict
from types import SimpleNamespace

import pytest
from motor_files import SOUND

from camring.files.motor import parse_motor_file
from camring.files.point_names import name_of
from camring.presentation.facts import _of_all_lobes
from camring.presentation.limits import constraints_of
from camring.presentation.simulation import starts_in_words

MODE = "\n[motor.modes.half]\nidle_lobes = [1, 3, 5]\n"
POINT = 'weight = 0.6\nmode = "half"'
FULL, HALF = 4.004e-4, 2.002e-4  # m3/rev


def found(text, displacements):
    """A file and results of which only the displacement is a number of its own."""
    results = [defaultdict(float, displacement=each) for each in displacements]
    outcome = SimpleNamespace(
        constraints={"displacement_low": -0.01}, results=results, failure=None
    )
    return SimpleNamespace(file=parse_motor_file(text), outcome=outcome)


def rows(simulated):
    results = [SimpleNamespace(metrics=each) for each in simulated.outcome.results]
    said = constraints_of([simulated], [SimpleNamespace(results=results)])
    return {each.name: each.values[0] for each in said}


def test_the_band_of_displacement_is_held_against_points_of_all_lobes():
    simulated = found(SOUND.replace("weight = 0.6", POINT) + MODE, [HALF, FULL])
    assert rows(simulated)["displacement_low"] == "400.4 cm³/rev"
    assert _of_all_lobes(simulated, "displacement") == pytest.approx(FULL)


def test_where_no_point_runs_on_all_lobes_nothing_is_held_against_the_band():
    text = SOUND.replace("weight = 0.6", POINT).replace("weight = 0.4", 'mode = "half"') + MODE
    assert "displacement_low" not in rows(found(text, [HALF, HALF]))


@pytest.mark.parametrize(("torque", "starts"), [(1147.0, True), (-3.033, False)])
def test_a_motor_that_somewhere_has_no_torque_is_said_not_to_start(torque, starts):
    simulated = found(SOUND, [FULL, FULL])
    start = SimpleNamespace(
        starting_torque=lambda reverse: torque, starting_efficiency=lambda reverse: torque / 1529
    )
    simulated.starts = [start, start]
    first = starts_in_words(simulated)[0]
    assert first.endswith("does not start by itself.") is not starts
    assert "-" not in first  # a minus is a minus, also before the per cent


@pytest.mark.parametrize(
    ("lines", "name"),
    [
        ("", "300 rpm, 250 bar"),
        ('\nmode = "half"', "300 rpm, 250 bar, half"),
        ('\nrotation = "reverse"\nmode = "half"', "300 rpm, 250 bar, half, reverse"),
    ],
)
def test_an_operating_point_is_called_by_speed_pressure_mode_and_direction(lines, name):
    text = SOUND.replace("weight = 0.6", f"weight = 0.6{lines}") + MODE
    point = parse_motor_file(text).system.operating_points[0]
    assert name_of(point) == name
    braking = parse_motor_file(
        text.replace(
            'supply_pressure = "250 bar"\nreturn_pressure = "10 bar"',
            'supply_pressure = "10 bar"\nreturn_pressure = "250 bar"',
            1,
        )
    )
    assert "10 against 250 bar" in name_of(braking.system.operating_points[0])
