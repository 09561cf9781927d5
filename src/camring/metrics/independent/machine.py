"""The numbers of one motor at one duty, as plain floats.

The second road to every result starts here: after this file nothing of JAX and
none of the program's own physics is used, so that a fault there cannot hide by
being made twice.
"""

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from math import nan, pi
from typing import Any, Literal

import numpy as np

from camring.metrics.independent.failure import OrbitError


@dataclass(frozen=True)
class Oil:
    """Numbers of both fluid laws; SI, absolute pressures."""

    density: float
    bulk_modulus: float
    vapour_pressure: float = 0.0
    transition_pressure: float = 1e5
    law: Literal["constant", "aerated"] = "constant"
    viscosity: float = 0.0
    air_fraction: float = 0.005
    air_density: float = 1.2
    polytropic_index: float = 1.0
    dissolution_pressure: float = 3e6
    atmospheric_pressure: float = 101325.0
    modulus_gain: float = 0.0


@dataclass(frozen=True)
class Window:
    """One kind of port: where it opens and how far. Angles in rad.

    `table` is a tabulated opening: distances from the centre and open shares,
    joined by straight lines.
    """

    width: float
    centre: float
    shape: Literal["linear", "round", "table"] = "linear"
    ramp: float = 1.0
    notch_angle: float = 0.0
    notch_area: float = 0.0
    table: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())


@dataclass(frozen=True)
class Manifold:
    """The gallery before the supply windows and the line that feeds it."""

    volume: float
    line_conductance: float  # volume flow for each pascal


@dataclass(frozen=True)
class Machine:
    """One motor, its oil and one duty: everything model.md sections 2 to 6 and 13 ask for."""

    pistons: int
    lobes: int
    bore: float
    piston_mass: float
    viscous_damping: float
    dead_volume: float
    leakage_coefficient: float
    control: np.ndarray  # radii, or planar points as complex numbers; one cam period
    repeats: int
    degree: int
    reference_radius: float | Literal["minimum", "mean"]
    ring_modulus: float
    ring_poisson: float
    roller_radius: float
    roller_length: float
    roller_modulus: float
    roller_poisson: float
    port_area: float
    discharge_coefficient: float
    supply: Window
    return_: Window
    oil: Oil
    shaft_speed: float
    supply_pressure: float
    return_pressure: float
    case_pressure: float
    orifice: Literal["turbulent", "laminar-turbulent"] = "turbulent"
    critical_flow_number: float = 1000.0
    roller_friction: float = 0.0
    side_friction: float = 0.0
    manifold: Manifold | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def piston_area(self) -> float:
        return pi * self.bore**2 / 4

    @property
    def period(self) -> float:
        return 2 * pi / self.repeats

    def with_gap(self, clearance: float, length: float, eccentricity: float) -> "Machine":
        """Leakage and damping of the piston's gap added to the coefficients (section 13)."""
        viscosity = self.oil.density * self.oil.viscosity
        leak = pi * self.bore * clearance**3 * (1 + 1.5 * eccentricity**2)
        return replace(
            self,
            leakage_coefficient=self.leakage_coefficient + leak / (12 * viscosity * length),
            viscous_damping=self.viscous_damping + viscosity * pi * self.bore * length / clearance,
        )


def number(value: Any) -> float:
    """A scalar leaf as a Python float."""
    return float(np.asarray(value))


def _oil(fluid: Any) -> Oil:
    kind = type(fluid).__name__
    if kind not in ("ConstantFluid", "AeratedFluid"):
        raise NotImplementedError(f"the independent solver has no fluid law {kind!r}")
    names = Oil.__dataclass_fields__.keys() - {"law"}
    given = {name: number(getattr(fluid, name)) for name in names if hasattr(fluid, name)}
    return Oil(**given, law="aerated" if kind == "AeratedFluid" else "constant")


SHAPES: dict[str, Literal["linear", "round", "table"]] = {
    "LinearWindow": "linear",
    "RoundWindow": "round",
    "TabulatedWindow": "table",
}
ORIFICES: dict[str, Literal["turbulent", "laminar-turbulent"]] = {
    "TurbulentOrifice": "turbulent",
    "LaminarTurbulentOrifice": "laminar-turbulent",
}


def _kind(law: Any, known: Collection[str]) -> str:
    kind = type(law).__name__
    if kind not in known:
        raise NotImplementedError(f"the independent solver has no law {kind!r}")
    return kind


