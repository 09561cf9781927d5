"""Bayesian optimisation: learn from every evaluation, look where the bound is lowest.

Trials take turns between the whole box, where a lower confidence bound explores,
and a trust region around the best point, where the surrogate is exact enough to
refine it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from camring.search.acquisition import Criterion, Region, apart, suggest
from camring.search.convergence import Convergence
from camring.search.dataset import Dataset, collect
from camring.search.learning import Learned, learn
from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Points,
    Proposal,
    Stop,
)
from camring.search.residual_mean import LeaveOneOut
from camring.search.sampling import generator, initial_point, sobol
from camring.search.surrogate import Surrogate, build
from camring.search.threads import one_linear_algebra_thread
from camring.search.trust_region import TrustRegion

EXPLORE, REFINE = "explore", "refine"
FEWEST_TO_LEARN_FROM = 3
FEW_DIMENSIONS = 6
USUAL_CONVERGENCE = Convergence()


@dataclass(frozen=True)
class Bayesian(AbstractStrategy):
    """Gaussian processes for objective and constraints, asked by a lower confidence bound.

    Attributes
    ----------
    approximate
        Cheap approximation of the objective, (k, dimension) to (k,); None when
        there is none. It is called with only a few different k.
    given
        Points to evaluate first, before Sobol's.
    initial
        Evaluations before the first surrogate, the given ones included; None
        is 2 dimension + 2.
    mode
        "separate" learns each constraint by a process of its own. "penalised"
        learns ``objective + penalty_weight sum max(0, constraint)^2`` by one: for
        comparison, since one process cannot follow the cliff of a penalty.
    kappa, refining_kappa
        Deviations taken off the mean in the whole box and in the trust region.
        In the whole box kappa is doubled every other time.
    explore_every
        One trial in so many looks at the whole box; None is 2 up to six
        dimensions and 4 above, where most of the box is beyond reach anyway.
    model_size, fit_size
        At most so many evaluations enter the surrogate, and the likelihood.
    separation
        No point is proposed within this Euclidean distance of an earlier one.
    tolerance
        Violation up to which a constraint counts as satisfied.
    """

    dimension: int
    approximate: Callable[[Points], Float[np.ndarray, " points"]] | None = None
    given: tuple[tuple[float, ...], ...] = ()
    initial: int | None = None
    mode: Literal["separate", "penalised"] = "separate"
    penalty_weight: float = 100.0
    kappa: float = 2.0
    refining_kappa: float = 1.0
    explore_every: int | None = None
    convergence: Convergence | None = USUAL_CONVERGENCE
    model_size: int = 256
    fit_size: int = 256
    separation: float = 1e-5
    tolerance: float = 0.0

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next point: of the initial design, of the whole box, or near the best."""
        with one_linear_algebra_thread():
            return self._next(history, memory, seed)

    def _next(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        trial = len(history)
        initial = 2 * self.dimension + 2 if self.initial is None else self.initial
        learnable = sum(not evaluation.failed for evaluation in history)
        if trial < max(initial, len(self.given)) or learnable < FEWEST_TO_LEARN_FROM:
            point = initial_point(trial, self.dimension, seed, self.given)
            return Proposal(self._apart(point, (), history, seed), "initial")
        if self.convergence is not None:
            reason = self.convergence.reason(history, initial, self.tolerance)
            if reason is not None:
                return Stop(reason)

        best = min(history, key=self._rank)
        surrogate = self._surrogate(history, best, memory)
        trusted = self._trusted(history, best, memory)
        usual = self.explore_every or (2 if self.dimension <= FEW_DIMENSIONS else 4)
        period = usual if trusted.collapses == 0 else min(usual, 2)
        turn, rest = divmod(trial - initial, period)
        step = EXPLORE if rest == 0 else REFINE
        if step == EXPLORE:
            region = Region.everything(self.dimension)
            criterion = Criterion(self.kappa * (1 + turn % 2), caution=-1.0)
        else:
            region = trusted.around(best.point)
            criterion = Criterion(self.refining_kappa, trusted.caution)
        random = generator(seed, trial)
        suggestions = suggest(
            surrogate, region, criterion, best.point, random, starts=2 if step == EXPLORE else 1
        )
        point = self._apart(
            suggestions[0].point, [one.point for one in suggestions[1:]], history, seed
        )
        kept = {
            "learned": surrogate.learned.to_memory(),
            "trust_region": trusted.to_memory(),
            "step": step,
        }
        return Proposal(point, "bayesian", kept)

    def _rank(self, evaluation: Evaluation) -> tuple[float, float]:
        """Sorts evaluations, best first, by what this mode minimises."""
        if self.mode == "separate" or evaluation.failed:
            return evaluation.rank(self.tolerance)
        excess = np.maximum(evaluation.constraints, 0.0)
        return 0.0, evaluation.objective + self.penalty_weight * float(np.sum(excess**2))

    def _surrogate(
        self, history: Sequence[Evaluation], best: Evaluation, memory: Memory
    ) -> Surrogate:
        weight = self.penalty_weight if self.mode == "penalised" else None
        dataset: Dataset = collect(history, best.point, weight)
        if self.approximate is None:
            dataset = dataset.without_approximation()
        before = Learned.from_memory(memory["learned"]) if "learned" in memory else None
        centre = float(dataset.objective[best.trial])
        learned = learn(dataset.nearest(self.fit_size), len(history), centre, before)
        return build(dataset.nearest(self.model_size), learned, self.approximate)

    def _trusted(
        self, history: Sequence[Evaluation], best: Evaluation, memory: Memory
    ) -> TrustRegion:
        """The trust region after the last trial."""
        if "trust_region" not in memory:
            return TrustRegion()
        trusted, last = TrustRegion(**memory["trust_region"]), history[-1]
        improved = last is best
        if memory["step"] == REFINE:
            return trusted.after_step(improved, last.feasible(self.tolerance))
        return trusted.after_discovery() if improved else trusted

    def _apart(
        self,
        point: Float[np.ndarray, " dimension"],
        alternatives: Sequence[Float[np.ndarray, " dimension"]],
        history: Sequence[Evaluation],
        seed: int,
    ) -> Float[np.ndarray, " dimension"]:
        """The point, or the first alternative, that is not where one was evaluated already."""
        evaluated = np.array([evaluation.point for evaluation in history])
        if apart(point, evaluated, self.separation):
            return point
        anywhere = sobol(64, self.dimension, generator(seed, len(history), stream=1))
        for other in (*alternatives, *anywhere):
            if apart(other, evaluated, self.separation):
                return other
        return anywhere[0]


def leave_one_out_errors(memory: Memory) -> tuple[str, dict[str, LeaveOneOut]]:
    """Which residual mean a search uses, and the leave-one-out errors that chose it.

    Empty before the first surrogate. Searches the memories of stages too.
    """
    for part in [memory, *reversed(memory.get("memories", []))]:
        if "learned" in part:
            learned = Learned.from_memory(part["learned"])
            return learned.mean.value, {m.value: judged for m, judged in learned.judged.items()}
    return "", {}
