"""The trust region's Bayesian search and the evolution: published optima."""

import pytest

from camring.search.cma_es import CmaEs
from camring.search.minimise import minimise
from camring.search.scbo import Scbo


def test_scbo_finds_a_minimum_on_an_active_constraint(disc):
    best = minimise(disc, Scbo(2), 30, seed=1).best
    assert best.feasible()
    assert best.objective == pytest.approx(2 * (1 - 0.5**0.5) ** 2, rel=1e-3)


@pytest.mark.long
def test_scbo_comes_near_the_minimum_of_branin(branin):
    best = minimise(branin, Scbo(2), 40, seed=0).best.objective
    assert best == pytest.approx(0.397887, rel=1e-2)


def test_cma_es_finds_the_minimum_of_hartmann(hartmann6):
    best = min(minimise(hartmann6, CmaEs(6), 600, seed=s).best.objective for s in range(3))
    assert best == pytest.approx(-3.32237, rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 2])
def test_scbo_leaves_a_local_minimum(townsend, seed):
    """Townsend (2014): -1.66 is a corner, -2.02399 the minimum."""
    assert minimise(townsend, Scbo(2), 60, seed=seed).best.objective < -2.0
