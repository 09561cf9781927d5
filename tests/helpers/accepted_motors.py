"""Motor files that the reader accepts, drawn from its own grammar: all laws, ranges to their ends.

What a key may be is asked of the reader's entries, so that a new key or law is drawn at once.
Only what keys ask of each other is written here a second time: windows within the pitch, a
volume above zero, a spring that presses at the outer dead centre and their like.
"""

import random
from dataclasses import dataclass
from math import log, pi

from camring.files.motor import laws
from camring.files.motor.entries import Count, Entry, Number, Numbers, Switch, Text, Word
from camring.files.motor.keys import Choices, file_tables, inner_table

MOST = 60  # pistons, and lobes
AT_AN_END = 0.15
LEFT_OUT = 0.5
POWERS = 12  # of ten below the upper end, where the lower end is zero
RELATED = "motor.cam. motor.piston. motor.modes motor.valve_plate.notch motor.valve_plate.groove"
MANIFOLDS = {"manifold", "return_manifold"}
SIDES = ("supply_", "return_")
OF_A_SIDE = ("port_area", "discharge_coefficient", "ramp", "notch")
RELATED = (*RELATED.split(), *(f"motor.valve_plate.{s}{key}" for s in SIDES for key in OF_A_SIDE))
EASY = {
    "motor.valve_plate.port_area": 6e-5,
    "motor.valve_plate.discharge_coefficient": 0.65,
    "motor.bore": 0.03,
    "motor.piston_mass": 0.24,
    "motor.dead_volume": 6e-6,
    "motor.leakage_coefficient": 1.6e-13,
    "motor.viscous_damping": 8.5,
    "motor.roller.radius": 0.012,
    "motor.roller.length": 0.028,
    "fluid.density": 870.0,
    "fluid.bulk_modulus": 1.4e9,
    "fluid.vapour_pressure": 3e3,
    "fluid.viscosity": 4.6e-5,
}
"""Of a motor of ordinary size: where `width` is below 1, numbers stay that near to them."""


@dataclass
class Draw:
    """One file as it is drawn.

    Attributes
    ----------
    chance
        All of it comes from here.
    width
        1 for ranges to their ends; below, so many powers of ten about an ordinary motor.
    """

    chance: random.Random
    width: float = 1.0

    def maybe(self, share: float = 1 - LEFT_OUT) -> bool:
        return self.chance.random() < share

    def number(self, low: float, high: float) -> float:
        """From an end, or between them: by powers of ten where zero is left out, else evenly."""
        if self.width == 1.0 and self.maybe(AT_AN_END):
            return self.chance.choice((low, high))
        if low < 0:
            return self.chance.uniform(low, high)
        low = low or high * 10.0**-POWERS
        return min(max(low * (high / low) ** self.chance.random(), low), high)

    def near(self, path: str, low: float, high: float) -> float:
        """The same, or near to an ordinary motor's."""
        if self.width == 1.0 or path not in EASY:
            return self.number(low, high)
        return min(max(EASY[path] * 10 ** self.chance.uniform(-self.width, self.width), low), high)

    def value(self, path: str, entry: Entry):
        """Anything that an entry takes by itself."""
        if isinstance(entry, Switch):
            return self.maybe(0.5)
        if isinstance(entry, Count):
            return self.chance.randint(entry.low, entry.high)
        if isinstance(entry, Text):
            return "".join(self.chance.choices("aé中 <&=\"'\\", k=self.chance.randint(0, 200)))
        if isinstance(entry, Word):
            return self.chance.choice(entry.words)
        if isinstance(entry, Numbers):
            count = self.chance.randint(entry.fewest, min(entry.most, 20))
            return sorted(self.value(path, entry.item) for _ in range(count))
        assert isinstance(entry, Number), path
        return self.near(path, entry.low, entry.high)


def accepted(seed: int, width: float = 1.0, most: int = MOST) -> dict:
    """The document of a motor file, each seed another.

    Parameters
    ----------
    width
        See `Draw`.
    most
        Pistons, and lobes.
    """
    draw = Draw(random.Random(seed), width)
    chosen = tuple(draw.chance.choice(ours(slot)) for slot in laws.SLOTS)
    document = _table(draw, file_tables(Choices(laws=chosen)), "")
    for slot, name in zip(laws.SLOTS, chosen, strict=True):
        _set(document, f"{slot.table}.{slot.chooser}", name)
    motor = document["motor"]
    motor["pistons"], motor["lobes"] = (draw.chance.randint(1, most) for _ in range(2))
    stroke = _cam(draw, motor)
    _plate(draw, motor)
    _sides(Draw(random.Random(f"{seed}, sides"), width), motor)
    _fluid(draw, document)
    motor.pop("modes", None)
    motor.pop("piston", None)
    if draw.maybe():
        rate = draw.number(0.0, min(1e9, 1e7 / stroke))
        motor["piston"] = {
            "spring_rate": rate,
            "spring_preload": draw.number(min(rate * stroke * (1 + 1e-9), 1e7), 1e7),
        }
    document["operating_points"] = [_point(draw, motor) for _ in range(draw.chance.randint(1, 4))]
    _modes(draw, document)
    return document


