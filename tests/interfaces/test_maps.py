"""camring map and sweep: a grid is its points one by one, written so that it can be read back."""

import csv
import json
import sys

import equinox as eqx
import numpy as np
import pytest
from motor_files import SOUND
from typer.testing import CliRunner

from camring.interfaces.batch import CHUNK, repeated, results_of_many
from camring.interfaces.cli import app
from camring.interfaces.compiled import simulate, summarise
from camring.interfaces.config import parse_motor_file
from camring.interfaces.errors import InputError
from camring.interfaces.grid import result_names
from camring.interfaces.grid_output import Folder, chosen_results, csv_text
from camring.interfaces.operating_map import operating_map
from camring.interfaces.ranges import axis, point_counts
from camring.interfaces.sweep import sweep
from camring.interfaces.units import to_si
from camring.numerics.verdict import Fault

RUN = CliRunner()
FILE = parse_motor_file(SOUND)
SHIFT = "motor.valve_plate.shift"
SPEED, SUPPLY = "operating_points.speed", "operating_points.supply_pressure"


def alone(motor, fluid, point):
    """All results of one simulation that knows no batch."""
    return vars(summarise(simulate(motor, fluid, point), FILE.goal.harmonics))


def agree(grid, place, found):
    for name in result_names():
        if name != "power_residual":  # what is left of a difference of equals
            scale = max(abs(float(found[name])), 1e-12)
            assert grid.results[name][place] == pytest.approx(float(found[name]), rel=1e-8), (
                name,
                scale,
            )


@pytest.fixture(scope="module")
def small_map():
    return operating_map(
        FILE, speed="30..300 rpm", pressure="100 bar..350 bar", points="3x2", operating_point=2
    )


@pytest.fixture(scope="module")
def small_sweep():
    return sweep(FILE, {SHIFT: "-1..1 deg", "motor.dead_volume": "5 cm^3, 6 cm^3"}, points="3x9")


def test_a_map_is_its_points_one_by_one(small_map):
    point = FILE.system.operating_points[1]
    for place in ((0, 0), (2, 1)):
        speed = to_si(f"{small_map.axes[0].shown[place[0]]} rpm", "rad/s")
        pressure = to_si(f"{small_map.axes[1].shown[place[1]]} bar", "Pa")
        asked = eqx.tree_at(
            lambda p: (p.shaft_speed, p.supply_pressure),
            point,
            (np.array(speed), np.array(pressure)),
        )
        agree(small_map, place, alone(FILE.system.motor, FILE.system.fluid, asked))


def test_a_sweep_is_the_motor_files_with_these_numbers(small_sweep):
    assert small_sweep.faults.shape == (3, 2)
    text = SOUND.replace('shift = "0 deg"', 'shift = "-1 deg"').replace('"6 cm^3"', '"5 cm^3"')
    system = parse_motor_file(text).system
    found = alone(system.motor, system.fluid, system.operating_points[0])
    agree(small_sweep, (0, 0), found)


def test_a_sweep_over_a_duty_is_the_map(small_map):
    swept = sweep(FILE, {SPEED: "30..300 rpm"}, points="3", operating_point=2)
    other = operating_map(
        FILE, speed="30..300 rpm", pressure="350 bar, 360 bar", points="3", operating_point=2
    )
    np.testing.assert_allclose(
        swept.results["efficiency"], other.results["efficiency"][:, 0], rtol=1e-9
    )


def test_a_bad_motor_sinks_nobody_else():
    system, count = FILE.system, CHUNK + 3
    motors = repeated(system.motor, count)
    volumes = np.array(motors.dead_volume)
    volumes[5] = -volumes[5]
    motors = eqx.tree_at(lambda m: m.dead_volume, motors, volumes)
    fluids, points = repeated(system.fluid, count), repeated(system.operating_points[0], count)
    found = results_of_many(motors, fluids, points, harmonics=FILE.goal.harmonics)
    assert found.faults.shape == found.metrics.efficiency.shape == (count,)
    assert found.faults[5] & Fault.CHAMBER_VOLUME_NOT_POSITIVE
    others = np.delete(np.arange(count), 5)
    assert not found.faults[others].any()
    ripple = found.metrics.torque_ripple[others]
    np.testing.assert_allclose(ripple, ripple[0], rtol=1e-12)


