"""The exchangeable laws of the file, read off the law classes themselves.

A law is one final class in `physics` or `geometry`. Its name in the file is its
class's name without the parent's noun (`ConstantFluid` is `law = "constant"`,
`LaminarTurbulentOrifice` is `orifice = "laminar-turbulent"`); its keys are its
fields, with the units of their annotations. A `Slot` says where the keys of one
kind of law stand. So a new law class is in the file, in the design space and in
the parameter reference at once; only what cannot be read off it (limits of
sanity, meaning, an example) may be added to `KNOWN_FIELDS`.
"""

import inspect
import pkgutil
import re
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from importlib import import_module
from typing import Any, get_args, get_type_hints

import camring.geometry
import camring.physics
from camring.files.motor.entries import Entry, Number, Numbers
from camring.files.motor.user_laws import import_user_laws
from camring.geometry.window import AbstractWindow
from camring.physics.friction import AbstractFriction
from camring.physics.leakage import AbstractLeakage
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.orifice import AbstractOrifice


@dataclass(frozen=True)
class Slot:
    """A place in the motor for one kind of law.

    Attributes
    ----------
    parent
        The abstract class of the laws.
    table, chooser
        The key that names the law: `chooser` in `[table]`.
    leaf
        Where the law stands in the `System`.
    default
        The law of a file that names none: the derivation's.
    keys
        File keys of fields that are called otherwise there, as paths.
    """

    parent: type
    table: str
    chooser: str
    leaf: str
    default: str
    keys: dict[str, str] = field(default_factory=dict, hash=False)


SLOTS = (
    Slot(AbstractFluid, "fluid", "law", "fluid", "constant"),
    Slot(AbstractOrifice, "motor.valve_plate", "orifice", "motor.orifice", "turbulent"),
    Slot(AbstractWindow, "motor.valve_plate", "shape", "motor.valve_plate.window", "linear"),
    Slot(
        AbstractLeakage,
        "motor",
        "leakage",
        "motor.leakage",
        "constant",
        {
            "coefficient": "motor.leakage_coefficient",
            "reference_viscosity": "motor.reference_viscosity",
        },
    ),
    Slot(
        AbstractFriction,
        "motor",
        "friction",
        "motor.friction",
        "viscous",
        {
            "damping": "motor.viscous_damping",
            "roller": "motor.roller.friction",
            "side": "motor.side_friction",
            "roller_static": "motor.roller.static_friction",
            "roller_stribeck": "motor.roller.stribeck_speed",
            "side_static": "motor.side_static_friction",
            "side_stribeck": "motor.side_stribeck_speed",
        },
    ),
)

# File defaults where the class has none; limits of sanity, meaning and example.
FILE_DEFAULTS = {"motor.valve_plate.ramp": 1.0}
LEAST_KNOTS = 2  # in a list that a law takes

# Rounding of the equation grows with the modulus; here it is 2e-11 of the pressure's range, and
# results agree with the independent solver to 5e-9 (docs/guide/accuracy.md).
STIFFEST = 1e14

KNOWN_FIELDS: dict[str, tuple[str, str, float, float]] = {
    "fluid.density": ("the density of the oil", '"870 kg/m^3"', 1.0, 3e4),
    "fluid.bulk_modulus": ("the bulk modulus of the oil", '"1.4 GPa"', 1e5, STIFFEST),
    "fluid.vapour_pressure": ("the absolute vapour pressure", '"3 kPa"', 0.0, 1e8),
    "fluid.transition_pressure": (
        "the pressure drop below which port flow is laminar",
        '"1 bar"',
        1.0,
        1e8,
    ),
    "fluid.viscosity": ("the kinematic viscosity", '"46 mm^2/s"', 1e-9, 1.0),
    "fluid.atmospheric_pressure": (
        "the pressure at which the oil took up its air",
        '"1.01325 bar"',
        1e3,
        1e7,
    ),
    "fluid.air_fraction": ("the free air by volume at that pressure", "0.005", 0.0, 0.5),
    "fluid.air_density": ("the density of that air", '"1.2 kg/m^3"', 0.0, 100.0),
    "fluid.polytropic_index": (
        "the polytropic index of the air, which else stays as warm as the oil (1)",
        "1.4",
        0.5,
        5.0,
    ),
    "fluid.dissolution_pressure": (
        "the pressure above which all air is in solution",
        '"30 bar"',
        1e4,
        1e9,
    ),
    "fluid.modulus_gain": ("the rise of bulk modulus with pressure", "9", 0.0, 100.0),
    "motor.valve_plate.critical_flow_number": (
        "the flow number at which an orifice turns turbulent",
        "1000",
        1e-3,
        1e9,
    ),
    "motor.valve_plate.position": (
        "distances from a window's centre over half its width",
        "-0.5",
        -1.0,
        1.0,
    ),
    "motor.valve_plate.opening_share": (
        "the open shares of the port area there",
        "0.8",
        0.0,
        1.0,
    ),
    "motor.roller.friction": ("the roller's friction coefficient", "0.013", 0.0, 1.0),
    "motor.roller.static_friction": (
        "the roller's friction coefficient at rest",
        "0.02",
        0.0,
        1.0,
    ),
    "motor.roller.stribeck_speed": (
        "the roller's sliding speed at which the difference has fallen to 1/e",
        '"0.3 m/s"',
        1e-6,
        1e3,
    ),
    "motor.side_static_friction": (
        "the friction coefficient of piston on bore at rest",
        "0.12",
        0.0,
        1.0,
    ),
    "motor.side_stribeck_speed": (
        "the piston's speed at which the difference has fallen to 1/e",
        '"0.05 m/s"',
        1e-6,
        1e3,
    ),
    "motor.side_friction": ("the friction coefficient of piston on bore", "0.05", 0.0, 1.0),
    "motor.valve_plate.discharge_coefficient": ("the discharge coefficient", "0.65", 1e-6, 2.0),
    "motor.valve_plate.ramp": ("the ramps' share of a window", "0.35", 1e-4, 1.0),
    "motor.leakage_coefficient": (
        "a chamber's leakage for each unit of pressure",
        '"1.6e-13 m^3/(s*Pa)"',
        0.0,
        1e-4,
    ),
    "motor.reference_viscosity": (
        "the kinematic viscosity at which the leakage coefficient holds",
        '"46 mm^2/s"',
        1e-9,
        1.0,
    ),
    "motor.viscous_damping": ("a piston's viscous damping", '"8.5 N*s/m"', 0.0, 1e7),
}


