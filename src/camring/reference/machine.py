"""The numbers of one motor at one operating point, as plain floats.

The second solver of every result starts here: after this file nothing of JAX and
none of the program's own physics is used, so that a fault there cannot hide by
being made twice.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from math import nan, pi
from typing import Any, Literal

import numpy as np

from camring.reference.cooling import Cooling, cooling_of, films_of
from camring.reference.failure import NoSecondSolver, OrbitError
from camring.reference.parts import Manifolds, Oil, Window, manifolds_of
from camring.reference.plate import Plate, plate_of
from camring.reference.stribeck import stribeck
from camring.reference.user_laws import (
    FRICTIONS,
    LEAKAGES,
    Friction,
    Leakage,
    Rubbing,
)


@dataclass(frozen=True)
class Machine:
    """One motor, oil and operating point: what sections 2 to 6 and 13 of docs/theory.md ask for."""

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
    spring_rate: float = 0.0
    spring_preload: float = 0.0
    manifolds: Manifolds = field(default_factory=Manifolds)
    user_leakage: Leakage | None = None
    user_friction: Friction | None = None
    plate: Plate | None = None
    idle_lobes: frozenset[int] = frozenset()
    cooling: Cooling | None = None
    churning: float = 0.0  # torque over density and half the speed's square
    notes: tuple[str, ...] = field(default=())

    def idles(self, window: Window, angle: float) -> bool:
        """Whether the supply window nearest to an angle is one that a mode leads to the return."""
        if not self.idle_lobes or window is not self.supply:
            return False
        return (
            round((angle - window.centre) * self.lobes / (2 * pi)) % self.lobes in self.idle_lobes
        )

    def port_of(self, window: Window) -> float:
        """Area of one fully open port of a kind, m2."""
        return self.port_area if window.area is None else window.area

    @property
    def piston_area(self) -> float:
        return pi * self.bore**2 / 4

    @property
    def film_viscosity(self) -> float:
        """Dynamic, of the oil in films and leakage paths."""
        thinner = 1.0 if self.cooling is None else self.cooling.thinner()
        return self.oil.density * self.oil.viscosity * thinner

    @property
    def period(self) -> float:
        return 2 * pi / self.repeats

    def leakage(self, pressure: float, case: float) -> float:
        """Volume flow past one piston, out of its chamber."""
        linear = self.leakage_coefficient * (pressure - case)
        return linear if self.user_leakage is None else linear + self.user_leakage(pressure, case)

    @property
    def rubs(self) -> bool:
        """Whether torque is lost in contacts, which bends where their load turns."""
        own = self.user_friction is not None
        return own or bool(self.roller_friction or self.side_friction)

    def contact_loss(self, at: Rubbing) -> np.ndarray:
        """Torque that one piston loses in its contacts."""
        lost = self.roller_friction * np.maximum(at.normal_force, 0) * at.ring_length
        lost = lost + self.side_friction * at.side_force * np.abs(at.slope)
        dragged = self.churning * self.oil.density * at.shaft_speed**2 / 2
        lost = lost + dragged / self.pistons
        return lost if self.user_friction is None else lost + self.user_friction.loss_torque(at)

    def with_gap(self, clearance: float, length: float, eccentricity: float) -> "Machine":
        """Leakage and damping of the piston's gap added to the coefficients (section 13)."""
        viscosity = self.film_viscosity
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
        raise NoSecondSolver(fluid)
    names = Oil.__dataclass_fields__.keys() - {"law"}
    given = {name: getattr(fluid, name, None) for name in names}
    numbers = {name: number(value) for name, value in given.items() if value is not None}
    return Oil(**numbers, law="aerated" if kind == "AeratedFluid" else "constant")


SHAPES: dict[str, Literal["linear", "round", "table"]] = {
    "LinearWindow": "linear",
    "RoundWindow": "round",
    "TabulatedWindow": "table",
}
ORIFICES: dict[str, Literal["turbulent", "laminar-turbulent"]] = {
    "TurbulentOrifice": "turbulent",
    "LaminarTurbulentOrifice": "laminar-turbulent",
}

LEAKAGE = ("ConstantLeakage", "ViscousLeakage")
FRICTION = ("ViscousFriction", "StribeckFriction")


def _kind(law: Any, known: Collection[str]) -> str:
    kind = type(law).__name__
    if kind not in known:
        raise NoSecondSolver(law)
    return kind


def _anew(written: Mapping[type | str, Any], law: Any) -> Any:
    return written.get(type(law)) or written.get(type(law).__name__)


def _user_laws(motor: Any, fluid: Any) -> tuple[Leakage | None, Friction | None]:
    """What users have written anew of the motor's laws; None for those known here."""
    leakage = _anew(LEAKAGES, motor.leakage)
    friction = _anew(FRICTIONS, motor.friction)
    if leakage is None:
        _kind(motor.leakage, LEAKAGE)
    rubbing = friction and friction(motor.friction, motor, fluid)
    if friction is None and _kind(motor.friction, FRICTION) == "StribeckFriction":
        rubbing = stribeck(motor.friction)
    return leakage and leakage(motor.leakage, motor, fluid), rubbing


