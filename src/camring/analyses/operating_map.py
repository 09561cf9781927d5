"""One motor over two of shaft speed, supply pressure and oil temperature."""

from dataclasses import replace
from math import pi

import numpy as np
from jaxtyping import Array

from camring.analyses.grid import Axis, Grid
from camring.analyses.oil_use import oils_at, require_oil, unread_viscosity
from camring.analyses.ranges import axis, point_counts
from camring.evaluation.simulations import repeated, results_of_many, stacked
from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.files.motor.entries import Number, Unfit
from camring.files.motor.keys import key_map
from camring.files.units import from_si, to_si
from camring.numerics.quantity import real
from camring.objective.constraints import UPPER_LIMITS
from camring.physics.operating_point import OperatingPoint

SPEED, SUPPLY = "operating_points.speed", "operating_points.supply_pressure"
TEMPERATURE = "fluid.temperature"
ON_EACH_AXIS = 40
SLOWEST, FASTEST = 0.05, 1.5  # of the file's highest speed
LOWEST, HIGHEST = 0.1, 1.25  # of the file's highest pressure drop
RPM, BAR = 2 * pi / 60, 1e5


def operating_map(
    file: MotorFile,
    *,
    speed: str | None = None,
    pressure: str | None = None,
    temperature: str | None = None,
    points: str | None = None,
    operating_point: int = 1,
) -> Grid:
    """Every result of a motor over speed and supply pressure, or one of them and temperature.

    Parameters
    ----------
    speed, pressure
        Ranges, `"10 rpm..300 rpm"` and `"50 bar..350 bar"` (absolute supply pressure);
        unless given, those of the file's `[envelope]`, without one from near standstill to
        half above the file's highest.
    temperature
        A range, `"20 degC..80 degC"`, of the oil that comes in, for an oil by its name. It takes
        the place of the pressures, or where these are given that of the speeds; what has no
        axis is that of the operating point.
    points
        Values on each axis, `"40x40"`: speeds first, temperatures last.
    operating_point
        Number of the operating point, counted from 1, whose return and case pressure
        are kept.

    Raises
    ------
    InputError
        For a range that is none, a supply pressure not above the return pressure, or an
        operating point that brakes; see `quadrants`.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> found = camring.operating_map(
    ...     file, speed="50 rpm..150 rpm", pressure="100 bar..300 bar", points="4x3"
    ... )
    >>> found.results["efficiency"].shape, int(found.faults.max())
    ((4, 3), 0)
    """
    axes, values = _asked(file, operating_point, speed, pressure, temperature, points)
    return _over(file, axes, values, operating_point)


def maps_beside(
    file: MotorFile,
    other: MotorFile,
    *,
    speed: str | None = None,
    pressure: str | None = None,
    temperature: str | None = None,
    points: str | None = None,
    operating_point: int = 1,
) -> tuple[Grid, Grid]:
    """The map of a motor, and that of another over the same values.

    Parameters
    ----------
    speed, pressure, temperature, points, operating_point
        As `operating_map`; ranges that are left out are those of the first motor.

    Raises
    ------
    InputError
        As `operating_map`, of either motor, before anything is simulated.
    """
    axes, values = _asked(file, operating_point, speed, pressure, temperature, points)
    try:
        there = _driving_point(other, operating_point)
        if TEMPERATURE in values:
            require_oil(other)
        others = {each.key: _checked(each, other) for each in axes}
        _require_drop(axes, others, there)
    except InputError as error:
        raise error.of(printable(other.path)) from None
    return (
        _over(file, axes, values, operating_point),
        _over(other, axes, others, operating_point),
    )


def _asked(
    file: MotorFile,
    operating_point: int,
    speed: str | None,
    pressure: str | None,
    temperature: str | None,
    points: str | None,
) -> tuple[tuple[Axis, ...], dict[str, np.ndarray]]:
    """Both axes of a map, and their values in SI by key."""
    point = _driving_point(file, operating_point)
    counts = point_counts(points, 2, ON_EACH_AXIS)
    return _axes(file, point, _ranges(file, point, speed, pressure, temperature), counts)


def _driving_point(file: MotorFile, operating_point: int) -> OperatingPoint:
    point = point_of(file, operating_point)
    if float(point.pressure_drop) < 0:
        raise InputError(
            f"operating point {operating_point}",
            f"brakes, from {float(point.supply_pressure) / BAR:.4g} bar against "
            f"{float(point.return_pressure) / BAR:.4g} bar, where a map is one of driving",
            "add --quadrants, which shows both, or choose another with --point",
        )
    return point


