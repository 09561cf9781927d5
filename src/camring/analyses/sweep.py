"""One or two numbers of a motor file, varied: every result at each of their values.

Each value is put into the document and read like any motor file, so whatever may
stand in a file may be swept, an oil's temperature too, and is checked as there.
"""

import copy
import re
from collections.abc import Mapping
from itertools import product
from typing import Any

from camring.analyses.grid import Axis, Grid
from camring.analyses.oil_use import unread_viscosity
from camring.analyses.operating_map import described, limits_of, point_of
from camring.analyses.ranges import axis, point_counts
from camring.evaluation.simulations import results_of_many, stacked
from camring.files.errors import InputError, quote
from camring.files.motor import MotorFile
from camring.files.motor.build import build_system
from camring.files.motor.entries import Count, Entry, Number, Numbers
from camring.files.motor.keys import foreign_keys, key_map, nearest
from camring.files.motor.motor_file import validated
from camring.files.motor.soundness import require_sound
from camring.files.shapes.own_ports import require_effect
from camring.physics.system import System

MOST_KEYS = 2
ON_ONE_AXIS, ON_TWO_AXES = 41, 21  # values, unless said otherwise
EXAMPLE = 'motor.valve_plate.shift="-2 deg..2 deg"'
SWEPT = ("motor", "fluid", "thermal", "operating_points")


def sweep(
    file: MotorFile,
    ranges: Mapping[str, str],
    *,
    points: str | None = None,
    operating_point: int = 1,
) -> Grid:
    """Every result of a motor while one or two numbers of its file vary.

    Parameters
    ----------
    ranges
        Key of the motor file to a range, `"-2 deg..2 deg"`, or a list, `"1 mm, 2 mm"`.
        `operating_points.speed` is that of the operating point below; one number of a
        list is `motor.cam.control_radii[3]`, counted from 0.
    points
        Values on each axis, `"41"` or `"40x30"`.
    operating_point
        Number of the operating point in the file, counted from 1.

    Raises
    ------
    InputError
        For a key that is none, a range that is none, or a value at which there is no motor.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> found = camring.sweep(file, {"motor.valve_plate.shift": "-1 deg..1 deg"}, points="5")
    >>> found.results["torque_ripple"].shape, int(found.faults.max())
    ((5,), 0)
    """
    point_of(file, operating_point)
    if not 1 <= len(ranges) <= MOST_KEYS:
        raise InputError(
            "a sweep",
            f"of {len(ranges)} numbers cannot be drawn",
            f"give one or two, such as {EXAMPLE}",
        )
    default = ON_ONE_AXIS if len(ranges) == 1 else ON_TWO_AXES
    counts = point_counts(points, len(ranges), default)
    axes = tuple(
        axis(key, text, _entry(key, file), count)
        for (key, text), count in zip(ranges.items(), counts, strict=True)
    )
    places = {each.key: _place(each.key, operating_point) for each in axes}
    swept = {key.rpartition(".")[2]: True for key in places}
    for key, steps in places.items():
        _require_effect(key, steps, operating_point)
        require_effect(key, key, file.document["motor"]["valve_plate"] | swept, "sweep")
    systems = [
        _system(file, axes, values, places) for values in product(*(each.shown for each in axes))
    ]
    number = operating_point - 1
    found = results_of_many(
        stacked([system.motor for system in systems]),
        stacked([system.fluid for system in systems]),
        stacked([system.operating_points[number] for system in systems]),
        harmonics=file.goal.harmonics,
    )
    title = described(file, operating_point, without=set(ranges))
    return Grid.of(axes, *found, limits_of(file), title, unread_viscosity(file))


