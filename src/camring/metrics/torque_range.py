"""Largest and smallest shaft torque, all pistons together.

Shaft torque repeats after one distinct piston phase. Its kinks lie where any
piston meets a breakpoint, so the nodes of the mesh, folded into one phase,
divide it into intervals on which it is smooth.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.extremum import EXTREMUM_FRACTIONS, quartic_top, vertex_value
from camring.numerics.mesh import folded
from camring.numerics.quantity import Q
from camring.numerics.selection import bounded
from camring.physics.cycle import Cycle
from camring.physics.piston_state import sample_located


class TorqueRange(NamedTuple):
    """Extremes of shaft torque over a revolution."""

    highest: Q[Float[Array, ""], "N.m"]
    lowest: Q[Float[Array, ""], "N.m"]


def torque_range(cycle: Cycle) -> TorqueRange:
    """Extremes of shaft torque: the most promising smooth interval each, looked at again.

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
    element = bounded(passed + entered - 1, 0)

    def torque_at(element: Array, within: Array) -> Array:
        """Of all pistons: elements (piston, place), places within the phase (..., 1, place)."""
        torque = sample_located(cycle, element, piston * phase + within - from_first[element])
        return motor.pistons // phases * jnp.sum(torque.torque, axis=-2)

    at_start, at_middle = torque_at(element, jnp.stack([angle, (angle + following) / 2])[:, None])

    def most(sign: int) -> Array:
        """The interval with the highest top, of torque with a sign."""
        ends = sign * at_start
        return jnp.argmax(vertex_value(ends, sign * at_middle, jnp.roll(ends, -1)))

    best = jnp.repeat(jnp.stack([most(1), most(-1)]), len(EXTREMUM_FRACTIONS))
    fraction = np.tile(EXTREMUM_FRACTIONS, 2)
    place = angle[best] + fraction * (following - angle)[best]
    high, low = torque_at(element[:, best], place[None]).reshape(2, -1)
    return TorqueRange(quartic_top(high), -quartic_top(-low))
