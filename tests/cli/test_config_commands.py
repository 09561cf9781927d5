"""camring new, check and simulate: what they print, write and refuse."""

import json
import re

import numpy as np
import pytest
import xarray
from motor_files import SOUND, with_line
from typer.testing import CliRunner

from camring.analyses.envelope_facts import EnvelopeFacts
from camring.analyses.simulation import simulated as looked_at
from camring.cli.app import app
from camring.files.motor import parse_motor_file, read_motor_file
from camring.files.starting.template import PROFILES

RUN = CliRunner()
RESULTS = """
mean_torque torque_ripple torque_ripple_peak_to_peak pressure_ripple flow_ripple displacement
stroke ideal_torque supply_flow efficiency volumetric_efficiency hydromechanical_efficiency
input_power output_power throttling_loss leakage_loss friction_loss compression_loss min_pressure
max_pressure min_contact_force max_contact_stress min_undercut_factor max_pressure_angle
max_velocity max_acceleration max_jerk min_volume natural_frequency damping_ratio jerk_objective
spectral_pressure spectral_torque
"""
# One operating point, so that the commands have half as much to do.
SIMPLE = (
    SOUND[: SOUND.index('[[operating_points]]\nspeed = "60 rpm"')]
    + SOUND[SOUND.index("# What is to become small") :]
)


@pytest.fixture(scope="module")
def motor(tmp_path_factory):
    path = tmp_path_factory.mktemp("motor") / "motor.toml"
    path.write_text(SIMPLE)
    return str(path)


@pytest.fixture(scope="module")
def simulated(motor):
    waves = motor.replace("motor.toml", "waves.nc")
    done = RUN.invoke(app, ["simulate", motor, "--json", "--waveforms", waves])
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout), waves


class TestNew:
    @pytest.mark.parametrize("profile", PROFILES)
    def test_writes_a_file_that_reads(self, tmp_path, profile):
        path = tmp_path / "motor.toml"
        done = RUN.invoke(app, ["new", str(path), "--profile", profile])
        assert done.exit_code == 0
        assert "camring check" in done.stdout
        assert read_motor_file(path).design_space.dimension == 12
        assert path.stat().st_mode & 0o400

    def test_never_overwrites(self, tmp_path):
        path = tmp_path / "motor.toml"
        path.write_text("mine")
        done = RUN.invoke(app, ["new", str(path)])
        assert done.exit_code == 2
        assert "exists; choose another name" in done.stderr
        assert path.read_text() == "mine"
        assert RUN.invoke(app, ["new", str(path), "--force"]).exit_code == 0
        assert "[motor]" in path.read_text()
        assert [each.name for each in tmp_path.iterdir()] == ["motor.toml"]

    @pytest.mark.parametrize("options", [[], ["--force"]])
    def test_refuses_places_that_cannot_be_written(self, tmp_path, options):
        for place in (tmp_path, tmp_path / "nowhere" / "motor.toml", tmp_path / ("x" * 300)):
            done = RUN.invoke(app, ["new", str(place), *options])
            assert done.exit_code == 2
            assert done.stderr.count("\n") == 1
        assert not list(tmp_path.iterdir())

    def test_a_link_that_leads_nowhere_is_left_alone(self, tmp_path):
        (tmp_path / "link.toml").symlink_to(tmp_path / "gone.toml")
        assert RUN.invoke(app, ["new", str(tmp_path / "link.toml")]).exit_code == 2
        assert not (tmp_path / "gone.toml").exists()

    def test_an_unknown_profile_is_refused(self, tmp_path):
        done = RUN.invoke(app, ["new", str(tmp_path / "a.toml"), "--profile", "square"])
        assert done.exit_code == 2


