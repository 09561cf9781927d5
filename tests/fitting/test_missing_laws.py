"""Which law a fit misses, by the shape of what is left over."""

from types import SimpleNamespace

import numpy as np
import pytest
from motor_files import added, without_table

from camring.files.motor import parse_motor_file
from camring.fitting.measurements.operating_points import operating_points_of
from camring.fitting.measurements.table import parse_measured_table
from camring.fitting.missing_laws import missing_law

PLACES = [(rpm, bar, t) for rpm in (20, 80, 150, 300) for bar in (100, 200, 300) for t in (30, 70)]
OIL = '\n[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n'
WARM = without_table("[fluid]") + OIL
HEAD = "speed [rpm],supply pressure [bar],oil temperature [degC],torque [Nm],flow [L/min]"


def left_over(shape, result, text=WARM, able=(), numbers=()):
    """A fit that misses a result by a shape of speed, pressure drop and viscosity.

    Parameters
    ----------
    able
        Shapes that the fitted numbers have: nothing of them is left.
    """
    file = parse_motor_file(text)
    rows = "\n".join([HEAD, *(f"{n},{p},{t},1000,10" for n, p, t in PLACES)])
    table = parse_measured_table(rows)
    points = operating_points_of(file, table)
    at = np.array(
        [(float(p.shaft_speed), float(p.pressure_drop), float(f.viscosity)) for p, f in points]
    ).T
    slopes = np.stack([each(*at) for each in able], axis=1) if able else np.zeros((len(points), 0))
    left = shape(*at)
    if able:
        left = left - slopes @ np.linalg.lstsq(slopes, left, rcond=None)[0]
    count = len(points)
    return SimpleNamespace(
        file=file,
        table=table,
        numbers=tuple(SimpleNamespace(key=key) for key in numbers),
        rows=np.arange(count),
        measured=np.ones(count),
        modelled=1 + left / np.max(np.abs(left)),
        deviation=np.full(count, 0.01),
        squares=SimpleNamespace(slopes=slopes, free=np.ones(slopes.shape[1], dtype=bool)),
        of=lambda name: np.full(count, name == result),
    )


def load(speed, drop, viscosity):
    return drop


def film(speed, drop, viscosity):
    return speed * viscosity


@pytest.mark.parametrize(
    ("shape", "result", "said"),
    [
        (lambda w, p, nu: w**2, "mean_torque", "[motor.churning] has that law"),
        (film, "mean_torque", "the film of [motor.gap] has that law"),
        (lambda w, p, nu: p / nu, "supply_flow", 'leakage = "viscous" has that law'),
        (lambda w, p, nu: p / nu, "case_drain", 'leakage = "viscous" has that law'),
    ],
)
def test_the_law_of_a_shape_is_named(shape, result, said):
    found = missing_law(left_over(shape, result), result)
    assert said in found
    assert found.startswith("100 % of it")


def test_what_the_fitted_numbers_can_do_hides_no_shape():
    """Friction with load and a film have taken what they can of a square of the speed."""
    found = left_over(lambda w, p, nu: w**2, "mean_torque", able=(load, film))
    assert "the square of the speed" in missing_law(found, "mean_torque")


def test_a_number_that_the_motor_has_is_named_to_be_fitted():
    text = added("[motor.valve_plate]", "", WARM)
    text += '\n[motor.churning]\nmoment_coefficient = 0\nradius = "100 mm"\n'
    found = missing_law(left_over(lambda w, p, nu: w**2, "mean_torque", text), "mean_torque")
    assert "moment_coefficient is kept as given: fit it too, with --of" in found


def test_chance_has_no_shape():
    random = np.random.default_rng(5)
    for _ in range(3):
        noise = random.normal(size=len(PLACES))
        for result in ("mean_torque", "supply_flow"):
            assert not missing_law(left_over(lambda w, p, nu, n=noise: n, result), result)
