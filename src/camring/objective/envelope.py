"""A motor at every point of its envelope: one batch, with what limits say of each point.

A point of an envelope is an operating point that only limits see. All points of a design
lie side by side along the last axis, those that turn backwards as the motor's mirror
image, so that one program solves them together (`objective/batch.py`).
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.numerics.quantity import real
from camring.objective.batch import designs_in_batch
from camring.objective.constraints import Constraints
from camring.objective.design_space import AbstractSpace
from camring.physics.envelope import Envelope, EnvelopeGrid
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.rotation import turned, with_like_ports
from camring.physics.system import System

POINTWISE = ("min_pressure", "min_contact_force", "max_pressure", "max_contact_stress")
"""Limits that depend on pressure and speed in a way of their own at every point."""

ONLY_AT_OPERATING_POINTS = ("min_mean_torque", "min_l10_life")
"""Limits that say what a motor must give where it works: at part load no motor can give its
torque, and life is counted at the loads that the operating points name."""

RIPPLE_RATIO, EFFICIENCY_LOSS = "max_ripple_ratio", "max_efficiency_loss"
"""Limits against the given motor at the same point, named as their keys in `[envelope]`."""


class Conditions(eqx.Module):
    """The points of a grid as arrays, those that turn backwards last."""

    point: OperatingPoint
    """Leaves (point,); all forwards, for the motor is turned instead."""
    fluid: AbstractFluid | None
    """Leaves (point,), where the grid has oils of its own."""
    backwards: int = eqx.field(static=True)
    """How many of the points turn backwards."""

    @property
    def count(self) -> int:
        return self.point.shaft_speed.shape[-1]


@dataclass(frozen=True)
class Reference:
    """The given motor at the points of a grid, against which its successors are held."""

    torque_ripple: Float[np.ndarray, " point"]
    efficiency: Float[np.ndarray, " point"]


@lru_cache(maxsize=8)  # every design of a search is solved under the same ones
def conditions_of(envelope: Envelope, grid: EnvelopeGrid) -> Conditions:
    """The points of a grid, ready for a batch."""
    point = OperatingPoint(
        shaft_speed=real(grid.shaft_speed),
        supply_pressure=real(grid.supply_pressure),
        return_pressure=real(grid.return_pressure),
        case_pressure=real(grid.case_pressure),
        weight=real(np.ones(grid.count)),
    )
    fluid = None
    if envelope.fluids:
        chosen = [envelope.fluids[place] for place in grid.fluid]
        fluid = jax.tree.map(lambda *each: jnp.stack(each), *chosen)
    return Conditions(point, fluid, int(np.count_nonzero(grid.backwards)))


def designs_in_envelope(designs: System, conditions: Conditions) -> System:
    """Every design at every point, leaves (..., design times point), one operating point."""
    designs_count = jax.tree.leaves(designs.motor)[0].shape[-1]
    forwards = conditions.count - conditions.backwards
    given = with_like_ports(designs.motor) if conditions.backwards else designs.motor
    motor = _repeated(given, forwards)
    if conditions.backwards:
        image = _backwards(given)
        both = _repeated(image, conditions.backwards)
        motor = jax.tree.map(lambda *each: jnp.concatenate(each, axis=-1), motor, both)
    motor = _side_by_side(motor)

    def at_each_design(tree: Any) -> Any:
        return jax.tree.map(lambda leaf: jnp.tile(leaf, designs_count), tree)

    fluid = conditions.fluid
    if fluid is None:
        fluid = _side_by_side(_repeated(designs.fluid, conditions.count))
    else:
        fluid = at_each_design(fluid)
    return System(motor, fluid, (at_each_design(conditions.point),))


def envelope_of_system(system: System, conditions: Conditions) -> System:
    """One motor at every point, leaves (..., point)."""
    one = jax.tree.map(lambda leaf: jnp.asarray(leaf)[..., None], system)
    return designs_in_envelope(one, conditions)


def envelope_of_designs(
    space: AbstractSpace,
    system: System,
    points: Float[Array, "design coordinate"],
    conditions: Conditions,
) -> System:
    """The designs at some points of the unit box, each at every point of the envelope."""
    return designs_in_envelope(designs_in_batch(space, system, points), conditions)


def envelope_with_slopes(
    space: AbstractSpace,
    system: System,
    points: Float[Array, "design coordinate"],
    conditions: Conditions,
) -> tuple[System, System]:
    """`envelope_of_designs`, and derivatives by each coordinate along a new first axis.

    There is no derivative (None) of numbers that the space leaves alone.
    """
    found, linear = jax.linearize(
        lambda at: envelope_of_designs(space, system, at, conditions), points
    )
    along = jnp.eye(points.shape[-1])[:, None]
    slopes = jax.vmap(linear)(jnp.broadcast_to(along, (points.shape[-1], *points.shape)))
    return found, eqx.filter(slopes, _moved(space, system, conditions))


def _moved(space: AbstractSpace, system: System, conditions: Conditions) -> System:
    """Which numbers of the batch follow the coordinates."""
    given = jax.tree.leaves(system)

    def kept(point: Float[Array, " coordinate"]) -> list[bool]:
        design = jax.tree.leaves(space.apply(system, point))
        moves.extend(mine is not theirs for mine, theirs in zip(design, given, strict=True))
        return []

    moves: list[bool] = []
    jax.eval_shape(kept, jax.ShapeDtypeStruct((space.dimension,), float))
    moved = jax.tree.unflatten(jax.tree.structure(system), moves)
    motor = moved.motor
    if conditions.backwards:
        # A mirror image has the same numbers, those of supply and return exchanged.
        motor = with_like_ports(motor)
        plate = motor.valve_plate
        image = eqx.tree_at(
            lambda each: (each.valve_plate.supply, each.valve_plate.return_),
            motor,
            (plate.return_, plate.supply),
        )
        motor = jax.tree.map(lambda one, other: one or other, motor, image)
    fluid = moved.fluid
    if conditions.fluid is not None:
        fluid = jax.tree.map(lambda _: False, fluid)
    point = jax.tree.map(lambda _: False, conditions.point)
    return System(motor, fluid, (point,))


def _backwards(motor: Motor) -> Motor:
    """The mirror image that turns forwards, as a motor like any other."""
    one, none = real(1.0), real(0.0)
    asked = OperatingPoint(one, one, none, none, reverse=True)
    return replace(turned(motor, asked), from_behind=False)


def _repeated(tree: Any, count: int) -> Any:
    """Every leaf (..., design) as (..., design, count)."""
    return jax.tree.map(lambda leaf: jnp.broadcast_to(leaf[..., None], (*leaf.shape, count)), tree)


def _side_by_side(tree: Any) -> Any:
    """Every leaf (..., design, point) as (..., design times point)."""
    return jax.tree.map(lambda leaf: leaf.reshape(*leaf.shape[:-2], -1), tree)


def names_in_envelope(constraints: Constraints) -> tuple[str, ...]:
    """Limits that hold everywhere in an envelope, of those that the file sets."""
    return tuple(name for name in constraints.names() if name not in ONLY_AT_OPERATING_POINTS)


def names_against_given(envelope: Envelope) -> tuple[str, ...]:
    """Limits of an envelope against the given motor, of those that are set."""
    limits = {
        RIPPLE_RATIO: envelope.ripple_ratio,
        EFFICIENCY_LOSS: envelope.efficiency_loss,
    }
    return tuple(name for name, limit in limits.items() if limit is not None)


def against_given(
    envelope: Envelope,
    reference: Reference,
    torque_ripple: Float[np.ndarray, " point"],
    efficiency: Float[np.ndarray, " point"],
) -> dict[str, Float[np.ndarray, " point"]]:
    """Each limit against the given motor as a `g <= 0` at every point."""
    found = {}
    if envelope.ripple_ratio is not None:
        found[RIPPLE_RATIO] = torque_ripple / (envelope.ripple_ratio * reference.torque_ripple) - 1
    if envelope.efficiency_loss is not None:
        lost = reference.efficiency - efficiency
        found[EFFICIENCY_LOSS] = (lost - envelope.efficiency_loss) / loss_scale(envelope)
    return found


def loss_scale(envelope: Envelope) -> float:
    """What the limit of lost efficiency is counted in: itself, unless it is nothing."""
    return envelope.efficiency_loss or 1.0
