"""Which numbers of a motor file are fitted, and in which coordinates.

Each is a variable of a design space from zero to its scale, so that coordinate one is the
scale itself. Numbers above zero are fitted by their logarithm, those that the file has as
zero as they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from jaxtyping import Float

from camring.files.errors import InputError, quote
from camring.files.motor import MotorFile
from camring.files.motor.entries import Number
from camring.files.motor.keys import foreign_keys, key_map, nearest
from camring.files.shapes.own_ports import overriding, require_effect
from camring.files.units import from_si, split_quantity, to_si
from camring.numerics.quantity import real
from camring.objective.design_space import DesignSpace, Variable, leaf

USUAL = (
    "motor.leakage_coefficient",
    "motor.gap.clearance",
    "motor.viscous_damping",
    "motor.roller.friction",
    "motor.side_friction",
    "motor.valve_plate.discharge_coefficient",
    "motor.valve_plate.supply_discharge_coefficient",
    "motor.valve_plate.return_discharge_coefficient",
    "fluid.bulk_modulus",
    "motor.valve_plate.gap",
    "motor.churning.moment_coefficient",
    "motor.roller.static_friction",
    "motor.roller.stribeck_speed",
    "motor.side_static_friction",
    "motor.side_stribeck_speed",
    "thermal.heat_transfer",
)
"""Fitted unless others are named, as far as the motor has them."""
BELIEVABLE = {
    "motor.roller.friction": 0.1,
    "motor.side_friction": 0.3,
    "motor.roller.static_friction": 0.3,
    "motor.side_static_friction": 0.5,
    "motor.valve_plate.discharge_coefficient": 1.0,
    "motor.valve_plate.supply_discharge_coefficient": 1.0,
    "motor.valve_plate.return_discharge_coefficient": 1.0,
}
"""What no machine has more of, whatever the key allows; a fit that wants more says so."""
SMALLEST = 1e-6  # of the scale: where a logarithm ends
DIGITS = 6
Point = Float[np.ndarray, " number"]


@dataclass(frozen=True)
class FittedNumber:
    """One number of the motor file.

    Attributes
    ----------
    given
        As the file has it, SI.
    scale
        What a number of this kind is about, SI: the given one unless that is zero.
    unit
        In which the file writes it, and people read it.
    """

    key: str
    entry: Number
    given: float
    scale: float
    unit: str

    @property
    def by_logarithm(self) -> bool:
        return self.given > 0

    @property
    def as_given(self) -> float:
        """The coordinate of the given number."""
        return 0.0 if self.by_logarithm else self.given / self.scale

    @property
    def start(self) -> float:
        """Where the fit begins; a number given as zero at half its usual size."""
        return self.as_given if self.given else 0.5

    @property
    def bounds(self) -> tuple[float, float]:
        """Of the coordinate, from the limits of the key and what can be believed."""
        believable = max(BELIEVABLE.get(self.key, self.entry.high), self.given)
        low, high = self.entry.low, min(self.entry.high, believable)
        if self.by_logarithm:
            return log(max(low / self.scale, SMALLEST)), log(high / self.scale)
        return low / self.scale, high / self.scale

    def ends(self, coordinate: float, half_width: float) -> tuple[float, float]:
        """The interval, SI. Of a number that may be zero it is even and ends there.

        Results are straight in such a number: leakage, a friction. In its logarithm they
        are not, and an interval that is wide would leave zero out.
        """
        if self.by_logarithm and self.entry.low > 0:
            return self.value(coordinate - half_width), self.value(coordinate + half_width)
        middle = self.value(coordinate)
        reach = half_width * (middle if self.by_logarithm else self.scale)
        return max(middle - reach, self.entry.low), middle + reach

    def value(self, coordinate: float) -> float:
        """SI."""
        with np.errstate(over="ignore"):
            return self.scale * float(np.exp(coordinate) if self.by_logarithm else coordinate)

    def shown(self, value: float) -> float:
        """In the file's unit."""
        return from_si(value, self.unit, self.entry.unit) if self.unit else value

    def written(self, value: float, digits: int = DIGITS) -> str:
        """With its unit, as in the file."""
        return f"{self.shown(value):.{digits}g} {self.unit}".rstrip()

    def rounded(self, value: float) -> float:
        """What its digits in the file mean, SI."""
        return to_si(self.written(value), self.entry.unit)


