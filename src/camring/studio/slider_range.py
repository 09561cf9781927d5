"""From where to where a slider goes: as far as a search may go, else as far as is worth a try."""

from math import pi

from camring.files.motor import MotorFile
from camring.files.motor.entries import Number, Unfit

SWEEP = 0.4  # of the value, either way


def slider_range(
    entry: Number,
    value: float | None,
    free: tuple[str, str] | None,
    key: str,
    file: MotorFile,
) -> tuple[float | None, float | None]:
    """Ends in SI, the value between them; None twice for a number that is not given."""
    if value is None:
        return None, None
    low, high = _free(entry, value, free) or _usual(entry, value, key, file)
    low, high = max(low, entry.low), min(high, entry.high)
    if key.endswith("_width"):
        high = min(high, 2 * pi / file.system.motor.lobes)
    return min(low, value), max(high, value)


def _free(entry: Number, value: float, free: tuple[str, str] | None) -> tuple[float, float] | None:
    if free is None:
        return None
    if free[0].rstrip().endswith("%") and entry.unit != "1":
        ends = [value * (1 + float(each.rstrip("% ")) / 100) for each in free]
        return min(ends), max(ends)
    try:
        ends = [entry.convert(_bare(each)) for each in free]
    except Unfit:
        return None
    return ends[0], ends[1]


def _bare(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _usual(entry: Number, value: float, key: str, file: MotorFile) -> tuple[float, float]:
    pitch = 2 * pi / file.system.motor.lobes
    if key == "shift":
        return -0.05 * pitch, 0.05 * pitch
    if key.endswith("_centre"):
        return value - 0.05 * pitch, value + 0.05 * pitch
    if key.endswith("_width"):
        return 0.85 * value, 1.15 * value
    if entry.high == 1.0 and entry.low == 0.0 and 0.1 < value <= 1:
        return 0.0, 1.0
    if key == "temperature":
        return value - 40, value + 40
    if value == 0:
        try:
            size = abs(entry.convert(entry.example.strip('"'))) or 1.0
        except Unfit:
            size = 1.0
        return (-size if entry.low < 0 else 0.0), size
    ends = sorted((value * (1 - SWEEP), value * (1 + SWEEP)))
    if entry.unit == "1" or key in ("air_fraction", "friction"):
        return 0.0, 2 * abs(value)
    return ends[0], ends[1]
