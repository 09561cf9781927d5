"""One motor at one operating point, over one period of its cam.

With constant port pressures every chamber runs through the same orbit, so one
reference piston gives all (model.md section 1). `simulate` finds its periodic
pressure; `piston_state.py` and `waveforms.py` read the rest off the result.
"""

import equinox as eqx
from jaxtyping import Array, Float

from camring.geometry.extremes import extreme_radius
from camring.numerics.equation import Equation
from camring.numerics.periodic import Orbit, PeriodicResolution, solve_periodic
from camring.numerics.quantity import Q
from camring.numerics.spline import Jet
from camring.numerics.verdict import Verdict, verdict
from camring.physics.fluid import AbstractFluid
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import Chamber, pressure_slope
from camring.physics.resolution import Resolution

CONVERGED_RESIDUAL = 1e-7
UNIQUE_MARGIN = 1e-9


class Cycle(eqx.Module):
    """The periodic solution with the system it belongs to."""

    motor: Motor
    fluid: AbstractFluid
    point: OperatingPoint
    reference_radius: Q[Float[Array, ""], "m"]
    orbit: Orbit
    verdict: Verdict

    @property
    def periodicity_residual(self) -> Q[Float[Array, ""], "1"]:
        """Largest violation of equation or periodicity over the range of the orbit."""
        return self.orbit.residual


def reference_radius(motor: Motor) -> Q[Float[Array, ""], "m"]:
    """The radius that lift is counted from. model.md section 2."""
    if motor.reference == "given":
        return motor.given_reference_radius
    if motor.reference == "mean":
        return motor.cam.mean_radius()
    return extreme_radius(motor.cam, -1)


def chamber_between(
    motor: Motor,
    reference: Q[Float[Array, ""], "m"],
    start: Q[Float[Array, " element"], "rad"],
    width: Q[Float[Array, " element"], "rad"],
    fraction: Float[Array, " point"],
) -> tuple[Jet, Chamber]:
    """Cam and chamber at fractions of elements that no breakpoint divides."""
    angle = start + fraction[:, None] * width
    radius = motor.cam.pitch_radius_between(start, width, fraction)
    return radius, chamber_at(motor, reference, angle, radius)


def chamber_at(
    motor: Motor,
    reference: Q[Float[Array, ""], "m"],
    angle: Q[Float[Array, "*grid"], "rad"],
    radius: Jet,
) -> Chamber:
    """Openings and volume of the chamber whose piston stands at each angle."""
    plate, area = motor.valve_plate, motor.piston.area
    return Chamber(
        plate.port_area * plate.opening(plate.supply, angle),
        plate.port_area * plate.opening(plate.return_, angle),
        motor.dead_volume + area * (radius.value - reference),
        area * radius.first,
    )


def _state_rate(parameters: tuple, chamber: Chamber, state: Array) -> Array:
    motor, fluid, point, _ = parameters
    pressure = fluid.pressure(state)
    slope = pressure_slope(motor, fluid, point, chamber, pressure)
    return fluid.state_slope(pressure) * slope


def _forcing(parameters: tuple, start: Array, width: Array, fraction: Array) -> Chamber:
    motor, _, _, reference = parameters
    return chamber_between(motor, reference, start, width, fraction)[1]


def _kinks(motor: Motor, fluid: AbstractFluid, point: OperatingPoint) -> tuple[Array, ...]:
    """States at which a law bends: the fluid's own, and the ports' where the orifice does."""
    ports = (point.supply_pressure, point.return_pressure) if motor.orifice.bends_at_zero else ()
    return tuple(fluid.state(pressure) for pressure in (*fluid.kinks(), *ports))


def simulate(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: Resolution | None = None,
) -> Cycle:
    """The periodic cycle of a motor at an operating point.

    Traceable, differentiable, and batched with `vmap`. Faults are in
    `cycle.verdict`; nothing is raised.
    """
    resolution = resolution or Resolution()
    reference = reference_radius(motor)
    breakpoints = motor.breakpoints()
    pitches = motor.lobes // motor.cam.repeats
    elements = resolution.elements * pitches + motor.promised_elements()
    guess = fluid.state((point.supply_pressure + point.return_pressure) / 2)
    orbit = solve_periodic(
        Equation(
            (motor, fluid, point, reference),
            _state_rate,
            _forcing,
            _kinks(motor, fluid, point),
        ),
        breakpoints,
        motor.cam.period,
        guess,
        PeriodicResolution(elements, resolution.refinements),
    )
    least_volume = motor.dead_volume + motor.piston.area * (
        extreme_radius(motor.cam, -1) - reference
    )
    unique = orbit.multiplier < 1 - UNIQUE_MARGIN
    outcome = verdict(
        chamber_volume_not_positive=~(least_volume > 0),
        orbit_not_unique=~unique,
        not_converged=unique & ~(orbit.residual < CONVERGED_RESIDUAL),
    )
    return Cycle(motor, fluid, point, reference, orbit, outcome)
