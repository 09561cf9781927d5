"""Searches by Gaussian processes that live in an environment of their own (torch, SMT)."""

import math
import warnings
from contextlib import suppress

import numpy as np

from benchmarks.search.oracle import Oracle

PENALTY = 10.0
"""Of a unit of excess, in spreads of the objective over the first points."""


def smt_ego(oracle: Oracle) -> str:
    """SMT's efficient global optimisation (Bouhlel et al. 2019), on a penalised objective.

    It takes no constraints: their sum of excess is added, in ten spreads of the
    objective, which keeps minima where they are unless a limit is dearer than that.
    """
    from smt.applications import EGO
    from smt.design_space import DesignSpace
    from smt.surrogate_models import KRG

    warnings.simplefilter("ignore")
    first = oracle.design(2 * oracle.dimension + 2)
    values = np.array([oracle.objective(point) for point in first])
    weight = PENALTY * float(np.subtract(*np.percentile(values, [75, 25])))

    def penalised(points: np.ndarray) -> np.ndarray:
        found = [oracle(point) for point in np.atleast_2d(points)]
        return np.array([[j + weight * np.sum(np.maximum(g, 0))] for j, g in found])

    box = DesignSpace([[0.0, 1.0]] * oracle.dimension, seed=oracle.seed)
    ego = EGO(
        n_iter=10 * oracle.budget,
        criterion="EI",
        xdoe=first,
        ydoe=penalised(first),
        surrogate=KRG(design_space=box, print_global=False, n_start=3),
        n_start=10,
        n_max_optim=10,
        seed=oracle.seed,
    )
    ego.optimize(fun=penalised)
    return "EGO has ended."


def botorch_scbo(oracle: Oracle, batch: int = 4) -> str:
    """SCBO as BoTorch's tutorial has it (Eriksson and Poloczek 2021), batches of four.

    Trust region, one process for the objective and one for each constraint, Thompson
    sampling over perturbed Sobol candidates.
    """
    import torch
    from botorch.exceptions.errors import ModelFittingError
    from botorch.fit import fit_gpytorch_mll
    from botorch.generation.sampling import (
        ConstrainedMaxPosteriorSampling,
        MaxPosteriorSampling,
    )
    from botorch.models import ModelListGP, SingleTaskGP
    from botorch.models.transforms.outcome import Standardize
    from gpytorch.constraints import Interval
    from gpytorch.kernels import MaternKernel, ScaleKernel
    from gpytorch.likelihoods import GaussianLikelihood
    from gpytorch.mlls import ExactMarginalLogLikelihood
    from torch.quasirandom import SobolEngine

    warnings.simplefilter("ignore")
    torch.set_num_threads(1)
    torch.manual_seed(oracle.seed)
    kind = torch.double
    dimension = oracle.dimension

    def fitted(points: "torch.Tensor", values: "torch.Tensor") -> SingleTaskGP:
        model = SingleTaskGP(
            points,
            values,
            covar_module=ScaleKernel(
                MaternKernel(
                    nu=2.5, ard_num_dims=dimension, lengthscale_constraint=Interval(0.005, 4.0)
                )
            ),
            likelihood=GaussianLikelihood(noise_constraint=Interval(1e-8, 1e-3)),
            outcome_transform=Standardize(m=1),
        )
        with suppress(ModelFittingError):  # then with the hyper-parameters that it starts from
            fit_gpytorch_mll(ExactMarginalLogLikelihood(model.likelihood, model))
        return model

    def evaluated(points: np.ndarray) -> list[tuple[float, np.ndarray]]:
        return [oracle(point) for point in points]

    def rank(pair: tuple[float, np.ndarray]) -> tuple[float, float]:
        excess = float(np.sum(np.maximum(pair[1], 0.0)))
        return (0.0, pair[0]) if excess <= 0 else (1.0, excess)

    engine = SobolEngine(dimension, scramble=True, seed=oracle.seed)
    points = oracle.design(2 * dimension + 2)
    known = evaluated(points)
    failures_allowed = math.ceil(max(4.0 / batch, dimension / batch))
    since, length, successes, failures = 0, 0.8, 0, 0
    lead = min(map(rank, known))
    while True:
        here, values = torch.tensor(points[since:], dtype=kind), known[since:]
        objective = torch.tensor([[-j] for j, _ in values], dtype=kind)
        limits = torch.tensor(np.array([g for _, g in values]), dtype=kind)
        model = fitted(here, objective)
        centre = here[min(range(len(values)), key=lambda i: rank(values[i]))]
        low, high = torch.clamp(centre - length / 2, 0, 1), torch.clamp(centre + length / 2, 0, 1)
        count = min(5000, max(2000, 200 * dimension))
        spread = low + (high - low) * engine.draw(count, dtype=kind)
        moved = torch.rand(count, dimension, dtype=kind) <= min(20.0 / dimension, 1.0)
        still = torch.where(~moved.any(dim=1))[0]
        moved[still, torch.randint(0, dimension, (len(still),))] = True
        candidates = torch.where(moved, spread, centre)
        if oracle.constraint_count:
            of_limits = ModelListGP(*[fitted(here, each[:, None]) for each in limits.T])
            draw = ConstrainedMaxPosteriorSampling(model, of_limits, replacement=False)
        else:
            draw = MaxPosteriorSampling(model, replacement=False)
        with torch.no_grad():
            chosen = draw(candidates, num_samples=batch).numpy()
        new = evaluated(chosen)
        points, known = np.concatenate([points, chosen]), known + new
        best = min(map(rank, new))
        better = best < (lead[0], lead[1] - 1e-3 * abs(lead[1]))
        successes, failures = (successes + 1, 0) if better else (0, failures + 1)
        lead = min(lead, best)
        if successes == 10:
            length, successes = min(2 * length, 1.6), 0
        elif failures == failures_allowed:
            length, failures = length / 2, 0
        if length < 0.5**7:  # begins anew elsewhere, from points of the same Sobol sequence
            since, length, successes, failures = len(points), 0.8, 0, 0
            again = engine.draw(2 * dimension + 2, dtype=kind).numpy()
            points, known = np.concatenate([points, again]), known + evaluated(again)
            lead = min(map(rank, known[since:]))
