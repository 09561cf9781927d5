"""Problems of the literature, with their optima as published.

Constraints are in the form g <= 0, divided by a constant where their size would drown
the tolerance; every method sees the same numbers. Slopes come from JAX.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.search.problem import Point, SearchProblem, ValueAt

jax.config.update("jax_enable_x64", True)
BUDGET_OF_TWO, BUDGET = 100, 150  # evaluations, for two variables and for more
Function = Callable[[jax.Array], tuple[jax.Array, list]]


def _problem(
    name: str,
    low: list[float],
    high: list[float],
    both: Function,
    best: float,
    minimiser: list[float],
    source: str,
) -> SearchProblem:
    lower, upper = np.array(low, dtype=float), np.array(high, dtype=float)

    def at(point: jax.Array) -> tuple[jax.Array, jax.Array]:
        objective, constraints = both(lower + (upper - lower) * point)
        return objective, jnp.array(constraints, dtype=float).reshape(-1)

    values, slopes = jax.jit(at), jax.jit(jax.jacfwd(at))

    def evaluate(point: Point) -> ValueAt:
        objective, constraints = values(point)
        return ValueAt(float(objective), np.asarray(constraints))

    def sloped(point: Point) -> tuple[np.ndarray, np.ndarray]:
        of_objective, of_constraints = slopes(point)
        return np.asarray(of_objective), np.asarray(of_constraints)

    count = len(evaluate(np.full(len(lower), 0.5)).constraints)
    budget = BUDGET_OF_TWO if len(lower) == 2 else BUDGET
    return SearchProblem(
        name,
        len(lower),
        count,
        budget,
        evaluate,
        sloped,
        best=best,
        minimiser=tuple((np.array(minimiser) - lower) / (upper - lower)),
        source=source,
    )


def townsend() -> SearchProblem:
    def both(x):
        value = -(jnp.cos((x[0] - 0.1) * x[1]) ** 2) - x[0] * jnp.sin(3 * x[0] + x[1])
        t = jnp.arctan2(x[0], x[1])
        along = 2 * jnp.cos(t) - jnp.cos(2 * t) / 2 - jnp.cos(3 * t) / 4 - jnp.cos(4 * t) / 8
        return value, [x[0] ** 2 + x[1] ** 2 - along**2 - (2 * jnp.sin(t)) ** 2]

    return _problem(
        "townsend",
        [-2.25, -2.5],
        [2.25, 1.75],
        both,
        -2.0239884,
        [2.0052938, 1.1944509],
        "Townsend (2014), Constrained optimization in Chebfun",
    )


def gramacy() -> SearchProblem:
    def both(x):
        wave = jnp.sin(2 * jnp.pi * (x[0] ** 2 - 2 * x[1])) / 2
        limits = [1.5 - x[0] - 2 * x[1] - wave, x[0] ** 2 + x[1] ** 2 - 1.5]
        return x[0] + x[1], limits

    return _problem(
        "gramacy",
        [0, 0],
        [1, 1],
        both,
        0.5997880,
        [0.1954, 0.4044],
        "Gramacy et al. (2016), Modeling an augmented Lagrangian for blackbox constrained "
        "optimization, Technometrics 58",
    )


def branin_disc() -> SearchProblem:
    def both(x):
        value = (
            (x[1] - 5.1 / (4 * jnp.pi**2) * x[0] ** 2 + 5 / jnp.pi * x[0] - 6) ** 2
            + 10 * (1 - 1 / (8 * jnp.pi)) * jnp.cos(x[0])
            + 10
        )
        return value, [((x[0] - 2.5) ** 2 + (x[1] - 7.5) ** 2) / 50 - 1]

    return _problem(
        "branin-disc",
        [-5, 0],
        [10, 15],
        both,
        0.397887,
        [np.pi, 2.275],
        "Gelbart, Snoek and Adams (2014), Bayesian optimization with unknown constraints",
    )


def g06() -> SearchProblem:
    def both(x):
        limits = [
            1 - ((x[0] - 5) ** 2 + (x[1] - 5) ** 2) / 100,
            ((x[0] - 6) ** 2 + (x[1] - 5) ** 2) / 82.81 - 1,
        ]
        return (x[0] - 10) ** 3 + (x[1] - 20) ** 3, limits

    return _problem("g06", [13, 0], [100, 100], both, -6961.8138756, [14.095, 0.84296079], CEC)


def g07() -> SearchProblem:
    def both(x):
        value = (
            x[0] ** 2
            + x[1] ** 2
            + x[0] * x[1]
            - 14 * x[0]
            - 16 * x[1]
            + (x[2] - 10) ** 2
            + 4 * (x[3] - 5) ** 2
            + (x[4] - 3) ** 2
            + 2 * (x[5] - 1) ** 2
            + 5 * x[6] ** 2
            + 7 * (x[7] - 11) ** 2
            + 2 * (x[8] - 10) ** 2
            + (x[9] - 7) ** 2
            + 45
        )
        limits = [
            (-105 + 4 * x[0] + 5 * x[1] - 3 * x[6] + 9 * x[7]) / 105,
            (10 * x[0] - 8 * x[1] - 17 * x[6] + 2 * x[7]) / 370,
            (-8 * x[0] + 2 * x[1] + 5 * x[8] - 2 * x[9] - 12) / 158,
            (3 * (x[0] - 2) ** 2 + 4 * (x[1] - 3) ** 2 + 2 * x[2] ** 2 - 7 * x[3] - 120) / 1258,
            (5 * x[0] ** 2 + 8 * x[1] + (x[2] - 6) ** 2 - 2 * x[3] - 40) / 816,
            (x[0] ** 2 + 2 * (x[1] - 2) ** 2 - 2 * x[0] * x[1] + 14 * x[4] - 6 * x[5]) / 788,
            ((x[0] - 8) ** 2 / 2 + 2 * (x[1] - 4) ** 2 + 3 * x[4] ** 2 - x[5] - 30) / 834,
            (-3 * x[0] + 6 * x[1] + 12 * (x[8] - 8) ** 2 - 7 * x[9]) / 4048,
        ]
        return value, limits

    minimiser = [2.171996, 2.363683, 8.773926, 5.095984, 0.990655]
    minimiser += [1.430574, 1.321644, 9.828726, 8.280092, 8.375927]
    return _problem("g07", [-10] * 10, [10] * 10, both, 24.3062091, minimiser, CEC)


def g24() -> SearchProblem:
    def both(x):
        limits = [
            -2 * x[0] ** 4 + 8 * x[0] ** 3 - 8 * x[0] ** 2 + x[1] - 2,
            -4 * x[0] ** 4 + 32 * x[0] ** 3 - 88 * x[0] ** 2 + 96 * x[0] + x[1] - 36,
        ]
        return -x[0] - x[1], limits

    return _problem("g24", [0, 0], [3, 4], both, -5.5080133, [2.3295202, 3.1784931], CEC)


def hartmann6() -> SearchProblem:
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

    def both(x):
        return -jnp.sum(weights * jnp.exp(-jnp.sum(curvature * (x - centre) ** 2, axis=1))), []

    return _problem(
        "hartmann6",
        [0] * 6,
        [1] * 6,
        both,
        -3.32237,
        [0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573],
        "Dixon and Szego (1978), Towards global optimisation 2",
    )


def pressure_vessel() -> SearchProblem:
    def both(x):
        shell, head, radius, length = x
        value = (
            0.6224 * shell * radius * length
            + 1.7781 * head * radius**2
            + 3.1661 * shell**2 * length
            + 19.84 * shell**2 * radius
        )
        volume = jnp.pi * radius**2 * length + 4 / 3 * jnp.pi * radius**3
        return value, [0.0193 * radius - shell, 0.00954 * radius - head, 1 - volume / 1296000]

    return _problem(
        "pressure-vessel",
        [0.0625, 0.0625, 10, 10],
        [6.1875, 6.1875, 200, 200],
        both,
        5885.3328,
        [0.7781686, 0.3846492, 40.3196187, 200],
        "Kannan and Kramer (1994), J. Mech. Des. 116; thicknesses continuous: Yang et al. (2013)",
    )


def welded_beam() -> SearchProblem:
    def both(x):
        weld, length, height, width = x
        load, arm, young, shear = 6000.0, 14.0, 30e6, 12e6
        moment = load * (arm + length / 2)
        reach = jnp.sqrt(length**2 / 4 + ((weld + height) / 2) ** 2)
        polar = 2 * jnp.sqrt(2) * weld * length * (length**2 / 12 + ((weld + height) / 2) ** 2)
        direct, twisted = load / (jnp.sqrt(2) * weld * length), moment * reach / polar
        stress = jnp.sqrt(direct**2 + direct * twisted * length / reach + twisted**2)
        bending = 6 * load * arm / (width * height**2)
        deflection = 4 * load * arm**3 / (young * height**3 * width)
        slender = 1 - height / (2 * arm) * jnp.sqrt(young / (4 * shear))
        buckling = 4.013 * young * height * width**3 / (6 * arm**2) * slender
        bar = 0.04811 * height * width * (14 + length)
        limits = [
            stress / 13600 - 1,
            bending / 30000 - 1,
            weld - width,
            (0.10471 * weld**2 + bar) / 5 - 1,
            0.125 - weld,
            deflection / 0.25 - 1,
            1 - buckling / load,
        ]
        return 1.10471 * weld**2 * length + bar, limits

    return _problem(
        "welded-beam",
        [0.1, 0.1, 0.1, 0.1],
        [2, 10, 10, 2],
        both,
        1.7248523,
        [0.205730, 3.470489, 9.036624, 0.205730],
        "Rao (1996), Engineering optimization; value: Coello and Mezura-Montes (2002)",
    )


CEC = "Liang et al. (2006), Problem definitions of the CEC 2006 special session"
PUBLISHED = {
    "townsend": townsend,
    "gramacy": gramacy,
    "branin-disc": branin_disc,
    "g06": g06,
    "g24": g24,
    "pressure-vessel": pressure_vessel,
    "welded-beam": welded_beam,
    "hartmann6": hartmann6,
    "g07": g07,
}
