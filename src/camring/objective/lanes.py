"""A goal's say of many designs at once, side by side (`numerics/lanes.py`).

The steps are separate functions because they are separate programs: compiled as one,
the compiler would write the end of the solution anew into every sum over it, at twice
the time (`benchmarks/batch_speed.py`).
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.metrics.lane_summary import summarise_lanes
from camring.metrics.summary import Metrics
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Assessment, Goal, judge
from camring.physics.lane_cycle import LaneCycle, LanesLook, neighbour_lanes, simulate_lanes
from camring.physics.system import System


def designs_in_lanes(
    space: AbstractSpace, system: System, points: Float[Array, "lane coordinate"]
) -> System:
    """The system at each point of the unit box, every leaf with a lane for each."""
    return jax.vmap(lambda point: space.apply(system, point), out_axes=-1)(points)


def solve_designs(designs: System, look: LanesLook) -> tuple[LaneCycle, ...]:
    """Every operating point of every design."""
    return tuple(
        simulate_lanes(designs.motor, designs.fluid, point, look)
        for point in designs.operating_points
    )


def summarise_designs(
    found: tuple[LaneCycle, ...], goal: Goal, look: LanesLook
) -> tuple[Metrics, ...]:
    """Results of every operating point of every design, leaves (lane,)."""
    return tuple(summarise_lanes(each, goal.harmonics, look.oversampling) for each in found)


def judge_designs(
    designs: System, found: tuple[LaneCycle, ...], metrics: tuple[Metrics, ...], goal: Goal
) -> Assessment:
    """What a goal says of each design: `judge`, leaves with lanes along their last axis."""
    faults = jnp.stack([each.cycle.verdict.code for each in found])
    return judge(designs, goal, metrics, faults)


class ManySlopes(NamedTuple):
    """Derivatives by the unit coordinates, shape (coordinate, lane)."""

    objective: Float[Array, "coordinate lane"]
    """Of `J_phys`, the objective without penalty."""
    constraints: dict[str, Float[Array, "coordinate lane"]]
    results: tuple[dict[str, Float[Array, "coordinate lane"]], ...]
    """At each operating point, of the results asked for."""


def slopes_of_designs(
    space: AbstractSpace,
    system: System,
    points: Float[Array, "lane coordinate"],
    found: tuple[LaneCycle, ...],
    goal: Goal,
    look: LanesLook,
    first: int | None = None,
    results: Sequence[str] = (),
) -> ManySlopes:
    """How objective and constraints of each design change with every coordinate, exactly.

    Parameters
    ----------
    found
        What was solved at the points; nothing is solved again, see `neighbour_lanes`.
    first
        By so many of the first coordinates only; by all unless given.
    results
        Names of results, such as `efficiency`, whose slopes are wanted, too.
    """

    def judged(
        points: Float[Array, "lane coordinate"],
    ) -> tuple[Array, dict[str, Array], tuple[dict[str, Array], ...]]:
        designs = designs_in_lanes(space, system, points)
        near = tuple(
            neighbour_lanes(known.cycle, designs.motor, designs.fluid, point, look)
            for known, point in zip(found, designs.operating_points, strict=True)
        )
        metrics = summarise_designs(near, goal, look)
        said = judge_designs(designs, near, metrics, goal)
        wanted = tuple({name: getattr(each, name) for name in results} for each in metrics)
        return said.physical_objective, said.constraints, wanted

    _, linear = jax.linearize(judged, points)
    along = jnp.eye(points.shape[-1])[:first, None]
    return ManySlopes(*jax.vmap(linear)(jnp.broadcast_to(along, (len(along), *points.shape))))
