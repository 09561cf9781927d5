"""Largest and smallest shaft torque, all pistons together.

Shaft torque repeats after one distinct piston phase. Its kinks lie where any
piston meets a breakpoint, so the nodes of the mesh, folded into one phase,
divide it into intervals on which it is smooth.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.extremum import vertex_value
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.waveforms import shaft_torque


class TorqueRange(NamedTuple):
    """Extremes of shaft torque over a revolution."""

    highest: Q[Float[Array, ""], "N.m"]
    lowest: Q[Float[Array, ""], "N.m"]


def torque_range(cycle: Cycle) -> TorqueRange:
    """Extremes of shaft torque, refined by a parabola in every smooth interval."""
    start = cycle.orbit.mesh.start
    phase = cycle.motor.cam.period / cycle.motor.distinct_phases
    folded = jnp.sort(start % phase)
    following = jnp.concatenate([folded[1:], folded[:1] + phase])
    middle = (folded + following) / 2
    at_node, at_middle = shaft_torque(cycle, jnp.stack([folded, middle]))
    after = jnp.roll(at_node, -1)
    highest = jnp.max(vertex_value(at_node, at_middle, after))
    lowest = -jnp.max(vertex_value(-at_node, -at_middle, -after))
    return TorqueRange(highest, lowest)
