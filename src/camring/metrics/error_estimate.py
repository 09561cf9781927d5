"""How wrong results may be, from a second solution at a coarser resolution."""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import jax
import numpy as np

from camring.metrics.summary import Metrics

FACTOR = 2
"""How many times what a mesh of seven tenths changes is claimed: extremes and ripples need
not shrink evenly."""

RESOLUTIONS = ((0.7, FACTOR), (0.85, 3.0))
"""Shares of the elements that a mesh is compared with, and how many times each difference is
claimed; the larger counts. Errors that do not shrink evenly can make two meshes agree by
chance: the same chance twice is rare. At order four the second difference claims half of
what the first does, so that it speaks only where the first is silent."""

CLIMBED_FACTOR = 1.5
"""The same after the elements were doubled: the difference is the coarser mesh's error."""


class Floor(NamedTuple):
    """Shares of a result below which two meshes may agree by chance."""

    of_results: float
    of_force: float
    """Of the smallest contact force: where some ten newtons are left of tens of thousands, 1e-8 of
    the pressure is 5e-6 of it."""


FLOOR = Floor(4e-6, 8e-6)
CLIMBED_FLOOR = Floor(2e-6, 2e-6)

SMALL_BESIDE = {
    "throttling_loss": ("input_power", 1e-4),
    "leakage_loss": ("input_power", 1e-4),
    "full_leakage_loss": ("input_power", 1e-4),
    "friction_loss": ("input_power", 1e-4),
    "compression_loss": ("input_power", 1e-4),
    "line_loss": ("input_power", 1e-4),
    "return_line_loss": ("input_power", 1e-4),
    "port_power": ("input_power", 1e-4),
    "case_drain": ("supply_flow", 1e-4),
    "return_flow": ("supply_flow", 1e-4),
    "case_heat": ("input_power", 1e-4),
    "surface_heat": ("input_power", 1e-4),
    "min_pressure": ("max_pressure", 1e-4),
    "supply_pressure_swing": ("max_pressure", 1e-4),
    "return_pressure_swing": ("max_pressure", 1e-4),
}
"""Differences of large numbers: below this share of another result they are compared with it."""

FORCE_SHARE = 1e-3
"""The same of the smallest contact force, beside the force of the ports' pressure difference."""

COMPANIONS = frozenset(
    {
        "min_lift",
        "max_lift",
        "power_residual",
        "pressure_overshoot",
        "pressure_undershoot",
        "air_release_margin",
        "vapour_margin",
        "share_below_air_release",
        "share_below_vapour",
    }
)
"""Differences and shares of no size of their own, beside the results (docs/theory.md section 10).
"""


def error_estimate(
    results: Metrics, coarser: Metrics, factor: float = FACTOR, floor: Floor = FLOOR
) -> Metrics:
    """Absolute error of each result: what a coarser mesh changes, and a floor.

    The coarser mesh (`Resolution.second_solution`) has about four times the error, so
    the difference is mostly its own and overstates that of the finer mesh. Extremes
    move by less regular steps, hence the factor; the floor stands for places where
    both happen to agree. All numbers are measured: against the independent solver,
    on sound and on awkward random motors (docs/notes/verification.md).

    Parameters
    ----------
    factor, floor
        `CLIMBED_FACTOR` and `CLIMBED_FLOOR` where `results` have twice the elements
        of `coarser`.
    """
    with np.errstate(invalid="ignore"):  # an undercut ring's stress has no end, nor has its error
        found = jax.tree.map(
            lambda fine, coarse: factor * np.abs(fine - coarse) + floor.of_results * np.abs(fine),
            jax.device_get(results),
            jax.device_get(coarser),
        )
    further = (floor.of_force - floor.of_results) * np.abs(np.asarray(results.min_contact_force))
    return replace(found, min_contact_force=found.min_contact_force + further)


def largest(*errors: Metrics) -> Metrics:
    """The largest of several estimates of each result's error; no number if one is none."""
    return jax.tree.map(lambda *each: np.max(np.stack(each), axis=0), *errors)


def relative_error(results: Metrics, error: Metrics) -> dict[str, float]:
    """The error of each result as a share of it, or of what it is small beside.

    Left out are the companions, what is nil (the line's loss without a line), and what is
    not a finite number in the first place (contact stress under an undercut). A result
    whose error is not finite has an infinite one.
    """
    return dict(_shares(results, error))


def _shares(results: Metrics, error: Metrics) -> Iterator[tuple[str, float]]:
    values = {name: float(value) for name, value in vars(results).items()}
    of_ports = abs(values["ideal_torque"]) / values["stroke"] if values["stroke"] > 0 else 0.0
    for name, value in values.items():
        other, share = SMALL_BESIDE.get(name, (name, 1.0))
        scale = max(abs(value), share * abs(values[other]))
        if name == "min_contact_force":
            scale = max(scale, FORCE_SHARE * of_ports)
        if name in COMPANIONS or value == 0 or not 0 < scale < float("inf"):
            continue
        found = float(getattr(error, name)) / scale
        yield name, found if found == found else float("inf")
