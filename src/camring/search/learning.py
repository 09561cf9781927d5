"""What searches have in common that learn a surrogate from every evaluation, in batches."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from camring.search.problem import AbstractStrategy, Evaluation, Memory, Points, Proposal, Stop
from camring.search.sampling import initial_point
from camring.search.surrogate.acquisition import apart
from camring.search.surrogate.dataset import Dataset, collect
from camring.search.surrogate.hyper_parameters import Learned, learn
from camring.search.threads import one_linear_algebra_thread

Point = Float[np.ndarray, " dimension"]

FEWEST_TO_LEARN_FROM = 3
FEW_DIMENSIONS = 6


@dataclass(frozen=True)
class AbstractLearningSearch(AbstractStrategy):
    """A batch of points at a time, chosen by a surrogate of all evaluations before it.

    Attributes
    ----------
    approximate
        Cheap approximation of the objective, (k, dimension) to (k,); None when there is
        none. Whether and how far it is believed is decided by leave-one-out errors.
    given
        Points to evaluate first, before Sobol's.
    initial
        Evaluations before the first surrogate, the given ones included; None leaves it to
        the search.
    batch
        Points chosen at once, none of which knows the others' results.
    separation
        No point is proposed within this Euclidean distance of an earlier one.
    tolerance
        Violation up to which a constraint counts as satisfied.
    """

    dimension: int
    approximate: Callable[[Points], Float[np.ndarray, " points"]] | None = None
    given: tuple[tuple[float, ...], ...] = ()
    initial: int | None = None
    batch: int = 1
    separation: float = 1e-6
    tolerance: float = 0.0

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next point of the batch at hand; when it is used up, the first of a new one."""
        if (waiting := Proposal.waiting(memory)) is not None:
            return waiting
        with one_linear_algebra_thread():
            return self._next_batch(history, memory, seed)

    @abstractmethod
    def _next_batch(
        self, history: Sequence[Evaluation], memory: Memory, seed: int
    ) -> Proposal | Stop:
        """The first of points chosen together."""

    @abstractmethod
    def _elsewhere(
        self, around: Point, before: Float[np.ndarray, "points dimension"], seed: int
    ) -> Point:
        """A random point where every one that was wanted has been evaluated before."""

    @property
    def _few(self) -> bool:
        return self.dimension <= FEW_DIMENSIONS

    def _design(self, history: Sequence[Evaluation], count: int, seed: int) -> list[Point]:
        """Points that lean on no evaluation; later ones go on in the same Sobol sequence."""
        taken = [one.point for one in history]
        for place in range(len(history), len(history) + count):
            point = initial_point(place, self.dimension, seed, self.given)
            taken.append(self._apart([point], taken, seed))
        return taken[len(history) :]

    def _dataset(
        self, history: Sequence[Evaluation], best: Evaluation, penalty: float | None = None
    ) -> Dataset:
        """All evaluations, seen from the best; limits as a penalty in the objective if wanted."""
        dataset = collect(history, best.point, penalty)
        return dataset.without_approximation() if self.approximate is None else dataset

    def _learned(
        self, dataset: Dataset, near: Dataset, best: Evaluation, memory: Memory
    ) -> Learned:
        """Hyper-parameters from the near part of a dataset, warm from those in the memory."""
        before = Learned.from_memory(memory["learned"]) if "learned" in memory else None
        centre = float(dataset.objective[best.trial])
        return learn(near, len(dataset.objective), centre, before, self.batch)

    def _apart(self, wanted: Sequence[Point], taken: Sequence[Point], seed: int) -> Point:
        """The first that is not where something was evaluated or will be; else a random one."""
        before = np.array(taken).reshape(-1, self.dimension)
        for point in wanted:
            if apart(point, before, self.separation):
                return point
        return self._elsewhere(wanted[0], before, seed)