def assignments(texts: list[str]) -> dict[str, str]:
    """Keys with their ranges from `KEY=RANGE` as typed.

    Raises
    ------
    InputError
        For a text without an equals sign, or a key given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        key = key.strip()
        if not equals or not key:
            raise InputError(quote(text), "is no KEY=RANGE", f"write {EXAMPLE}")
        if key in found:
            raise InputError(key, "appears twice", "give it one range")
        found[key] = value
    return found


def _entry(key: str, file: MotorFile) -> Number:
    """What the number of a key takes."""
    plain = re.sub(r"\[\d{1,4}\]", "", key)
    keys = {name: e for name, e in key_map(file.choices).items() if name.split(".")[0] in SWEPT}
    entry: Entry | None = keys.get(plain)
    if entry is None:
        raise _unknown(key, plain, keys, file)
    for _ in range(key.count("[") - plain.startswith("operating_points[")):
        entry = entry.item if isinstance(entry, Numbers) else entry
    if isinstance(entry, Numbers):
        raise InputError(
            key, "is a list", f"sweep one of its numbers, {key}[0]; they are counted from 0"
        )
    if isinstance(entry, Count):
        raise InputError(
            key, "is a count, which has no range", "write a motor file for each and compare them"
        )
    if not isinstance(entry, Number):
        raise InputError(key, "is a word, which has no range", f"sweep a number, such as {EXAMPLE}")
    return entry


def _unknown(key: str, plain: str, keys: dict[str, Entry], file: MotorFile) -> InputError:
    foreign = foreign_keys(file.choices).get(plain)
    if foreign is not None:
        return InputError(
            key,
            f'has no effect with {foreign.chooser} = "{foreign.now}"',
            f'sweep another, or set {foreign.chooser} = "{foreign.needed}" in the motor file',
        )
    shown = key if key.isprintable() and len(key) < 100 else "a key"
    numbers = [name for name, each in keys.items() if isinstance(each, Number)]
    same_end = [name for name in numbers if name.rsplit(".", 1)[-1] == plain.rsplit(".", 1)[-1]]
    close = same_end[0] if same_end else nearest(plain, numbers)
    if close is None:
        ends = {name.rsplit(".", 1)[-1]: name for name in numbers}
        end = nearest(plain.rsplit(".", 1)[-1], list(ends))
        close = ends[end] if end is not None else None
    return InputError(
        shown,
        "is no number of the motor file",
        f"you probably meant {close}" if close else f"give a key such as {EXAMPLE}",
    )


def _place(key: str, operating_point: int) -> list[str | int]:
    """A key as the steps that lead to it in the document."""
    steps: list[str | int] = []
    for part in key.split("."):
        name, *inside = re.findall(r"[^\[\]]+", part)
        steps += [name, *(int(index) for index in inside)]
        if name == "operating_points" and not inside:
            steps.append(operating_point - 1)
    return steps


def _require_effect(key: str, steps: list[str | int], operating_point: int) -> None:
    """Refuse a number of the operating point that no result of this operating point depends on."""
    if steps[0] != "operating_points":
        return
    if steps[1] != operating_point - 1:
        raise InputError(
            key,
            f"is not of operating point {operating_point}, whose results are asked for",
            f"add --point {int(steps[1]) + 1}",
        )
    if steps[-1] == "weight":
        raise InputError(key, "changes no result", "sweep another number")


def _system(
    file: MotorFile,
    axes: tuple[Axis, ...],
    values: tuple[float, ...],
    places: dict[str, list[str | int]],
) -> System:
    document: dict[str, Any] = copy.deepcopy(
        {name: file.document[name] for name in SWEPT if name in file.document}
    )
    for each, value in zip(axes, values, strict=True):
        text = f"{float(value)!r} {each.unit}" if each.unit else float(value)
        _put(document, each.key, places[each.key], text)
    choices, tables = validated(document)
    require_sound(tables, document)
    return build_system(tables, choices)


def _put(document: dict[str, Any], key: str, steps: list[str | int], value: Any) -> None:
    here: Any = document
    for step in steps[:-1]:
        here = here.setdefault(step, {}) if isinstance(step, str) else _item(here, step, key)
    last = steps[-1]
    if isinstance(last, int):
        _item(here, last, key)
    here[last] = value


def _item(values: Any, index: int, key: str) -> Any:
    if not isinstance(values, list) or index >= len(values):
        has = f"{len(values)} items" if isinstance(values, list) else "no list"
        last = f"[0] to [{len(values) - 1}]" if isinstance(values, list) else "it without an index"
        raise InputError(key, f"counts beyond the {has} there", f"give {last}")
    return values[index]


__all__ = ["assignments", "sweep"]
