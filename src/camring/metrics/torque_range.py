"""Largest and smallest shaft torque, all pistons together.

Shaft torque repeats after one distinct piston phase. Its kinks lie where any
piston meets a breakpoint, so the nodes of the mesh, folded into one phase,
divide it into intervals on which it is smooth.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.extremum import vertex_value
from camring.numerics.mesh import folded
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.piston_state import sample_located


class TorqueRange(NamedTuple):
    """Extremes of shaft torque over a revolution."""

    highest: Q[Float[Array, ""], "N.m"]
    lowest: Q[Float[Array, ""], "N.m"]


def torque_range(cycle: Cycle) -> TorqueRange:
    """Extremes of shaft torque, refined by a parabola in every smooth interval.

    The element in which each piston stands needs no search: going round, piston
    `j` enters its next element exactly at the folded nodes that are its own.
    """
    motor, mesh = cycle.motor, cycle.orbit.mesh
    phases = motor.distinct_phases
    phase = motor.cam.period / phases
    from_first = mesh.start - mesh.start[0]
    own, within = folded(mesh.start, phase, phases)
    order = jnp.lexsort((own, within))
    angle = within[order]
    following = jnp.concatenate([angle[1:], jnp.full(1, phase)])

    piston = jnp.arange(phases)[:, None]
    entered = jnp.cumsum(own[order] == piston, axis=1)
    passed = jnp.sum(own < piston, axis=1, keepdims=True)
    element = jnp.clip(passed + entered - 1, 0)
    where = piston * phase + jnp.stack([angle, (angle + following) / 2])[:, None]
    torque = sample_located(cycle, element, where - from_first[element]).torque
    at_start, at_middle = motor.pistons // phases * jnp.sum(torque, axis=1)
    at_end = jnp.roll(at_start, -1)
    highest = jnp.max(vertex_value(at_start, at_middle, at_end))
    lowest = -jnp.max(vertex_value(-at_start, -at_middle, -at_end))
    return TorqueRange(highest, lowest)
