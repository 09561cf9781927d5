"""A motor looked at ever more finely until every result is as accurate as was asked.

A short ladder of resolutions: each resolution is compared with two coarser solutions of the same
program, and with the one below it. Only those that are stepped on are compiled.
"""

from collections.abc import Callable
from typing import NamedTuple

from camring.metrics.error_estimate import (
    CLIMBED_FACTOR,
    CLIMBED_FLOOR,
    FLOOR,
    RESOLUTIONS,
    Floor,
    error_estimate,
    largest,
    relative_error,
)
from camring.metrics.summary import Metrics
from camring.numerics.verdict import Fault
from camring.physics.cycle import Cycle, meshed
from camring.physics.resolution import Resolution


class Solution(NamedTuple):
    """One motor at one operating point, seen at one resolution."""

    cycle: Cycle
    metrics: Metrics


class Accurate(NamedTuple):
    """What the last resolution gave, and how good it is."""

    cycle: Cycle
    metrics: Metrics
    error: Metrics
    """Estimated absolute error of each result, in its unit."""
    resolution: Resolution
    accuracy: float
    """What was asked for."""

    @property
    def elements(self) -> int:
        """Of a lobe pitch, in the mesh of the cycle."""
        return meshed(self.cycle.motor, self.resolution).elements

    @property
    def relative_errors(self) -> dict[str, float]:
        """The estimated error of each result of docs/theory.md section 10, as a share of it."""
        return relative_error(self.metrics, self.error)

    @property
    def largest_error(self) -> float:
        """Of any result, as a share of it."""
        return max(self.relative_errors.values())

    @property
    def worst_result(self) -> str:
        """The name of the result in which that error is."""
        errors = self.relative_errors
        return max(errors, key=lambda name: errors[name])

    @property
    def reached(self) -> bool:
        """Whether every result is estimated to be as accurate as was asked."""
        return _sound(self.cycle) and self.largest_error <= self.accuracy


def climb(
    solution_at: Callable[[Resolution], Solution],
    accuracy: float = 1e-5,
    ladder: tuple[Resolution, ...] | None = None,
) -> Accurate:
    """The first resolution whose estimated error is within the accuracy, else the last sound one.

    Parameters
    ----------
    solution_at
        Simulates and summarises at a resolution.
    accuracy
        Wanted of each result of docs/theory.md section 10, relative; see
        `error_estimate.relative_error` for those that are small differences.
    ladder
        `Resolution.ladder()` if not given.

    Notes
    -----
    No finer mesh mends a motor that is refused for what it is, so such a one stays on
    the first resolution. Not traceable: each step depends on numbers.
    """
    first, *rest = ladder or Resolution.ladder()
    seen = solution_at(first)
    error = _beside_coarser_solutions(solution_at, first, seen.metrics, FLOOR)
    found = Accurate(*seen, error, first, accuracy)
    for finer in rest:
        if found.reached or not _curable(found.cycle):
            break
        seen = solution_at(finer)
        error = largest(
            error_estimate(seen.metrics, found.metrics, CLIMBED_FACTOR, CLIMBED_FLOOR),
            _beside_coarser_solutions(solution_at, finer, seen.metrics, CLIMBED_FLOOR),
        )
        if not (_sound(found.cycle) and not _sound(seen.cycle)):
            found = Accurate(*seen, error, finer, accuracy)
    return found


def _beside_coarser_solutions(
    solution_at: Callable[[Resolution], Solution],
    resolution: Resolution,
    results: Metrics,
    floor: Floor,
) -> Metrics:
    """The error of results at a resolution, from solutions of the same program at less."""
    return largest(
        *(
            error_estimate(
                results, solution_at(resolution.second_solution(share)).metrics, factor, floor
            )
            for share, factor in RESOLUTIONS
        )
    )


def _sound(cycle: Cycle) -> bool:
    return int(cycle.verdict.code) == Fault.NONE


def _curable(cycle: Cycle) -> bool:
    return int(cycle.verdict.code) in (Fault.NONE, Fault.NOT_CONVERGED)
