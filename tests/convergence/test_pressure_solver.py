"""How fast the periodic pressure converges with the mesh, against the independent orbit."""

from dataclasses import replace

import equinox as eqx
import numpy as np
import pytest
from motors import STRUCTURES, sound_case

from camring.numerics.quadrature import gauss_legendre
from camring.physics.piston_state import sample_elements
from camring.physics.resolution import Resolution
from camring.programs.compiled import simulate
from camring.reference import machine_of
from camring.reference.orbit import periodic_orbit

ELEMENTS = (48, 96, 192)
"""That many of the default's have a width: three meshes, one program."""


@eqx.filter_jit
def _sampled(cycle, fraction):
    state = sample_elements(cycle, fraction)
    return state.angle, state.chamber_pressure, cycle.orbit.mesh.width


def test_pressure_inside_elements_converges_at_the_order_of_the_cubic():
    """Root mean square over the period, order four in the number of elements."""
    points, weights = gauss_legendre(6)
    cases = [sound_case(seed, STRUCTURES[0]) for seed in (0, 1, 3)]
    orbits = [periodic_orbit(machine_of(*case), 1e-11) for case in cases]
    rates = []
    for case, orbit in zip(cases, orbits, strict=True):
        errors = []
        for elements in ELEMENTS:
            most = Resolution()
            cycle = simulate(*case, replace(most, filled=elements / most.elements))
            angle, pressure, width = map(np.asarray, _sampled(cycle, points))
            if angle.shape[0] == len(points):
                angle, pressure = angle.T, pressure.T
            wrong = pressure - orbit.pressure(angle)
            mean_square = np.sum(width[:, None] * weights * wrong**2) / np.sum(width)
            errors.append(np.sqrt(mean_square) / orbit.chamber.scale)
        assert errors[-1] < 1e-7
        rates.append(np.log2(errors[0] / errors[-1]) / 2)
    assert np.median(rates) > 3.5, rates


def test_the_independent_orbit_is_converged_enough_to_compare_with():
    case = sound_case(0, STRUCTURES[0])
    coarse, fine = (periodic_orbit(machine_of(*case), t) for t in (1e-9, 1e-11))
    angle = np.linspace(0, coarse.chamber.curve.period, 2000)
    wrong = np.abs(coarse.pressure(angle) - fine.pressure(angle)).max()
    assert wrong < 1e-8 * coarse.chamber.scale


@pytest.mark.parametrize("seed", [0, 1])
def test_the_orbit_closes_on_itself(seed):
    orbit = periodic_orbit(machine_of(*sound_case(seed, STRUCTURES[0])), 1e-9)
    assert abs(orbit.residual) < 1e-8 * orbit.chamber.scale
    inner = orbit.edges[1:-1]
    across = orbit.pressure(inner + 1e-12) - orbit.pressure(inner - 1e-12)
    assert np.abs(across).max() < 1e-7 * orbit.chamber.scale
