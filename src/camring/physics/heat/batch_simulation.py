"""Many motors side by side: pressure, and how warm films and cases become.

The same as `simulation.py`, with a batch along the last axis.
"""

from dataclasses import replace
from typing import Any

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
    guessed_cycles,
    nearby_cycles,
    periodic_cycles,
    settled,
    stepped,
)
from camring.physics.cycle import Cycle
from camring.physics.heat.balance import (
    Sampled,
    closes,
    leakage_drop,
    missed,
    missed_and_slope,
    rise_of,
    settled_rise,
    with_rise,
    with_verdict,
)
from camring.physics.heat.collocation import at_collocation_points
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

MOST_PASSES = 12
"""Times at most that rise and pressure are brought up to date in turn; two or three are usual."""


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
    if motor.thermal is None:
        return periodic_cycles(motor, fluid, point, resolution, filled)
    guessed = guessed_cycles(motor, fluid, point, resolution)
    rise = computed_once(settled_rise(guessed.cycle, _sampled(guessed)))
    found = periodic_cycles(with_rise(motor, rise), fluid, point, resolution, filled)
    return _balanced(found)


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


def _balanced(found: BatchCycle) -> BatchCycle:
    """Cycles with the rise that closes their balance, and the pressures that go with it.

    In turn a Newton step on the rise while the pressure stays, and one on the pressure, until
    every member's balance closes; each stops by itself. One more of both follows.
    """

    def at(rise: Array, stages: list[Array]) -> BatchCycle:
        orbit = replace(found.cycle.orbit, stage_state=jnp.stack(stages))
        cycle = replace(found.cycle, motor=with_rise(found.cycle.motor, rise), orbit=orbit)
        return _of(found, cycle)

    def open_by(rise: Array, stages: list[Array]) -> tuple[Array, Array]:
        here = at(rise, stages)
        sampled = _sampled(here)
        return missed_and_slope(here.cycle, sampled, leakage_drop(here.cycle, sampled(here.cycle)))

    def unsettled(rise: Array, over: Array) -> Array:
        return ~closes(rise, over) & ~jnp.isnan(over)

    def unfinished(carry: tuple[Any, ...]) -> Array:
        rise, _, over, _, count = carry
        return jnp.any(unsettled(rise, over)) & (count < MOST_PASSES)

    def improved(carry: tuple[Any, ...]) -> tuple[Any, ...]:
        rise, stages, over, slope, count = carry
        going = unsettled(rise, over)
        rise = jnp.where(going, rise - over / slope, rise)
        moved = stepped(at(rise, stages)).cycle.orbit.stage_state
        stages = [jnp.where(going, new, old) for new, old in zip(moved, stages, strict=True)]
        return rise, stages, *open_by(rise, stages), count + 1

    rise, stages = rise_of(found.cycle), list(found.cycle.orbit.stage_state)
    start = rise, stages, *open_by(rise, stages), jnp.asarray(0)
    rise, stages, over, slope, _ = jax.lax.while_loop(unfinished, improved, start)
    last = settled(at(rise - over / slope, stages))
    return last._replace(cycle=with_verdict(last.cycle, _missed(last)))


def _of(found: BatchCycle, cycle: Cycle) -> BatchCycle:
    return found._replace(cycle=cycle)


def _missed(found: BatchCycle) -> Q[Float[Array, " batch"], "K"]:
    return missed(found.cycle, _sampled(found))


def _sampled(found: BatchCycle) -> Sampled:
    return lambda cycle: at_collocation_points(_of(found, cycle))
