"""Other libraries' searches: evolution, interpolation models, differences.

Each begins from the same first points as ours of the same seed: a population is filled
with them, a local method evaluates them and starts at the best.
"""

import warnings
from collections.abc import Iterator

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, differential_evolution, minimize

from benchmarks.search.oracle import Oracle
from benchmarks.search.problem import TOLERANCE

SOBOL_STARTS = 8  # as camring's own descents
FIRST_STEP = 0.25  # box widths, as camring's own evolution


def slsqp(oracle: Oracle) -> str:
    """SciPy's SLSQP with forward differences, from starts in turn as camring's own descents."""
    seen: list[np.ndarray] = []
    for start in _starts(oracle):
        scale = 1 / max(abs(oracle.objective(start)), np.finfo(float).tiny)
        for _ in range(3):
            found = minimize(
                lambda point, scale=scale: scale * oracle.objective(point),
                start,
                bounds=Bounds(0.0, 1.0),
                constraints=[{"type": "ineq", "fun": lambda point: -oracle.constraints(point)}]
                if oracle.constraint_count
                else [],
                method="SLSQP",
                options={"maxiter": 100, "ftol": 1e-7, "eps": 1e-6},
            )
            start = np.clip(found.x, 0.0, 1.0)
            if found.success:
                break
        seen.append(start)
    return f"{len(seen)} descents have ended."


def _starts(oracle: Oracle) -> Iterator[np.ndarray]:
    """In turn the best one left and the one farthest from all starts so far."""
    left = list(oracle.ranked(oracle.design(SOBOL_STARTS + len(oracle.given))))
    gone: list[np.ndarray] = []
    while left:
        place = 0
        if len(gone) % 2:
            apart = np.linalg.norm(np.array(left)[:, None] - np.array(gone), axis=-1)
            place = int(np.argmax(apart.min(axis=1)))
        gone.append(left.pop(place))
        yield gone[-1]


def cobyqa(oracle: Oracle) -> str:
    """SciPy's COBYQA (Ragonneau and Zhang 2024), begun again from the next best start."""
    starts = oracle.ranked(oracle.design(oracle.dimension + 2))
    limits = (
        NonlinearConstraint(oracle.constraints, -np.inf, 0.0) if oracle.constraint_count else ()
    )
    for start in starts:
        scale = 1 / max(abs(oracle.objective(start)), np.finfo(float).tiny)
        minimize(
            lambda point, scale=scale: scale * oracle.objective(point),
            start,
            bounds=Bounds(0.0, 1.0),
            constraints=limits,
            method="COBYQA",
            options={
                "initial_tr_radius": FIRST_STEP,
                "feasibility_tol": TOLERANCE,
                "maxfev": 10 * oracle.budget,
            },
        )
    return f"{len(starts)} descents have ended."


def scipy_de(oracle: Oracle) -> str:
    """SciPy's differential evolution; 15 members an axis would be one generation."""
    count = max(10, 2 * oracle.dimension)
    limits = (
        NonlinearConstraint(oracle.constraints, -np.inf, 0.0) if oracle.constraint_count else ()
    )
    differential_evolution(
        oracle.objective,
        Bounds(np.zeros(oracle.dimension), np.ones(oracle.dimension)),
        constraints=limits,
        init=oracle.design(count),
        rng=oracle.seed,
        tol=0,
        maxiter=10 * oracle.budget,
        polish=False,
    )
    return "Differential evolution has ended."


def pycma(oracle: Oracle) -> str:
    """CMA-ES of Hansen's own library, its augmented Lagrangian for constraints."""
    import cma

    start = oracle.ranked(oracle.design(oracle.dimension + 2))[0]
    options = {
        "bounds": [0, 1],
        "seed": oracle.seed + 1,  # 0 would mean the clock
        "verbose": -9,
        "maxfevals": 10 * oracle.budget,
    }
    if oracle.constraint_count:
        cma.fmin_con2(
            oracle.objective,
            start,
            FIRST_STEP,
            constraints=lambda point: list(oracle.constraints(point)),
            options=options,
        )
    else:
        cma.fmin2(oracle.objective, start, FIRST_STEP, options)
    return "pycma has ended."


def pymoo_ga(oracle: Oracle) -> str:
    """pymoo's genetic algorithm: a feasible design beats an infeasible one (Deb 2000)."""
    return _pymoo(oracle, "GA")


def pymoo_isres(oracle: Oracle) -> str:
    """pymoo's improved stochastic ranking (Runarsson and Yao 2005)."""
    return _pymoo(oracle, "ISRES")


def _pymoo(oracle: Oracle, which: str) -> str:
    from pymoo.algorithms.soo.nonconvex.ga import GA
    from pymoo.algorithms.soo.nonconvex.isres import ISRES
    from pymoo.core.problem import ElementwiseProblem
    from pymoo.optimize import minimize as evolve

    class Wrapped(ElementwiseProblem):
        def __init__(self) -> None:
            super().__init__(
                n_var=oracle.dimension,
                n_obj=1,
                n_ieq_constr=oracle.constraint_count,
                xl=np.zeros(oracle.dimension),
                xu=np.ones(oracle.dimension),
            )

        def _evaluate(self, x, out, *args, **kwargs) -> None:
            out["F"], out["G"] = oracle(x)

    if which == "GA":
        algorithm = GA(pop_size=20, sampling=oracle.design(20))
    else:
        algorithm = ISRES(n_offsprings=21, rule=1 / 7, sampling=oracle.design(21))
    evolve(Wrapped(), algorithm, ("n_gen", 10 * oracle.budget), seed=oracle.seed, verbose=False)
    return "pymoo has ended."


def optuna_tpe(oracle: Oracle) -> str:
    """Optuna's tree of Parzen estimators, multivariate, given the constraints."""
    import optuna

    return _optuna(
        oracle,
        lambda first, limits: optuna.samplers.TPESampler(
            seed=oracle.seed,
            n_startup_trials=first,
            multivariate=True,
            constraints_func=limits,
        ),
    )


def optuna_gp(oracle: Oracle) -> str:
    """Optuna's Gaussian process sampler, given the constraints and that nothing is noise."""
    import optuna
    import torch

    torch.set_num_threads(1)
    return _optuna(
        oracle,
        lambda first, limits: optuna.samplers.GPSampler(
            seed=oracle.seed,
            n_startup_trials=first,
            deterministic_objective=True,
            constraints_func=limits,
        ),
    )


def _optuna(oracle: Oracle, sampler) -> str:
    import optuna

    warnings.simplefilter("ignore")  # parts of it are called experimental, others deprecated
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    first = 2 * oracle.dimension + 2
    limits = (lambda trial: trial.user_attrs["limits"]) if oracle.constraint_count else None
    study = optuna.create_study(sampler=sampler(first, limits))
    names = [f"x{i:02d}" for i in range(oracle.dimension)]
    for point in oracle.design(first):
        study.enqueue_trial(dict(zip(names, map(float, point), strict=True)))
    while True:
        trial = study.ask()
        point = np.array([trial.suggest_float(name, 0.0, 1.0) for name in names])
        objective, constraints = oracle(point)
        trial.set_user_attr("limits", list(map(float, constraints)))
        study.tell(trial, objective)
