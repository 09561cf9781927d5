"""What a motor shows at its ports and its shaft: what a system around it would notice."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.numerics.selection import larger
from camring.physics.cycle import Cycle
from camring.physics.manifold.coupling import line_flow
from camring.physics.manifold.sides import RETURN, SUPPLY, Side
from camring.physics.piston_state import PistonState, sample_angles


class PortWaves(NamedTuple):
    """Of all pistons together; flows as volumes at the density of the higher port pressure."""

    torque: Q[Float[Array, "*grid"], "N.m"]
    """On the shaft, positive in the sense of positive speed."""
    supply_flow: Q[Float[Array, "*grid"], "m3/s"]
    """Into the motor by the supply port; with a manifold, through its line."""
    return_flow: Q[Float[Array, "*grid"], "m3/s"]
    """Out of the motor by the return port; with a manifold, through its line."""
    case_flow: Q[Float[Array, "*grid"], "m3/s"]
    """Out of the motor past the pistons."""


def port_waves(cycle: Cycle, angle: Q[Float[Array, " angle"], "rad"]) -> PortWaves:
    """Torque and flows at shaft angles, piston 0 standing at the angle.

    They repeat after a turn over the motor's surviving order.
    """
    motor = cycle.motor
    phases = motor.distinct_phases
    shifts = motor.cam.period / phases * jnp.arange(phases)
    one = of_one_piston(cycle, sample_angles(cycle, angle[:, None] + shifts))
    alike = motor.pistons // phases
    return PortWaves(*(alike * jnp.sum(wave, axis=-1) for wave in one))


def of_one_piston(cycle: Cycle, piston: PistonState) -> PortWaves:
    """A piston's share; that of the flow through a manifold's line is an equal one."""
    motor, fluid, point = cycle.motor, cycle.fluid, cycle.point

    def through(side: Side, own: Float[Array, "*grid"]) -> Float[Array, "*grid"]:
        """Into the motor by one kind of port."""
        manifold = side.of(motor)
        if manifold is None:
            return own
        port, pressure = side.set_pressure(point), getattr(piston, side.pressure)
        return line_flow(manifold, fluid, port, pressure) / motor.pistons

    reference = larger(point.supply_pressure, point.return_pressure)
    per_amount = 1 / fluid.content(reference)
    return PortWaves(
        piston.torque,
        per_amount * through(SUPPLY, piston.supply_flow),
        -per_amount * through(RETURN, piston.return_flow),
        per_amount * piston.leakage_flow,
    )
