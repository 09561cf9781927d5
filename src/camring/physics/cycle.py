"""One motor at one operating point, over one period of its cam.

Every chamber runs through the same orbit, so one reference piston gives all
(docs/theory.md section 1); with manifolds they also meet in the pressure at their
windows. `periodic_cycle` finds its periodic pressure with the oil in the films as warm as the
motor says; `heat/simulation.py` finds out how warm that is, and `piston_state.py` and
`waveforms.py` read the rest off the result.
"""

from math import pi
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.extremes import extreme_radius
from camring.numerics.coupled.orbits import CoupledOrbit
from camring.numerics.equation import Equation
from camring.numerics.mesh import ElementCount
from camring.numerics.periodic import Orbit, PeriodicResolution, settle, solve_periodic
from camring.numerics.quantity import Q
from camring.numerics.radau import STAGE_INTEGRALS, STAGES
from camring.numerics.verdict import Verdict, verdict
from camring.physics.chamber import Chamber, chamber_alone, chamber_between
from camring.physics.manifold.coupling import (
    expected_pressures,
    settle_with_manifolds,
    solve_with_manifolds,
)
from camring.physics.manifold.sides import SIDES, at_windows, sides_of
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import exchange_rate, kinks, state_rate
from camring.physics.resolution import Resolution
from camring.physics.rotation import turned

CONVERGED_RESIDUAL = 1e-7
SHUT = 1e-3  # share of a port's area below which a first guess takes it for closed
UNIQUE_MARGIN = 1e-9  # of the oil in a chamber, renewed in a period


class Cycle(eqx.Module):
    """The periodic solution with the system it belongs to.

    Examples
    --------
    >>> [cycle] = camring.simulate("motor.toml")
    >>> int(cycle.verdict.code), float(cycle.periodicity_residual) < 1e-9
    (0, True)
    """

    motor: Motor
    """As it is turned: seen from behind at an operating point that turns backwards."""
    fluid: AbstractFluid
    point: OperatingPoint
    reference_radius: Q[Float[Array, ""], "m"]
    orbit: Orbit
    manifold: Orbit | None
    """State of the oil before the supply windows, on the same mesh; None without a manifold."""
    verdict: Verdict
    lowest_radius: Q[Float[Array, ""], "m"] | None = None
    """Of the pitch curve; None where no return spring asks for it."""
    return_manifold: Orbit | None = None
    """State of the oil behind the return windows, as that before the supply's."""

    @property
    def manifolds(self) -> tuple[Orbit, ...]:
        """Those that there are, in the order of `manifold.sides.sides_of`."""
        return tuple(side.of(self) for side in sides_of(self))

    @property
    def periodicity_residual(self) -> Q[Float[Array, ""], "1"]:
        """Largest violation of equation or periodicity over the range of the orbit."""
        return self.orbit.residual

    def __repr__(self) -> str:
        code = self.verdict.code
        if isinstance(code, jax.core.Tracer) or jnp.ndim(code):
            return f"Cycle (of a batch or traced, {jnp.shape(code)})"
        motor, point = self.motor, self.point
        parts = [
            f"{motor.name or 'Cycle'}: {motor.pistons} pistons, {motor.lobes} lobes",
            f"{float(point.shaft_speed) * 30 / pi:.5g} rpm{', reverse' * point.reverse}, "
            f"supply {float(point.supply_pressure) / 1e5:.5g} bar, "
            f"return {float(point.return_pressure) / 1e5:.5g} bar",
            self.verdict.explain() or "sound",
        ]
        return "; ".join(parts)


def reference_radius(motor: Motor) -> Q[Float[Array, ""], "m"]:
    """The radius that lift is counted from. docs/theory.md section 2."""
    if motor.reference == "given":
        return motor.given_reference_radius
    if motor.reference == "mean":
        return motor.cam.mean_radius()
    return extreme_radius(motor.cam, -1)


def rate_in_state(parameters: tuple[Any, ...], chamber: Chamber, state: Array) -> Array:
    motor, fluid, point, _ = parameters
    return state_rate(motor, fluid, point, chamber, state)


def quasi_steady(parameters: tuple[Any, ...], chamber: Chamber) -> Array:
    """State of a chamber that stands still: a mean of the ports' pressures by their openings."""
    motor, fluid, point, _ = parameters
    supply, back = chamber.supply_area, chamber.return_area
    back = back if chamber.idle_area is None else back + chamber.idle_area
    closed = SHUT * motor.valve_plate.port_area
    middle = (point.supply_pressure + point.return_pressure) / 2
    total = supply * point.supply_pressure + back * point.return_pressure + closed * middle
    return fluid.state(total / (supply + back + closed))