def test_the_table_holds_every_result_with_a_unit_that_reads_back(small_sweep):
    names, units, *rows = list(csv.reader(csv_text(small_sweep).splitlines()))
    assert names == [SHIFT, "motor.dead_volume", *result_names(), "fault"]
    assert len(rows) == small_sweep.faults.size
    assert [row[:2] for row in rows[:3]] == [["-1.0", "5.0"], ["-1.0", "6.0"], ["0.0", "5.0"]]
    assert units[:2] == ["deg", "cm^3"]
    for name, si_unit in (
        ("mean_torque", "N*m"),
        ("min_pressure", "Pa"),
        ("supply_flow", "m^3/s"),
        ("efficiency", "1"),
        ("max_acceleration", "m/s^2"),
    ):
        column = names.index(name)
        read = [to_si(f"{row[column]} {units[column]}", si_unit) for row in rows]
        np.testing.assert_allclose(read, small_sweep.results[name].ravel(), rtol=1e-12)


def test_a_point_without_a_result_is_an_empty_cell_with_its_reason(small_sweep):
    faults = small_sweep.faults.copy()
    faults[1, 0] = Fault.NOT_CONVERGED
    holed = type(small_sweep).of(
        small_sweep.axes,
        type("Metrics", (), {"__init__": lambda self, d: self.__dict__.update(d)})(
            {name: values.ravel() for name, values in small_sweep.results.items()}
        ),
        faults.ravel(),
        {},
        "",
    )
    assert np.isnan(holed.results["efficiency"][1, 0])
    assert np.isfinite(holed.results["efficiency"]).sum() == 5
    row = csv_text(holed).splitlines()[4].split(",")
    assert row[2:5] == ["", "", ""]
    assert "not found to solver accuracy" in row[-1]
    assert holed.warnings()[0].startswith("1 of 6 points have no results")


@pytest.fixture(scope="module")
def motor(tmp_path_factory):
    path = tmp_path_factory.mktemp("motor") / "motor.toml"
    path.write_text(SOUND)
    return path


def run(*arguments):
    return RUN.invoke(app, [str(argument) for argument in arguments])


def test_the_map_command_writes_a_table_and_pictures(motor, tmp_path):
    out = tmp_path / "map"
    asked = ("map", motor, "--out", out, "--points", "4x3", "--results", "efficiency")
    done = run(*asked, "--format", "svg")
    assert done.exit_code == 0, done.output
    assert "Efficiency" in done.output
    assert {path.name for path in out.iterdir()} == {"map.csv", "efficiency.svg"}
    assert (out / "efficiency.svg").read_text().count("<svg") == 1
    assert len((out / "map.csv").read_text().splitlines()) == 2 + 12
    again = run(*asked, "--format", "svg")
    assert again.exit_code == 2
    assert "exists" in again.stderr
    done = run(*asked, "--format", "none", "--force", "--json")
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert np.shape(said["results"]["efficiency"]) == (4, 3)
    assert [each["unit"] for each in said["axes"]] == ["rpm", "bar"]


