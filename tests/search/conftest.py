"""Problems with published optima, and one as thin as a displacement band."""

import numpy as np
import pytest

from camring.search.bayesian import Bayesian
from camring.search.minimise import minimise
from camring.search.problem import Problem


def on_unit_box(objective, lower, upper, constraints=None, count=0, approximation=None):
    """A `Problem` from functions of a point in the problem's own units."""
    lower, upper = np.array(lower, dtype=float), np.array(upper, dtype=float)

    def evaluate(points):
        outputs = []
        for point in points:
            x = lower + (upper - lower) * point
            values = np.array(constraints(x) if constraints else [], dtype=float)
            guess = float(approximation(x)) if approximation else np.nan
            outputs.append((float(objective(x)), values, guess, None))
        return outputs

    def approximate(points):
        return np.array([approximation(lower + (upper - lower) * point) for point in points])

    return Problem(len(lower), count, evaluate, approximate if approximation else None)


def branin_value(x):
    return (
        (x[1] - 5.1 / (4 * np.pi**2) * x[0] ** 2 + 5 / np.pi * x[0] - 6) ** 2
        + 10 * (1 - 1 / (8 * np.pi)) * np.cos(x[0])
        + 10
    )


@pytest.fixture(scope="session")
def branin():
    """Minimum 0.397887 at three points. Dixon and Szego (1978)."""
    return on_unit_box(branin_value, [-5, 0], [10, 15])


@pytest.fixture(scope="session")
def branin_found(branin):
    """One search that several tests look at."""
    return minimise(branin, Bayesian(branin.dimension, convergence=None), budget=40, seed=0)


@pytest.fixture(scope="session")
def hartmann6():
    """Minimum -3.32237. Dixon and Szego (1978)."""
    weights = np.array([1.0, 1.2, 3.0, 3.2])
    curvature = np.array(
        [
            [10, 3, 17, 3.5, 1.7, 8],
            [0.05, 10, 17, 0.1, 8, 14],
            [3, 3.5, 1.7, 10, 17, 8],
            [17, 8, 0.05, 10, 0.1, 14],
        ]
    )
    centre = 1e-4 * np.array(
        [
            [1312, 1696, 5569, 124, 8283, 5886],
            [2329, 4135, 8307, 3736, 1004, 9991],
            [2348, 1451, 3522, 2883, 3047, 6650],
            [4047, 8828, 8732, 5743, 1091, 381],
        ]
    )

    def value(x):
        return -np.sum(weights * np.exp(-np.sum(curvature * (x - centre) ** 2, axis=1)))

    return on_unit_box(value, [0] * 6, [1] * 6)


@pytest.fixture(scope="session")
def townsend():
    """Minimum -2.02399 in a region shaped like a bean. Townsend (2014)."""

    def value(x):
        return -(np.cos((x[0] - 0.1) * x[1]) ** 2) - x[0] * np.sin(3 * x[0] + x[1])

    def excess(x):
        t = np.arctan2(x[0], x[1])
        along = 2 * np.cos(t) - np.cos(2 * t) / 2 - np.cos(3 * t) / 4 - np.cos(4 * t) / 8
        return [x[0] ** 2 + x[1] ** 2 - along**2 - (2 * np.sin(t)) ** 2]

    return on_unit_box(value, [-2.25, -2.5], [2.25, 1.75], excess, 1)


@pytest.fixture(scope="session")
def disc():
    """The point of the unit disc nearest to (1, 1): squared distance 2 (1 - 1/sqrt 2)^2."""

    def value(x):
        return (x[0] - 1) ** 2 + (x[1] - 1) ** 2

    def excess(x):
        return [x[0] ** 2 + x[1] ** 2 - 1]

    return on_unit_box(value, [-2, -2], [2, 2], excess, 1)


@pytest.fixture(scope="session")
def g07():
    """Ten variables, eight constraints, six active; 3e-6 of the box is feasible.

    Minimum 24.3062. Hock and Schittkowski (1981), problem 113.
    """

    def value(x):
        return (
            x[0] ** 2 + x[1] ** 2 + x[0] * x[1] - 14 * x[0] - 16 * x[1] + (x[2] - 10) ** 2
            + 4 * (x[3] - 5) ** 2 + (x[4] - 3) ** 2 + 2 * (x[5] - 1) ** 2 + 5 * x[6] ** 2
            + 7 * (x[7] - 11) ** 2 + 2 * (x[8] - 10) ** 2 + (x[9] - 7) ** 2 + 45
        )  # fmt: skip

    def excess(x):
        return np.array([
            4 * x[0] + 5 * x[1] - 3 * x[6] + 9 * x[7] - 105,
            10 * x[0] - 8 * x[1] - 17 * x[6] + 2 * x[7],
            -8 * x[0] + 2 * x[1] + 5 * x[8] - 2 * x[9] - 12,
            3 * (x[0] - 2) ** 2 + 4 * (x[1] - 3) ** 2 + 2 * x[2] ** 2 - 7 * x[3] - 120,
            5 * x[0] ** 2 + 8 * x[1] + (x[2] - 6) ** 2 - 2 * x[3] - 40,
            x[0] ** 2 + 2 * (x[1] - 2) ** 2 - 2 * x[0] * x[1] + 14 * x[4] - 6 * x[5],
            (x[0] - 8) ** 2 / 2 + 2 * (x[1] - 4) ** 2 + 3 * x[4] ** 2 - x[5] - 30,
            -3 * x[0] + 6 * x[1] + 12 * (x[8] - 8) ** 2 - 7 * x[9],
        ]) / [105, 100, 12, 120, 40, 100, 30, 100]  # fmt: skip

    return on_unit_box(value, [-10] * 10, [10] * 10, excess, 8)


THIN_SLAB_MINIMUM = 0.0259158  # best of 60 gradient searches from random starts


@pytest.fixture(scope="session")
def thin_slab():
    """Harmonics squared, curvatures apart by a thousand, in a band of +-1 % of a linear function.

    Six combinations of ten variables stand for the harmonics of a ripple, the
    band for a displacement that has to be kept.
    """
    random = np.random.default_rng(5)
    mixing = random.normal(size=(6, 10))
    height = np.array([3, 2, 1, 0.5, 0.3, 0.2])
    quiet = 0.3 + 0.4 * random.random(10)
    slope = np.abs(random.normal(size=10)) + 0.3
    slope /= slope.sum()
    wanted = 0.5 + slope @ quiet + 0.06

    def value(x):
        phase = mixing @ (x - quiet)
        harmonics = height * (phase + 0.3 * np.sin(2 * phase) + 0.1 * phase**2)
        regular = 0.05 * np.sum((x - quiet) ** 2) + 0.1 * np.sum((x - 0.5) ** 2)
        return np.sum(harmonics**2) + regular

    def band(x):
        share = (0.5 + slope @ x) / wanted
        return [share / 1.01 - 1, 1 - share / 0.99]

    def guess(x):
        return np.sum((height * (mixing @ (x - quiet))) ** 2)

    return on_unit_box(value, [0] * 10, [1] * 10, band, 2, guess)


@pytest.fixture(scope="session")
def thin_slab_minimum():
    """The best that gradients find."""
    return THIN_SLAB_MINIMUM


@pytest.fixture(scope="session")
def thin_slab_found(thin_slab):
    """One search that several tests of the long run look at."""
    strategy = Bayesian(thin_slab.dimension, convergence=None)
    return minimise(thin_slab, strategy, budget=220, seed=0)
