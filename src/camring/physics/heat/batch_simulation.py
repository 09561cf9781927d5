"""Many motors side by side: pressure, and how warm films and cases become.

The same as `simulation.py`, with a batch along the last axis.
"""

from dataclasses import replace
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Bool, Float, Int

from camring.numerics.compilation import computed_once
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
    warmed,
    with_rise,
    with_verdict,
)
from camring.physics.heat.collocation import at_collocation_points
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

ROUGHLY, NEARLY = 1e-2, 1e-4
"""Shares of the rise that a first guess, and every turn but the last, may leave over."""
MOST_TURNS = 12
"""Of rise and pressure; two are usual."""


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
    guess = _in_turns(guessed_cycles(motor, fluid, point, resolution), ROUGHLY)
    rise = jnp.where(closes(guess.rise, guess.over, ROUGHLY), guess.rise, motor.thermal.rise)
    motor = with_rise(motor, computed_once(rise))
    first = periodic_cycles(motor, fluid, point, resolution, filled)
    found = _in_turns(first, NEARLY)
    last = settled(_at(first, found.rise - found.over / found.slope, found.stages))
    return last._replace(cycle=with_verdict(last.cycle, _missed(last)))


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
    return settled(_of(found, warmed(found.cycle, rise)))


class _InTurns(NamedTuple):
    """Where rise and pressure have come to, with what the balance leaves over there."""

    rise: Q[Float[Array, " batch"], "K"]
    stages: list[Float[Array, "element batch"]]
    over: Q[Float[Array, " batch"], "K"]
    slope: Q[Float[Array, " batch"], "1"]
    """Of what is left over, by the rise while the pressure stays."""
    turns: Int[Array, ""]


def _in_turns(found: BatchCycle, share: float) -> _InTurns:
    """A Newton step on the rise while the pressure stays, and one on the pressure, in turn.

    Until every member's balance leaves over no more than a share of the rise; each stops by
    itself, and one that has no number any more stops, too.
    """

    def unsettled(now: _InTurns) -> Bool[Array, " batch"]:
        return ~closes(now.rise, now.over, share) & ~jnp.isnan(now.over)

    def unfinished(now: _InTurns) -> Bool[Array, ""]:
        return jnp.any(unsettled(now)) & (now.turns < MOST_TURNS)

    def improved(now: _InTurns) -> _InTurns:
        going = unsettled(now)
        rise = jnp.where(going, now.rise - now.over / now.slope, now.rise)
        moved = stepped(_at(found, rise, now.stages)).cycle.orbit.stage_state
        stages = [jnp.where(going, new, old) for new, old in zip(moved, now.stages, strict=True)]
        return _left_over(found, rise, stages, now.turns + 1)

    start = rise_of(found.cycle), list(found.cycle.orbit.stage_state), jnp.asarray(0)
    return jax.lax.while_loop(unfinished, improved, _left_over(found, *start))


def _left_over(
    found: BatchCycle, rise: Array, stages: list[Array], turns: Int[Array, ""]
) -> _InTurns:
    here = _at(found, rise, stages)
    sampled = _sampled(here)
    drop = leakage_drop(here.cycle, sampled(here.cycle))
    return _InTurns(rise, stages, *missed_and_slope(here.cycle, sampled, drop), turns)


def _at(found: BatchCycle, rise: Array, stages: list[Array]) -> BatchCycle:
    orbit = replace(found.cycle.orbit, stage_state=jnp.stack(stages))
    return _of(found, replace(warmed(found.cycle, rise), orbit=orbit))


def _of(found: BatchCycle, cycle: Cycle) -> BatchCycle:
    return found._replace(cycle=cycle)


def _missed(found: BatchCycle) -> Q[Float[Array, " batch"], "K"]:
    return missed(found.cycle, _sampled(found))


def _sampled(found: BatchCycle) -> Sampled:
    return lambda cycle: at_collocation_points(_of(found, cycle))
