"""Random motors for tests: sound ones of the kinds that are built, and awkward ones.

Everything is drawn from a seeded generator, so a failing seed is a test case.
"""

from dataclasses import dataclass
from math import pi

import equinox as eqx
import numpy as np
from hypothesis import strategies as st

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.geometry.valve_plate import LinearWindow, Port, ValvePlate
from camring.physics.fluid import ConstantFluid
from camring.physics.friction import ViscousFriction
from camring.physics.leakage import ConstantLeakage
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.orifice import TurbulentOrifice

STEEL = Material(206e9, 0.3)
REVOLUTION_PER_MINUTE = 2 * pi / 60


@dataclass(frozen=True)
class Case:
    """One motor with its oil and its duty."""

    motor: Motor
    fluid: ConstantFluid
    point: OperatingPoint

    def __iter__(self):
        return iter((self.motor, self.fluid, self.point))

    def changed(self, where, value) -> "Case":
        """A copy with some numbers replaced: `case.changed(lambda c: c.fluid.density, 900.0)`."""
        tree = (self.motor, self.fluid, self.point)

        def of(tree):
            return where(Case(*tree))

        example = of(tree)
        many = isinstance(example, tuple | list)
        value = [np.asarray(v, float) for v in value] if many else np.asarray(value, float)
        return Case(*eqx.tree_at(of, tree, value))


def smooth_radii(rng, count: int, inner: float, stroke: float, modes: int = 3) -> np.ndarray:
    """A rise and a fall with a few smooth modes on top; exact stroke of the control values."""
    phase = 2 * pi * np.arange(count) / count
    shape = -np.cos(phase)
    for mode in range(2, modes + 2):
        a, b = rng.normal(scale=0.06 / mode**2, size=2)
        shape = shape + a * np.cos(mode * phase) + b * np.sin(mode * phase)
    return inner + stroke * (shape - shape.min()) / np.ptp(shape)


def random_cam(rng, lobes: int, inner: float, stroke: float, kind: str = "radial") -> AbstractCam:
    """`kind`: radial, ring (free round the whole turn) or planar."""
    degree = int(rng.choice([3, 3, 3, 4, 5]))
    count = int(rng.integers(10, 21))
    if kind == "ring":
        lobe = [
            smooth_radii(rng, count, inner, stroke * rng.uniform(0.93, 1.0)) for _ in range(lobes)
        ]
        return RadialCam(np.concatenate(lobe), 1, degree)
    radii = smooth_radii(rng, count, inner, stroke)
    if kind == "radial":
        return RadialCam(radii, lobes, degree)
    step = 2 * pi / lobes / count
    turned = step * (np.arange(count) + rng.uniform(-0.1, 0.1, size=count))
    points = np.stack([radii * np.cos(turned), radii * np.sin(turned)], axis=-1)
    return PlanarCam(points, lobes, degree)


def sound_case(seed: int, kind: str | None = None) -> Case:
    """A motor an engineer might build, at a duty it might run at."""
    rng = np.random.default_rng([2024, seed])
    lobes = int(rng.integers(4, 10))
    pistons = int(rng.choice([p for p in range(5, 17) if p != lobes]))
    bore = rng.uniform(0.025, 0.06)
    stroke = bore * rng.uniform(0.3, 0.5)
    room = lobes * stroke / rng.uniform(0.7, 1.1)  # keeps the pressure angle below about 35 deg
    inner = max(room, 1.3 * pistons * bore / (2 * pi))
    kind = kind or str(rng.choice(["radial", "radial", "radial", "ring", "planar"]))
    cam = random_cam(rng, lobes, inner, stroke, kind)
    area = pi * bore**2 / 4
    pitch = 2 * pi / lobes
    speed = np.exp(rng.uniform(np.log(10), np.log(300))) * REVOLUTION_PER_MINUTE
    drop = np.exp(rng.uniform(np.log(0.2e5), np.log(15e5)))  # throttled at the largest flow
    flow = area * speed * stroke * lobes / 2
    port_area = flow / (0.65 * np.sqrt(2 * drop / 870))
    widths = pitch / 2 * rng.uniform(0.92, 0.99, size=2)
    plate = ValvePlate(
        port_area,
        Port(widths[0], pitch / 4),
        Port(widths[1], 3 * pitch / 4),
        LinearWindow(rng.uniform(0.15, 1.0)),
        pitch * rng.uniform(-0.004, 0.004),
        lobes=lobes,
    )
    supply, back = rng.uniform(120e5, 420e5), rng.uniform(5e5, 20e5)
    motor = Motor(
        cam,
        Piston(bore, 400 * bore**2),
        Roller(0.4 * bore, bore, STEEL),
        STEEL,
        plate,
        area * stroke * rng.uniform(0.4, 1.5),
        TurbulentOrifice(rng.uniform(0.6, 0.7)),
        ConstantLeakage(area * 10 ** rng.uniform(-10.2, -9.2)),
        ViscousFriction(rng.uniform(5.0, 60.0)),
        reference="mean" if rng.uniform() < 0.2 else "minimum",
        pistons=pistons,
        lobes=lobes,
    )
    fluid = ConstantFluid(
        rng.uniform(840, 900), rng.uniform(0.9e9, 1.8e9), 3e3, rng.choice([1e5, 1e5, 3e4])
    )
    case = back if rng.uniform() < 0.5 else rng.uniform(1e5, 3e5)
    if motor.reference == "mean":
        motor = eqx.tree_at(lambda m: m.dead_volume, motor, motor.dead_volume + area * stroke)
    return Case(motor, fluid, OperatingPoint(speed, supply, back, case))


