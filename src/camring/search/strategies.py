"""Every strategy by its name: a new one is a file of its own and a line here."""

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from jaxtyping import Float

from camring.search.bayesian import Bayesian
from camring.search.cma_es import CmaEs
from camring.search.cobyqa import Cobyqa
from camring.search.descent.gradient import GradientSearch
from camring.search.descent.path import Slopes
from camring.search.hybrid import Hybrid, Stage
from camring.search.nelder_mead import NelderMead
from camring.search.problem import AbstractStrategy, Points
from camring.search.scbo import Scbo

SHARE_OF_REFINEMENT = 0.2  # of a Bayesian search's budget, for the descent at its end
FIRST_STEP = 0.25  # box widths, of a descent that begins where nothing is known
REFINING_STEP = 0.05  # box widths: a first step of that descent
LEARNING, LEARNING_EACH = 30, 4  # evaluations, and of each variable, before descents by differences
FEW_VARIABLES = 6  # up to which processes need fewer evaluations than differences
FEWEST_STEPS = 5  # of a descent that is worth its beginning


@dataclass(frozen=True)
class Task:
    """What a strategy may want to know before it begins.

    Attributes
    ----------
    given
        Points of the unit box to evaluate first.
    approximate
        Cheap approximation of the objective, (k, dimension) to (k,), or None.
    slopes
        Gradients of objective and constraints at a point, or None.
    batch
        Points to choose at once: as many as there are workers.
    """

    dimension: int
    budget: int
    given: tuple[tuple[float, ...], ...] = ()
    approximate: Callable[[Points], Float[np.ndarray, " points"]] | None = None
    slopes: Slopes | None = None
    batch: int = 1


def then_descent(learning: Bayesian, budget: int, share: float = SHARE_OF_REFINEMENT) -> Hybrid:
    """A Bayesian search whose last share of the budget refines its best point by COBYQA.

    With batches it is a share of the time: that descent has use for one worker only.
    """
    first = max(budget - int(share * budget / learning.batch), len(learning.given))
    descent = Cobyqa(learning.dimension, step=REFINING_STEP, tolerance=learning.tolerance)
    return Hybrid((Stage(learning, first), Stage(descent, None)))


def _bayesian(task: Task) -> AbstractStrategy:
    learning = Bayesian(
        task.dimension, approximate=task.approximate, given=task.given, batch=task.batch
    )
    return then_descent(learning, task.budget)


def _nelder_mead(task: Task) -> AbstractStrategy:
    return NelderMead(task.dimension, start=task.given[0] if task.given else None)


def _cobyqa(task: Task) -> AbstractStrategy:
    return Cobyqa(task.dimension, start=task.given[0] if task.given else None, step=FIRST_STEP)


def _scbo(task: Task) -> AbstractStrategy:
    return Scbo(task.dimension, approximate=task.approximate, given=task.given, batch=task.batch)


def _differences(task: Task) -> AbstractStrategy:
    """Processes find where to begin, descents by differences go on, then processes again.

    Processes have the last word where a model is too noisy for differences, too.
    """
    learning = _scbo(task)
    descents = GradientSearch(task.dimension)
    stages = (Stage(learning, _learning(task)), Stage(descents), Stage(learning))
    return Hybrid(stages)


def _learning(task: Task) -> int:
    return max(LEARNING, LEARNING_EACH * task.dimension, len(task.given))


def _automatic(task: Task) -> AbstractStrategy:
    """Descents where there are many variables, evaluations for some steps, and no better guide."""
    steps = (task.budget - _learning(task)) / (task.dimension + 1)
    if task.dimension <= FEW_VARIABLES or steps < FEWEST_STEPS or task.approximate is not None:
        return _scbo(task)
    return _differences(task)


def _cma_es(task: Task) -> AbstractStrategy:
    return CmaEs(task.dimension, given=task.given, batch=task.batch)


def _gradient(task: Task) -> AbstractStrategy:
    if task.slopes is None:
        raise ValueError("gradient needs slopes, and there are none; use bayesian")
    return GradientSearch(task.dimension, task.slopes, task.given)


STRATEGIES: dict[str, Callable[[Task], AbstractStrategy]] = {
    "automatic": _automatic,
    "bayesian": _bayesian,
    "cma-es": _cma_es,
    "cobyqa": _cobyqa,
    "differences": _differences,
    "gradient": _gradient,
    "nelder-mead": _nelder_mead,
    "scbo": _scbo,
}


def strategy_named(name: str, task: Task) -> AbstractStrategy:
    """The strategy of this name, ready for a task.

    Raises
    ------
    ValueError
        When there is none of the name, or the task lacks what it needs.
    """
    if name not in STRATEGIES:
        close = get_close_matches(name, STRATEGIES, n=1)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        raise ValueError(f"there is no strategy {name!r}{hint}; choose {', '.join(STRATEGIES)}")
    return STRATEGIES[name](task)