class TestSimulate:
    def test_json_holds_every_result(self, simulated):
        document, _ = simulated
        (record,) = document["results"]
        named = RESULTS.split()
        assert set(named) <= set(record)
        assert all(np.isfinite(record[name]) for name in named)
        assert record["mean_torque"] == pytest.approx(1494.694, rel=1e-5)

    def test_json_says_where_it_comes_from_and_how_good_it_is(self, simulated):
        document, _ = simulated
        assert document["input"].endswith("motor.toml")
        assert set(document["versions"]) == {"camring", "python", "jax", "numpy"}
        assert 0 < document["numerical_error"] < 1e-3
        assert document["feasible"] is True
        assert document["constraints"]["max_pressure"] < 0
        assert document["warnings"] == []

    def test_waveforms_are_one_revolution(self, simulated):
        with xarray.open_dataset(simulated[1], engine="h5netcdf") as waves:
            assert waves.sizes["operating_point"] == 1
            assert waves.chamber_pressure.dims == ("operating_point", "angle")

    def test_the_table_has_units_and_the_error(self, motor):
        done = RUN.invoke(app, ["simulate", motor])
        assert done.exit_code == 0
        assert re.search(r"Mean torque +N·m +1.495", done.stdout)
        assert "Numerical error: at most" in done.stdout
        assert "constraints hold" in done.stdout
        assert "\x1b[" not in done.stdout

    def test_an_undercut_is_a_warning(self, tmp_path):
        path = tmp_path / "undercut.toml"
        path.write_text(with_line('radius = "80 mm"', SIMPLE))
        done = RUN.invoke(app, ["simulate", str(path), "--json"])
        assert done.exit_code == 0
        document = json.loads(done.stdout)
        assert any("undercuts the ring" in sentence for sentence in document["warnings"])
        assert document["feasible"] is False
        assert "Infinity" not in done.stdout

    def test_overlapping_windows_are_a_warning_and_a_result(self, tmp_path):
        path = tmp_path / "overlap.toml"
        text = SIMPLE.replace('_width = "28.4 deg"', '_width = "32 deg"')
        path.write_text(text[: text.index("[design_space]")])
        document = json.loads(RUN.invoke(app, ["simulate", str(path), "--json"]).stdout)
        assert any("overlap by 2 deg at the inner" in each for each in document["warnings"])
        assert 0 < document["results"][0]["efficiency"] < 1

    def test_a_motor_that_wastes_most_of_its_power_is_a_warning(self):
        text = with_line('leakage_coefficient = "5e-11 m^3/(s*Pa)"', SIMPLE)
        found = looked_at(parse_motor_file(text), estimate=False)
        said = next(each for each in found.warnings() if "hydraulic power reaches" in each)
        assert said.startswith(f"Only {100 * found.outcome.results[0]['efficiency']:.2g} %")

    def test_a_shaft_that_is_driven_is_a_warning(self):
        text = with_line('shift = "30 deg"', SIMPLE)
        text = text[: text.index("[design_space]")]
        said = " ".join(looked_at(parse_motor_file(text), estimate=False).warnings())
        assert "The shaft is driven" in said

    def test_bad_input_is_one_sentence(self, tmp_path):
        path = tmp_path / "bad.toml"
        path.write_text(with_line('bore = "30 s"'))
        for command in ("simulate", "check"):
            done = RUN.invoke(app, [command, str(path)])
            assert done.exit_code == 2
            assert done.stdout == ""
            assert done.stderr.startswith('camring: motor.bore is "30 s"')
            assert done.stderr.count("\n") == 1


class TestCheck:
    @pytest.fixture(autouse=True)
    def _no_envelope(self, monkeypatch):
        """What is said of it has tests of its own, in test_envelope_facts.py."""
        monkeypatch.setattr(EnvelopeFacts, "of", lambda file: None)

    def test_prints_the_facts(self, motor):
        done = RUN.invoke(app, ["check", motor])
        assert done.exit_code == 0, done.output
        said = " ".join(done.stdout.split())
        assert "8 on 6, in 4 phases" in said
        assert "24, 48, 72" in said
        assert "400.4 cm³/rev" in said
        assert "return closes 0.80 deg before, supply opens 0.80 deg after" in said
        assert "full pre-compression takes" in said
        assert "max_contact_stress at most 1.9 GPa" in said
        assert "All 9 constraints hold." in said

    def test_a_broken_constraint_is_exit_code_3(self, tmp_path):
        path = tmp_path / "weak.toml"
        path.write_text(with_line('max_contact_stress = "1 GPa"', SIMPLE))
        done = RUN.invoke(app, ["check", str(path)])
        assert done.exit_code == 3
        assert "Broken: max_contact_stress." in done.stdout
        done = RUN.invoke(app, ["check", str(path), "--json"])
        assert done.exit_code == 3
        assert json.loads(done.stdout)["feasible"] is False

    def test_json_holds_the_facts(self, motor):
        document = json.loads(RUN.invoke(app, ["check", motor, "--json"]).stdout)
        assert document["surviving_order"] == 24
        assert document["common_divisor"] == 2
        assert document["displacement"] == pytest.approx(400.4e-6, rel=1e-3)
        assert document["timing"]["supply_opens"] == pytest.approx(np.radians(0.8))
        assert document["design_space"][-1] == "cam cos 8"