def _window(plate: Any, port: Any) -> Window:
    shape = plate.window
    kind = SHAPES[_kind(shape, SHAPES)]
    width = number(port.width)
    window = Window(width, number(port.centre) + number(plate.shift), kind)
    if kind == "table":
        knots = np.asarray(shape.position, float) * width / 2
        shares = np.asarray(shape.opening_share, float)
        window = replace(window, table=(tuple(knots.tolist()), tuple(shares.tolist())))
    else:
        window = replace(window, ramp=number(shape.ramp))
    notch = getattr(plate, "notch", None)
    if notch is None:
        return window
    return replace(window, notch_angle=number(notch.angle), notch_area=number(notch.area))


def _manifold(manifold: Any) -> Manifold | None:
    if manifold is None:
        return None
    return Manifold(number(manifold.volume), number(manifold.line_conductance))


def _from_behind(machine: Machine) -> Machine:
    """A machine that turns backwards with its ports exchanged, seen from its other end.

    Worked out here once more, in plain numbers: nothing of `camring.physics.mirror`.
    """
    places = -np.arange(len(machine.control)) % len(machine.control)
    control = machine.control[places]
    if np.iscomplexobj(control):
        # Below the line of angle 0 the last points of the period before come first.
        before = np.where(places > 0, np.exp(-1j * machine.period), 1)
        control = np.conj(control * before)

    def behind(window: Window) -> Window:
        if window.notch_area:
            raise OrbitError("a relief notch at the closing edge is no part of this solver")
        places, shares = window.table
        table = (tuple(-each for each in reversed(places)), tuple(reversed(shares)))
        return replace(window, centre=-window.centre, table=table)

    return replace(
        machine,
        control=control,
        supply=behind(machine.return_),
        return_=behind(machine.supply),
    )


def machine_of(motor: Any, fluid: Any, point: Any) -> Machine:
    """Read the nouns of `camring.physics` into plain numbers."""
    cam, plate = motor.cam, motor.valve_plate
    _kind(motor.leakage, ["ConstantLeakage"])
    _kind(motor.friction, ["ViscousFriction"])
    orifice = ORIFICES[_kind(motor.orifice, ORIFICES)]
    if hasattr(cam, "control_points"):
        points = np.asarray(cam.control_points, dtype=float)
        control = points[:, 0] + 1j * points[:, 1]
    else:
        control = np.asarray(cam.control_radii, dtype=float)
    given = number(getattr(motor, "given_reference_radius", nan))
    machine = Machine(
        pistons=motor.pistons,
        lobes=motor.lobes,
        bore=number(motor.piston.bore),
        piston_mass=number(motor.piston.mass),
        viscous_damping=number(motor.friction.damping),
        dead_volume=number(motor.dead_volume),
        leakage_coefficient=number(motor.leakage.coefficient),
        control=control,
        repeats=cam.repeats,
        degree=cam.degree,
        reference_radius=given if motor.reference == "given" else motor.reference,
        ring_modulus=number(motor.ring_material.elastic_modulus),
        ring_poisson=number(motor.ring_material.poisson_ratio),
        roller_radius=number(motor.roller.radius),
        roller_length=number(motor.roller.length),
        roller_modulus=number(motor.roller.material.elastic_modulus),
        roller_poisson=number(motor.roller.material.poisson_ratio),
        port_area=number(plate.port_area),
        discharge_coefficient=number(motor.orifice.discharge_coefficient),
        supply=_window(plate, plate.supply),
        return_=_window(plate, plate.return_),
        oil=_oil(fluid),
        shaft_speed=number(point.shaft_speed),
        supply_pressure=number(point.supply_pressure),
        return_pressure=number(point.return_pressure),
        case_pressure=number(point.case_pressure),
        orifice=orifice,
        critical_flow_number=number(getattr(motor.orifice, "critical_flow_number", 1000.0)),
        roller_friction=number(getattr(motor.friction, "roller", 0.0)),
        side_friction=number(getattr(motor.friction, "side", 0.0)),
        manifold=_manifold(getattr(motor, "manifold", None)),
    )
    if getattr(point, "reverse", False) != getattr(motor, "from_behind", False):
        machine = _from_behind(machine)
    gap = getattr(motor, "gap", None)
    if gap is None:
        return machine
    return machine.with_gap(number(gap.clearance), number(gap.length), number(gap.eccentricity))
