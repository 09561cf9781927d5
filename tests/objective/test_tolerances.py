"""Tolerances add to what the design says, and waves lie on the ring as high as stated."""

import jax
import numpy as np
import pytest
from motor_files import SOUND, ring

from camring.files.motor import parse_motor_file
from camring.objective.design_space import leaf
from camring.objective.tolerances import Deviation, ToleratedSpace, Waviness

FILE = parse_motor_file(SOUND)
SYSTEM, SPACE = FILE.system, FILE.design_space
BORE, SPEEDS = "motor.piston.bore", ("operating_points.0.shaft_speed",)
WIDTH = "motor.valve_plate.supply.width"


def deviation(leaves, size, relative=False):
    return Deviation(name=leaves[0], leaves=leaves, deviation=size, relative=relative)


def radius(system, count=4096):
    angle = 2 * np.pi * np.arange(count) / count
    return np.asarray(system.motor.cam.pitch_radius(angle).value)


def test_without_scatter_the_motor_is_the_motor_to_the_bit():
    none = ToleratedSpace(None, (deviation((BORE,), 0.0), deviation(SPEEDS, 0.0, True)))
    for amounts in ([0.0, 0.0], [1.7, -3.0]):
        same = none.apply(SYSTEM, np.array(amounts))
        for one, other in zip(jax.tree.leaves(SYSTEM), jax.tree.leaves(same), strict=True):
            assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


def test_a_deviation_goes_with_the_design():
    """The width that a design gives, not the given one, deviates."""
    space = ToleratedSpace(SPACE, (deviation((WIDTH,), 0.01),))
    point = np.append(SPACE.locate(SYSTEM), 2.0)
    place = SPACE.names.index("motor.valve_plate.supply_width")
    for at, degrees in ((0.0, 26.0), (1.0, 30.0)):
        point[place] = at
        width = float(leaf(WIDTH)(space.apply(SYSTEM, point)))
        assert width == pytest.approx(np.radians(degrees) + 0.02)
    assert space.dimension == len(point)
    assert space.design_dimension == SPACE.dimension


def test_a_share_moves_each_number_by_its_own_size():
    both = tuple(f"operating_points.{place}.supply_pressure" for place in (0, 1))
    space = ToleratedSpace(None, (deviation(both, 0.02, relative=True),))
    moved = space.apply(SYSTEM, np.array([-1.5]))
    for path in both:
        assert float(leaf(path)(moved)) == pytest.approx(0.97 * float(leaf(path)(SYSTEM)))


@pytest.mark.parametrize(("orders", "unfold"), [((6, 12), False), ((2, 3, 12), True)])
def test_waves_are_as_high_as_stated(orders, unfold):
    """The curve's own Fourier coefficients at each order, at the phase that was drawn."""
    amplitudes = 1e-6 * np.arange(1, len(orders) + 1)
    space = ToleratedSpace(None, (), Waviness(orders, amplitudes, unfold))
    phase = np.linspace(0.3, 2.0, len(orders))
    amounts = np.sqrt(2) * np.stack([np.cos(phase), np.sin(phase)], axis=1).ravel()
    wavy = space.apply(SYSTEM, amounts)
    assert wavy.motor.cam.repeats == (1 if unfold else 6)
    found = np.fft.rfft(radius(wavy) - radius(SYSTEM)) * 2 / 4096
    for order, amplitude, at in zip(orders, amplitudes, phase, strict=True):
        assert abs(found[order]) == pytest.approx(amplitude, rel=1e-6)
        assert -np.angle(found[order]) == pytest.approx(at, abs=1e-6)


def test_a_ring_described_lobe_by_lobe_is_the_ring():
    space = ToleratedSpace(None, (), Waviness((3,), np.zeros(1), True))
    unfolded = space.apply(SYSTEM, np.array([1.0, -1.0]))
    assert unfolded.motor.cam.control_count == 6 * SYSTEM.motor.cam.control_count
    np.testing.assert_allclose(radius(unfolded), radius(SYSTEM), rtol=1e-14)


def test_waves_on_a_free_ring_are_as_high_as_stated():
    system = parse_motor_file(ring()).system
    wavy = ToleratedSpace(None, (), Waviness((4,), np.array([2e-6]), False)).apply(
        system, np.array([np.sqrt(2), 0.0])
    )
    found = np.fft.rfft(radius(wavy) - radius(system)) * 2 / 4096
    assert abs(found[4]) == pytest.approx(2e-6, rel=1e-6)
