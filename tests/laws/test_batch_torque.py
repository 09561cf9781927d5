"""The extremes of shaft torque are those of its sum over all pistons, wherever they lie."""

import jax
import numpy as np
import pytest
from motors import STRUCTURES, sound_case, stacked

from camring.metrics.batch_torque import torque_span
from camring.numerics.mesh import Mesh
from camring.numerics.quantity import real
from camring.numerics.radau import STAGES, element_powers
from camring.physics.cycle import Cycle
from camring.physics.motor import Motor

ELEMENTS, MEMBERS, SAMPLES = 23, 8, 40_000
FRACTIONS = np.concatenate([[0.0], STAGES])[:, None, None]


def random_waves(motor: Motor, seed: int):
    """Cubics on meshes with elements of no width; from one to the next the slope jumps."""
    rng = np.random.default_rng(seed)
    period = motor.cam.period
    node = np.sort(rng.uniform(0, 1, (ELEMENTS - 3, MEMBERS)), axis=0)
    node = np.sort(np.concatenate([np.zeros((1, MEMBERS)), node, node[4:6]]), axis=0)
    start = period * (node + rng.uniform(0, 1, MEMBERS))
    width = np.diff(np.concatenate([start, start[:1] + period]), axis=0)
    place = (start + FRACTIONS * width) * (2 * np.pi / period)
    values = 3 + np.sin(place) + 0.4 * np.cos(3 * place)
    return Mesh(start, width, np.ones(start.shape, bool)), values


def sampled_span(motor: Motor, mesh: Mesh, values, member: int) -> float:
    """By looking everywhere, the beginnings of all intervals included."""
    period, phases = motor.cam.period, motor.distinct_phases
    start, width = mesh.start[:, member], mesh.width[:, member]
    fractions = np.linspace(0, 1, SAMPLES // ELEMENTS)[:-1]
    place = (start[:, None] + fractions * width[:, None]).ravel() - start[0]
    powers = np.asarray(element_powers(values[0, :, member], values[1:, :, member]))
    total = 0.0
    for piston in range(phases):
        behind = (place + piston * period / phases) % period
        element = np.searchsorted(start - start[0], behind, side="right") - 1
        fraction = (behind - (start[element] - start[0])) / width[element]
        total = total + np.polyval(powers[::-1, element], fraction)
    return motor.pistons // phases * np.ptp(total)


@pytest.mark.parametrize("structure", STRUCTURES[:3], ids=lambda each: f"{each.kind} {each.count}")
def test_the_span_is_that_of_all_pistons_together(structure):
    case = sound_case(0, structure)
    motor = jax.tree.map(lambda leaf: leaf[0], stacked([case])[0])
    mesh, values = random_waves(motor, seed=structure.pistons)
    # Only the motor's counts and the mesh are read.
    cycle = Cycle(motor, None, None, None, _Orbit(mesh), None, None)
    found = np.asarray(torque_span(cycle, real(values)))
    for member in range(MEMBERS):
        expected = sampled_span(motor, mesh, values, member)
        assert found[member] >= expected * (1 - 1e-12)
        assert found[member] == pytest.approx(expected, rel=1e-5)


class _Orbit:
    def __init__(self, mesh: Mesh):
        self.mesh = mesh