def _exchange(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
    orbit: Orbit,
) -> Float[Array, ""]:
    """How often in a period the flows renew a chamber's oil; without any, any amount is right."""
    between_ports = (point.supply_pressure + point.return_pressure) / 2
    found = fluid.pressure(orbit.stage_state)
    pressure = jnp.where(jnp.isfinite(found), found, between_ports)
    start, width = orbit.mesh.start, orbit.mesh.width
    _, chamber = chamber_between(motor, reference, start, width, jnp.asarray(STAGES))
    rate = exchange_rate(motor, fluid, point, chamber, pressure)
    return jnp.asarray(STAGE_INTEGRALS[-1]) @ rate @ width


def periodic_cycle(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: Resolution | None = None,
    filled: Float[Array, ""] | None = None,
) -> Cycle:
    """The periodic cycle of a motor at an operating point, see `heat.simulation.simulate`."""
    resolution = resolution or Resolution()
    motor = turned(motor, point)
    reference = reference_radius(motor)
    breakpoints = motor.breakpoints()
    sizes = meshed(motor, resolution)
    elements = _elements(motor, sizes, resolution.filled if filled is None else filled)

    def orbit_at(held: OperatingPoint, refinements: int) -> Orbit:
        """With both port pressures constant."""
        return solve_periodic(
            _equation(motor, fluid, held, reference),
            breakpoints,
            motor.cam.period,
            PeriodicResolution(elements, refinements),
        )

    if not sides_of(motor):
        return _assessed(motor, fluid, point, reference, orbit_at(point, resolution.refinements))
    held = expected_pressures(motor, point)
    # The last mesh is laid from the motor with its manifolds.
    alone = orbit_at(at_windows(motor, point, held), resolution.refinements - 1)
    coupled = solve_with_manifolds(
        motor, fluid, point, reference, alone, held, breakpoints, elements
    )
    return _assessed(motor, fluid, point, reference, *coupled)


def meshed(motor: Motor, resolution: Resolution) -> Resolution:
    """What a motor is solved with where a resolution is asked for."""
    return resolution.behind_manifolds() if sides_of(motor) else resolution


def nearby_cycle(cycle: Cycle, motor: Motor, fluid: AbstractFluid, point: OperatingPoint) -> Cycle:
    """The cycle of a motor very near to that of a cycle, see `heat.simulation.neighbour`."""
    motor = turned(motor, point)
    reference, breakpoints = reference_radius(motor), motor.breakpoints()
    if not cycle.manifolds:
        orbit = settle(
            _equation(motor, fluid, point, reference),
            breakpoints,
            motor.cam.period,
            cycle.orbit.mesh,
            cycle.orbit.stage_state,
            cycle.orbit.iterations,
        )
        return _assessed(motor, fluid, point, reference, orbit)
    known = CoupledOrbit(cycle.orbit, cycle.manifolds)
    coupled = settle_with_manifolds(motor, fluid, point, reference, known, breakpoints)
    return _assessed(motor, fluid, point, reference, *coupled)


def _elements(
    motor: Motor, resolution: Resolution, filled: float | Float[Array, ""]
) -> ElementCount:
    """Of one cam period, those that breakpoints take for themselves included."""
    pitches, promised = motor.lobes // motor.cam.repeats, motor.promised_elements()
    used = jnp.round(filled * resolution.elements).astype(int)
    return ElementCount(resolution.elements * pitches + promised, used * pitches + promised)


def _equation(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
) -> Equation:
    """Of a chamber between ports of constant pressure."""
    return Equation(
        (motor, fluid, point, reference),
        rate_in_state,
        chamber_alone,
        quasi_steady,
        kinks(motor, fluid, point.supply_pressure, point.return_pressure),
    )


def _assessed(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, ""], "m"],
    orbit: Orbit,
    manifolds: tuple[Orbit, ...] = (),
) -> Cycle:
    seen = at_windows(motor, point, [fluid.pressure(each.stage_state) for each in manifolds])
    lowest = extreme_radius(motor.cam, -1)
    least_volume = motor.dead_volume + motor.piston.area * (lowest - reference)
    unique = _exchange(motor, fluid, seen, reference, orbit) > UNIQUE_MARGIN
    outcome = verdict(
        chamber_volume_not_positive=~(least_volume > 0),
        orbit_not_unique=~unique,
        not_converged=unique & ~(orbit.residual < CONVERGED_RESIDUAL),
    )
    sprung = None if motor.piston.spring is None else lowest
    solved = dict(zip(sides_of(motor), manifolds, strict=True))
    found = {side.manifold: solved.get(side) for side in SIDES}
    return Cycle(
        motor,
        fluid,
        point,
        reference,
        orbit,
        verdict=outcome,
        lowest_radius=sprung,
        **found,
    )
