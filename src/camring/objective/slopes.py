"""How objective and constraints change with the design, exactly.

A cycle at hand is differentiated by one Newton step (`physics.heat.simulation.neighbour`), for
all variables at once in forward mode: nothing is solved again, and a variable costs
a fraction of a simulation. The slopes are those of the discrete model, free of any
step. At a kink (a window's edge that passes a knot, another operating point that
becomes the worst) they are those of one side.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.metrics.summary import Metrics, summarise
from camring.numerics.quantity import ArrayLike
from camring.objective.design_space import AbstractSpace
from camring.objective.objective import Goal, assessment_of
from camring.objective.terms import TERM_RESULTS
from camring.physics.cycle import Cycle
from camring.physics.heat.simulation import neighbour
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System


class Operated(NamedTuple):
    """A motor at one operating point, or a direction in which to change it."""

    motor: Motor
    fluid: AbstractFluid
    point: OperatingPoint


class Slopes(eqx.Module):
    """Derivatives by the unit coordinates of a design space."""

    objective: Float[Array, " coordinate"]
    """Of `J_phys`, the objective without penalty."""
    constraints: dict[str, Float[Array, " coordinate"]]


def results_used(goal: Goal) -> tuple[str, ...]:
    """The results that objective and constraints are made of."""
    return tuple(dict.fromkeys([*TERM_RESULTS, *goal.constraints.results_used()]))


def directions(space: AbstractSpace, system: System, unit_point: ArrayLike) -> System:
    """What a unit step along each coordinate changes in a system, leaves (coordinate, ...)."""
    point = jnp.asarray(unit_point)

    def along(step: Float[Array, " coordinate"]) -> System:
        return jax.jvp(lambda at: space.apply(system, at), (point,), (step,))[1]

    return jax.vmap(along)(jnp.eye(space.dimension))


def result_slopes(
    cycle: Cycle, along: Operated, names: Sequence[str], highest_order: int = 600
) -> dict[str, Float[Array, " direction"]]:
    """Derivatives of some results of a cycle in several directions.

    Parameters
    ----------
    along
        The directions, leaves (direction, ...).
    names
        Of the results; what only others need is not computed.
    """

    def results(here: Operated) -> dict[str, Array]:
        found = summarise(neighbour(cycle, *here), highest_order)
        return {name: getattr(found, name) for name in names}

    _, linear = jax.linearize(results, Operated(cycle.motor, cycle.fluid, cycle.point))
    return jax.vmap(linear)(along)


def assessed_slopes(
    system: System,
    goal: Goal,
    metrics: tuple[Metrics, ...],
    along: System,
    slopes: Sequence[Mapping[str, Float[Array, " coordinate"]]],
) -> Slopes:
    """From the slopes of results to those of objective and constraints.

    Parameters
    ----------
    metrics, slopes
        At each operating point the results, and the derivatives of those used.
    along
        The directions that the slopes belong to, as from `directions`.
    """
    sound = jnp.zeros(len(metrics), int)

    def assessed(system: System, metrics: tuple[Metrics, ...]) -> tuple[Array, dict[str, Array]]:
        found = assessment_of(system, goal, metrics, sound)
        return found.physical_objective, found.constraints

    nothing = jnp.zeros_like(next(iter(slopes[0].values())))
    whole = tuple(
        Metrics(**{each.name: found.get(each.name, nothing) for each in fields(Metrics)})
        for found in slopes
    )
    _, linear = jax.linearize(assessed, system, metrics)
    return Slopes(*jax.vmap(linear)(along, whole))
