"""Random motors for tests: sound ones of the kinds that are built, and awkward ones.

Everything is drawn from a seeded generator, so a failing seed is a test case.
"""

from dataclasses import dataclass, replace
from math import pi

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import strategies as st

from camring.geometry.cam import AbstractCam, PlanarCam, RadialCam
from camring.geometry.extremes import extreme_radius
from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.geometry.valve_plate import LinearWindow, Port, ValvePlate
from camring.physics.friction import ViscousFriction
from camring.physics.leakage import ConstantLeakage
from camring.physics.manifold.manifold import Manifold
from camring.physics.motor import Motor
from camring.physics.oil.fluid import ConstantFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.orifice import TurbulentOrifice

STEEL = Material(206e9, 0.3)
REVOLUTION_PER_MINUTE = 2 * pi / 60


@dataclass(frozen=True)
class Case:
    """One motor with its oil and its operating point."""

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


@dataclass(frozen=True)
class Structure:
    """The counts and kinds of a motor: what shapes its arrays and costs a compilation."""

    kind: str  # radial, ring (free round the whole turn) or planar
    pistons: int
    lobes: int
    count: int  # control values of a lobe
    degree: int = 3
    reference: str = "minimum"


STRUCTURES = (
    Structure("radial", 8, 6, 16),
    Structure("ring", 6, 4, 10, reference="mean"),
    Structure("radial", 5, 9, 12, degree=5),
    Structure("planar", 6, 4, 12, degree=4),
)


def random_cam(rng, structure: Structure, inner: float, stroke: float) -> AbstractCam:
    lobes, count, degree = structure.lobes, structure.count, structure.degree
    if structure.kind == "ring":
        lobe = [
            smooth_radii(rng, count, inner, stroke * rng.uniform(0.97, 1.0)) for _ in range(lobes)
        ]
        return RadialCam(np.concatenate(lobe), repeats=1, degree=degree)
    radii = smooth_radii(rng, count, inner, stroke)
    if structure.kind == "radial":
        return RadialCam(radii, repeats=lobes, degree=degree)
    step = 2 * pi / lobes / count
    turned = step * (np.arange(count) + rng.uniform(-0.1, 0.1, size=count))
    points = np.stack([radii * np.cos(turned), radii * np.sin(turned)], axis=-1)
    return PlanarCam(points, repeats=lobes, degree=degree)


def sound_case(seed: int, structure: Structure | None = None) -> Case:
    """A motor an engineer might build, at an operating point it might run at.

    Without a structure the seed picks one of `STRUCTURES`.
    """
    rng = np.random.default_rng([2024, seed])
    structure = structure or STRUCTURES[seed % len(STRUCTURES)]
    lobes, pistons = structure.lobes, structure.pistons
    bore = rng.uniform(0.025, 0.06)
    stroke = bore * rng.uniform(0.3, 0.5)
    least = lobes * stroke / rng.uniform(0.7, 1.1)  # keeps the pressure angle below about 35 deg
    inner = max(least, 1.3 * pistons * bore / (2 * pi))
    cam = random_cam(rng, structure, inner, stroke)
    area = pi * bore**2 / 4
    pitch = 2 * pi / lobes
    drop = np.exp(rng.uniform(np.log(0.2e5), np.log(15e5)))  # throttled at the largest flow
    supply, back = rng.uniform(120e5, 420e5), rng.uniform(5e5, 20e5)
    # As fast as centrifugal lift-off and the return pressure let it.
    mass = 400 * bore**2
    fastest = np.sqrt(0.5 * area * back / (mass * stroke / 2)) / lobes
    speed = np.exp(rng.uniform(np.log(0.03), 0)) * min(fastest, 300 * REVOLUTION_PER_MINUTE)
    flow = area * speed * stroke * lobes / 2
    port_area = flow / (0.65 * np.sqrt(2 * min(drop, 0.5 * back) / 870))
    widths = pitch / 2 * rng.uniform(0.94, 0.995, size=2)
    plate = ValvePlate(
        port_area,
        Port(widths[0], pitch / 4),
        Port(widths[1], 3 * pitch / 4),
        LinearWindow(rng.uniform(0.15, 1.0)),
        pitch * rng.uniform(-0.003, 0.003),
        lobes=lobes,
    )
    lift_spread = 1.0 if structure.reference == "mean" else 0.0
    motor = Motor(
        cam,
        Piston(bore, mass),
        Roller(0.4 * bore, bore, STEEL),
        STEEL,
        plate,
        area * stroke * (rng.uniform(0.4, 1.5) + lift_spread),
        TurbulentOrifice(rng.uniform(0.6, 0.7)),
        ConstantLeakage(area * speed * stroke * 10 ** rng.uniform(-11, -9.5)),
        ViscousFriction(rng.uniform(5.0, 60.0)),
        reference=structure.reference,
        pistons=pistons,
        lobes=lobes,
    )
    fluid = ConstantFluid(
        rng.uniform(840, 900), rng.uniform(0.9e9, 1.8e9), 3e3, rng.choice([1e5, 1e5, 3e4])
    )
    case = back if rng.uniform() < 0.5 else rng.uniform(1e5, 3e5)
    return Case(motor, fluid, OperatingPoint(speed, supply, back, case))


