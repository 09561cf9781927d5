"""Every key of a motor file as a field of the page: value, unit, range of its slider, whether free.

Read off the reader's own map of keys, so that the page can hold nothing that a file cannot,
and a law of a user's own has its sliders, too.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from camring.files.motor import MotorFile
from camring.files.motor.entries import (
    Band,
    Count,
    Entry,
    Number,
    NumberOrWord,
    Numbers,
    Switch,
    Text,
    Unfit,
    Word,
)
from camring.files.motor.keys import key_map
from camring.files.motor.paths import flat_paths
from camring.files.raw_values import Place, raw_value
from camring.studio.shown_units import given_unit, units_for
from camring.studio.slider_range import slider_range

GROUPS = {
    "operating_points": "Operating point",
    "motor.valve_plate": "Valve plate",
    "motor.cam": "Cam ring",
    "motor.piston": "Return spring",
    "motor.roller": "Rollers",
    "motor.gap": "Piston gap",
    "motor.manifold": "Supply manifold",
    "motor.return_manifold": "Return manifold",
    "motor.churning": "Churning",
    "motor": "Motor",
    "fluid": "Oil",
    "thermal": "Cooling",
    "constraints": "Limits",
    "envelope": "Envelope",
    "objective": "Objective",
    "search": "Search",
    "evaluator": "Evaluator",
}
_HELD_BY_HANDLES = ("motor.cam.control_radii", "motor.cam.control_points")
_NEVER = ("evaluator.command", "evaluator.fmu", "evaluator.units", "motor.cam.profile")
"""A program or another file is named in the motor file by hand and by nothing else."""


@dataclass(frozen=True)
class Field:
    """One number, count, word, switch or text of the file.

    Attributes
    ----------
    path
        Its name everywhere: `operating_points[1].speed`, `envelope.speed[0]`.
    place, item
        Where it stands in the document, and which of a band's two ends it is.
    value
        SI, or the word; None where neither file nor oil gives one.
    written
        Whether the file itself holds it.
    units
        Name, factor and offset to SI of each unit it may be shown in, the file's first.
    low, high
        Ends of its slider, SI; None where it has none.
    free
        Its bounds as the file writes them, where a search may change it.
    can_be_free
        Whether a search could.
    """

    path: str
    place: Place
    item: int | None
    group: str
    label: str
    meaning: str
    example: str
    kind: str
    value: Any
    written: bool
    units: tuple[tuple[str, float, float], ...] = ()
    words: tuple[str, ...] = ()
    low: float | None = None
    high: float | None = None
    free: tuple[str, str] | None = None
    can_be_free: bool = False

    def as_message(self) -> dict[str, Any]:
        found = asdict(self)
        del found["place"]
        return found


def fields_of(file: MotorFile, values: dict[str, float]) -> list[Field]:
    """Every field of a file.

    Parameters
    ----------
    values
        SI numbers of the motor by path, those of a named oil among them.
    """
    keys = key_map(file.choices)
    bounds = {}
    if file.document.get("design_space"):
        bounds = dict(flat_paths(file.document["design_space"], keys, without="cam"))
    found: list[Field] = []
    for path, entry in keys.items():
        if path in _HELD_BY_HANDLES or path in _NEVER:
            continue
        table, key = path.rsplit(".", 1)
        if table == "operating_points":
            for k in range(len(file.document["operating_points"])):
                place: Place = (table, k, key)
                group = f"{GROUPS[table]} {k + 1}"
                found += _fields(file, place, f"{table}[{k}].{key}", group, entry, values, bounds)
        else:
            place = (*table.split("."), key)
            found += _fields(file, place, path, GROUPS[table], entry, values, bounds)
    order = list(GROUPS.values())
    return sorted(found, key=lambda each: order.index(each.group.rstrip("0123456789 ")))


def _fields(
    file: MotorFile,
    place: Place,
    path: str,
    group: str,
    entry: Entry,
    values: dict[str, float],
    bounds: dict[str, Any],
) -> Iterator[Field]:
    raw = raw_value(file.document, place)
    label = str(place[-1]).replace("_", " ").capitalize()
    words: dict[str, Any] = {
        "place": place,
        "group": group,
        "meaning": entry.meaning,
        "written": raw is not None,
    }
    if isinstance(entry, Band):
        item = entry.item
        assert isinstance(item, Number)
        for end, name in enumerate(("lowest", "highest")):
            here = raw[end] if isinstance(raw, list) and len(raw) == 2 else None
            yield Field(
                path=f"{path}[{end}]",
                item=end,
                label=f"{label}, {name}",
                example=item.example,
                kind="number",
                **_number(item, here, _read(item, here), None, place, file),
                **words,
            )
        return
    one: dict[str, Any] = {
        "path": path,
        "item": None,
        "label": label,
        "example": entry.example,
        **words,
    }
    if isinstance(entry, NumberOrWord) and isinstance(raw, str) and raw in entry.words:
        yield Field(kind="word or number", value=raw, words=entry.words, **one)
    elif isinstance(entry, Number):
        value = values.get(path, _read(entry, raw))
        free = _bounds(bounds.get(path))
        yield Field(
            kind="number",
            can_be_free=type(entry) is Number and bool(entry.leaves) and value is not None,
            words=entry.words if isinstance(entry, NumberOrWord) else (),
            **_number(entry, raw, value, free, place, file),
            **one,
        )
    elif isinstance(entry, Count):
        yield Field(kind="count", value=_read(entry, raw), low=entry.low, high=entry.high, **one)
    elif isinstance(entry, Word):
        chosen = raw if raw is not None else _default(place, file)
        yield Field(kind="word", value=chosen, words=entry.words, **one)
    elif isinstance(entry, Switch):
        yield Field(kind="switch", value=bool(raw), **one)
    elif isinstance(entry, Text):
        yield Field(kind="text", value=raw or "", **one)
    elif isinstance(entry, Numbers):
        yield Field(kind="list", value=None if raw is None else str(raw), **one)


def _number(
    entry: Number,
    raw: Any,
    value: float | None,
    free: tuple[str, str] | None,
    place: Place,
    file: MotorFile,
) -> dict[str, Any]:
    units = units_for(entry.unit, given_unit(entry, raw))
    low, high = slider_range(entry, value, free, str(place[-1]), file)
    return {"value": value, "units": units, "low": low, "high": high, "free": free}


def _read(entry: Entry, raw: Any) -> Any:
    if raw is None:
        return None
    try:
        return entry.read(raw)
    except Unfit:
        return None


def _bounds(given: Any) -> tuple[str, str] | None:
    """As text; a share of the given value keeps its sign."""
    if isinstance(given, dict):
        given = given.get("bounds", given.get("relative"))
    if isinstance(given, list) and len(given) == 2:
        return str(given[0]), str(given[1])
    return None


def _default(place: Place, file: MotorFile) -> str | None:
    """The word that counts where the file gives none, where the choices say it."""
    from camring.files.motor.laws import SLOTS

    for slot, law in zip(SLOTS, file.choices.laws, strict=True):
        if (*slot.table.split("."), slot.chooser) == place:
            return law
    defaults = {"representation": file.choices.representation, "symmetry": "lobes"}
    return defaults.get(str(place[-1]), "forward" if place[-1] == "rotation" else None)
