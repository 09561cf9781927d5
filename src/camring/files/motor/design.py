"""The table `[design_space]`: which numbers may change, and how far."""

from dataclasses import replace
from typing import Any

import jax
import numpy as np

from camring.files.errors import InputError, quote
from camring.files.motor.design_cam import build_cam_modes
from camring.files.motor.entries import Band, Count, Entry, Number, Numbers, Unfit
from camring.files.motor.keys import Choices, key_map, nearest
from camring.files.motor.paths import flat_paths
from camring.files.motor.tables import FileTables
from camring.files.shapes.own_ports import require_effect
from camring.files.units import from_si, split_quantity
from camring.numerics.quantity import real
from camring.objective.design_space import DesignSpace, Variable, leaf
from camring.physics.system import System

SHARE = Number("a share of the given value", '"-10 %"', unit="1", low=-0.99, high=100.0)
INSIDE = 1e-9  # of the width of the bounds: what rounding may put outside
MOST_VARIABLES = 100
EXAMPLE = '"motor.valve_plate.shift" = ["-1 deg", "1 deg"]'


def build_design_space(
    table: dict[str, Any], tables: FileTables, system: System, choices: Choices
) -> DesignSpace:
    """The design space of a file, around its own motor.

    Raises
    ------
    InputError
        For a path that cannot vary, bounds without width, a given motor outside.
    """
    keys = key_map(choices)
    variables, seen = [], set[str]()
    for path, bounds in flat_paths(table, keys, without="cam"):
        variable = _variable(path, bounds, keys, tables, system)
        for key in variable.keys:
            if key in seen:
                raise InputError(_field(key), "appears twice", "give it one pair of bounds")
            seen.add(key)
        variables.append(variable)
    cam = build_cam_modes(table["cam"], tables.motor, system) if "cam" in table else None
    key = "control_points" if tables.motor.cam.representation == "planar" else "control_radii"
    space = DesignSpace(tuple(variables), cam, f"motor.cam.{key}")
    if space.dimension == 0:
        raise InputError(
            "[design_space]", "lets nothing change", f"give it a line such as {EXAMPLE}"
        )
    if space.dimension > MOST_VARIABLES:
        raise InputError(
            "[design_space]",
            f"has {space.dimension} coordinates, more than the {MOST_VARIABLES} of any search",
            "leave some out",
        )
    return space


def _field(path: str) -> str:
    return f'design_space."{path}"'


def _variable(
    path: str, bounds: Any, keys: dict[str, Entry], tables: FileTables, system: System
) -> Variable:
    relative, companions = False, []
    if isinstance(bounds, dict):
        unknown = set(bounds) - {"bounds", "relative", "together_with"}
        if unknown:
            name = min(unknown)
            close = nearest(name, ["bounds", "relative", "together_with"])
            raise InputError(
                f"{_field(path)}.{name if name.isidentifier() else quote(name)}",
                "is not a key of a variable",
                f"you probably meant {close}" if close else "use bounds, relative, together_with",
            )
        companions = bounds.get("together_with", [])
        if ("bounds" in bounds) == ("relative" in bounds):
            raise InputError(
                _field(path),
                "must have either bounds or relative",
                'write { relative = ["-5 %", "5 %"] } or { bounds = [low, high] }',
            )
        relative = "relative" in bounds
        bounds = bounds["relative"] if relative else bounds["bounds"]
    paths = (path, *_companions(path, companions))
    entries = [_varied(each, keys, tables) for each in paths]
    for each, entry in zip(paths, entries, strict=True):
        _require_present(each, entry, system)
        require_effect(_field(each), each, vars(tables.motor.valve_plate), "vary")
    item = SHARE if relative else replace(entries[0], leaves=())
    assert isinstance(item, Number)
    low, high = _bounds(path, bounds, item)
    variable = Variable(
        keys=paths,
        leaves=tuple(entry.leaves for entry in entries),
        low=real(low),
        high=real(high),
        relative=relative,
    )
    # Of plain numbers: nothing has to be compiled for what is looked at once.
    plain, given = jax.tree.map(np.asarray, (variable, system))
    _require_given_inside(plain, bounds, item, given)
    _require_limits(plain, entries, tables, given)
    return variable


def _companions(path: str, value: Any) -> list[str]:
    if isinstance(value, list) and all(isinstance(each, str) for each in value):
        return value
    raise InputError(
        f"{_field(path)}.together_with",
        f"is {quote(value)} but must be a list of paths",
        'write together_with = ["motor.valve_plate.return_width"]',
    )