def with_manifold(case: Case, share: float, strokes: float, name: str = "manifold") -> Case:
    """The motor fed through a line and a manifold; or emptied, by the name `return_manifold`.

    `share` of the pressure difference is lost in the line at the displaced flow;
    the manifold holds the strokes of all pistons `strokes` times.
    """
    motor, area = case.motor, float(case.motor.piston.area)
    stroke = float(extreme_radius(motor.cam, 1) - extreme_radius(motor.cam, -1))
    swept = motor.pistons * area * stroke
    flow = swept * motor.lobes * float(case.point.shaft_speed) / (2 * pi)
    manifold = Manifold(strokes * swept, flow / (share * float(case.point.pressure_drop)))
    return Case(replaced_manifold(motor, manifold, name), case.fluid, case.point)


def with_drawn_manifold(case: Case, random: np.random.Generator, name: str = "manifold") -> Case:
    """2 to 20 % of the pressure difference lost in the line, 0.04 to 30 strokes in the manifold."""
    share = 0.02 * 10 ** random.uniform()
    return with_manifold(case, share, 10 ** random.uniform(-1.4, 1.5), name)


def replaced_manifold(motor, manifold, name="manifold"):
    return replace(motor, **{name: manifold})


def stacked(cases: list[Case]) -> tuple:
    """Motors of one structure as one batch: (motor, fluid, point) with a leading axis."""
    trees = [tuple(case) for case in cases]
    return jax.tree.map(lambda *leaves: jnp.stack(leaves), *trees)


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


def window_widths(case: Case):
    plate = case.motor.valve_plate
    return plate.supply.width, plate.return_.width


def shaft_speed(case: Case):
    return case.point.shaft_speed


def awkward_case(seed: int, trouble: str, structure: Structure = STRUCTURES[0]) -> Case:
    """A sound motor with one thing pushed to where solvers have trouble."""
    rng = np.random.default_rng([77, seed])
    case = sound_case(seed, structure)
    plate = case.motor.valve_plate
    pitch = plate.pitch
    match trouble:
        case "windows nearly touch":
            gap = 10 ** rng.uniform(-9, -3) * pitch
            return case.changed(window_widths, (pitch / 2 - gap, pitch / 2 - gap))
        case "windows overlap":
            return case.changed(window_widths, tuple(pitch / 2 * rng.uniform(1.01, 1.25, size=2)))
        case "trapped oil":
            return case.changed(window_widths, tuple(pitch / 2 * rng.uniform(0.72, 0.82, size=2)))
        case "no leakage":
            return case.changed(lambda c: c.motor.leakage.coefficient, 0.0)
        case "crawling":
            return case.changed(shaft_speed, 1 * REVOLUTION_PER_MINUTE)
        case "racing":
            return case.changed(shaft_speed, 1500 * REVOLUTION_PER_MINUTE)
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
