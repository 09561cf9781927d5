"""What a test bench can measure of a motor, with its slopes: at one row, or at many at once."""

from collections.abc import Sequence

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from camring.metrics.result_scale import RIPPLES
from camring.metrics.summary import summarise
from camring.objective.batch import (
    in_groups,
    moving,
    solve_designs,
    summarise_designs,
    where_other,
)
from camring.objective.design_space import AbstractSpace
from camring.objective.slopes import Operated
from camring.physics.batch_cycle import BatchResolution
from camring.physics.cycle import Cycle
from camring.physics.heat.batch_simulation import neighbour_batch
from camring.physics.heat.simulation import neighbour
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.system import System

CASE_DRAIN = "case_drain"
CASE_RISE = "case_temperature_rise"

MEASURABLE = (
    "mean_torque",
    "supply_flow",
    "return_flow",
    CASE_DRAIN,
    "efficiency",
    "port_efficiency",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "input_power",
    "output_power",
    *RIPPLES,
    "max_pressure",
    "min_pressure",
    "supply_pressure_swing",
    "return_pressure_swing",
    CASE_RISE,
)
"""Those results of `Metrics` that a bench can read."""


def measurable(
    cycle: Cycle, names: Sequence[str], highest_order: int = 600
) -> dict[str, Float[Array, ""]]:
    """Some of `MEASURABLE` of a cycle, SI; what only others need is not computed."""
    found = summarise(cycle, highest_order)
    return {name: getattr(found, name) for name in names}


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


def rows_with_slopes(
    space: AbstractSpace,
    motor: Motor,
    fluids: AbstractFluid,
    points: OperatingPoint,
    unit_point: Float[Array, " coordinate"],
) -> tuple[System, System]:
    """One design at many rows of a table, and its derivatives by each coordinate.

    Parameters
    ----------
    space
        Of a system with this motor and any of the oils.
    fluids, points
        Leaves (row,).

    Returns
    -------
    Leaves (..., row) and (coordinate, ..., row), the latter None where nothing moves.
    """

    def every_row(at: Array, moved: bool) -> System:
        def row(fluid: AbstractFluid) -> System:
            given = System(motor, fluid, ())
            design = space.apply(given, at)
            return where_other(design, given) if moved else design

        return jax.vmap(row, in_axes=-1, out_axes=-1)(fluids)

    _, linear = jax.linearize(lambda at: every_row(at, True), unit_point)
    slopes = jax.vmap(linear)(jnp.eye(unit_point.shape[0]))
    rows = every_row(unit_point, False)
    still = jax.tree.map(lambda _: None, points)
    return (
        System(rows.motor, rows.fluid, (points,)),
        System(slopes.motor, slopes.fluid, (still,)),
    )


def measurable_of_rows(
    rows: System,
    along: System,
    names: Sequence[str],
    highest_order: int,
    resolution: BatchResolution,
) -> tuple[
    dict[str, Float[Array, " row"]], dict[str, Float[Array, "coordinate row"]], Int[Array, " row"]
]:
    """`measurable` of many rows, its derivatives, and verdicts.

    Parameters
    ----------
    rows, along
        As from `rows_with_slopes`.
    """
    (known,) = solve_designs(rows, resolution)
    numbers, rest = moving(rows, along)

    def found(numbers: System) -> dict[str, Array]:
        rows = eqx.combine(numbers, rest)
        near = neighbour_batch(
            known.cycle, rows.motor, rows.fluid, rows.operating_points[0], resolution
        )
        (metrics,) = summarise_designs((near,), highest_order, resolution)
        return {name: getattr(metrics, name) for name in names}

    values, linear = jax.linearize(found, numbers)
    return values, in_groups(linear, along), known.cycle.verdict.code
