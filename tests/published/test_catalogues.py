"""Published torque rows. What they show and what not stands in docs/validation.md.

Staffa HMC125: a crank motor, five pistons in a star, one lobe of sine motion, whose
eccentric is set to another stroke; its catalogue gives the average actual torque for each
bar. Poclain MS50 and Hägglunds CA 50: cam motors; their catalogues give torque without loss.
"""

from dataclasses import replace
from math import pi

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from motor_files import SOUND

from camring.analyses.modes import cam_repeats
from camring.files.motor import parse_motor_file
from camring.geometry.cam import RadialCam
from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.geometry.profiles import sine
from camring.metrics.displacement import rises_between_knots
from camring.physics.contact import normal_force
from camring.physics.friction import SlidingContacts, ViscousFriction
from camring.physics.oil.fluid import ConstantFluid
from camring.physics.rotation import in_mode
from camring.physics.torque import torque_by_virtual_work

CUBIC_INCH = 0.0254**3
BAR = 1e5

HMC125_SETTINGS = np.array([125, 120, 110, 100, 90, 80, 70, 60, 50, 40, 30, 20, 10])  # in3/rev
HMC125_TORQUE = np.array(
    [29.9, 28.7, 26.3, 23.6, 21.0, 18.3, 15.7, 12.8, 10.6, 8.1, 5.9, 3.1, 0.6]
)  # N m / bar, average actual

MS50_DISPLACEMENT = np.array([3500, 4008, 4498, 4997, 5504, 6011])  # cm3/rev
MS50_TORQUE = np.array([5565, 6373, 7152, 7945, 8751, 9557])  # N m at 100 bar, without loss

MS50_PAIRS = {  # cm3/rev: the two halves of a cam, of lobes 1, 3, 5 and of lobes 2, 4, 6
    "7": (1750, 1750), "8": (2004, 2004), "9": (2249, 2249), "0": (2499, 2499),
    "1": (2752, 2752), "2": (3006, 3006), "K": (2752, 1500), "A": (3006, 2004),
}  # fmt: skip
MS50_FULL = {"7": 3500, "8": 4008, "9": 4498, "0": 4997, "1": 5504, "2": 6011, "K": 4252, "A": 5010}
MS50_AT_100_BAR = {  # N m, without loss
    "7": 5565, "8": 6373, "9": 7152, "0": 7945, "1": 8751, "2": 9557, "K": 6761, "A": 7966,
}  # fmt: skip

CA50_DISPLACEMENT = np.array([1256, 1570, 2010, 2512, 3140])  # cm3/rev
CA50_REDUCED = 1570  # of 3140, ratio 1:2
CA50_TORQUE = np.array([20, 25, 32, 40, 50])  # N m / bar

PISTONS, BORE, CRANK = 5, 0.11, 0.10  # bore and ring are assumed: the catalogue gives neither


def crank_torque(setting, friction):
    """Mean torque for each bar with ideal switching at the dead centres, N m / bar."""
    area = pi * BORE**2 / 4
    stroke = setting * CUBIC_INCH / (PISTONS * area)
    phase = 2 * pi * np.arange(64) / 64
    # A spline through control values on a cosine swings by (2 + cos h)/3 of theirs.
    swing = stroke * 3 / (2 + np.cos(phase[1]))
    cam = RadialCam(CRANK + swing * sine(phase), repeats=1)
    angle = jnp.asarray(2 * pi * (np.arange(720) + 0.5) / 720)
    radius = cam.pitch_radius(angle)
    force = jnp.where(radius.first > 0, area * BAR, 0.0)
    roller = Roller(0.02, 0.05, Material(2.1e11, 0.3))
    contacts = SlidingContacts(radius, force, normal_force(force, radius), roller, jnp.ones(()))
    lost = friction.loss_torque(contacts, Piston(BORE, 1.0), ConstantFluid(870.0, 1.4e9, 3e3))
    return float(PISTONS * jnp.mean(torque_by_virtual_work(force, radius) - lost))


def columns(settings):
    """Torque without friction, and what one unit of each coefficient takes off it."""
    bare = np.array([crank_torque(s, ViscousFriction(0.0)) for s in settings])
    rolling = np.array([crank_torque(s, ViscousFriction(0.0, 1.0)) for s in settings])
    sliding = np.array([crank_torque(s, ViscousFriction(0.0, 0.0, 1.0)) for s in settings])
    return bare, np.stack([bare - rolling, bare - sliding], axis=-1)


def test_without_friction_the_crank_gives_displacement_over_a_turn():
    bare, _ = columns(HMC125_SETTINGS[:2])
    ideal = HMC125_SETTINGS[:2] * CUBIC_INCH * BAR / (2 * pi)
    np.testing.assert_allclose(bare, ideal, rtol=1e-4)