def _over(
    file: MotorFile,
    axes: tuple[Axis, ...],
    values: dict[str, np.ndarray],
    operating_point: int,
) -> Grid:
    """The motor at every combination of the axes' values, SI by key."""
    system, point = file.system, point_of(file, operating_point)
    places = np.meshgrid(*(np.arange(len(each.shown)) for each in axes), indexing="ij")
    place = {each.key: at.ravel() for each, at in zip(axes, places, strict=True)}
    count = places[0].size

    def over(key: str, otherwise: Array) -> Array:
        return real(values[key][place[key]]) if key in values else repeated(otherwise, count)

    fluids = repeated(system.fluid, count)
    if TEMPERATURE in values:
        warm = oils_at(file, values[TEMPERATURE])
        fluids = stacked([warm[k] for k in place[TEMPERATURE]])
    asked = replace(
        repeated(point, count),
        shaft_speed=over(SPEED, point.shaft_speed),
        supply_pressure=over(SUPPLY, point.supply_pressure),
    )
    found = results_of_many(
        repeated(system.motor, count),
        fluids,
        asked,
        harmonics=file.goal.harmonics,
    )
    title = described(file, operating_point, without=set(values))
    grid = Grid.of(axes, *found, limits_of(file), title, unread_viscosity(file))
    return replace(grid, envelope=envelope_on(axes, file))


def map_axes(
    file: MotorFile,
    speed: str | None,
    pressure: str | None,
    operating_point: int,
    counts: tuple[int, ...],
) -> tuple[Axis, Axis]:
    """Speeds and supply pressures of driving, as typed or as the file has them.

    Raises
    ------
    InputError
        For a range that is none, or a supply pressure not above the low side's.
    """
    point = point_of(file, operating_point)
    (speeds, pressures), _ = _axes(file, point, _ranges(file, point, speed, pressure, None), counts)
    return speeds, pressures


def _axes(
    file: MotorFile, point: OperatingPoint, ranges: dict[str, str], counts: tuple[int, ...]
) -> tuple[tuple[Axis, ...], dict[str, np.ndarray]]:
    """Both axes, and their values in SI by key."""
    axes = tuple(
        axis(key, text, _number(file, key), count)
        for (key, text), count in zip(ranges.items(), counts, strict=True)
    )
    values = {each.key: _checked(each, file) for each in axes}
    _require_drop(axes, values, point)
    return axes, values


def _ranges(
    file: MotorFile,
    point: OperatingPoint,
    speed: str | None,
    pressure: str | None,
    temperature: str | None,
) -> dict[str, str]:
    """The two axes, by the keys of the motor file, with the range of each."""
    if temperature is None:
        return {
            SPEED: speed or _usual_speeds(file),
            SUPPLY: pressure or _usual_pressures(file, point),
        }
    if speed is not None and pressure is not None:
        raise InputError(
            "--temperature",
            "is a third axis beside --speed and --pressure, and a picture has two",
            "leave one of the three out: it is then held at the operating point's",
        )
    require_oil(file)
    if pressure is not None:
        return {SUPPLY: pressure, TEMPERATURE: temperature}
    return {SPEED: speed or _usual_speeds(file), TEMPERATURE: temperature}


def _require_drop(
    axes: tuple[Axis, ...], values: dict[str, np.ndarray], point: OperatingPoint
) -> None:
    """Refuse supply pressures that are not above that of the low side."""
    back = float(point.lower_pressure)
    for each in axes:
        if each.key == SUPPLY and values[SUPPLY].min() <= back:
            raise InputError(
                "--pressure",
                f"begins at {each.text(int(np.argmin(values[SUPPLY])))}, not above the return "
                f"pressure of {back / BAR:.4g} bar",
                "raise it, or choose another operating point with --point; pressures are absolute",
            )


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
    kept += f", mode {point.mode}" * bool(point.mode)
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


def envelope_on(axes: tuple[Axis, ...], file: MotorFile) -> tuple[tuple[float, float], ...] | None:
    """The range in which the motor must run, in the units of the axes."""
    if file.envelope is None:
        return None
    ranges = {SPEED: file.envelope.speed, SUPPLY: file.envelope.supply_pressure}
    if file.envelope.temperatures:
        coldest, hottest = file.envelope.temperatures
        ranges[TEMPERATURE] = coldest, hottest
    if any(each.key not in ranges for each in axes):
        return None
    units = {each.key: _number(file, each.key).unit for each in axes}
    return tuple(
        (from_si(low, each.unit, units[each.key]), from_si(high, each.unit, units[each.key]))
        for each in axes
        for low, high in [ranges[each.key]]
    )


def _usual_speeds(file: MotorFile) -> str:
    if file.envelope is not None:
        return _between(file.envelope.speed, RPM, "rpm")
    highest = max(float(each.shaft_speed) for each in file.system.operating_points) / RPM
    return f"{_round(SLOWEST * highest):g} rpm..{_round(FASTEST * highest):g} rpm"


def _usual_pressures(file: MotorFile, point: OperatingPoint) -> str:
    if file.envelope is not None:
        return _between(file.envelope.supply_pressure, BAR, "bar")
    back = float(point.lower_pressure) / BAR
    drop = max(abs(float(p.pressure_drop)) for p in file.system.operating_points) / BAR
    return f"{_round(back + LOWEST * drop):g} bar..{_round(back + HIGHEST * drop):g} bar"


def _between(ends: tuple[float, float], scale: float, unit: str) -> str:
    return "..".join(f"{end / scale:.9g} {unit}" for end in ends)


def _round(value: float) -> float:
    """To two digits, so that an axis begins and ends at a number one would choose."""
    return float(f"{value:.2g}")