AWKWARD = (
    "windows nearly touch",
    "windows overlap",
    "trapped oil",
    "no leakage",
    "crawling",
    "racing",
    "high pressure",
    "stiff oil",
    "soft oil",
    "small ports",
    "wide ports",
    "tiny dead volume",
    "sharp transition",
    "late timing",
    "narrow ramps",
)


def awkward_case(seed: int, trouble: str) -> Case:
    """A sound motor with one thing pushed to where solvers have trouble."""
    rng = np.random.default_rng([77, seed])
    case = sound_case(seed)
    plate = case.motor.valve_plate
    pitch = plate.pitch
    widths = lambda c: (c.motor.valve_plate.supply.width, c.motor.valve_plate.return_.width)  # noqa: E731
    speed = lambda c: c.point.shaft_speed  # noqa: E731
    match trouble:
        case "windows nearly touch":
            gap = 10 ** rng.uniform(-9, -3) * pitch
            return case.changed(widths, (pitch / 2 - gap, pitch / 2 - gap))
        case "windows overlap":
            return case.changed(widths, tuple(pitch / 2 * rng.uniform(1.01, 1.25, size=2)))
        case "trapped oil":
            return case.changed(widths, tuple(pitch / 2 * rng.uniform(0.72, 0.82, size=2)))
        case "no leakage":
            return case.changed(lambda c: c.motor.leakage.coefficient, 0.0)
        case "crawling":
            return case.changed(speed, 1 * REVOLUTION_PER_MINUTE)
        case "racing":
            return case.changed(speed, 1500 * REVOLUTION_PER_MINUTE)
        case "high pressure":
            return case.changed(lambda c: c.point.supply_pressure, 450e5)
        case "stiff oil":
            return case.changed(lambda c: c.fluid.bulk_modulus, 2e11)
        case "soft oil":
            return case.changed(lambda c: c.fluid.bulk_modulus, 2e8)
        case "small ports":
            area = float(plate.port_area)
            return case.changed(lambda c: c.motor.valve_plate.port_area, area / 6)
        case "wide ports":
            area = float(plate.port_area)
            return case.changed(lambda c: c.motor.valve_plate.port_area, area * 20)
        case "tiny dead volume":
            volume = float(case.motor.dead_volume)
            share = 1.0 if case.motor.reference == "mean" else 0.02
            return case.changed(lambda c: c.motor.dead_volume, volume * share)
        case "sharp transition":
            return case.changed(lambda c: c.fluid.transition_pressure, 1e3)
        case "late timing":
            shift = float(plate.shift) + pitch * rng.uniform(0.02, 0.05)
            return case.changed(lambda c: c.motor.valve_plate.shift, shift)
        case "narrow ramps":
            return case.changed(lambda c: c.motor.valve_plate.window.ramp, 0.02)
    raise ValueError(trouble)


def seeds() -> st.SearchStrategy[int]:
    """Seeds of random motors, for hypothesis."""
    return st.integers(0, 10_000)
