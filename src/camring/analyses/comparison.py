"""Motors side by side: each at the same operating points, and what differs in their files."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import fspath
from pathlib import Path
from typing import Any

import equinox as eqx

from camring.analyses.simulation import Simulated, simulated
from camring.files.errors import InputError, quote
from camring.files.motor import MotorFile, read_motor_file
from camring.files.motor.document import printable
from camring.files.motor.entries import Entry, Unfit
from camring.files.motor.keys import key_map
from camring.physics.operating_point import OperatingPoint
from camring.studies.database import DATABASE_NAME
from camring.studies.study_folder import BEST_NAME

FEWEST, MOST = 2, 8
SAME = 1e-9  # relative; below it two inputs are one


@dataclass(frozen=True, eq=False)
class Compared:
    """One motor of a comparison, under the name it goes by there."""

    label: str
    simulated: Simulated


@dataclass(frozen=True, eq=False)
class Comparison:
    """Motors with their results.

    Attributes
    ----------
    differences
        Key of the motor file to what each file says there; None where one says nothing.
    notes
        What a reader of the table should know, a sentence each.
    """

    motors: tuple[Compared, ...]
    differences: dict[str, list[str | None]]
    notes: list[str]


def compare(paths: Sequence[str | Path], *, own_points: bool = False) -> Comparison:
    """Simulate motors and list what differs in their files.

    Parameters
    ----------
    paths
        Motor files, or folders of studies, which stand for their best motor.
    own_points
        Each motor at its own file's operating points; else all at those of the first.

    Raises
    ------
    InputError
        For fewer than two motors, a study without a best one, operating points that do not pair up.
    """
    if not FEWEST <= len(paths) <= MOST:
        raise InputError(
            "camring compare", f"names {len(paths)}", f"name {FEWEST} to {MOST} motors to compare"
        )
    places = [Path(fspath(path)) for path in paths]
    files = [read_motor_file(_motor_in(place)) for place in places]
    notes = []
    if own_points:
        _require_as_many(files, places)
    else:
        files, changed = _at_points_of_first(files)
        if changed:
            notes.append(
                "All motors run at the operating points of the first; --own-points takes each "
                "file's own."
            )
    motors = tuple(
        Compared(label, simulated(file, estimate=False))
        for label, file in zip(_labels(places), files, strict=True)
    )
    return Comparison(motors, differing_inputs(files), notes)


def _motor_in(place: Path) -> Path:
    """The motor file, or the best motor of a study's folder."""
    if not place.is_dir():
        return place
    best = place / BEST_NAME
    if best.is_file():
        return best
    if (place / DATABASE_NAME).is_file():
        raise InputError(
            printable(place),
            f"holds a study without a {BEST_NAME}: no design kept every limit, or it still runs",
            "go on with `camring resume`, or name a motor file",
        )
    raise InputError(
        printable(place), "holds no study", "name a motor file, or the folder of a study"
    )


def _require_as_many(files: list[MotorFile], places: list[Path]) -> None:
    first = len(files[0].system.operating_points)
    for file, place in zip(files, places, strict=True):
        count = len(file.system.operating_points)
        if count != first:
            raise InputError(
                printable(place),
                f"has {count} operating points and {printable(places[0])} {first}, "
                "so they do not pair up",
                "leave out --own-points",
            )


def _at_points_of_first(files: list[MotorFile]) -> tuple[list[MotorFile], bool]:
    """Every motor at the first's operating points; whether that changes any."""
    first = files[0].system.operating_points
    moved, changed = [], False
    for file in files:
        own = file.system.operating_points
        _require_both_ways(file, first)
        changed |= not bool(eqx.tree_equal(own, first, rtol=SAME))
        system = eqx.tree_at(lambda each: each.operating_points, file.system, first)
        moved.append(replace(file, system=system))
    return moved, changed


def _require_both_ways(file: MotorFile, points: tuple[OperatingPoint, ...]) -> None:
    notched = file.system.motor.valve_plate.notched
    if notched and any(point.reverse for point in points):
        raise InputError(
            printable(file.path),
            "has relief notches, which lie at the opening edges one way round only, but the "
            "first motor turns backwards at an operating point",
            "name another motor first, or compare with --own-points",
        )


def _labels(places: list[Path]) -> list[str]:
    """The shortest names that tell the motors apart."""
    tried = [
        [place.name if place.is_dir() else place.stem for place in map(Path.resolve, places)],
        ["/".join(place.resolve().parts[-2:]) for place in places],
        [f"{n + 1}: {place}" for n, place in enumerate(places)],
    ]
    found = next(names for names in tried if len(set(names)) == len(names))
    return [printable(Path(name)) for name in found]


def differing_inputs(files: Sequence[MotorFile]) -> dict[str, list[str | None]]:
    """Keys of motor, oil and operating points that do not mean the same in all files."""
    flat = [_flat(file) for file in files]
    keys = dict.fromkeys(key for each in flat for key in each)
    found = {}
    for key in keys:
        values = [each.get(key) for each in flat]
        if any(not _same(value, values[0]) for value in values):
            found[key] = [None if value is None else value[0] for value in values]
    return found


def _flat(file: MotorFile) -> dict[str, tuple[str, Any]]:
    """Key to what the file says, as written and as read in SI."""
    entries, found = key_map(file.choices), dict[str, tuple[str, Any]]()

    def walk(value: Any, key: str, plain: str) -> None:
        entry: Entry | None = entries.get(plain)
        if entry is not None:
            found[key] = (_written(value), _read(entry, value))
        elif isinstance(value, dict):
            for name, inner in value.items():
                walk(inner, f"{key}.{name}", f"{plain}.{name}")
        elif isinstance(value, list):
            for place, inner in enumerate(value):
                walk(inner, f"{key}[{place}]", plain)

    for table in ("motor", "fluid", "thermal", "operating_points"):
        walk(file.document.get(table, {}), table, table)
    found.pop("motor.name", None)
    return found


def _written(value: Any) -> str:
    return value if isinstance(value, str) else quote(value)


def _read(entry: Entry, value: Any) -> Any:
    try:
        return entry.read(value)
    except Unfit:
        return value


def _same(one: tuple[str, Any] | None, other: tuple[str, Any] | None) -> bool:
    if one is None or other is None:
        return one is other
    a, b = one[1], other[1]
    if isinstance(a, int | float) and isinstance(b, int | float):
        return abs(a - b) <= SAME * max(abs(a), abs(b))
    return bool(a == b)