def ours(slot) -> list[str]:
    """Laws of this package: a test may have defined further ones."""
    found = laws.laws_of(slot)
    return sorted(name for name, law in found.items() if law.__module__.startswith("camring."))


def _table(draw, table, prefix):
    """Every key of a table, some of those that have a default left out."""
    found = {}
    for name, key in table.model_fields.items():
        path = f"{prefix}{name}"
        entries = [item for item in key.metadata if isinstance(item, Entry)]
        inner = inner_table(key.annotation)
        if path.startswith(RELATED) or path in NOT_DRAWN:
            continue
        if not key.is_required() and draw.maybe(LEFT_OUT) and path not in ALWAYS:
            continue
        if entries:
            found[name] = draw.value(path, entries[0])
        elif inner is not None:
            found[name] = _table(draw, inner, f"{path}.")
    return found


NOT_DRAWN = ("design_space", "tolerances", "search", "evaluator", "envelope", "operating_points")
NOT_DRAWN += ("objective", "constraints", "fluid.oil", "fluid.temperature", "thermal")
ALWAYS = ("motor.roller", "motor.valve_plate", "fluid.viscosity")


def _set(document, path, value):
    *tables, key = path.split(".")
    for each in tables:
        document = document.setdefault(each, {})
    document[key] = value


