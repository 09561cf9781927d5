"""Which hyper-parameters, warps and residual mean to use, and when to look again.

A fit from several starts is expensive and a warm one is cheap. Everything is chosen
afresh only each time the history has grown by half; between, the objective is
refitted every few trials from where it was, and the constraints take turns, one
at each trial.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from camring.search.problem import Memory
from camring.search.surrogate.dataset import Dataset
from camring.search.surrogate.gaussian_process import Observations, capacity_for, pad
from camring.search.surrogate.likelihood import Fitted, fit, standard_starts
from camring.search.surrogate.residual_mean import (
    LeaveOneOut,
    ResidualMean,
    available,
    leave_one_out,
    observations_of,
)
from camring.search.surrogate.rotation import fit_with_axes
from camring.search.surrogate.warp import Warp, candidate_warps

GROWTH_TO_RELEARN = 1.5
OBJECTIVE_REFIT_EVERY = 4  # trials
MOST_RESTRICTION_ROWS = 128  # constraints are many, and mostly simpler than the objective
WARM_ITERATIONS = 15


@dataclass(frozen=True)
class Learned:
    """Choices for every output, as plain numbers that survive JSON bit by bit.

    Attributes
    ----------
    mean
        The residual mean of least leave-one-out error.
    objective
        Hyper-parameters of the objective for each residual mean.
    scores
        Leave-one-out error of each residual mean.
    restrictions
        Hyper-parameters and warp of each constraint.
    learned_at, refitted_at
        Number of evaluations when everything, and when the objective, was last fitted.
    """

    mean: ResidualMean
    objective_warp: Warp
    objective: dict[ResidualMean, Fitted]
    scores: dict[ResidualMean, LeaveOneOut]
    restrictions: tuple[tuple[Fitted, Warp], ...]
    learned_at: int
    refitted_at: int

    def to_memory(self) -> Memory:
        """As JSON-able values."""
        return {
            "mean": self.mean.value,
            "objective_warp": _warp_to_list(self.objective_warp),
            "objective": {mean.value: _fitted_to_list(f) for mean, f in self.objective.items()},
            "leave_one_out": {m.value: [j.error, j.rho] for m, j in self.scores.items()},
            "restrictions": [[_fitted_to_list(f), _warp_to_list(w)] for f, w in self.restrictions],
            "learned_at": self.learned_at,
            "refitted_at": self.refitted_at,
        }

    @staticmethod
    def from_memory(memory: Memory) -> "Learned":
        """The inverse of `to_memory`."""
        return Learned(
            mean=ResidualMean(memory["mean"]),
            objective_warp=_warp_from_list(memory["objective_warp"]),
            objective={
                ResidualMean(m): _fitted_from_list(f) for m, f in memory["objective"].items()
            },
            scores={ResidualMean(m): LeaveOneOut(*j) for m, j in memory["leave_one_out"].items()},
            restrictions=tuple(
                (_fitted_from_list(f), _warp_from_list(w)) for f, w in memory["restrictions"]
            ),
            learned_at=memory["learned_at"],
            refitted_at=memory["refitted_at"],
        )


def learn(
    dataset: Dataset, trial: int, centre: float, before: Learned | None, batch: int = 1
) -> Learned:
    """Hyper-parameters for this data set, starting from what was known before.

    Parameters
    ----------
    trial
        How many evaluations there are in all, which sets the schedule.
    centre
        Value of the objective about which it may be warped: the best one.
    batch
        Trials from one call to the next.
    """
    if before is None or trial >= GROWTH_TO_RELEARN * before.learned_at:
        return _learn_afresh(dataset, trial, centre, before)
    return _refit(dataset, trial, before, batch)


def objective_rows(mean: ResidualMean, dataset: Dataset, warp: Warp) -> Observations:
    """What the process of the objective learns from, padded."""
    return observations_of(mean, dataset.points, dataset.objective, dataset.approximation, warp)


def restriction_rows(dataset: Dataset, column: int, warp: Warp) -> Observations:
    """What the process of one constraint learns from, padded."""
    count = len(dataset.points)
    basis = np.column_stack([np.ones(count), np.zeros(count)])
    values = warp(dataset.restrictions[:, column])
    return pad(dataset.points, values, basis, capacity_for(count))


def _learn_afresh(dataset: Dataset, trial: int, centre: float, before: Learned | None) -> Learned:
    means = available(dataset.approximation[np.isfinite(dataset.objective)])
    known = [] if before is None else list(before.objective.values())
    fitted, warp = _with_best_warp(
        dataset.objective,
        candidate_warps(dataset.objective, centre),
        lambda tried: objective_rows(means[-1], dataset, tried),
        known,
    )
    objective = {
        mean: fitted
        if mean is means[-1]
        else _from_several_starts(objective_rows(mean, dataset, warp), [fitted])
        for mean in means
    }
    restrictions = []
    fewer = dataset.nearest(MOST_RESTRICTION_ROWS)
    for column in range(fewer.restrictions.shape[1]):
        restrictions.append(
            _learn_restriction(
                fewer,
                column,
                [] if before is None else [f for f, _ in before.restrictions[column : column + 1]],
            )
        )
    learned = Learned(means[0], warp, objective, {}, tuple(restrictions), trial, trial)
    return _scored(dataset, learned)


def _learn_restriction(
    dataset: Dataset, column: int, known: Sequence[Fitted]
) -> tuple[Fitted, Warp]:
    values = dataset.restrictions[:, column]
    return _with_best_warp(
        values,
        candidate_warps(values, 0.0),
        lambda tried: restriction_rows(dataset, column, tried),
        known,
    )


def _with_best_warp(
    values: Float[np.ndarray, " rows"],
    warps: Sequence[Warp],
    rows: Callable[[Warp], Observations],
    known: Sequence[Fitted],
) -> tuple[Fitted, Warp]:
    """The warp under which the values are most likely, then a thorough fit under it."""
    first = standard_starts(rows(warps[0]).points.shape[-1])[:1]

    def log_density(warp: Warp) -> float:
        return fit(rows(warp), first, iterations=WARM_ITERATIONS)[1] + warp.log_jacobian(values)

    warp = max(warps, key=log_density) if len(warps) > 1 else warps[0]
    return _from_several_starts(rows(warp), known), warp


def _from_several_starts(observations: Observations, known: Sequence[Fitted]) -> Fitted:
    dimension = observations.points.shape[-1]
    warm = [np.array(one.parameters) for one in known if one.axes is None]
    fitted, density = fit(observations, [*standard_starts(dimension), *warm])
    return fit_with_axes(observations, fitted, density, known)[0]


def _refit(dataset: Dataset, trial: int, before: Learned, batch: int) -> Learned:
    restrictions = list(before.restrictions)
    fewer = dataset.nearest(MOST_RESTRICTION_ROWS)
    count = fewer.restrictions.shape[1]
    while len(restrictions) < count:  # the first failure adds an output
        restrictions.append(_learn_restriction(fewer, len(restrictions), []))
    for turn in [(trial + place) % count for place in range(min(batch, count))]:
        fitted, warp = restrictions[turn]
        restrictions[turn] = _warm(restriction_rows(fewer, turn, warp), fitted), warp
    learned = replace(before, restrictions=tuple(restrictions))
    if trial < before.refitted_at + OBJECTIVE_REFIT_EVERY:
        return learned
    objective = {
        mean: _warm(
            objective_rows(mean, dataset, before.objective_warp),
            before.objective.get(mean, before.objective[ResidualMean.PLAIN]),
        )
        for mean in available(dataset.approximation[np.isfinite(dataset.objective)])
    }
    return _scored(dataset, replace(learned, objective=objective, refitted_at=trial))


def _warm(observations: Observations, fitted: Fitted) -> Fitted:
    return fit(observations, [fitted.parameters], fitted.axes, WARM_ITERATIONS)[0]


def _scored(dataset: Dataset, learned: Learned) -> Learned:
    warp = learned.objective_warp
    warped = warp(dataset.objective)
    scores = {
        mean: leave_one_out(
            mean, objective_rows(mean, dataset, warp), fitted.hyperparameters(), warped
        )
        for mean, fitted in learned.objective.items()
    }
    best = min(scores, key=lambda mean: scores[mean].error)
    return replace(learned, mean=best, scores=scores)


def _warp_to_list(warp: Warp) -> list[float | None]:
    return [warp.centre, warp.scale if np.isfinite(warp.scale) else None]


def _warp_from_list(values: Sequence[float | None]) -> Warp:
    centre, scale = values
    return Warp(0.0 if centre is None else centre, np.inf if scale is None else scale)


def _fitted_to_list(fitted: Fitted) -> list[list[Any]]:
    return [list(fitted.parameters), [list(row) for row in fitted.axes or ()]]


def _fitted_from_list(values: Sequence[Sequence[Any]]) -> Fitted:
    parameters, axes = values
    return Fitted(tuple(parameters), tuple(tuple(row) for row in axes) if axes else None)