def _varied(path: str, keys: dict[str, Entry], tables: FileTables) -> Number:
    """The entry of a number of motor or oil that may vary."""
    field, entry = _field(path), keys.get(path)
    varying = [key for key, each in keys.items() if type(each) is Number and each.leaves]
    if entry is None:
        close = nearest(path, varying)
        raise InputError(
            field if path.isprintable() and len(path) < 100 else "design_space",
            "is no number of the motor",
            f'you probably meant "{close}"' if close else f"give a path as in {EXAMPLE}",
        )
    if isinstance(entry, Count):
        raise InputError(
            field,
            "is a count, which cannot be varied in one search",
            "run one study for each count and compare",
        )
    if isinstance(entry, Numbers):
        raise InputError(
            field,
            "is a list, which does not vary number by number",
            "let smooth modes shape it: add [design_space.cam] with modes and amplitude",
        )
    if not isinstance(entry, Number) or not entry.leaves:
        raise InputError(
            field, "is not a number of motor or oil", "leave it out; the search varies hardware"
        )
    if path == "motor.cam.reference_radius" and isinstance(tables.motor.cam.reference_radius, str):
        raise InputError(
            field,
            f"is given as the rule {quote(tables.motor.cam.reference_radius)}",
            "give motor.cam.reference_radius as a length to vary it",
        )
    return entry


def _require_present(path: str, entry: Number, system: System) -> None:
    try:
        leaf(entry.leaves[0])(system)
    except AttributeError:
        raise InputError(
            _field(path),
            "varies a part that the motor does not have",
            f"give {path} a value too, where the search begins",
        ) from None


def _bounds(path: str, bounds: Any, item: Number) -> tuple[float, float]:
    example = f"[{item.example}, {item.example}]"
    band = Band(f"bounds [low, high] of {item.meaning}", example, item=item, fewest=2, most=2)
    try:
        return band.read(bounds)
    except Unfit as error:
        raise InputError(_field(path) + error.inside, error.problem, error.way_out) from None


def _as_bounds(given: float, bounds: Any, si_unit: str) -> str:
    """A value as the bounds are written: in their unit, if they have one."""
    unit = split_quantity(bounds[0])[1] if isinstance(bounds[0], str) else ""
    return f"{from_si(given, unit, si_unit):.6g} {unit}" if unit else f"{given:.6g}"


def _require_given_inside(variable: Variable, bounds: Any, item: Number, system: System) -> None:
    unit = float(variable.locate(system))
    shown = f"[{quote(bounds[0])}, {quote(bounds[1])}]"
    if not -INSIDE <= unit <= 1 + INSIDE:
        given = 0.0 if variable.relative else float(leaf(variable.leaves[0][0])(system))
        shown_value = _as_bounds(given, bounds, item.unit)
        left_out = "no change" if variable.relative else f"the given value {shown_value}"
        raise InputError(
            _field(variable.name), f"has bounds {shown} that leave out {left_out}", "widen them"
        )
    values = [float(leaf(paths[0])(system)) for paths in variable.leaves]
    if variable.relative and min(abs(value) for value in values) == 0:
        raise InputError(
            _field(variable.name),
            "has relative bounds but the given value is zero",
            "give absolute bounds",
        )
    if not variable.relative and max(values) - min(values) > 1e-12 * max(map(abs, values)):
        raise InputError(
            _field(variable.name),
            "moves together with numbers that are given differently",
            "give them one value, or use relative bounds",
        )


def _require_limits(
    variable: Variable, entries: list[Number], tables: FileTables, system: System
) -> None:
    """Each number must stay within its own limits at both ends."""
    for key, entry, paths in zip(variable.keys, entries, variable.leaves, strict=True):
        for unit in (0.0, 1.0):
            value = float(leaf(paths[0])(variable.apply(system, unit)))
            high = entry.high
            if key.endswith(("supply_width", "return_width")):
                high = 2 * np.pi / tables.motor.lobes * (1 + 1e-9)
            if not entry.low <= value <= high:
                raise InputError(
                    _field(variable.name),
                    f"lets {key} reach {value:.6g} {entry.unit}, beyond its limits "
                    f"{entry.low:.4g} to {high:.4g}",
                    "narrow the bounds",
                )