def test_two_friction_constants_reproduce_the_staffa_row():
    bare, taken = columns(HMC125_SETTINGS)
    constants, *_ = np.linalg.lstsq(taken, bare - HMC125_TORQUE, rcond=None)
    rolling, sliding = constants
    error = bare - taken @ constants - HMC125_TORQUE
    rms = np.sqrt(np.mean(error**2))
    print(f"HMC125: roller {rolling:.4f}, side {sliding:.4f}, rms {rms:.3f} N m/bar")
    assert rms < 0.5
    assert 0 < rolling < 0.2
    assert 0 <= sliding < 1
    # Linear in both, so the laws themselves give the same with the fitted numbers.
    fitted = crank_torque(HMC125_SETTINGS[3], ViscousFriction(0.0, rolling, sliding))
    assert fitted == pytest.approx((bare - taken @ constants)[3], rel=1e-9)


def test_torque_without_loss_is_pressure_times_displacement_over_a_turn_in_the_poclain_row():
    """The catalogue computes 0.159 N m for each cm3 and 10 bar, 1/(2 pi) rounded."""
    ideal = MS50_DISPLACEMENT * 1e-6 * 100 * BAR / (2 * pi)
    np.testing.assert_allclose(MS50_TORQUE, ideal, rtol=1.2e-3)
    np.testing.assert_allclose(MS50_TORQUE, 1.59 * MS50_DISPLACEMENT, atol=1.0)


def alternating(halves, per_lobe=40):
    """A motor whose lobes displace these halves, cm3/rev, by turns; its pistons are assumed."""
    file = parse_motor_file(SOUND)
    motor = file.system.motor
    strokes = np.array(halves) * 1e-6 / (motor.pistons * float(motor.piston.area) * 3)
    phase = 2 * pi * np.arange(per_lobe) / per_lobe
    low = 5 * strokes.max()  # a ring wide enough for these strokes
    ring = np.concatenate([low + strokes[k % 2] * sine(phase) for k in range(motor.lobes)])
    return replace(motor, cam=RadialCam(ring, repeats=1))


_rises = eqx.filter_jit(rises_between_knots)


def displaced(motor, idle=()):
    """cm3/rev."""
    rises = _rises(in_mode(motor, idle))
    return 1e6 * motor.pistons * float(motor.piston.area) * float(rises)


@pytest.mark.parametrize("cam", MS50_PAIRS)
def test_half_the_lobes_of_a_poclain_cam_are_its_half_displacement_equal_or_not(cam):
    """Six lobes by turns of two strokes; half idle leave the other half, and both are the full one.

    The spline of a sine's values lies a per cent inside them, alike for all lobes: one scale
    makes up for it, but for what unequal neighbours share at their dead centre.
    """
    first, second = MS50_PAIRS[cam]
    motor = alternating((first, second))
    full = displaced(motor)
    halves = displaced(motor, (1, 3, 5)), displaced(motor, (0, 2, 4))
    assert sum(halves) == pytest.approx(full, rel=1e-12)
    assert halves[0] / full == pytest.approx(first / (first + second), rel=2e-3)
    scale = MS50_FULL[cam] / full
    assert scale * halves[0] == pytest.approx(first, rel=2e-3)
    assert scale * halves[1] == pytest.approx(second, rel=2e-3)
    ideal = 100 * BAR * scale * full * 1e-6 / (2 * pi)
    assert ideal == pytest.approx(MS50_AT_100_BAR[cam], rel=1.2e-3)
    assert cam_repeats(motor.cam, 6) == (6 if first == second else 3)
    print(f"{cam}: {scale * halves[0]:.0f} {scale * halves[1]:.0f} cm3, {ideal:.0f} N m")


def test_the_cams_of_unequal_lobes_are_halves_of_the_others_in_the_poclain_row():
    """K is half of cam 1 and 1500, A half of 2 and half of 8."""
    assert MS50_PAIRS["K"][0] == MS50_PAIRS["1"][0]
    assert MS50_PAIRS["A"] == (MS50_PAIRS["2"][0], MS50_PAIRS["8"][0])
    for cam, halves in MS50_PAIRS.items():
        assert sum(halves) == pytest.approx(MS50_FULL[cam], abs=1.5)


def test_newton_metres_a_bar_are_displacement_over_a_turn_in_the_hagglunds_row():
    """Rounded to whole numbers; nothing of the machine but its displacement."""
    np.testing.assert_allclose(CA50_DISPLACEMENT * 1e-6 * BAR / (2 * pi), CA50_TORQUE, atol=0.05)


def test_every_second_lobe_idle_is_the_reduced_displacement_of_the_hagglunds_row():
    motor = alternating((CA50_REDUCED, CA50_REDUCED))
    full, reduced = displaced(motor), displaced(motor, (1, 3, 5))
    scale = CA50_DISPLACEMENT[-1] / full
    assert scale * reduced == pytest.approx(CA50_REDUCED, rel=1e-9)
