"""What pistons on idle lobes take from the shaft: friction, throttling to and fro, inertia none."""

from jaxtyping import Array, Float

from camring.metrics.displacement import driving
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.piston_state import quadrature_samples

__all__ = ["idle_drag"]


def idle_drag(cycle: Cycle) -> Q[Float[Array, ""], "N.m"]:
    """Mean torque against the motion of all pistons while they are on idle lobes.

    Zero without any. A lobe lasts from its inner dead centre to the next.
    """
    samples = quadrature_samples(cycle)
    idle = 1 - driving(cycle.motor.valve_plate, samples.piston.angle)
    return -cycle.motor.pistons * samples.mean(samples.piston.torque * idle)