def test_without_matplotlib_the_table_comes_and_says_that_the_picture_does_not(
    small_map, tmp_path, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    names = ("efficiency", "torque_ripple")
    written = Folder(tmp_path, "map.csv", names, "png", replace=False).write(small_map, names)
    assert [each.name for each in written] == ["map.csv"]
    assert [each.name for each in tmp_path.iterdir()] == ["map.csv"]
    assert "picture is left out. Pictures need matplotlib" in capsys.readouterr().err


def test_the_sweep_command_prints_and_writes(motor, tmp_path):
    out = tmp_path / "sweep"
    done = run("sweep", motor, f"{SHIFT}=-0.5..0.5 deg", "--points", "3", "--out", out)
    assert done.exit_code == 0, done.output
    assert {path.name for path in out.iterdir()} == {"sweep.csv", "sweep.png"}
    assert "Torque ripple" in done.output
    assert "better end" in done.output


REFUSED = [
    (["motor.valve_plate.shfit=-1..1 deg"], "you probably meant motor.valve_plate.shift"),
    (["dead_volume=5..6 cm^3"], "you probably meant motor.dead_volume"),
    (["fluid.air_fraction=0..0.01"], 'has no effect with fluid.law = "constant"'),
    (["motor.bore=1 deg..2 deg"], "measures an angle, not a length"),
    (["motor.bore=30 mm"], "must be a range or a list"),
    (["motor.bore=30 mm..30 mm"], "has the empty range"),
    (["motor.bore=30 mm, 32 mm, 31 mm"], "neither rises nor falls"),
    (["motor.bore"], "is no KEY=RANGE"),
    (["motor.bore=0.03..0.04"], "without a unit; write one behind it: 30 mm"),
    (["motor.bore=29..30 mm", "motor.bore=29..30 mm"], "appears twice"),
    (["motor.bore=1..2", "motor.dead_volume=1..2", f"{SHIFT}=0..1"], "give one or two"),
    (["motor.pistons=5..9"], "is a count"),
    (["motor.cam.control_radii=80..90 mm"], "is a list"),
    (["motor.cam.control_radii[99]=80..90 mm"], "counts beyond"),
    (["motor.cam.symmetry=0..1"], "is a word"),
    (["motor.valve_plate.supply_width=20 deg..70 deg"], "wider than the pitch of 60 deg"),
    ([f"{SHIFT}=0..1 deg", "--points", "many"], "must be a whole number"),
    ([f"{SHIFT}=0..1 deg", "--points", "1"], "takes 2 to 1000"),
    ([f"{SHIFT}=0..1 deg", "--point", "3"], "has 2 operating points"),
    (["operating_points[1].speed=30..60 rpm"], "add --point 2"),
    (["operating_points.weight=0..1"], "changes no result"),
    ([f"{SHIFT}=0..1 deg", "--results", "eficiency"], "you probably meant efficiency"),
]


@pytest.mark.parametrize(("arguments", "words"), REFUSED)
def test_a_sweep_that_cannot_be_is_refused_in_a_sentence(motor, arguments, words):
    done = run("sweep", motor, *arguments)
    assert done.exit_code == 2, done.output
    assert words in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--pressure", "5 bar..100 bar"], "not above the return pressure of 10 bar"),
        (["--speed", "10..20 bar"], "which measures a pressure"),
        (["--speed", "10..300"], "without a unit"),
        (["--speed", "-5 rpm..20 rpm"], "operating_points.speed"),
        (["--points", "400x400"], "asks for 160,000 simulations"),
    ],
)
def test_a_map_that_cannot_be_is_refused_and_leaves_nothing(motor, tmp_path, arguments, words):
    done = run("map", motor, "--out", tmp_path / "map", *arguments)
    assert done.exit_code == 2, done.output
    assert words in done.stderr
    assert not (tmp_path / "map").exists()


def test_ranges_are_even_in_the_unit_they_are_written_in():
    from camring.interfaces.config.keys import key_map

    entry = key_map(FILE.choices)[SHIFT]
    found = axis(SHIFT, "-0.1 rad .. 0.1 rad", entry, 3)
    assert (found.unit, found.shown.tolist()) == ("rad", [-0.1, 0.0, 0.1])
    found = axis(SHIFT, "-1..1 deg", entry, 5)
    assert (found.unit, found.shown.tolist()) == ("deg", [-1.0, -0.5, 0.0, 0.5, 1.0])
    found = axis("motor.bore", "1 cm, 20 mm, 30 mm", key_map(FILE.choices)["motor.bore"], 99)
    assert (found.unit, found.shown.tolist()) == ("mm", [10.0, 20.0, 30.0])
    assert found.label == "Bore, mm"


def test_points_are_one_number_or_one_for_each_axis():
    assert point_counts(None, 2, 40) == (40, 40)
    assert point_counts("12", 2, 40) == (12, 12)
    assert point_counts("12 x 7", 2, 40) == (12, 7)
    with pytest.raises(InputError, match="one whole number, or one for each axis"):
        point_counts("1x2x3", 2, 40)


def test_results_are_named_as_everywhere():
    assert chosen_results("efficiency, torque_ripple,efficiency", ()) == (
        "efficiency",
        "torque_ripple",
    )
    with pytest.raises(InputError, match="names 0 results"):
        chosen_results(" , ", ())
