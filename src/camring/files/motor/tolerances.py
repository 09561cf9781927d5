"""The table `[tolerances]`: which numbers scatter from one motor to the next, and how."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

import numpy as np

from camring.files.errors import InputError, quote
from camring.files.motor.entries import Count, Number, NumberOrWord, Numbers, Unfit, Word
from camring.files.motor.keys import Choices, key_map, nearest
from camring.files.motor.paths import flat_paths
from camring.files.motor.tables import FileTables
from camring.files.motor.waviness import build_waviness
from camring.files.shapes.own_ports import require_effect
from camring.numerics.quantity import real
from camring.objective.design_space import DesignSpace, leaf
from camring.objective.tolerances import Deviation, ToleratedSpace, Waviness
from camring.physics.system import System
from camring.search.scatter.distributions import Kind

EXAMPLE = '"motor.valve_plate.shift" = "0.2 deg"'
DISTRIBUTION = Word("the distribution", '"uniform"', words=("uniform", "normal"))
SIGMAS = {"uniform": sqrt(3), "normal": 2.0}
"""Standard deviations within plus or minus the tolerance."""

REACH = {"uniform": sqrt(3), "normal": 4.0}
"""How far from its number a deviate goes, in standard deviations; a normal one hardly farther."""

OPTIONS = ("plus_minus", "relative", "distribution", "together_with")
POINT_LEAVES = {
    "speed": "shaft_speed",
    "supply_pressure": "supply_pressure",
    "return_pressure": "return_pressure",
    "case_pressure": "case_pressure",
}


@dataclass(frozen=True, eq=False)
class Tolerances:
    """What scatters.

    Attributes
    ----------
    kinds
        The distribution of each deviation, then "phase" for each order of waviness.
    names, wording
        Of each of these, its path in the file, and in words how far it goes.
    """

    deviations: tuple[Deviation, ...]
    waviness: Waviness | None
    kinds: tuple[Kind, ...]
    names: tuple[str, ...]
    wording: tuple[str, ...]

    def about(self, design: DesignSpace | None) -> ToleratedSpace:
        """Designs of a space, or the given motor alone, with these tolerances about them."""
        return ToleratedSpace(design, self.deviations, self.waviness)


def build_tolerances(
    table: dict[str, Any],
    tables: FileTables,
    document: dict[str, Any],
    system: System,
    choices: Choices,
) -> Tolerances:
    """The tolerances of a file, about its own motor.

    Raises
    ------
    InputError
        For a path that is no number of the motor, and for tolerances that lead out of
        the limits of their numbers.
    """
    reader = _Reader(tables, document, system, choices)
    deviations, kinds, wording, seen = [], list[Kind](), list[str](), set[str]()
    for path, value in flat_paths(table, key_map(choices), without="waviness"):
        deviation, kind, words, keys = reader.read(path, value)
        for key in keys:
            if key in seen:
                raise InputError(_field(key), "appears twice", "give it one tolerance")
            seen.add(key)
        deviations.append(deviation)
        kinds.append(kind)
        wording.append(words)
    names = [each.name for each in deviations]
    waviness = None
    if "waviness" in table:
        waviness, words_of_waves = build_waviness(table["waviness"], tables.motor, system)
        kinds += ["phase"] * len(waviness.orders)
        names += [f"waviness, order {order}" for order in waviness.orders]
        wording += words_of_waves
    if not kinds:
        raise InputError("[tolerances]", "lets nothing scatter", f"give it a line as {EXAMPLE}")
    return Tolerances(tuple(deviations), waviness, tuple(kinds), tuple(names), tuple(wording))


def _field(path: str) -> str:
    return f'tolerances."{path}"'


@dataclass(frozen=True)
class _Reader:
    """Reads one line at a time."""

    tables: FileTables
    document: dict[str, Any]
    system: System
    choices: Choices

    def read(self, path: str, value: Any) -> tuple[Deviation, Kind, str, tuple[str, ...]]:
        """The deviation, its distribution, how far it goes in words, all its keys."""
        options = _options(path, value)
        keys = (path, *options["together_with"])
        entries = [self._entry(each) for each in keys]
        relative = "relative" in options
        size = _size(path, options["relative" if relative else "plus_minus"], entries[0], relative)
        kind: Kind = "normal" if options["distribution"] == "normal" else "uniform"
        leaves = [self._leaves(each, entry) for each, entry in zip(keys, entries, strict=True)]
        deviation = Deviation(
            name=path,
            leaves=tuple(at for each in leaves for at in each),
            deviation=real(size / SIGMAS[kind]),
            relative=relative,
        )
        for key, entry, at in zip(keys, entries, leaves, strict=True):
            self._require_limits(key, entry, at, deviation, kind)
        shown = options["relative" if relative else "plus_minus"]
        words = f"± {str(shown).strip().lstrip('±').strip()}, {kind}"
        return deviation, kind, words, keys

    def _entry(self, path: str) -> Number:
        """What the number of a path takes."""
        known = key_map(self.choices)
        entry, field = known.get(path), _field(path)
        if entry is None:
            numbers = [
                key
                for key, each in known.items()
                if isinstance(each, Number) and (each.leaves or _is_of_point(key))
            ]
            raise InputError(
                field if path.isprintable() and len(path) < 100 else "tolerances",
                "is no number of the motor",
                f'you probably meant "{_near(path, numbers)}"'
                if _near(path, numbers)
                else f"give a path as in {EXAMPLE}",
            )
        if isinstance(entry, Count):
            raise InputError(field, "is a count, which has no tolerance", "leave it out")
        if isinstance(entry, Numbers):
            raise InputError(
                field,
                "is a list, which does not scatter number by number",
                "let the ring be wavy: add [tolerances.waviness] with amplitudes by order",
            )
        if not isinstance(entry, Number) or not (entry.leaves or _is_of_point(path)):
            raise InputError(
                field, "is not a number of motor, oil or operating points", "leave it out"
            )
        if isinstance(entry, NumberOrWord) and self.system.motor.reference != "given":
            raise InputError(
                field,
                f"is given as the rule {quote(self.tables.motor.cam.reference_radius)}",
                "give motor.cam.reference_radius as a length if it is to scatter",
            )
        return entry

    def _leaves(self, path: str, entry: Number) -> tuple[str, ...]:
        if _is_of_point(path):
            return self._leaves_of_point(path.rsplit(".", 1)[1])
        try:
            leaf(entry.leaves[0])(self.system)
        except AttributeError:
            raise InputError(
                _field(path),
                "is a tolerance on a part that the motor does not have",
                f"give {path} a value, or leave the tolerance out",
            ) from None
        require_effect(_field(path), path, vars(self.tables.motor.valve_plate), "give it to")
        return entry.leaves

    def _leaves_of_point(self, key: str) -> tuple[str, ...]:
        """At every operating point; a case pressure that is not given follows the return."""
        places = []
        for place, given in enumerate(self.document["operating_points"]):
            if key == "case_pressure" and key not in given:
                raise InputError(
                    _field(f"operating_points.{key}"),
                    f"is not given at operating point {place + 1}, where it is the return pressure",
                    "give it there, or a tolerance to operating_points.return_pressure",
                )
            places.append(f"operating_points.{place}.{POINT_LEAVES[key]}")
            if key == "return_pressure" and "case_pressure" not in given:
                places.append(f"operating_points.{place}.case_pressure")
        return tuple(places)

    def _require_limits(
        self, key: str, entry: Number, leaves: tuple[str, ...], deviation: Deviation, kind: Kind
    ) -> None:
        high = entry.high
        if key.endswith(("supply_width", "return_width")):
            high = 2 * pi / self.tables.motor.lobes * (1 + 1e-9)
        for amount in (-REACH[kind], REACH[kind]):
            moved = deviation.apply(self.system, amount)
            for at in leaves:
                value = float(leaf(at)(moved))
                if not entry.low <= value <= high:
                    raise InputError(
                        _field(key),
                        f"lets it reach {value:.6g} {entry.unit}, beyond its limits "
                        f"{entry.low:.4g} to {high:.4g}",
                        "give less" if kind == "uniform" else 'give less, or write "uniform"',
                    )


def _is_of_point(path: str) -> bool:
    table, _, key = path.partition(".")
    return table == "operating_points" and key in POINT_LEAVES


def _near(path: str, numbers: list[str]) -> str | None:
    """The number that a path probably meant, by the whole or by its last part."""
    last = path.rsplit(".", 1)[-1]
    ends = {each.rsplit(".", 1)[-1]: each for each in numbers}
    return ends.get(last) or nearest(path, numbers) or ends.get(nearest(last, list(ends)) or "")


def _options(path: str, value: Any) -> dict[str, Any]:
    """A line as its table, `"0.2 deg"` being short for { plus_minus = "0.2 deg" }."""
    options: dict[str, Any] = value if isinstance(value, dict) else {"plus_minus": value}
    for name in sorted(set(options) - set(OPTIONS)):
        close = nearest(name, list(OPTIONS))
        raise InputError(
            f"{_field(path)}.{name if name.isidentifier() else quote(name)}",
            "is not a key of a tolerance",
            f"you probably meant {close}" if close else "use " + ", ".join(OPTIONS),
        )
    if ("plus_minus" in options) == ("relative" in options):
        raise InputError(
            _field(path),
            "must have either plus_minus or relative",
            'write { plus_minus = "0.2 deg" } or { relative = "5 %" }',
        )
    try:
        kind = DISTRIBUTION.read(options.get("distribution", "uniform"))
    except Unfit as error:
        raise InputError(f"{_field(path)}.distribution", error.problem, error.way_out) from None
    together = options.get("together_with", [])
    if not (isinstance(together, list) and all(isinstance(each, str) for each in together)):
        raise InputError(
            f"{_field(path)}.together_with",
            f"is {quote(together)} but must be a list of paths",
            'write together_with = ["motor.valve_plate.return_width"]',
        )
    return {**options, "distribution": kind, "together_with": together}


def _size(path: str, value: Any, entry: Number, relative: bool) -> float:
    text = value.strip().removeprefix("±").strip() if isinstance(value, str) else value
    if not relative and entry.unit != "1" and isinstance(text, str) and text.endswith("%"):
        raise InputError(_field(path), "is a share", f"write {{ relative = {quote(text)} }}")
    meaning = f"plus or minus how much {entry.meaning} scatters"
    item = (
        Number("plus or minus which share of the number it scatters", '"5 %"', unit="1", high=0.99)
        if relative
        else Number(meaning, _example_for(entry), unit=entry.unit, difference=True, high=np.inf)
    )
    try:
        return item.read(text)
    except Unfit as error:
        inside = ".relative" if relative else ""
        raise InputError(_field(path) + inside, error.problem, error.way_out) from None


def _example_for(entry: Number) -> str:
    """A tolerance in the unit that the number's own example has."""
    unit = entry.example.strip('"').partition(" ")[2]
    return f'"0.1 {unit}"' if unit else "0.01"


__all__ = ["Tolerances", "build_tolerances"]
