"""Every method by its name, with how expensive its own thinking is."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from benchmarks.search import ours, rivals, rivals_learning
from benchmarks.search.oracle import Oracle
from benchmarks.search.problem import SearchProblem


@dataclass(frozen=True)
class Method:
    """One searcher.

    Attributes
    ----------
    run
        Evaluates through the oracle until it stops, with the reason, or raises `Spent`.
    is_ours
        Whether it is camring's.
    with_slopes
        Whether it asks for exact slopes.
    only_motors
        Whether it needs the reduced model, which published problems have not.
    cost
        Of its own thinking: 0 next to nothing, 1 seconds to minutes a run, 2 more.
    share
        Of a problem's budget that it is given: the dearest cannot be afforded more.
    """

    run: Callable[[Oracle], str]
    is_ours: bool = False
    with_slopes: bool = False
    only_motors: bool = False
    cost: int = 0
    share: float = 1.0

    def budget(self, problem: SearchProblem) -> int:
        """Evaluations of a run on the problem."""
        if self.cost == 0 and problem.long_budget is not None:
            return problem.long_budget
        return round(self.share * problem.budget)


def _ours(name: str, **more: Any) -> Method:
    model = more.get("only_motors", False)
    return Method(partial(ours.run, name=name, reduced_model=model), is_ours=True, **more)


METHODS = {
    "gradient": _ours("gradient", with_slopes=True),
    "bayesian": _ours("bayesian", cost=1),
    "bayesian + model": _ours("bayesian", only_motors=True, cost=1),
    "scbo": _ours("scbo", cost=1),
    "scbo + model": _ours("scbo", only_motors=True, cost=1),
    "differences": _ours("differences"),
    "cma-es": _ours("cma-es"),
    "nelder-mead": _ours("nelder-mead"),
    "SLSQP, differences": Method(rivals.slsqp),
    "COBYQA": Method(rivals.cobyqa),
    "SciPy DE": Method(rivals.scipy_de),
    "pycma": Method(rivals.pycma),
    "pymoo GA": Method(rivals.pymoo_ga),
    "pymoo ISRES": Method(rivals.pymoo_isres),
    "Optuna TPE": Method(rivals.optuna_tpe),
    "Optuna GP": Method(rivals.optuna_gp, cost=1, share=0.5),
    "SMT EGO": Method(rivals_learning.smt_ego, cost=2, share=0.5),
    "BoTorch SCBO": Method(rivals_learning.botorch_scbo, cost=1),
}
