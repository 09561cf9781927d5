"""Many motors side by side: pressure, and how warm films and cases become.

The same as `simulation.py`, with a batch along the last axis.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.numerics.once import computed_once
from camring.numerics.quantity import Q
from camring.physics.batch_cycle import (
    BatchCycle,
    BatchResolution,
    carried_over,
    nearby_cycles,
    periodic_cycles,
    settled,
)
from camring.physics.cycle import Cycle
from camring.physics.heat.balance import missed, rise_of, settled_rise, with_rise, with_verdict
from camring.physics.heat.collocation import at_collocation_points
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

PASSES = 3
"""Times rise and pressure are brought up to date in turn."""


def simulate_batch(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: BatchResolution,
    filled: Float[Array, " batch"] | None = None,
) -> BatchCycle:
    """The periodic cycles of many motors at once; faults are in `cycle.verdict`.

    Parameters
    ----------
    motor, fluid, point
        Leaves (member,), control radii (control, member).
    filled
        Share of its elements that each motor's lobe pitch is divided into, all unless given:
        one program for several resolutions.
    """
    found = periodic_cycles(motor, fluid, point, resolution, filled)
    if motor.thermal is None:
        return found
    for _ in range(PASSES):
        found = computed_once(_warmed(found, _settled_rise(found)))
    return found._replace(cycle=with_verdict(found.cycle, _missed(found)))


def neighbour_batch(
    known: Cycle,
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: BatchResolution,
) -> BatchCycle:
    """Cycles of motors very near to those of cycles at hand; see `simulation.neighbour`."""
    if motor.thermal is None:
        return nearby_cycles(known, motor, fluid, point, resolution)
    carried = carried_over(known, motor, fluid, point, resolution)
    at = stop_gradient(rise_of(known))
    frozen = jax.tree.map(stop_gradient, carried)
    _, slope = jax.jvp(lambda rise: _missed(_warmed(frozen, rise)), (at,), (jnp.ones_like(at),))
    over = _missed(_warmed(carried, at))
    return _warmed(carried, at - over / stop_gradient(slope))


def _warmed(found: BatchCycle, rise: Q[Float[Array, " batch"], "K"]) -> BatchCycle:
    """With another rise, and the pressures that go with it."""
    motor = with_rise(found.cycle.motor, rise)
    return settled(_of(found, replace(found.cycle, motor=motor)))


def _settled_rise(found: BatchCycle) -> Q[Float[Array, " batch"], "K"]:
    return settled_rise(found.cycle, lambda cycle: at_collocation_points(_of(found, cycle)))


def _of(found: BatchCycle, cycle: Cycle) -> BatchCycle:
    return found._replace(cycle=cycle)


def _missed(found: BatchCycle) -> Q[Float[Array, " batch"], "K"]:
    return missed(found.cycle, lambda cycle: at_collocation_points(_of(found, cycle)))
