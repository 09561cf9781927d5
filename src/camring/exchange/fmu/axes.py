"""Which operating points a table has: from ranges on the command line or the motor file."""

from dataclasses import dataclass
from math import pi

import numpy as np
from jaxtyping import Float

from camring.analyses.ranges import axis, point_counts
from camring.files.errors import InputError, quote
from camring.files.motor import MotorFile
from camring.files.motor.entries import Number, Unfit
from camring.files.motor.keys import key_map
from camring.files.units import to_si

__all__ = ["BAR", "RPM", "Axes", "Ranges", "axes_of"]

RPM, BAR = 2 * pi / 60, 1e5
SPEEDS, PRESSURES = 13, 7
SLOWEST, FASTEST = 0.05, 1.5  # of the file's highest speed
HIGHEST = 1.25  # of the file's highest pressure drop
LOWEST_LOW, HIGHEST_LOW = 0.5, 2.0  # of the file's return pressures above the case
# Where the file has an envelope, its ranges, drawn out to the operating points, take their place.
MOST_POINTS = 20_000


@dataclass(frozen=True)
class Ranges:
    """As typed; None for the motor file's own."""

    speed: str | None = None
    pressure: str | None = None
    low_pressure: str | None = None
    points: str | None = None

    def require_use(self, wanted: bool) -> None:
        """Raises `InputError` for a range where no FMU is asked for: it would have no effect."""
        for name, text in vars(self).items():
            if text is not None and not wanted:
                raise InputError(
                    f"--{name.replace('_', '-')}",
                    f"is {quote(text)} but no FMU is asked for",
                    "add --fmu, or leave the option out",
                )


@dataclass(frozen=True, eq=False)
class Axes:
    """Points of one quadrant: the others are mirror images.

    Attributes
    ----------
    speeds
        rad/s, ascending from above zero.
    drops
        Pressure drops, Pa, ascending from zero.
    lows
        The lower port's pressure above the case's, Pa, ascending.
    case_pressure
        Pa, absolute; that of the file's first operating point.
    """

    speeds: Float[np.ndarray, " speed"]
    drops: Float[np.ndarray, " drop"]
    lows: Float[np.ndarray, " low"]
    case_pressure: float


def axes_of(file: MotorFile, ranges: Ranges) -> Axes:
    """The table's points.

    A range of speeds is divided in equal ratios, one of pressures in equal steps; a
    list is taken as it is. Zero pressure drop always belongs to the table.

    Raises
    ------
    InputError
        For what is no range, a speed that is not above zero, a pressure below the
        return pressure, or too many points.
    """
    points = file.system.operating_points
    back = float(points[0].lower_pressure)
    speed_count, pressure_count = (SPEEDS, PRESSURES)
    if ranges.points is not None:
        speed_count, pressure_count = point_counts(ranges.points, 2, SPEEDS)
    speeds = _speeds(file, ranges.speed, speed_count)
    drops = _drops(file, ranges.pressure, pressure_count, back)
    lows, case = _lows(file, ranges.low_pressure)
    count = 4 * len(speeds) * len(drops) * len(lows)
    if count > MOST_POINTS:
        raise InputError(
            "--points", f"asks for {count:,} simulations in both directions and with both signs "
            "of the pressure drop", f"stay below {MOST_POINTS:,}",
        )  # fmt: skip
    return Axes(speeds, drops, lows, case)


def _speeds(file: MotorFile, text: str | None, count: int) -> np.ndarray:
    if text is None:
        given = [float(each.shaft_speed) for each in file.system.operating_points]
        if file.envelope is not None:
            low, high = min(*file.envelope.speed, *given), max(*file.envelope.speed, *given)
            return np.unique(np.geomspace(low, high, count if high > low else 1))
        highest = max(given)
        return np.geomspace(SLOWEST * highest, FASTEST * highest, count)
    values = _values(file, "operating_points.speed", "--speed", text, count)
    return values if "," in text else np.geomspace(values[0], values[-1], count)


def _drops(file: MotorFile, text: str | None, count: int, back: float) -> np.ndarray:
    if text is None:
        given = [abs(float(each.pressure_drop)) for each in file.system.operating_points]
        if file.envelope is not None:
            supply, low = file.envelope.supply_pressure, file.envelope.return_pressure
            ends = (supply[0] - low[-1], supply[-1] - low[0])
            least, most = min(*ends, *given), max(*ends, *given)
            steps = max(count - 1, 2) if most > least else 1
            return np.concatenate([[0.0], np.linspace(least, most, steps)])
        highest = max(given)
        return np.linspace(0, HIGHEST * highest, count)
    values = _values(file, "operating_points.supply_pressure", "--pressure", text, count)
    if values[0] < back:
        raise InputError(
            "--pressure",
            f"begins at {values[0] / BAR:.4g} bar, below the return pressure of {back / BAR:.4g} "
            "bar of the first operating point",
            "raise it; pressures are absolute, and the other sign of the pressure drop comes by "
            "itself",
        )
    drops = values - back
    return drops if drops[0] == 0 else np.concatenate([[0.0], drops])


def _lows(file: MotorFile, text: str | None) -> tuple[np.ndarray, float]:
    points = file.system.operating_points
    case = float(points[0].case_pressure)
    if text is not None:
        values = _values(file, "operating_points.return_pressure", "--low-pressure", text, 2)
        return values - case, case
    if file.envelope is not None:
        least, most = (each - case for each in file.envelope.return_pressure)
        if most > least > -BAR * 1e-9:
            return np.array([least, most]), case
        if least > 0:
            return np.array([least, HIGHEST_LOW * least]), case
    above = [float(each.return_pressure) - float(each.case_pressure) for each in points]
    if max(above) <= 0:
        return np.array([0.0, BAR]), case
    return np.array([LOWEST_LOW * min(above), HIGHEST_LOW * max(above)]), case


def _values(file: MotorFile, key: str, option: str, text: str, count: int) -> np.ndarray:
    """What a range or a list stands for, SI and ascending."""
    entry = key_map(file.choices)[key]
    assert isinstance(entry, Number)
    asked = axis(option, text, entry, count)
    values = []
    for shown in asked.shown:
        said = f"{float(shown)!r} {asked.unit}".rstrip()
        try:
            entry.read(said if asked.unit else float(shown))
        except Unfit as error:
            raise InputError(option, error.problem, error.way_out) from None
        values.append(to_si(said, entry.unit))
    return np.sort(np.array(values))