def laws_of(slot: Slot) -> dict[str, type]:
    """Every law of a kind by its name in the file, the default first.

    Of two classes of one name, as when a cell of a notebook has run twice, the later one.
    """
    _import_laws()
    found = {law_name(law, slot.parent): law for law in _finals(slot.parent)}
    return {slot.default: found.pop(slot.default), **dict(sorted(found.items()))}


def known_laws() -> tuple[type, ...]:
    """All of all kinds, for keeping what depends on which there are."""
    return tuple(law for slot in SLOTS for law in laws_of(slot).values())


def law_name(law: type, parent: type) -> str:
    """`LaminarTurbulentOrifice` among the `AbstractOrifice`s is "laminar-turbulent"."""
    noun = parent.__name__.removeprefix("Abstract")
    words = re.findall(r"[A-Z][a-z0-9]*", law.__name__.removesuffix(noun))
    return "-".join(words).lower()


def law_keys(slot: Slot, law: type) -> dict[str, tuple[str, Entry, Any]]:
    """What each field of a law takes: name -> (path in the file, entry, default or `...`)."""
    hints = get_type_hints(law, include_extras=True)
    keys = {}
    for each in fields(law):
        if each.default is None and not hasattr(hints[each.name], "__metadata__"):
            continue  # a part of its own, which no key of the law gives
        path = slot.keys.get(each.name, f"{slot.table}.{each.name}")
        default = each.default if each.default is not MISSING else ...
        default = FILE_DEFAULTS.get(path, default)
        keys[each.name] = path, _entry(path, hints[each.name], f"{slot.leaf}.{each.name}"), default
    return keys


def _entry(path: str, annotation: Any, leaf: str) -> Entry:
    if not hasattr(annotation, "__metadata__"):
        raise TypeError(f"{leaf} has no unit in its annotation, so no file can give it")
    array, unit = get_args(annotation)[:2]
    plain = path.rsplit(".", 1)[1].replace("_", " ")
    meaning, example, low, high = KNOWN_FIELDS.get(
        path, (f"the {plain}", "1" if unit == "1" else f'"1 {unit}"', -1e15, 1e15)
    )
    number = Number(meaning, example, unit=unit, low=low, high=high, leaves=(leaf,))
    if getattr(array, "dim_str", "") == "":
        return number
    item = replace(number, meaning=f"one of {meaning}", leaves=())
    listed = f"[{example}, ...]"
    return Numbers(meaning, listed, item=item, fewest=LEAST_KNOTS, leaves=(leaf,))


@cache
def _import_laws() -> None:
    for package in (camring.geometry, camring.physics):
        for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            import_module(module.name)
    import_user_laws()


def unfinished_law(slot: Slot, name: str) -> tuple[str, list[str]] | None:
    """The class of a law that lacks some methods, and which, by the name it would have."""
    for child in _below(slot.parent):
        if inspect.isabstract(child) and law_name(child, slot.parent) == name:
            return child.__name__, sorted(getattr(child, "__abstractmethods__", ()))
    return None


def _finals(parent: type) -> list[type]:
    return [child for child in _below(parent) if not inspect.isabstract(child)]


def _below(parent: type) -> list[type]:
    """All classes under one, each after those under it."""
    found: list[type] = []
    children: list[type] = parent.__subclasses__()
    for child in children:
        found += [*_below(child), child]
    return found
