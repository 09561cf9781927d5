"""The heat that stays in a motor, and what carries it off.

Film and contact friction and the pressure that leaking oil loses on its way into the case
stay; throttling, and what passes the valve plate from port to port, leave with the oil of
the return. The steady rise `t` of case and films above the oil that comes in closes

    heat = mass flow of the drain * specific heat * t + heat transfer * (inlet + t - ambient)

docs/theory.md section 14.
"""

from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from camring.numerics.quantity import Q
from camring.numerics.selection import larger
from camring.numerics.verdict import Fault
from camring.physics.cycle import Cycle
from camring.physics.motor import Motor
from camring.physics.piston_state import QuadratureSamples

FROZEN_STEPS = 2
"""Newton steps on the rise while the chamber's pressure stays."""
CLOSED = 1e-5  # K, and share of the rise, to which the balance of heat must close

Sampled = Callable[[Cycle], QuadratureSamples]


class HeatFlows(NamedTuple):
    """Of the whole motor."""

    heat: Q[Float[Array, "*batch"], "W"]
    """That stays in it."""
    drain: Q[Float[Array, "*batch"], "kg/s"]
    """Out of its case."""


def heat_flows(
    cycle: Cycle, samples: QuadratureSamples, drop: Float[Array, "*grid"] | None = None
) -> HeatFlows:
    """Heat that stays in a motor, and the oil that takes it along.

    `drop` is `leakage_drop` where it is at hand.
    """
    motor, fluid, point, piston = cycle.motor, cycle.fluid, cycle.point, samples.piston
    in_case, speed = fluid.potential(point.case_pressure), point.shaft_speed
    damping = motor.viscous_damping(fluid)
    falling = piston.leakage_flow * (leakage_drop(cycle, samples) if drop is None else drop)
    rubbing = damping * (speed * piston.radius.first) ** 2 + speed * piston.friction_torque
    heat = motor.pistons * samples.mean(falling + rubbing)
    drained = motor.pistons * samples.mean(piston.leakage_flow)
    plate = motor.plate_flows(fluid, point)
    if plate is not None:
        at_supply, at_return = (
            fluid.potential(each) for each in (point.supply_pressure, point.return_pressure)
        )
        heat = heat + plate.supply_to_case * (at_supply - in_case)
        heat = heat + plate.return_to_case * (at_return - in_case)
        drained = drained + plate.supply_to_case + plate.return_to_case
    return HeatFlows(heat, drained * mass_of_amount(cycle))


def leakage_drop(cycle: Cycle, samples: QuadratureSamples) -> Float[Array, "*grid"]:
    """Potential that oil loses on its way from the chamber into the case."""
    fluid = cycle.fluid
    in_case = fluid.potential(cycle.point.case_pressure)
    return fluid.potential(samples.piston.chamber_pressure) - in_case


def mass_of_amount(cycle: Cycle) -> Float[Array, "*batch"]:
    """Kilograms of a unit amount of the oil."""
    fluid, case = cycle.fluid, cycle.point.case_pressure
    return fluid.density_at(case) / fluid.content(case)


def balanced_rise(cycle: Cycle, flows: HeatFlows) -> Q[Float[Array, "*batch"], "K"]:
    """The rise at which these flows would balance.

    Oil that a pressure presses into the case from outside carries nothing off.
    """
    thermal, line = cycle.motor.thermal, cycle.fluid.line
    assert thermal is not None
    assert line is not None
    from_outside = thermal.heat_transfer * (thermal.ambient_temperature - line.temperature)
    carried = thermal.specific_heat * larger(flows.drain, 0) + thermal.heat_transfer
    return (flows.heat + from_outside) / carried


def with_rise(motor: Motor, rise: Q[Float[Array, "*batch"], "K"]) -> Motor:
    """A motor with another rise."""
    return eqx.tree_at(lambda each: each.thermal.rise, motor, rise)


def warmed(cycle: Cycle, rise: Q[Float[Array, "*batch"], "K"]) -> Cycle:
    """A cycle with another rise, and the pressure that it has."""
    return eqx.tree_at(lambda each: each.motor, cycle, with_rise(cycle.motor, rise))


def rise_of(cycle: Cycle) -> Q[Float[Array, "*batch"], "K"]:
    """The rise that a cycle has been solved with."""
    thermal = cycle.motor.thermal
    assert thermal is not None
    return thermal.rise


def missed(
    cycle: Cycle, sampled: Sampled, drop: Float[Array, "*grid"] | None = None
) -> Q[Float[Array, "*batch"], "K"]:
    """By how much a cycle's rise is above that at which its own flows would balance.

    It rises with the rise itself: warmer oil is thinner, rubs less and leaks more. Newton on it
    is safe where one on the heat is not, because both sides of that grow with the leakage.
    """
    return rise_of(cycle) - balanced_rise(cycle, heat_flows(cycle, sampled(cycle), drop))


def missed_and_slope(
    cycle: Cycle, sampled: Sampled, drop: Float[Array, "*grid"]
) -> tuple[Q[Float[Array, "*batch"], "K"], Q[Float[Array, "*batch"], "1"]]:
    """The same, and its derivative by the rise while the pressure stays, and so `leakage_drop`."""
    rise = rise_of(cycle)
    return jax.jvp(
        lambda at: missed(warmed(cycle, at), sampled, drop), (rise,), (jnp.ones_like(rise),)
    )


def settled_rise(cycle: Cycle, sampled: Sampled) -> Q[Float[Array, "*batch"], "K"]:
    """The rise that balances the flows of a cycle while its pressure stays: it hardly knows."""
    # What the oil loses takes the longest to work out, and stays with the pressure.
    drop = leakage_drop(cycle, sampled(cycle))

    # A loop of this kind is one that the machine code of a batch knows, too.
    def improved(current: tuple[Array, Array]) -> tuple[Array, Array]:
        rise, count = current
        value, slope = missed_and_slope(warmed(cycle, rise), sampled, drop)
        return rise - value / slope, count + 1

    start = rise_of(cycle), jnp.asarray(0)
    return jax.lax.while_loop(lambda now: now[1] < FROZEN_STEPS, improved, start)[0]


def closes(
    rise: Q[Float[Array, "*batch"], "K"],
    left: Q[Float[Array, "*batch"], "K"],
    share: float = CLOSED,
) -> Bool[Array, "*batch"]:
    """Whether a balance leaves over less than a share; never where it is no number."""
    return jnp.abs(left) < share * (1 + jnp.abs(rise))


def with_verdict(cycle: Cycle, left: Q[Float[Array, "*batch"], "K"]) -> Cycle:
    """The cycle, not converged where a balance leaves over more than little, or no number."""
    code = cycle.verdict.code
    failed = jnp.where(closes(rise_of(cycle), left), code, code | int(Fault.NOT_CONVERGED))
    return eqx.tree_at(lambda each: each.verdict.code, cycle, failed)
