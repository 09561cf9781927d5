"""Bayesian optimisation: learn from every evaluation, look where the bound is lowest.

Trials take turns between the whole box, where a lower confidence bound explores,
and a trust region around the best point, where the surrogate is exact enough to
refine it.

In a batch each point is chosen as if those before it had brought what the surrogate
expects of them: the "Kriging believer" of Ginsbourger et al. (2010), Kriging is
well-suited to parallelize optimization.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from camring.search.convergence import Convergence
from camring.search.learning import FEWEST_TO_LEARN_FROM, AbstractLearningSearch, Point
from camring.search.problem import Evaluation, Memory, Proposal, Stop
from camring.search.sampling import generator, sobol
from camring.search.surrogate.acquisition import Criterion, Region, apart, suggest
from camring.search.surrogate.hyper_parameters import Learned
from camring.search.surrogate.residual_mean import LeaveOneOut
from camring.search.surrogate.surrogate import Surrogate, build
from camring.search.trust_region import TrustRegion

EXPLORE, REFINE = "explore", "refine"
USUAL_CONVERGENCE = Convergence()


@dataclass(frozen=True)
class Bayesian(AbstractLearningSearch):
    """Gaussian processes for objective and constraints, asked by a lower confidence bound.

    Attributes
    ----------
    initial
        None is 2 dimension + 2.
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
    """

    mode: Literal["separate", "penalised"] = "separate"
    penalty_weight: float = 100.0
    kappa: float = 2.0
    refining_kappa: float = 1.0
    explore_every: int | None = None
    convergence: Convergence | None = USUAL_CONVERGENCE
    model_size: int = 256
    fit_size: int = 256
    separation: float = 1e-5

    def _next_batch(
        self, history: Sequence[Evaluation], memory: Memory, seed: int
    ) -> Proposal | Stop:
        """Points of the initial design, of the whole box, or near the best."""
        trial = len(history)
        initial = 2 * self.dimension + 2 if self.initial is None else self.initial
        learnable = sum(not evaluation.failed for evaluation in history)
        if trial < max(initial, len(self.given)) or learnable < FEWEST_TO_LEARN_FROM:
            count = max(initial - trial, len(self.given) - trial, self.batch)
            return Proposal.of_batch(self._design(history, count, seed), "initial", memory)
        if self.convergence is not None:
            reason = self.convergence.reason(history, initial, self.tolerance)
            if reason is not None:
                return Stop(reason)

        best = min(history, key=self._rank)
        dataset = self._dataset(history, best, self._penalty)
        learned = self._learned(dataset, dataset.nearest(self.fit_size), best, memory)
        trusted = self._trusted(history, memory)
        usual = self.explore_every or (2 if self._few else 4)
        period = usual if trusted.collapses == 0 else min(usual, 2)
        points: list[Point] = []
        steps: list[str] = []
        surrogate = self._conditioned(history, best, learned)
        for place in range(self.batch):
            if place > 0:
                history = [*history, self._believed(surrogate, points[-1], history)]
                surrogate = self._conditioned(history, best, learned)
            turn, rest = divmod(len(history) - initial, period)
            steps.append(EXPLORE if rest == 0 else REFINE)
            if steps[-1] == EXPLORE:
                region = Region.everything(self.dimension)
                criterion, starts = Criterion(self.kappa * (1 + turn % 2), caution=-1.0), 2
            else:
                region = trusted.around(best.point)
                criterion, starts = Criterion(self.refining_kappa, trusted.caution), 1
            random = generator(seed, len(history))
            found = suggest(surrogate, region, criterion, best.point, random, starts)
            taken = [one.point for one in history]
            points.append(self._apart([each.point for each in found], taken, seed))
        kept = {
            "learned": learned.to_memory(),
            "trust_region": trusted.to_memory(),
            "steps": steps,
        }
        return Proposal.of_batch(points, "bayesian", kept)

    def _rank(self, evaluation: Evaluation) -> tuple[float, float]:
        """Sorts evaluations, best first, by what this mode minimises."""
        if self.mode == "separate" or evaluation.failed:
            return evaluation.rank(self.tolerance)
        excess = np.maximum(evaluation.constraints, 0.0)
        return 0.0, evaluation.objective + self.penalty_weight * float(np.sum(excess**2))

    @property
    def _penalty(self) -> float | None:
        return self.penalty_weight if self.mode == "penalised" else None

    def _conditioned(
        self, history: Sequence[Evaluation], best: Evaluation, learned: Learned
    ) -> Surrogate:
        dataset = self._dataset(history, best, self._penalty)
        return build(dataset.nearest(self.model_size), learned, self.approximate)

    def _believed(
        self, surrogate: Surrogate, point: Point, history: Sequence[Evaluation]
    ) -> Evaluation:
        """What is expected of the point, for those chosen after it in its batch."""
        expected = surrogate.expected(point, len(history))
        if self.mode == "penalised":  # its objective has the penalty in it already
            return replace(expected, constraints=np.zeros_like(history[-1].constraints))
        return expected

    def _trusted(self, history: Sequence[Evaluation], memory: Memory) -> TrustRegion:
        """The trust region after what the last batch brought."""
        if "trust_region" not in memory:
            return TrustRegion()
        trusted = TrustRegion(**memory["trust_region"])
        steps: list[str] = memory["steps"] if "steps" in memory else [memory["step"]]
        begun = len(history) - len(steps)
        lead = min(map(self._rank, history[:begun]))
        brought = list(zip(steps, history[begun:], strict=True))
        refined = [one for step, one in brought if step == REFINE]
        if any(step == EXPLORE and self._rank(one) < lead for step, one in brought):
            trusted = trusted.after_discovery()
        if not refined:
            return trusted
        improved = any(self._rank(one) < lead for one in refined)
        return trusted.after_step(improved, refined[0].feasible(self.tolerance))

    def _elsewhere(
        self, around: Point, before: Float[np.ndarray, "points dimension"], seed: int
    ) -> Point:
        anywhere = sobol(64, self.dimension, generator(seed, len(before), stream=1))
        free = (other for other in anywhere if apart(other, before, self.separation))
        return next(free, anywhere[0])


def leave_one_out_errors(memory: Memory) -> tuple[str, dict[str, LeaveOneOut]]:
    """Which residual mean a search uses, and the leave-one-out errors that chose it.

    Empty before the first surrogate. Searches the memories of stages too.
    """
    for part in [memory, *reversed(memory.get("memories", []))]:
        if "learned" in part:
            learned = Learned.from_memory(part["learned"])
            return learned.mean.value, {m.value: scores for m, scores in learned.scores.items()}
    return "", {}
