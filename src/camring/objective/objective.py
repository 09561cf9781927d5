"""One number for a motor, with everything it was made from."""

from dataclasses import dataclass, field

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import register_dataclass
from jaxtyping import Array, Float, Int

from camring.metrics.summary import Metrics, summarise
from camring.objective.constraints import Constraints, penalty, violations
from camring.objective.terms import TERM_NAMES, Weights, raw_terms, weighted_sum
from camring.physics.heat.simulation import simulate
from camring.physics.resolution import Resolution
from camring.physics.system import System


@register_dataclass
@dataclass(frozen=True)
class Goal:
    """What a study is after: weights, limits, and how many orders a ripple counts.

    Its numbers are data of compiled programs (`as_data`).

    Examples
    --------
    >>> goal = camring.Goal(camring.Weights(torque_ripple=1000.0))
    >>> goal.harmonics, goal.constraints.names()
    (600, ('min_pressure', 'chamber_volume'))
    """

    weights: Weights = field(default_factory=Weights)
    constraints: Constraints = field(default_factory=Constraints)
    harmonics: int = field(default=600, metadata={"static": True})

    def as_data(self) -> "Goal":
        """The same with numbers that a program is given: another limit needs no other program."""
        return jax.tree.map(np.float64, self)


class Assessment(eqx.Module):
    """A motor assessed by a goal."""

    objective: Float[Array, ""]
    """`J`: the weighted mean of `J_phys` over the operating points, plus the penalty."""
    physical_objective: Float[Array, ""]
    terms: dict[str, Float[Array, " operating_point"]]
    """Raw terms of each operating point, unweighted."""
    constraints: dict[str, Float[Array, ""]]
    metrics: tuple[Metrics, ...]
    faults: Int[Array, " operating_point"]
    """Verdict of each operating point; zero is sound."""


def evaluate(system: System, goal: Goal, resolution: Resolution | None = None) -> Assessment:
    """Simulate every operating point and assess the results. Traceable and batched."""
    cycles = [
        simulate(system.motor, system.fluid, point, resolution) for point in system.operating_points
    ]
    metrics = tuple(summarise(cycle, goal.harmonics) for cycle in cycles)
    faults = jnp.stack([cycle.verdict.code for cycle in cycles])
    return assessment_of(system, goal, metrics, faults)


def assessment_of(
    system: System, goal: Goal, metrics: tuple[Metrics, ...], faults: Int[Array, " operating_point"]
) -> Assessment:
    """Terms, constraints and objective from results already at hand."""
    each = [raw_terms(results) for results in metrics]
    terms = {name: jnp.stack([found[name] for found in each]) for name in TERM_NAMES}
    weights = jnp.stack([point.weight for point in system.operating_points])
    weighted = jnp.sum(weights * weighted_sum(terms, goal.weights), axis=0)
    physical = weighted / jnp.sum(weights, axis=0)
    found = violations(goal.constraints, system, metrics)
    return Assessment(
        objective=physical + penalty(found, goal.weights.penalty),
        physical_objective=physical,
        terms=terms,
        constraints=found,
        metrics=metrics,
        faults=faults,
    )
