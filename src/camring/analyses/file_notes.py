"""What a motor file may mean otherwise than its author did, in sentences."""

from collections.abc import Iterator

from camring.files.motor import MotorFile
from camring.files.units import from_si

__all__ = ["file_notes"]


def file_notes(file: MotorFile) -> list[str]:
    """Speeds without a unit, and an envelope in which no operating point lies."""
    return [*_speeds_without_unit(file), *_envelope_elsewhere(file)]


def _speeds_without_unit(file: MotorFile) -> Iterator[str]:
    """Alone among the quantities a speed is sensible both in rpm and in SI."""
    for number, given in enumerate(file.document["operating_points"], 1):
        if not isinstance(given["speed"], str):
            yield (
                f"[[operating_points]] {number}, speed = {given['speed']:g} has no unit and is "
                f"read in rad/s, {_rpm(given['speed'])} rpm; write one behind it, such as "
                f'"{given["speed"]:g} rpm".'
            )
    speeds = file.document.get("envelope", {}).get("speed", [])
    bare = [each for each in speeds if not isinstance(each, str)]
    if bare:
        read = " and ".join(f"{each:g} is {_rpm(each)} rpm" for each in bare)
        meant = ", ".join(f'"{each:g} rpm"' if each in bare else f'"{each}"' for each in speeds)
        yield f"envelope.speed has no unit and is read in rad/s: {read}; write one, [{meant}]."


def _envelope_elsewhere(file: MotorFile) -> Iterator[str]:
    envelope = file.envelope
    if envelope is None:
        return
    (slow, fast), (low, high) = envelope.speed, envelope.supply_pressure
    near = 1e-9
    for point in file.system.operating_points:
        speed, pressure = float(point.shaft_speed), float(point.supply_pressure)
        if slow * (1 - near) <= speed <= fast * (1 + near) and (
            low * (1 - near) <= pressure <= high * (1 + near)
        ):
            return
    yield (
        f"No operating point lies in the [envelope], {_rpm(slow)} to {_rpm(fast)} rpm and "
        f"{low / 1e5:.4g} to {high / 1e5:.4g} bar: the objective counts where the limits of the "
        "envelope are not asked; check the ranges, or move an operating point there."
    )


def _rpm(speed: float) -> str:
    return f"{from_si(float(speed), 'rpm'):.4g}"
