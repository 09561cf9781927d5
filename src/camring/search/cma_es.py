"""Evolution by an adapted covariance matrix: CMA-ES, without a process or a slope.

Hansen (2016), The CMA evolution strategy: a tutorial, with its default constants and
without negative weights. A library's object would have to be kept between
two evaluations; here the whole state is a few lists of numbers in the memory, so a
study goes on with the same bits after a kill, as with every other strategy.

Constraints enter by rank: a feasible point beats an infeasible one, and of two
infeasible ones the lesser violation wins (Deb 2000). Coordinates beyond the box are
reflected at its walls.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from camring.search.problem import AbstractStrategy, Evaluation, Memory, Proposal, Stop
from camring.search.sampling import generator, initial_point

AT_FIRST = 0.25  # standard deviation along each axis, in box widths
SMALLEST = 1e-9  # standard deviation along the longest axis; then it begins anew
GROWTH = 2  # of the population at each restart; Auger and Hansen (2005)


@dataclass(frozen=True)
class CmaEs(AbstractStrategy):
    """Generations of normal deviates whose mean and covariance follow the better half.

    Attributes
    ----------
    given
        Points to evaluate first; the best of the initial design is the first mean.
    initial
        Points of the initial design; None is dimension + 2.
    population
        Points of a generation; None is 4 + 3 log(dimension).
    batch
        Workers: a generation is a multiple of it, so that none of them waits.
    """

    dimension: int
    given: tuple[tuple[float, ...], ...] = ()
    initial: int | None = None
    population: int | None = None
    batch: int = 1
    tolerance: float = 0.0

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next point of the generation; after its last one, the first of another."""
        return Proposal.waiting(memory) or self._generation(history, memory, seed)

    def _generation(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal:
        trial = len(history)
        if not memory:
            wanted = self.dimension + 2 if self.initial is None else self.initial
            count = max(wanted, len(self.given), 1)
            points = [initial_point(i, self.dimension, seed, self.given) for i in range(count)]
            return Proposal.of_batch(points, "initial", {})
        random = generator(seed, trial)
        if "mean" not in memory:
            best = min(history, key=lambda one: one.rank(self.tolerance))
            state = self._fresh(best.point, self._usual_population())
        else:
            state = self._updated(history[memory["begun"] :], memory)
            if _width(state) < SMALLEST:
                state = self._fresh(random.random(self.dimension), GROWTH * state["population"])
        mean = np.array(state["mean"])
        roots, axes = _principal(np.array(state["covariance"]))
        steps = (random.normal(size=(state["population"], self.dimension)) * roots) @ axes.T
        steps *= state["sigma"]
        points = [reflected(mean + step) for step in steps]
        kept = {**state, "begun": trial, "steps": steps.tolist()}
        return Proposal.of_batch(points, "cma-es", kept)

    def _usual_population(self) -> int:
        usual = self.population or 4 + int(3 * math.log(max(self.dimension, 1)))
        return -(-max(usual, 4) // self.batch) * self.batch

    def _fresh(self, mean: Float[np.ndarray, " dimension"], population: int) -> dict[str, Any]:
        nothing = [0.0] * self.dimension
        return {
            "mean": mean.tolist(),
            "sigma": AT_FIRST,
            "covariance": np.eye(self.dimension).tolist(),
            "path": nothing,
            "sigma_path": nothing,
            "generation": 0,
            "population": population,
        }

    def _updated(self, generation: Sequence[Evaluation], memory: Memory) -> dict[str, Any]:
        """Mean, step size and covariance after a generation. Hansen (2016), figure 6."""
        n, population, sigma = self.dimension, memory["population"], memory["sigma"]
        weights = np.log((population + 1) / 2) - np.log(np.arange(1, population // 2 + 1))
        weights /= np.sum(weights)
        effective = 1 / np.sum(weights**2)
        c_sigma = (effective + 2) / (n + effective + 5)
        damping = 1 + 2 * max(0.0, math.sqrt((effective - 1) / (n + 1)) - 1) + c_sigma
        c_path = (4 + effective / n) / (n + 4 + 2 * effective / n)
        c_one = 2 / ((n + 1.3) ** 2 + effective)
        c_mu = min(1 - c_one, 2 * (effective - 2 + 1 / effective) / ((n + 2) ** 2 + effective))
        expected = math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n**2))

        order = sorted(range(population), key=lambda i: generation[i].rank(self.tolerance))
        steps = np.array(memory["steps"])[order[: len(weights)]] / sigma
        covariance = np.array(memory["covariance"])
        roots, axes = _principal(covariance)
        step = weights @ steps
        count = memory["generation"] + 1
        sigma_path = (1 - c_sigma) * np.array(memory["sigma_path"]) + math.sqrt(
            c_sigma * (2 - c_sigma) * effective
        ) * (axes @ ((axes.T @ step) / roots))
        length = float(np.linalg.norm(sigma_path))
        usual = math.sqrt(1 - (1 - c_sigma) ** (2 * count)) * (1.4 + 2 / (n + 1)) * expected
        moving = float(length < usual)
        path = (1 - c_path) * np.array(memory["path"])
        path = path + moving * math.sqrt(c_path * (2 - c_path) * effective) * step
        lost = (1 - moving) * c_path * (2 - c_path)
        covariance = (
            (1 - c_one - c_mu + c_one * lost) * covariance
            + c_one * np.outer(path, path)
            + c_mu * (steps.T * weights) @ steps
        )
        grown = sigma * math.exp(min(1.0, c_sigma / damping * (length / expected - 1)))
        return {
            "mean": reflected(np.array(memory["mean"]) + sigma * step).tolist(),
            "sigma": min(grown, 1.0),
            "covariance": ((covariance + covariance.T) / 2).tolist(),
            "path": path.tolist(),
            "sigma_path": sigma_path.tolist(),
            "generation": count,
            "population": population,
        }


def reflected(point: Float[np.ndarray, " dimension"]) -> Float[np.ndarray, " dimension"]:
    """The point folded back into the unit box at its walls."""
    folded = np.mod(point, 2.0)
    return np.asarray(np.clip(np.where(folded > 1.0, 2.0 - folded, folded), 0.0, 1.0))


def _principal(
    covariance: Float[np.ndarray, "dimension dimension"],
) -> tuple[Float[np.ndarray, " dimension"], Float[np.ndarray, "dimension dimension"]]:
    values, axes = np.linalg.eigh(covariance)
    return np.sqrt(np.maximum(values, 1e-20)), axes


def _width(state: Memory) -> float:
    return float(state["sigma"] * np.sqrt(np.max(np.diagonal(np.array(state["covariance"])))))
