"""The table that the FMU looks up: its interpolation, its axes, its file."""

from math import pi, tau

import motor_files
import numpy as np
import pytest

from camring.exchange.fmu.axes import BAR, RPM, Ranges, axes_of
from camring.exchange.fmu.places import angles_of
from camring.exchange.fmu.table import Table, held_at_edges, spline_coefficients
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file

PERIODS = 24


def smooth(places, angle):
    """Torque and flows of no motor, smooth in everything, shape (place, 4, angle)."""
    x, y, z = (each[:, None] for each in places.T)
    phase = PERIODS * angle
    wave = np.sin(phase + y) + 0.3 * np.cos(2 * phase) * np.exp(x / 2)
    torque = x**2 + np.cos(y) + z**2 / 3 + wave
    waves = np.broadcast_arrays(torque, x * y + wave, np.exp(-y) * wave, z + x)
    return np.stack(waves, axis=1)


def table_of(speeds, drops, lows=3, angles=128):
    axes = [np.linspace(0, 1, n) for n in (speeds, drops, lows)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    waves = smooth(places, tau / PERIODS * np.arange(angles) / angles)
    shape = (speeds, drops, lows)
    means = waves.mean(axis=-1).reshape(*shape, 4)
    return Table(*axes, means, waves.reshape(*shape, 4, angles), PERIODS)


def test_the_error_falls_with_the_square_of_the_spacing():
    places = np.random.default_rng(0).uniform(0, 1, (200, 3))
    errors = []
    for count in (5, 9, 17, 33):
        table = table_of(count, count, count, 16)
        away = table.waves_at(places) - smooth(places, table.angles())
        errors.append(np.sqrt(np.mean(away**2)))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(rates - 2) < 0.1), rates


def test_along_the_angle_the_error_falls_with_its_fourth_power():
    """A cubic spline does."""
    places = np.zeros((1, 3))
    errors = []
    for angles in (16, 32, 64):
        table = table_of(2, 2, 2, angles)
        halfway = table.angles() + tau / PERIODS / angles / 2
        errors.append(np.abs(table.waves_between(places) - smooth(places, halfway)).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(rates - 4) < 0.2), rates


def test_a_spline_goes_through_its_samples_and_keeps_their_mean():
    samples = np.random.default_rng(3).normal(size=(2, 7))
    c = spline_coefficients(samples)
    through = (np.roll(c, 1, axis=-1) + 4 * c + np.roll(c, -1, axis=-1)) / 6
    np.testing.assert_allclose(through, samples, atol=1e-13)
    np.testing.assert_allclose(c.mean(axis=-1), samples.mean(axis=-1), atol=1e-14)


def test_a_table_is_exact_at_its_points_and_held_beyond_its_edges():
    table = table_of(3, 4)
    at = np.array([[0.5, 1 / 3, 0.0], [1.0, 1.0, 1.0]])
    np.testing.assert_allclose(table.means_at(at), smooth(at, table.angles()).mean(-1), atol=1e-14)
    np.testing.assert_array_equal(
        table.means_at(np.array([[9.0, -3.0, 0.5]])), table.means_at(np.array([[1.0, 0.0, 0.5]]))
    )


def test_an_axis_of_one_value_serves_everywhere():
    one = held_at_edges((np.array([2.0]), np.array([0.0, 1.0])), np.array([[3.0, 5.0]]),
                        np.array([[7.0, 0.5]]))  # fmt: skip
    assert one == pytest.approx([4.0])


def axes(text=motor_files.SOUND, **ranges):
    return axes_of(parse_motor_file(text), Ranges(**ranges))


def test_the_file_s_own_points_lie_within_its_table():
    file = parse_motor_file(motor_files.SOUND)
    found = axes_of(file, Ranges())
    for point in file.system.operating_points:
        assert found.speeds[0] < float(point.shaft_speed) < found.speeds[-1]
        assert found.drops[0] <= float(point.pressure_drop) < found.drops[-1]
        low = float(point.return_pressure) - float(point.case_pressure)
        assert found.lows[0] < low < found.lows[-1]
    assert (len(found.speeds), len(found.drops), len(found.lows)) == (13, 7, 2)


def test_ranges_are_those_of_a_map_and_zero_pressure_drop_belongs_to_the_table():
    back = float(parse_motor_file(motor_files.SOUND).system.operating_points[0].return_pressure)
    found = axes(speed="10..160 rpm", pressure="100 bar..300 bar", points="5x3")
    np.testing.assert_allclose(found.speeds / RPM, [10, 20, 40, 80, 160])
    np.testing.assert_allclose((found.drops[1:] + back) / BAR, [100, 200, 300])
    assert found.drops[0] == 0
    listed = axes(speed="30 rpm, 10 rpm")
    np.testing.assert_allclose(listed.speeds, [20 * pi / 60, pi])


@pytest.mark.parametrize("text", [motor_files.SOUND, motor_files.ring()], ids=["lobes", "ring"])
def test_windows_are_sampled_as_finely_on_any_cam(text):
    motor = parse_motor_file(text).system.motor
    step = tau / motor.surviving_order / angles_of(motor)
    assert motor.valve_plate.pitch / 4096 <= step <= motor.valve_plate.pitch / 2048


def test_a_range_without_an_fmu_is_refused():
    Ranges(speed="1 rpm..2 rpm").require_use(True)
    Ranges().require_use(False)
    with pytest.raises(InputError, match=r"--low-pressure .* add --fmu"):
        Ranges(low_pressure="1 bar..2 bar").require_use(False)


@pytest.mark.parametrize(
    ("ranges", "said"),
    [
        ({"speed": "0 rpm..100 rpm"}, "must be above zero"),
        ({"speed": "10 bar..20 bar"}, "measures a pressure"),
        ({"speed": "100 rpm"}, "must be a range or a list"),
        ({"pressure": "1 bar..200 bar"}, "below the return pressure"),
        ({"points": "200x200"}, "stay below 20,000"),
        ({"points": "many"}, "one whole number, or one for each axis"),
    ],
)
def test_a_slip_is_reported_in_a_sentence(ranges, said):
    with pytest.raises(InputError, match=said):
        axes(**ranges)