def _own(port: Any, name: str) -> float | None:
    given = getattr(port, name, None)
    return None if given is None else number(given)


def _window(plate: Any, port: Any) -> Window:
    shape = plate.window
    kind = SHAPES[_kind(shape, SHAPES)]
    width = number(port.width)
    centre = number(port.centre) + number(plate.shift)
    area, coefficient = _own(port, "area"), _own(port, "discharge_coefficient")
    window = Window(width, centre, kind, area=area, discharge_coefficient=coefficient)
    if kind == "table":
        knots = np.asarray(shape.position, float) * width / 2
        shares = np.asarray(shape.opening_share, float)
        window = replace(window, table=(tuple(knots.tolist()), tuple(shares.tolist())))
    else:
        ramp = _own(port, "ramp")
        window = replace(window, ramp=number(shape.ramp) if ramp is None else ramp)
    notch = getattr(port, "notch", None) or getattr(plate, "notch", None)
    if notch is None:
        return window
    return replace(window, notch_angle=number(notch.angle), notch_area=number(notch.area))


def _leakage_coefficient(leakage: Any, fluid: Any) -> float:
    """With this oil; a bare one holds for every oil."""
    if not hasattr(leakage, "reference_viscosity"):
        return number(leakage.coefficient)
    thinner = number(leakage.reference_viscosity) / number(fluid.viscosity)
    return number(leakage.coefficient) * thinner


def _churning(churning: Any) -> float:
    if churning is None:
        return 0.0
    return number(churning.moment_coefficient) * number(churning.radius) ** 5


def _spring(piston: Any) -> dict[str, Any]:
    spring = getattr(piston, "spring", None)
    if spring is None:
        return {}
    return {"spring_rate": number(spring.rate), "spring_preload": number(spring.preload)}


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
        idle_lobes=frozenset(-lobe % machine.lobes for lobe in machine.idle_lobes),
    )


def _in_mode(machine: Machine, idle: Collection[int]) -> Machine:
    """With some lobes idle, all round the ring: the shorter period of a pattern is not used."""
    if not idle:
        return machine
    control, copies = machine.control, machine.repeats
    if np.iscomplexobj(control):
        turns = np.exp(2j * pi * np.arange(copies) / copies)
        around = (turns[:, None] * control).ravel()
    else:
        around = np.tile(control, copies)
    return replace(machine, control=around, repeats=1, idle_lobes=frozenset(idle))


def machine_of(motor: Any, fluid: Any, point: Any, rise: float = 0.0) -> Machine:
    """Read the nouns of `camring.physics` into plain numbers.

    Parameters
    ----------
    rise
        Of the oil in films and case above the oil that comes in, where it has a heat balance.

    Raises
    ------
    NoSecondSolver
        For a law that is neither known here nor in `user_laws`.
    """
    cam, plate = motor.cam, motor.valve_plate
    cooling = cooling_of(motor, fluid)
    cooling = None if cooling is None else replace(cooling, rise=rise)
    films = films_of(fluid, cooling)
    leakage, friction = _user_laws(motor, films)
    orifice = ORIFICES[_kind(motor.orifice, ORIFICES)]
    if hasattr(cam, "control_points"):
        points = np.asarray(cam.control_points, dtype=float)
        control = points[:, 0] + 1j * points[:, 1]
    elif hasattr(cam, "control_radii"):
        control = np.asarray(cam.control_radii, dtype=float)
    else:
        raise NoSecondSolver(cam)
    given = number(getattr(motor, "given_reference_radius", nan))
    machine = Machine(
        pistons=motor.pistons,
        lobes=motor.lobes,
        bore=number(motor.piston.bore),
        piston_mass=number(motor.piston.mass),
        viscous_damping=friction.damping if friction else number(motor.friction.damping),
        dead_volume=number(motor.dead_volume),
        leakage_coefficient=0.0 if leakage else _leakage_coefficient(motor.leakage, films),
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
        roller_friction=0.0 if friction else number(getattr(motor.friction, "roller", 0.0)),
        side_friction=0.0 if friction else number(getattr(motor.friction, "side", 0.0)),
        **_spring(motor.piston),
        manifolds=manifolds_of(motor),
        user_leakage=leakage,
        user_friction=friction,
        plate=plate_of(motor, point),
        cooling=cooling,
        churning=_churning(getattr(motor, "churning", None)),
    )
    own = getattr(plate, "idle_lobes", ())
    if own:  # the period of its pattern is in the cam already
        machine = replace(machine, idle_lobes=frozenset(own))
    else:
        machine = _in_mode(machine, getattr(point, "idle_lobes", ()))
    if getattr(point, "reverse", False) != getattr(motor, "from_behind", False):
        machine = _from_behind(machine)
    gap = getattr(motor, "gap", None)
    if gap is None:
        return machine
    return machine.with_gap(number(gap.clearance), number(gap.length), number(gap.eccentricity))
