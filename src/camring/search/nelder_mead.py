"""Nelder and Mead's downhill simplex, inside a box and under constraints.

Values stay in the history; the memory holds the vertices, each with its trial
number, and the move that the last proposal belonged to. That is the whole
state, so a search can be stopped at any trial and goes on with the same bits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from camring.search.nelder_mead_moves import (
    Coefficients,
    along,
    diameter,
    flatness,
    shrunk,
    start_simplex,
    to_angles,
    to_box,
)
from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Proposal,
    Stop,
    best_of,
)

FLAT = 1e-9  # a simplex flatter than this searches a subspace only
SAME_POINT = 1e-12  # box widths; nearer points share one evaluation

Rank = tuple[float, float]
Angles = tuple[float, ...]


class Move(StrEnum):
    """What the last proposal was for."""

    BUILD = "build"
    REFLECT = "reflect"
    EXPAND = "expand"
    CONTRACT_OUTSIDE = "contract outside"
    CONTRACT_INSIDE = "contract inside"
    SHRINK = "shrink"


class Vertex(NamedTuple):
    """An evaluated corner of the simplex."""

    trial: int
    angles: Angles


@dataclass(frozen=True)
class State:
    """Where the search stands.

    Attributes
    ----------
    simplex
        Best vertex first, unless being built.
    queue
        Angles of vertices still to be evaluated while building or shrinking.
    reflected
        The reflected vertex while expanding or contracting.
    best_at_restart
        Trial that was best when the simplex was last built anew; -1 before.
    """

    move: Move
    simplex: tuple[Vertex, ...]
    queue: tuple[Angles, ...] = ()
    reflected: Vertex | None = None
    restarts: int = 0
    best_at_restart: int = -1

    def to_memory(self) -> Memory:
        """As JSON-able values."""
        return {
            "move": self.move.value,
            "simplex": [[vertex.trial, list(vertex.angles)] for vertex in self.simplex],
            "queue": [list(angles) for angles in self.queue],
            "reflected": self.reflected and [self.reflected.trial, list(self.reflected.angles)],
            "restarts": self.restarts,
            "best_at_restart": self.best_at_restart,
        }

    @staticmethod
    def from_memory(memory: Memory) -> "State":
        """The inverse of `to_memory`."""
        reflected = memory["reflected"]
        return State(
            Move(memory["move"]),
            tuple(Vertex(trial, tuple(angles)) for trial, angles in memory["simplex"]),
            tuple(tuple(angles) for angles in memory["queue"]),
            Vertex(reflected[0], tuple(reflected[1])) if reflected else None,
            memory["restarts"],
            memory["best_at_restart"],
        )

    @property
    def vertices(self) -> Float[np.ndarray, "vertices dimension"]:
        """Angles of all vertices."""
        return np.array([vertex.angles for vertex in self.simplex])


@dataclass(frozen=True)
class NelderMead(AbstractStrategy):
    """Refines the best point known, or `start`, by a simplex of its own size.

    Attributes
    ----------
    step
        Edge of the first simplex, in box widths.
    smallest
        The search has converged when no vertex is further from the best than
        this along any axis.
    restarts
        How often a converged or flattened simplex is built anew around the best
        point; a restart that gains nothing is the last.
    penalty_weight
        None compares feasible before infeasible, then by objective, then by
        violation. A number compares ``objective + weight sum max(0, constraint)^2``.
    coefficients
        None for those adapted to the dimension.
    tolerance
        Violation up to which a constraint counts as satisfied.
    """

    dimension: int
    start: tuple[float, ...] | None = None
    step: float = 0.05
    smallest: float = 1e-5
    restarts: int = 2
    penalty_weight: float | None = None
    coefficients: Coefficients | None = None
    tolerance: float = 0.0

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next vertex to evaluate. No chance is involved; the seed has no effect."""
        del seed
        if memory:
            state = self._absorbed(State.from_memory(memory), len(history) - 1, history)
        elif (best := best_of(history, self.tolerance)) is not None:
            state = _built_around(best, self.step)
        elif not history:
            first = np.full(self.dimension, 0.5) if self.start is None else np.array(self.start)
            corners = np.vstack([to_angles(first), start_simplex(first, self.step)])
            state = State(Move.BUILD, (), _rows(corners))
        else:
            return Stop("Nothing to refine: every evaluation so far has failed.")
        while True:
            if state.move is Move.REFLECT:
                outcome = self._rebuilt_if_done(state, history)
                if isinstance(outcome, Stop):
                    return outcome
                state = outcome
            point = to_box(np.array(self._wanted(state)))
            known = _trial_at(point, history)
            if known is None:
                return Proposal(point, "nelder-mead", state.to_memory())
            state = self._absorbed(state, known, history)

    def ahead(self, trial: int, memory: Memory) -> list[Float[np.ndarray, " dimension"]]:
        """Vertices of a simplex that is being built or shrunk; every other move is one point."""
        queue = memory.get("queue", ())
        return [to_box(np.array(angles)) for angles in queue[1:]]

    def rank(self, evaluation: Evaluation) -> Rank:
        """What the simplex compares; smaller is better."""
        if self.penalty_weight is None or evaluation.failed:
            return evaluation.rank(self.tolerance)
        excess = np.maximum(evaluation.constraints, 0.0)
        return 0.0, evaluation.objective + self.penalty_weight * float(np.sum(excess**2))

    def _wanted(self, state: State) -> Angles:
        """The vertex that the state asks for."""
        if state.queue:
            return state.queue[0]
        far = self.coefficients or Coefficients.adapted_to(self.dimension)
        factor = {
            Move.REFLECT: far.reflection,
            Move.EXPAND: far.reflection * far.expansion,
            Move.CONTRACT_OUTSIDE: far.reflection * far.contraction,
            Move.CONTRACT_INSIDE: -far.contraction,
        }[state.move]
        vertices = state.vertices
        return _row(along(vertices[-1], vertices[:-1], factor))

    def _absorbed(self, state: State, trial: int, history: Sequence[Evaluation]) -> State:
        """The state after the wanted vertex was evaluated as this trial."""
        vertex = Vertex(trial, self._wanted(state))
        if state.move in (Move.BUILD, Move.SHRINK):
            simplex, queue = (*state.simplex, vertex), state.queue[1:]
            if queue:
                return replace(state, simplex=simplex, queue=queue)
            return self._reflecting(replace(state, queue=()), simplex, history)
        rank = self.rank(history[trial])
        best, second_worst, worst = (
            self.rank(history[state.simplex[place].trial]) for place in (0, -2, -1)
        )
        if state.reflected is None:
            if best <= rank < second_worst:
                return self._accepted(state, vertex, history)
            if rank < best:
                move = Move.EXPAND
            else:
                move = Move.CONTRACT_OUTSIDE if rank < worst else Move.CONTRACT_INSIDE
            return replace(state, move=move, reflected=vertex)
        reflected = self.rank(history[state.reflected.trial])
        if state.move is Move.EXPAND:
            return self._accepted(state, vertex if rank < reflected else state.reflected, history)
        if rank <= reflected if state.move is Move.CONTRACT_OUTSIDE else rank < worst:
            return self._accepted(state, vertex, history)
        far = self.coefficients or Coefficients.adapted_to(self.dimension)
        shrinking = _rows(shrunk(state.vertices[0], state.vertices[1:], far.shrink))
        return replace(
            state, move=Move.SHRINK, simplex=state.simplex[:1], queue=shrinking, reflected=None
        )

    def _accepted(self, state: State, vertex: Vertex, history: Sequence[Evaluation]) -> State:
        """The worst vertex replaced."""
        return self._reflecting(state, (*state.simplex[:-1], vertex), history)

    def _reflecting(
        self, state: State, simplex: Sequence[Vertex], history: Sequence[Evaluation]
    ) -> State:
        """Ready to reflect, the vertices sorted best first."""
        ordered = sorted(simplex, key=lambda vertex: self.rank(history[vertex.trial]))
        return replace(state, move=Move.REFLECT, simplex=tuple(ordered), reflected=None)

    def _rebuilt_if_done(self, state: State, history: Sequence[Evaluation]) -> State | Stop:
        """The same state, a new simplex around the best point, or the end."""
        size = diameter(state.vertices)
        small = size < self.smallest
        if not small and flatness(state.vertices) > FLAT:
            return state
        best = state.simplex[0].trial
        if state.restarts >= self.restarts or best == state.best_at_restart:
            return Stop(
                f"The simplex has {'shrunk' if small else 'flattened'} to {size:.1e} box widths"
                f" after {state.restarts} restarts."
            )
        step = max(self.step * 0.2 ** (state.restarts + 1), 10 * self.smallest)
        rebuilt = _built_around(history[best], step)
        return replace(rebuilt, restarts=state.restarts + 1, best_at_restart=best)


def _built_around(best: Evaluation, step: float) -> State:
    first = Vertex(best.trial, _row(to_angles(best.point)))
    return State(Move.BUILD, (first,), _rows(start_simplex(best.point, step)))


def _row(angles: Float[np.ndarray, " dimension"]) -> Angles:
    return tuple(float(angle) for angle in angles)


def _rows(angles: Float[np.ndarray, "rows dimension"]) -> tuple[Angles, ...]:
    return tuple(_row(row) for row in angles)


def _trial_at(point: Float[np.ndarray, " dimension"], history: Sequence[Evaluation]) -> int | None:
    """The trial that already evaluated this point, if any."""
    for evaluation in history:
        if np.max(np.abs(evaluation.point - point)) <= SAME_POINT:
            return evaluation.trial
    return None
