"""The reference pistons of a batch where integrals over their periods are taken."""

import jax.numpy as jnp

from camring.numerics.batch_mesh import positions
from camring.numerics.radau import STAGE_INTEGRALS, STAGES
from camring.physics.batch_cycle import BatchCycle
from camring.physics.piston_state import QuadratureSamples, piston_state
from camring.physics.pressure import pressure_slope


def at_collocation_points(found: BatchCycle) -> QuadratureSamples:
    """Sample cycles at their collocation points, arrays (3, element, batch)."""
    cycle, (radius, chamber) = found.cycle, found.at_stages
    mesh = cycle.orbit.mesh
    angle = positions(mesh, jnp.asarray(STAGES))
    piston = piston_state(cycle, angle, radius, chamber, cycle.orbit.stage_state)
    pressure = piston.chamber_pressure
    slope = pressure_slope(cycle.motor, cycle.fluid, cycle.point, chamber, pressure)
    return QuadratureSamples(piston, slope, STAGE_INTEGRALS[-1][:, None, None] * mesh.width)
