"""A waveform file explains itself, and is whole or not there."""

import math

import equinox as eqx
import h5py
import jax.numpy as jnp
import numpy as np
import pytest
import xarray

from camring.cli.simulate import simulate as command
from camring.exchange.waveforms import file as waveform_file
from camring.exchange.waveforms.file import (
    ENDINGS,
    WAVEFORMS,
    waveform_dataset,
    write_waveforms,
)
from camring.files.errors import InputError
from camring.physics.manifold.manifold import Manifold
from camring.physics.system import System
from camring.programs.compiled import simulate

ASKED = {
    "lift",
    "velocity",
    "acceleration",
    "jerk",
    "volume",
    "chamber_pressure",
    "supply_flow",
    "return_flow",
    "leakage_flow",
    "contact_force",
    "contact_stress",
    "torque",
}


@pytest.fixture(scope="module")
def dataset(simulated, tmp_path_factory):
    path = tmp_path_factory.mktemp("waveforms") / "out.nc"
    write_waveforms(path, *simulated, source="[motor]\npistons = 8\n", samples=720)
    with xarray.open_dataset(path) as opened:
        yield opened.load()


def test_what_was_asked_for_is_there_with_units(dataset):
    assert (
        set(dataset.data_vars)
        == ASKED
        == set(WAVEFORMS)
        - {
            "manifold_pressure",
            "return_manifold_pressure",
        }
    )
    for variable in dataset.data_vars.values():
        assert variable.dims == ("operating_point", "angle")
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]
        assert np.isfinite(variable).all()
    for coordinate in dataset.coords.values():
        assert coordinate.attrs["units"]


def test_a_manifold_brings_its_pressure(simulated):
    system, _ = simulated
    motor, fluid, point = system.motor, system.fluid, system.operating_points[0]
    manifold = Manifold(jnp.asarray(2e-4), jnp.asarray(5e-9))
    fed = eqx.tree_at(lambda m: m.manifold, motor, manifold, is_leaf=lambda leaf: leaf is None)
    cycle = simulate(fed, fluid, point)
    dataset = waveform_dataset(System(fed, fluid, (point,)), [cycle], samples=720)
    assert set(dataset.data_vars) == set(WAVEFORMS) - {"return_manifold_pressure"}
    manifold_pressure = dataset.manifold_pressure
    assert manifold_pressure.dims == ("operating_point", "angle")
    assert manifold_pressure.attrs["units"] == "Pa"
    # The line loses some of the supply's pressure, and what is left swings with the pistons.
    assert float(manifold_pressure.max()) < float(point.supply_pressure)
    assert float(np.ptp(manifold_pressure.to_numpy())) > 1e-3 * float(point.pressure_drop)
    # All pistons draw alike: a part of the revolution repeats.
    part = 720 // np.lcm(motor.pistons, motor.lobes)
    once = manifold_pressure[0].to_numpy()
    np.testing.assert_allclose(once, np.roll(once, part), rtol=1e-6)


def test_the_angle_is_one_revolution_of_the_shaft(dataset):
    angle = dataset.angle.to_numpy()
    assert dataset.angle.attrs["units"] == "rad"
    np.testing.assert_allclose(angle, 2 * math.pi * np.arange(720) / 720)


def test_operating_points_carry_their_mode(dataset, simulated):
    system, _ = simulated
    for name in ("shaft_speed", "supply_pressure", "return_pressure", "case_pressure"):
        wanted = [float(getattr(point, name)) for point in system.operating_points]
        np.testing.assert_array_equal(dataset[name], wanted)


def test_the_waveforms_belong_together(dataset, simulated):
    system, _ = simulated
    motor = system.motor
    # Piston volume follows lift, and lift repeats with the lobes.
    volume = float(motor.dead_volume) + float(motor.piston.area) * dataset.lift
    np.testing.assert_allclose(dataset.volume, volume, rtol=1e-12)
    lift = dataset.lift.to_numpy()
    lobe = 720 // motor.lobes
    np.testing.assert_allclose(lift[:, :lobe], lift[:, lobe : 2 * lobe], atol=1e-15)
    # Shaft speed halves the velocity of the second point.
    np.testing.assert_allclose(dataset.velocity[0], 2 * dataset.velocity[1], rtol=1e-12)


def test_the_file_says_where_it_comes_from(dataset):
    assert "camring" in dataset.attrs["source"]
    assert dataset.attrs["motor_file"] == "[motor]\npistons = 8\n"
    assert dataset.attrs["pistons"] == 8


def test_other_programs_can_read_it(simulated, tmp_path):
    path = write_waveforms(tmp_path / "out.nc", *simulated, samples=360)
    with h5py.File(path) as file:
        assert file["torque"].shape == (2, 360)
        assert file["torque"].attrs["units"] == "N m"
        assert file["angle"].shape == (360,)


def test_a_new_file_replaces_an_old_one_whole(simulated, tmp_path):
    path = tmp_path / "out.nc"
    write_waveforms(path, *simulated, samples=360)
    write_waveforms(path, *simulated, samples=720)
    with xarray.open_dataset(path) as opened:
        assert opened.sizes["angle"] == 720
    assert [each.name for each in tmp_path.iterdir()] == ["out.nc"]


def test_a_write_that_fails_leaves_the_old_file_alone(simulated, tmp_path, monkeypatch):
    path = write_waveforms(tmp_path / "out.nc", *simulated, samples=360)
    before = path.read_bytes()

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xarray.Dataset, "to_netcdf", full)
    with pytest.raises(InputError, match="No space left"):
        write_waveforms(path, *simulated, samples=360)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["out.nc"]


def test_a_motor_file_is_never_replaced_by_waveforms(simulated, tmp_path):
    path = tmp_path / "motor.toml"
    path.write_text("[motor]\n")
    with pytest.raises(InputError, match="no kind of waveform file"):
        write_waveforms(path, *simulated)
    assert path.read_text() == "[motor]\n"


@pytest.mark.parametrize(
    ("ending", "kind"), [(".nc", "NetCDF"), (".csv", "CSV"), (".xlsx", "XLSX"), (".mat", "MAT")]
)
def test_a_file_of_another_kind_is_never_replaced(simulated, tmp_path, ending, kind):
    path = tmp_path / f"out{ending}"
    path.write_text("[motor]\n")
    with pytest.raises(InputError, match=f"no {kind} file"):
        write_waveforms(path, *simulated, samples=36)
    assert path.read_text() == "[motor]\n"


@pytest.mark.parametrize("name", ["out.txt", "out", "out.csvv"])
def test_an_unknown_ending_learns_those_that_are_known(simulated, tmp_path, name):
    with pytest.raises(InputError) as said:
        write_waveforms(tmp_path / name, *simulated)
    assert all(ending in str(said.value) for ending in ENDINGS)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "words"), [("absent/out.nc", "no existing folder"), ("kept.csv", "no CSV file")]
)
def test_the_place_is_looked_at_before_the_motor_is(tmp_path, name, words):
    (tmp_path / "kept.csv").write_text("mine")
    with pytest.raises(InputError, match=words):
        command(tmp_path / "no_motor.toml", waveforms=tmp_path / name)


def test_a_place_that_does_not_exist_is_said_in_a_sentence(simulated, tmp_path):
    with pytest.raises(InputError, match="no existing folder"):
        write_waveforms(tmp_path / "absent" / "out.nc", *simulated)
    with pytest.raises(InputError, match="is a folder"):
        write_waveforms(tmp_path, *simulated)


def test_a_tenth_of_a_degree_is_the_default():
    assert waveform_file.SAMPLES == 3600