def numbers_named(file: MotorFile, keys: Sequence[str] | None) -> tuple[FittedNumber, ...]:
    """The numbers that these keys name; without keys the usual ones, given ones in front.

    Raises
    ------
    InputError
        For a key that names no number of the motor or its oil.
    """
    if keys is None:
        found = [_number(file, key) for key in USUAL if _has(file, key)]
        return tuple(sorted(found, key=lambda each: not each.by_logarithm))
    paths = [_path(file, key) for key in keys]
    if not paths:
        raise InputError("--of", "names nothing", f"name a key, for example {USUAL[0]}")
    return tuple(_number(file, path) for path in dict.fromkeys(paths))


def space_of(numbers: Sequence[FittedNumber]) -> DesignSpace:
    """Coordinate one of each variable is the scale of its number."""
    return DesignSpace(
        tuple(
            Variable((each.key,), (each.entry.leaves,), real(0.0), real(each.scale))
            for each in numbers
        )
    )


def keys_of(text: str) -> list[str]:
    """Keys from `motor.viscous_damping,fluid.bulk_modulus`."""
    return text.replace(",", " ").split()


def short(key: str) -> str:
    """The last parts of a key that say enough: `roller.friction`, `bulk_modulus`."""
    last = key.rpartition(".")[2]
    return last if "_" in last else ".".join(key.split(".")[-2:])


def _has(file: MotorFile, key: str) -> bool:
    entry = key_map(file.choices).get(key)
    if overriding(key, file.document["motor"]["valve_plate"]):
        return False
    return isinstance(entry, Number) and _present(file, entry)


def _present(file: MotorFile, entry: Number) -> bool:
    try:
        return bool(np.isfinite(float(leaf(entry.leaves[0])(file.system))))
    except AttributeError:
        return False


def _path(file: MotorFile, key: str) -> str:
    """The whole path of a key, which may be its last parts where only one has them."""
    known = key_map(file.choices)
    if key in known:
        return key
    fits = [path for path in known if path.endswith(f".{key}") and _fittable(path, known)]
    if len(fits) == 1:
        return fits[0]
    field = f"--of {quote(key)}"
    if fits:
        raise InputError(field, "names several numbers", f"write one of {', '.join(fits)}")
    foreign = foreign_keys(file.choices).get(key)
    if foreign is not None:
        raise InputError(
            field,
            f'has no effect with {foreign.chooser} = "{foreign.now}"',
            f'set {foreign.chooser} = "{foreign.needed}" in the motor file to fit it',
        )
    open_to = [*USUAL, *(path for path in known if _fittable(path, known))]
    ends = {path.rpartition(".")[2]: path for path in reversed(open_to)}
    meant = next((path for path in open_to if key in path), None)
    meant = meant or ends.get(nearest(key, list(ends)) or "") or nearest(key, open_to)
    raise InputError(
        field,
        "is no key of a motor file",
        f"you probably meant {meant}" if meant else f"name some of {', '.join(USUAL)}",
    )


def _fittable(path: str, known: dict) -> bool:
    entry = known[path]
    return (
        isinstance(entry, Number)
        and bool(entry.leaves)
        and path.startswith(("motor.", "fluid.", "thermal."))
        and path != "motor.cam.reference_radius"
    )


def _number(file: MotorFile, path: str) -> FittedNumber:
    entry = key_map(file.choices)[path]
    if not _fittable(path, key_map(file.choices)):
        raise InputError(
            f"--of {quote(path)}",
            "is not a number of motor or oil that can be fitted",
            f"name some of {', '.join(USUAL)}",
        )
    assert isinstance(entry, Number)
    plate = file.document["motor"]["valve_plate"]
    require_effect(f"--of {quote(path)}", path, plate, "fit")
    if not _present(file, entry):
        raise InputError(
            f"--of {quote(path)}",
            "belongs to a part that the motor does not have",
            f"give {path} a value in {file.path.name}, where the fit begins",
        )
    given = float(leaf(entry.leaves[0])(file.system))
    example = entry.example.strip('"')
    usual = abs(to_si(example, entry.unit)) or 1.0
    in_file = _given_text(file, path)
    unit = split_quantity(in_file if isinstance(in_file, str) else example)[1]
    if in_file is not None and not isinstance(in_file, str):
        unit = ""
    return FittedNumber(path, entry, given, abs(given) or usual, unit)


def _given_text(file: MotorFile, path: str) -> object:
    here: object = file.document
    for part in path.split("."):
        here = here.get(part) if isinstance(here, dict) else None
    return here
