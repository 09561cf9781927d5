"""What a test bench can measure of a motor, with its slopes."""

from collections.abc import Sequence

import jax
from jaxtyping import Array, Float

from camring.metrics.case_drain import case_drain
from camring.metrics.summary import summarise
from camring.objective.slopes import Operated
from camring.physics.cycle import Cycle, neighbour

CASE_DRAIN = "case_drain"

MEASURABLE = (
    "mean_torque",
    "supply_flow",
    CASE_DRAIN,
    "efficiency",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "input_power",
    "output_power",
    "torque_ripple",
    "torque_ripple_true_rms",
    "torque_ripple_peak_to_peak",
    "flow_ripple",
    "flow_ripple_true_rms",
    "pressure_ripple",
    "pressure_ripple_true_rms",
    "max_pressure",
    "min_pressure",
    "supply_pressure_swing",
)
"""Results of `Metrics`, and the flow out of the case."""


def measurable(
    cycle: Cycle, names: Sequence[str], highest_order: int = 600
) -> dict[str, Float[Array, ""]]:
    """Some of `MEASURABLE` of a cycle, SI; what only others need is not computed."""
    found = summarise(cycle, highest_order)
    return {
        name: case_drain(cycle) if name == CASE_DRAIN else getattr(found, name) for name in names
    }


def measurable_slopes(
    cycle: Cycle, along: Operated, names: Sequence[str], highest_order: int = 600
) -> tuple[dict[str, Float[Array, ""]], dict[str, Float[Array, " direction"]]]:
    """`measurable` and its derivatives in several directions; nothing is solved again.

    Parameters
    ----------
    along
        The directions, leaves (direction, ...).
    """

    def found(here: Operated) -> dict[str, Array]:
        return measurable(neighbour(cycle, *here), names, highest_order)

    here = Operated(cycle.motor, cycle.fluid, cycle.point)
    values, linear = jax.linearize(found, here)
    return values, jax.vmap(linear)(along)
