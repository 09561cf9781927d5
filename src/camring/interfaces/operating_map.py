"""One motor over shaft speed and supply pressure."""

from math import pi

import numpy as np

from camring.interfaces.batch import repeated, results_of_many
from camring.interfaces.config import MotorFile
from camring.interfaces.config.entries import Number, Unfit
from camring.interfaces.config.keys import key_map
from camring.interfaces.errors import InputError
from camring.interfaces.grid import Axis, Grid
from camring.interfaces.ranges import axis, point_counts
from camring.interfaces.units import to_si
from camring.objective.constraints import UPPER_LIMITS
from camring.physics.operating_point import OperatingPoint

SPEED, SUPPLY = "operating_points.speed", "operating_points.supply_pressure"
ON_EACH_AXIS = 40
SLOWEST, FASTEST = 0.05, 1.5  # of the file's highest speed
LOWEST, HIGHEST = 0.1, 1.25  # of the file's highest pressure drop
RPM, BAR = 2 * pi / 60, 1e5


def operating_map(
    file: MotorFile,
    *,
    speed: str | None = None,
    pressure: str | None = None,
    points: str | None = None,
    operating_point: int = 1,
) -> Grid:
    """Every result of a motor over speed and supply pressure.

    Parameters
    ----------
    speed, pressure
        Ranges, `"10 rpm..300 rpm"` and `"50 bar..350 bar"` (absolute supply pressure);
        unless given, from near standstill to half above the file's highest.
    points
        Values on each axis, `"40x40"`: speeds first.
    operating_point
        Number of the operating point, counted from 1, whose return and case pressure
        are kept.

    Raises
    ------
    InputError
        For a range that is none, or a supply pressure not above the return pressure.
    """
    point = point_of(file, operating_point)
    counts = point_counts(points, 2, ON_EACH_AXIS)
    system = file.system
    speed = speed or _usual_speeds(file)
    pressure = pressure or _usual_pressures(file, point)
    axes = tuple(
        axis(key, text, _number(file, key), count)
        for key, text, count in zip((SPEED, SUPPLY), (speed, pressure), counts, strict=True)
    )
    speeds, pressures = (_checked(each, file) for each in axes)
    back = float(point.return_pressure)
    if pressures.min() <= back:
        raise InputError(
            "--pressure",
            f"begins at {axes[1].text(int(np.argmin(pressures)))}, not above the return pressure "
            f"of {back / BAR:.4g} bar",
            "raise it, or choose another operating point with --point; pressures are absolute",
        )
    grid_speed, grid_pressure = (
        each.ravel() for each in np.meshgrid(speeds, pressures, indexing="ij")
    )
    count = grid_speed.size
    asked = OperatingPoint(
        shaft_speed=grid_speed,
        supply_pressure=grid_pressure,
        return_pressure=repeated(point.return_pressure, count),
        case_pressure=repeated(point.case_pressure, count),
        weight=repeated(point.weight, count),
        reverse=point.reverse,
    )
    found = results_of_many(
        repeated(system.motor, count),
        repeated(system.fluid, count),
        asked,
        harmonics=file.goal.harmonics,
    )
    title = described(file, operating_point, without={SPEED, SUPPLY})
    return Grid.of(axes, *found, limits_of(file), title)


def point_of(file: MotorFile, number: int) -> OperatingPoint:
    """An operating point by its number in the file, counted from 1.

    Raises
    ------
    InputError
        When there is none of this number.
    """
    points = file.system.operating_points
    if not 1 <= number <= len(points):
        raise InputError(
            "--point",
            f"is {number} but the motor file has {len(points)} operating points",
            f"give a number from 1 to {len(points)}",
        )
    return points[number - 1]


def described(file: MotorFile, number: int, without: set[str]) -> str:
    """The motor's name and what of its operating point is held still."""
    point = point_of(file, number)
    held = [
        (SPEED, f"{float(point.shaft_speed) / RPM:.4g} rpm"),
        (SUPPLY, f"supply {float(point.supply_pressure) / BAR:.4g} bar"),
        (
            "operating_points.return_pressure",
            f"return {float(point.return_pressure) / BAR:.4g} bar",
        ),
        ("operating_points.case_pressure", f"case {float(point.case_pressure) / BAR:.4g} bar"),
    ]
    own = {key.replace(f"[{number - 1}]", "") for key in without}
    kept = ", ".join(text for key, text in held if key not in own) + ", reverse" * point.reverse
    return f"{file.system.motor.name or file.path.stem}\n{kept}"


def limits_of(file: MotorFile) -> dict[str, float]:
    """Upper limits of the file's [constraints] by the result they bound, SI."""
    given = file.goal.constraints
    limits = {result: getattr(given, name) for name, result in UPPER_LIMITS.items()}
    return {name: limit for name, limit in limits.items() if limit is not None}


def _checked(each: Axis, file: MotorFile) -> np.ndarray:
    """The axis in SI, both ends within the limits of its key."""
    entry = _number(file, each.key)
    for end in (each.shown.min(), each.shown.max()):
        text = f"{float(end)!r} {each.unit}".rstrip()
        try:
            entry.read(text if each.unit else float(end))
        except Unfit as error:
            raise InputError(each.key, error.problem, entry.way_out) from None
    return np.array([to_si(f"{float(v)!r} {each.unit}".rstrip(), entry.unit) for v in each.shown])


def _number(file: MotorFile, key: str) -> Number:
    """What a key takes that is known to be a number."""
    entry = key_map(file.choices)[key]
    assert isinstance(entry, Number)
    return entry


def _usual_speeds(file: MotorFile) -> str:
    highest = max(float(each.shaft_speed) for each in file.system.operating_points) / RPM
    return f"{_round(SLOWEST * highest):g} rpm..{_round(FASTEST * highest):g} rpm"


def _usual_pressures(file: MotorFile, point: OperatingPoint) -> str:
    back = float(point.return_pressure) / BAR
    drop = max(float(p.pressure_drop) for p in file.system.operating_points) / BAR
    return f"{_round(back + LOWEST * drop):g} bar..{_round(back + HIGHEST * drop):g} bar"


def _round(value: float) -> float:
    """To two digits, so that an axis begins and ends at a number one would choose."""
    return float(f"{value:.2g}")
