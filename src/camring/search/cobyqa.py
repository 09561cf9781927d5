"""Descent without slopes: quadratic models of objective and constraints, in a trust region.

SciPy's COBYQA (Ragonneau and Zhang 2024), a successor of Powell's methods. Constraints
stay constraints. Its first 2 dimension + 1 points stand along the axes; from then on every
evaluation mends the models.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float
from scipy.optimize import Bounds, NonlinearConstraint, minimize

from camring.search.problem import (
    AbstractStrategy,
    Evaluation,
    Memory,
    Proposal,
    Stop,
    best_of,
)
from camring.search.replay import Unknown, on_grid
from camring.search.threads import one_linear_algebra_thread

Point: TypeAlias = Float[np.ndarray, " dimension"]

INSIDE = 2e-7  # what it keeps of every limit: it may end a rounding error beyond one
PHASE = "cobyqa"
MOST = 10_000  # evaluations: never the reason why it ends


@dataclass(frozen=True)
class Cobyqa(AbstractStrategy):
    """Refines one point: the best that it finds in the history when it begins.

    Attributes
    ----------
    start
        Where to begin when there is no history; None is the middle of the box.
    step
        Radius of the trust region at first, in box widths.
    smallest
        Radius at which it ends.
    tolerance
        Violation up to which a constraint counts as satisfied.
    """

    dimension: int
    start: tuple[float, ...] | None = None
    step: float = 0.1
    smallest: float = 1e-5
    tolerance: float = 0.0

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The first point of the descent that is not in the history."""
        if not history:
            first = np.full(self.dimension, 0.5) if self.start is None else np.array(self.start)
            return Proposal(np.clip(first, 0.0, 1.0), PHASE)
        if "start" not in memory:
            best = best_of(history, self.tolerance)
            if best is None:
                return Stop("Every evaluation so far has failed: there is nothing to refine.")
            memory = {"start": best.trial, "begun": len(history)}
        with one_linear_algebra_thread():
            return self._descended(history, memory)

    def _descended(self, history: Sequence[Evaluation], memory: Memory) -> Proposal | Stop:
        start, begun = history[memory["start"]], memory["begun"]
        known = {on_grid(each.point).tobytes(): each for each in history[:begun]}
        answers = iter(history[begun:])  # in the order in which it asked
        scale = 1 / max(abs(start.objective), np.finfo(float).tiny)
        worst = start

        def at(point: Point) -> Evaluation:
            """Of what was evaluated there; for a failure the worst objective before it."""
            nonlocal worst
            within = on_grid(point)
            key = within.tobytes()
            if key not in known:
                answer = next(answers, None)
                if answer is None:
                    raise Unknown(within)
                known[key] = answer
            found = known[key]
            if not found.failed and found.objective > worst.objective:
                worst = found
            return found

        def objective(point: Point) -> float:
            found = at(point)
            return scale * (worst.objective if found.failed else found.objective)

        def constraints(point: Point) -> Float[np.ndarray, " constraint"]:
            found = at(point)
            return np.ones_like(found.constraints) if found.failed else found.constraints + INSIDE

        limits = NonlinearConstraint(constraints, -np.inf, 0.0)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                ended = minimize(
                    objective,
                    start.point,
                    bounds=Bounds(np.zeros(self.dimension), np.ones(self.dimension)),
                    constraints=limits if len(start.constraints) else (),
                    method="COBYQA",
                    options={
                        "initial_tr_radius": self.step,
                        "final_tr_radius": self.smallest,
                        "feasibility_tol": self.tolerance + INSIDE,
                        "maxfev": MOST,
                    },
                )
        except Unknown as unknown:
            return Proposal(unknown.point, PHASE, memory)
        return Stop(f"The descent by quadratic models has ended: {ended.message}")
