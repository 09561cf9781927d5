"""Ask for the next point, tell what came of it: a search that somebody else drives.

`minimise` calls the function itself. Where the function is a test rig, a queue of
jobs or another program's loop, that program keeps the loop and this keeps the search.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Proposal,
    Stop,
    best_of,
)


class AskTell:
    """A strategy with its history, its memory and its seed.

    Parameters
    ----------
    constraint_count
        How many constraints come with every objective.
    seed
        The only source of chance.
    history, memory
        Of an earlier search to be continued; the points that follow have the same
        bits as if it had never been interrupted.
    """

    def __init__(
        self,
        strategy: AbstractStrategy,
        constraint_count: int = 0,
        seed: int = 0,
        history: Sequence[Evaluation] = (),
        memory: Memory | None = None,
    ) -> None:
        self._strategy = strategy
        self._constraint_count = constraint_count
        self._seed = seed
        self._history = list(history)
        self._memory: Memory = dict(memory or {})
        self._asked: Proposal | None = None

    @property
    def history(self) -> tuple[Evaluation, ...]:
        """Every evaluation that was reported, in order."""
        return tuple(self._history)

    @property
    def memory(self) -> Memory:
        """With it and the history the search can be continued; JSON-able."""
        return self._memory

    def best(self, tolerance: float = 0.0) -> Evaluation | None:
        """The feasible evaluation of lowest objective, else the least violation."""
        return best_of(self._history, tolerance)

    def ask(self) -> Float[np.ndarray, " dimension"] | Stop:
        """The next point of the unit box, the same until its value is known; or why none."""
        if self._asked is None:
            answer = self._strategy.propose(self._history, self._memory, self._seed)
            if isinstance(answer, Stop):
                return answer
            self._asked = answer
        return np.array(self._asked.point, dtype=float)

    def ahead(self) -> list[Float[np.ndarray, " dimension"]]:
        """Points that come after the one last asked for, whatever is reported of it."""
        if self._asked is None:
            return []
        return self._strategy.ahead(len(self._history) + 1, self._asked.memory)

    def tell(
        self,
        objective: float,
        constraints: Sequence[float] | Float[np.ndarray, " constraints"] = (),
        failure: str | None = None,
        *,
        approximation: float = np.nan,
    ) -> Evaluation:
        """Keeps what came of the point last asked for; the evaluation as it stands now.

        Parameters
        ----------
        objective
            What is to be minimised; NaN counts as a failure.
        constraints
            Each is satisfied when it is at most 0; may be left out of a failure.
        failure
            Why there are no numbers, in words.
        approximation
            A cheap approximation of the objective at the point, where there is one.

        Raises
        ------
        ValueError
            When no point was asked for, or the number of constraints is another.
        """
        if self._asked is None:
            raise ValueError("no point is waiting for an answer: ask() before every tell()")
        values = np.asarray(constraints, dtype=float).reshape(-1)
        if failure is not None and len(values) == 0:
            values = np.full(self._constraint_count, np.nan)
        if len(values) != self._constraint_count:
            raise ValueError(
                f"{len(values)} constraints were given, but the search has {self._constraint_count}"
            )
        if failure is None and not np.isfinite(objective):
            failure = f"the objective is {objective}"
        if failure is None and not np.all(np.isfinite(values)):
            failure = f"constraint {int(np.argmin(np.isfinite(values)))} is not finite"
        evaluation = Evaluation(
            len(self._history),
            self._asked.point,
            float(objective),
            values,
            float(approximation),
            failure,
            self._asked.phase,
        )
        self._history.append(evaluation)
        self._memory = self._asked.memory
        self._asked = None
        return evaluation
