"""Oil that leaves through the case drain, as a flow meter there would show it."""

from jaxtyping import Array, Float

from camring.metrics.spectrum import quadrature_samples
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle


def case_drain(cycle: Cycle) -> Q[Float[Array, ""], "m3/s"]:
    """Mean leakage of all pistons, as a volume at case pressure.

    All leakage of the model goes past the pistons into the case; a real valve plate
    leaks there, too.
    """
    samples = quadrature_samples(cycle)
    amount = cycle.motor.pistons * samples.mean(samples.piston.leakage_flow)
    return amount / cycle.fluid.content(cycle.point.case_pressure)
