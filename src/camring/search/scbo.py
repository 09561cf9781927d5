"""Constrained Bayesian search in a trust region, in batches: for expensive models.

Of the family of TuRBO (Eriksson et al. 2019) and SCBO (Eriksson and Poloczek 2021):
one Gaussian process for the objective and one for each constraint, under warps that
make them easier to learn; a brick around the best point, longer where the objective
changes slowly, that grows with success and shrinks with failure; Thompson sampling
in it. Three things are added. One point of each batch is not drawn but descended to
by the slopes of the processes, which is what makes the last digits cheap; where points
are chosen one by one most of them are, and now and then one is where the whole box
promises most, whatever the brick. A known approximation of the objective may serve as
its prior mean.

When the brick has become too small to matter, the search begins again elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from camring.search.learning import FEWEST_TO_LEARN_FROM, AbstractLearningSearch, Point
from camring.search.problem import Evaluation, Memory, Proposal
from camring.search.sampling import generator
from camring.search.surrogate.acquisition import (
    Criterion,
    Region,
    apart,
    spread_candidates,
    suggest,
)
from camring.search.surrogate.hyper_parameters import Learned
from camring.search.surrogate.surrogate import Surrogate, build
from camring.search.surrogate.thompson import best_of_draw, draws
from camring.search.trust_region import TrustRegion

CANDIDATES = 512
MOST_STRETCHED = 4.0  # longest over mean edge of the brick, and mean over shortest
SURPRISING = 0.5  # deviations taken off the objective's mean by every other descent
WORTHWHILE = 1e-4  # gain of the objective, or of the violation, relative
SMALLEST = 0.005  # mean edge of the brick, in box widths; a smaller one begins anew elsewhere
EVERY_FEW, EVERY_MANY = 2, 4  # one draw in so many is of the whole box
FIRST_OF_MANY = 0.4  # edge at first, above few dimensions: a corner of a large box is far away
MOST_DESCENTS = 3  # between two points that are none, where points are chosen one by one
HOPEFUL, LENIENT = 2.0, -1.0  # deviations off objective and limits for a point of the whole box
INITIAL, SEARCHING = "initial", "scbo"
BATCH, DESCENT, DRAW, EXPLORATION = "batch", "descent", "draw", "look"


@dataclass(frozen=True)
class Scbo(AbstractLearningSearch):
    """Batches of points: one descended to, the others drawn.

    Attributes
    ----------
    initial
        Of each restart's design, too; None is dimension + 2, or one batch if that is more.
    batch
        With 1, up to three descents, the more the more dimensions, are followed by a point of the
        whole box, or, above six dimensions, in turn by one and by a draw.
    model_size
        At most so many evaluations, mostly the nearest, enter the processes: a proposal
        after 1000 evaluations takes no longer than one after 200.
    patience
        Batches without a better point that halve the brick; None is half the
        dimension over the batch, at least 3.
    """

    model_size: int = 192
    patience: int | None = None

    @property
    def _descents(self) -> int:
        return min(max(self.dimension // 2, 1), MOST_DESCENTS)

    def _next_batch(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal:
        trial = len(history)
        since, region = memory.get("since", 0), self._region(history, memory)
        if region.collapses > memory.get("collapses", 0):
            since, memory = trial, {"learned": memory["learned"]}
        missing = self._initial(trial) - (trial - since)
        learnable = sum(not one.failed for one in history[since:])
        kept = {
            "since": since,
            "begun": trial,
            "collapses": region.collapses,
            "region": region.to_memory(),
            **({"learned": memory["learned"]} if "learned" in memory else {}),
        }
        if missing > 0 or learnable < FEWEST_TO_LEARN_FROM:
            return Proposal.of_batch(
                self._design(history, max(missing, self.batch), seed), INITIAL, kept
            )
        best = min(history[since:], key=lambda one: one.rank(self.tolerance))
        surrogate = self._surrogate(history, best, memory)
        kept["learned"] = surrogate.learned.to_memory()
        kept["kind"] = kind = self._kind(trial - since)
        points = self._points(history, surrogate, region, best.point, seed, kind)
        return Proposal.of_batch(points, SEARCHING, kept)

    def _initial(self, trial: int) -> int:
        wanted = self.dimension + 2 if self.initial is None else self.initial
        return max(wanted, self.batch, len(self.given), FEWEST_TO_LEARN_FROM)

    def _region(self, history: Sequence[Evaluation], memory: Memory) -> TrustRegion:
        """The brick after what the last batch brought."""
        if memory.get("phase") != SEARCHING:
            kept = memory.get("region")
            return TrustRegion(**kept) if kept else self._first()
        since, begun = memory["since"], memory["begun"]
        infeasible, value = min(one.rank(self.tolerance) for one in history[since:begun])
        batch = history[begun:]
        # A gain that is none to speak of does not keep a brick from collapsing.
        worth = (infeasible, value - WORTHWHILE * abs(value))
        improved = min(one.rank(self.tolerance) for one in batch) < worth
        if memory.get("kind") == EXPLORATION:
            region = TrustRegion(**memory["region"])
            return region.after_discovery() if improved else region
        patience = self.patience or max(3, -(-self.dimension // (2 * self.batch)))
        before = TrustRegion(**memory["region"])
        after = before.after_step(improved, batch[0].feasible(self.tolerance), patience, SMALLEST)
        if after.collapses > before.collapses:
            return replace(after, length=self._first().length)
        return after

    def _first(self) -> TrustRegion:
        return TrustRegion() if self._few else TrustRegion(FIRST_OF_MANY)

    def _kind(self, place: int) -> str:
        """Of the next point, if points are chosen one by one."""
        if self.batch > 1:
            return BATCH
        turn, rest = divmod(place, self._descents + 1)
        if rest < self._descents:
            return DESCENT
        return EXPLORATION if self._few or turn % 2 else DRAW

    def _surrogate(
        self, history: Sequence[Evaluation], best: Evaluation, memory: Memory
    ) -> Surrogate:
        dataset = self._dataset(history, best)
        near = dataset.nearest(self.model_size)
        return build(near, self._learned(dataset, near, best, memory), self.approximate)

    def _points(
        self,
        history: Sequence[Evaluation],
        surrogate: Surrogate,
        trusted: TrustRegion,
        centre: Point,
        seed: int,
        kind: str,
    ) -> list[Point]:
        trial = len(history)
        region = trusted.around(centre, self._shape(surrogate.learned))
        turn = trial // self.batch
        criterion, starts = Criterion(SURPRISING * (turn % 2), trusted.caution), 1
        if kind == EXPLORATION:
            region = Region.everything(self.dimension)
            turn = trial // (self._descents + 1)
            criterion, starts = Criterion(HOPEFUL * (1 + turn % 2), LENIENT), 2
        found: list[Point] = []
        if kind != DRAW:
            suggestions = suggest(
                surrogate, region, criterion, centre, generator(seed, trial), starts
            )
            taken = [one.point for one in history]
            found.append(self._apart([each.point for each in suggestions], taken, seed))
        if len(found) < self.batch:
            only_here = kind == DRAW
            found += self._drawn(history, surrogate, region, centre, found, turn, seed, only_here)
        return found

    def _drawn(
        self,
        history: Sequence[Evaluation],
        surrogate: Surrogate,
        region: Region,
        centre: Point,
        before: Sequence[Point],
        turn: int,
        seed: int,
        only_here: bool,
    ) -> list[Point]:
        """The best points of draws: in the brick, and if wanted every so many in the whole box."""
        random = generator(seed, len(history), 2)
        count = self.batch - len(before)
        period = EVERY_FEW if self._few else EVERY_MANY
        anywhere = (turn * count + np.arange(count)) % period == period - 1
        anywhere &= not only_here
        found: list[Point] = []
        for place in (Region.everything(self.dimension), region):
            wanted = int(np.sum(anywhere if place is not region else ~anywhere))
            if wanted == 0:
                continue
            candidates = spread_candidates(place, centre, random, CANDIDATES)
            many = draws(surrogate, candidates, random, wanted)
            scale = np.maximum(np.std(many, axis=(0, 1)), 1e-300)
            for drawn in many:
                ranked = candidates[best_of_draw(drawn, scale)]
                taken = [*(one.point for one in history), *before, *found]
                found.append(self._apart(list(ranked), taken, seed))
        return found

    def _shape(self, learned: Learned) -> Point:
        """Edges of the brick over their geometric mean: as the lengthscales of the objective."""
        fitted = learned.objective[learned.mean]
        lengthscales = np.exp(np.array(fitted.parameters[:-1]))
        along = np.sqrt(np.sum((fitted.axes_array() / lengthscales) ** 2, axis=1))
        shape = np.exp(np.mean(np.log(along))) / along
        return np.clip(shape, 1 / MOST_STRETCHED, MOST_STRETCHED)

    def _elsewhere(
        self, around: Point, before: Float[np.ndarray, "points dimension"], seed: int
    ) -> Point:
        random = generator(seed, len(before), stream=1)
        for width in 2.0 ** np.arange(-16, 1):
            step = width * (random.random(self.dimension) - 0.5)
            point = np.clip(around + step, 0.0, 1.0)
            if apart(point, before, self.separation):
                return point
        return random.random(self.dimension)