def _cam(draw, motor):
    """Lobes of a sine or nearly; the stroke that its control values cannot exceed."""
    import numpy as np

    if draw.width == 1.0:
        radius = draw.number(1e-3, 9.0)
        stroke = radius * 10 ** draw.chance.uniform(-2.5, -0.2)
    else:
        radius = 0.0909 * 10 ** draw.chance.uniform(-0.2, 0.2) * max(1.0, motor["lobes"] / 6)
        stroke = min(0.0122, radius / motor["lobes"] ** 1.5)
    whole, degree = draw.maybe(0.25), draw.chance.choice((3, 3, 4, 5))
    lobes = motor["lobes"]
    least = max(degree + 1, 6 * lobes if whole else 6)
    count = draw.chance.randint(least, max(least, 720 // 3 if not whole else 720))
    if draw.width < 1.0:
        count = (lobes if whole else 1) * 16
    angle = 2 * pi * np.arange(count) / count * (lobes if whole else 1)
    bent = draw.chance.uniform(-0.2, 0.2)
    lift = stroke / 2 * (1 - np.cos(angle) + bent * np.cos(2 * angle))
    found = {
        "symmetry": "ring" if whole else "lobes",
        "degree": degree,
        "elastic_modulus": draw.number(1e6, 1e14) if draw.width == 1.0 else 2.06e11,
        "poisson_ratio": draw.number(0.0, 0.5),
        "reference_radius": draw.chance.choice(("minimum", "mean")),
        "control_radii": (radius + lift).tolist(),
    }
    high = float(np.ptp(radius + lift))
    if found["reference_radius"] == "mean":
        fewest = pi / 4 * motor["bore"] ** 2 * high
        motor["dead_volume"] = draw.number(min(max(1e-12, 1.01 * fewest), 10.0), 10.0)
        if draw.width < 1.0:
            motor["dead_volume"] = 1.5 * fewest
    if draw.maybe(0.3):
        inside = 2 * (radius + high + motor["roller"]["radius"])
        found["outer_diameter"] = min(20.0, draw.number(max(1e-3, 1.01 * inside), 40.0))
        if found["outer_diameter"] <= 2.5 * (radius + motor["roller"]["radius"]):
            del found["outer_diameter"]
    motor["cam"] = found
    return high


def _plate(draw, motor):
    plate, pitch = motor["valve_plate"], 2 * pi / motor["lobes"]
    widths = (1e-4, pitch) if draw.width == 1.0 else (0.42 * pitch, 0.5 * pitch)
    for side in ("supply", "return"):
        plate[f"{side}_width"] = draw.number(*widths)
        plate.pop(f"{side}_centre", None)
        if draw.width == 1.0 and draw.maybe():
            plate[f"{side}_centre"] = draw.number(-2 * pi, 2 * pi)
    if draw.width < 1.0:
        plate["shift"] = draw.chance.uniform(-0.02, 0.02) * pitch
        if "ramp" in plate:
            plate["ramp"] = draw.chance.uniform(0.1, 1.0)
    for key in ("gap", "land_radii"):
        plate.pop(key, None)
    if plate["shape"] == "tabulated":
        places = sorted({-1.0, 0.0, 1.0, *(draw.chance.uniform(-1, 1) for _ in range(4))})
        plate["position"] = places
        plate["opening_share"] = [
            1.0 if each == 0 else draw.chance.random() * (abs(each) < 1) for each in places
        ]
    elif draw.maybe(0.3) and not MANIFOLDS & motor.keys():
        plate["gap"] = draw.number(1e-8, 1e-3) if draw.width == 1.0 else 8e-6
        radii = [draw.chance.uniform(0.02, 0.06) for _ in range(4)]
        plate["land_radii"] = sorted(radii)
    free = (pitch - max(plate["supply_width"], plate["return_width"])) / 2
    if draw.maybe(0.3) and free > 2e-5:
        plate["notch_angle"] = draw.number(1e-5, free)
        plate["notch_area"] = draw.number(0.0, 1.0 if draw.width == 1.0 else 0.05)


def _sides(draw, motor):
    """What one kind of port has of its own."""
    plate, pitch = motor["valve_plate"], 2 * pi / motor["lobes"]
    usual = draw.width < 1.0
    for side in SIDES:
        if draw.maybe(0.3):
            area = plate["port_area"] * draw.chance.uniform(0.5, 2.0)
            plate[f"{side}port_area"] = area if usual else draw.number(1e-12, 10.0)
        if draw.maybe(0.3):
            low, high = (0.5, 0.9) if usual else (1e-6, 2.0)
            plate[f"{side}discharge_coefficient"] = draw.number(low, high)
        if plate["shape"] != "tabulated" and draw.maybe(0.3):
            plate[f"{side}ramp"] = draw.number(0.1 if usual else 1e-4, 1.0)
        free = (pitch - plate[f"{side}width"]) / 2
        if draw.maybe(0.1) and free > 2e-5:
            plate[f"{side}notch_angle"] = draw.number(1e-5, free)
            plate[f"{side}notch_area"] = draw.number(0.0, 0.05 if usual else 1.0)


def _fluid(draw, document):
    fluid = document["fluid"]
    fluid.setdefault("atmospheric_pressure", 101325.0)
    if fluid["law"] == "aerated":
        least = max(1e4, 1.01 * fluid["atmospheric_pressure"])
        fluid["dissolution_pressure"] = draw.number(least, 1e9)
    if draw.width < 1.0:
        for key in ("atmospheric_pressure", "transition_pressure", "polytropic_index"):
            fluid.pop(key, None)
        if "dissolution_pressure" in fluid:
            fluid["dissolution_pressure"] = 3e6
            fluid["air_fraction"] = draw.number(1e-4, 0.05)
            fluid["air_density"] = 1.2
            fluid["modulus_gain"] = draw.chance.uniform(0, 12)


def _point(draw, motor):
    if draw.width < 1.0:
        speed = 10 ** draw.chance.uniform(-0.3, 1.7)
        pressures = draw.number(5e6, 4.5e7), draw.number(2e5, 3e6), 2e5
    else:
        speed = draw.number(1e-4, 1e4)
        pressures = tuple(draw.number(0.0, 1e9) for _ in range(3))
        if pressures[0] == pressures[1]:
            pressures = (5e8, *pressures[1:])
    notched = any("notch_angle" in key for key in motor["valve_plate"])
    return {
        "speed": speed,
        "supply_pressure": pressures[0],
        "return_pressure": pressures[1],
        "case_pressure": pressures[2],
        "weight": draw.number(1e-6, 1e6),
        "rotation": "reverse" if draw.maybe(0.3) and not notched else "forward",
    }


def _modes(draw, document):
    motor = document["motor"]
    if motor["lobes"] < 2 or MANIFOLDS & motor.keys() or not draw.maybe(0.2):
        return
    count = draw.chance.randint(1, motor["lobes"] - 1)
    idle = draw.chance.sample(range(1, motor["lobes"] + 1), count)
    motor["modes"] = {"=1+1 <half>": {"idle_lobes": idle}}
    document["operating_points"][-1]["mode"] = "=1+1 <half>"


def spread(values: list[float]) -> float:
    """Powers of ten between the least and the greatest of numbers above zero."""
    positive = [each for each in values if each > 0]
    return (log(max(positive)) - log(min(positive))) / log(10)
