"""camring map and sweep: a grid is its points one by one, written so that it can be read back."""

import csv
import json
import sys
from dataclasses import replace

import equinox as eqx
import jax
import numpy as np
import pytest
from motor_files import SOUND, with_line
from typer.testing import CliRunner

from camring.analyses.operating_map import envelope_on, operating_map
from camring.analyses.ranges import axis, point_counts
from camring.analyses.sweep import sweep
from camring.cli.app import app
from camring.evaluation.simulations import (
    ACCURACY,
    CHUNK,
    Many,
    agreed,
    of_one,
    repeated,
    results_of_many,
    stacked,
)
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.keys import key_map
from camring.files.result_names import result_names
from camring.files.units import to_si
from camring.metrics.error_estimate import relative_error
from camring.metrics.summary import Metrics
from camring.numerics.verdict import Fault
from camring.presentation.grid import Folder, chosen_results, csv_text
from camring.programs.compiled import simulate, summarise

RUN = CliRunner()
FILE = parse_motor_file(SOUND)
SHIFT = "motor.valve_plate.shift"
SPEED, SUPPLY = "operating_points.speed", "operating_points.supply_pressure"


def alone(motor, fluid, point):
    """All results of one simulation that knows no batch."""
    return vars(summarise(simulate(motor, fluid, point), FILE.goal.harmonics))


def agree(grid, place, found):
    """To the accuracy that a batch claims, and a tenth of it where no layer is thin."""
    found = {name: np.asarray(value) for name, value in found.items()}
    here = {name: grid.results[name][place] for name in found}
    away = {name: np.abs(here[name] - found[name]) for name in found}
    errors = relative_error(Metrics(**found), Metrics(**away))
    assert max(errors.values()) < ACCURACY / 10, max(errors.items(), key=lambda each: each[1])


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


def test_the_frame_of_a_map_is_the_envelope_in_whatever_unit_its_axes_have():
    lines = 'speed = ["30 rpm", "300 rpm"]\nsupply_pressure = ["70 bar", "350 bar"]'
    file = parse_motor_file(f"{SOUND}\n[envelope]\n{lines}\n")
    entries = key_map(file.choices)
    for speed, pressure, low in (
        ("rpm", "bar", 70),
        ("1/min", "kg/cm2", 71.38),
        ("min-1", "barg", 68.98675),
    ):
        axes = (axis(SPEED, f"10..400 {speed}", entries[SPEED], 3),
                axis(SUPPLY, f"50..400 {pressure}", entries[SUPPLY], 3))  # fmt: skip
        speeds, pressures = envelope_on(axes, file)
        assert speeds == pytest.approx((30, 300))
        assert pressures[0] == pytest.approx(low, rel=1e-5)


def test_a_sweep_is_the_motor_files_with_these_numbers(small_sweep):
    assert small_sweep.faults.shape == (3, 2)
    text = SOUND.replace('shift = "0 deg"', 'shift = "-1 deg"').replace('"6 cm^3"', '"5 cm^3"')
    system = parse_motor_file(text).system
    found = alone(system.motor, system.fluid, system.operating_points[0])
    agree(small_sweep, (0, 0), found)


def test_a_sweep_over_an_operating_point_is_the_map(small_map):
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
    np.testing.assert_array_equal(ripple, ripple[-1])


@pytest.fixture
def made_up():
    """Results of four simulations, of no motor: the place itself, and one more."""
    values = {name: np.arange(4) + 2.0 for name in result_names()}
    return Many(Metrics(**values), np.zeros(4, int))


def test_what_two_resolutions_do_not_agree_on_is_doubtful(made_up):
    values = {name: each.copy() for name, each in vars(made_up.metrics).items()}
    values["torque_ripple"][2] *= 1 + 2 * ACCURACY
    values["flow_ripple"][1] *= 1 + ACCURACY / 2
    values["efficiency"][3] = np.nan
    coarser = Many(Metrics(**values), np.array([8, 0, 0, 0]))
    assert agreed(made_up, coarser).tolist() == [False, True, False, False]
    assert agreed(made_up, coarser, ["flow_ripple"]).tolist() == [False, True, True, True]


def test_what_is_doubtful_is_what_the_solver_for_one_motor_says(made_up, monkeypatch):
    asked = []

    def alone(systems, which, harmonics):
        asked.extend(which.tolist())
        return Many(jax.tree.map(lambda each: -each[which], made_up.metrics), which * 0 + 4)

    doubtful = np.array([False, True, False, True])
    monkeypatch.setattr("camring.evaluation.simulations.one_by_one", alone)
    monkeypatch.setattr(
        "camring.evaluation.simulations.side_by_side", lambda *_: (made_up, doubtful.copy())
    )
    system = FILE.system
    found = results_of_many(
        *(repeated(each, 4) for each in (system.motor, system.fluid, system.operating_points[0]))
    )
    assert asked == [1, 3]
    assert found.metrics.efficiency.tolist() == [2, -3, 4, -5]
    assert found.faults.tolist() == [0, 4, 0, 4]


def test_a_batch_of_motors_has_them_along_the_last_axis():
    motor = FILE.system.motor
    for many in (repeated(motor, 3), stacked([motor] * 3)):
        assert many.cam.control_radii.shape == (*motor.cam.control_radii.shape, 3)
        assert many.dead_volume.shape == (3,)
        jax.tree.map(np.testing.assert_array_equal, of_one(many, 1), motor)


def test_the_table_holds_every_result_with_a_unit_that_reads_back(small_sweep):
    head, *rows = list(csv.reader(csv_text(small_sweep).splitlines()))
    names = [each.partition(" [")[0] for each in head]
    units = [each.partition(" [")[2].rstrip("]") for each in head]
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


def test_a_point_without_a_result_is_no_number_and_has_its_reason(small_sweep):
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
    row = csv_text(holed).splitlines()[3].split(",")
    assert row[2:5] == ["NaN", "NaN", "NaN"]
    assert "not found to solver accuracy" in row[-1]
    assert holed.warnings()[0].startswith("1 of 6 points have no results")


def test_a_warning_names_the_values_of_the_axes_and_how_many_points_the_envelope_holds(small_map):
    results = {**small_map.results, "min_contact_force": np.ones((3, 2))}
    results["min_contact_force"][:2, 0] = -1.0
    lifted = replace(small_map, results=results)
    assert lifted.warnings() == [
        "2 of 6 points: the roller lifts off the ring (30 to 165 rpm, 100 bar)."
    ]
    for ends, words in (((100, 300), "1 of them"), ((200, 300), "none of them")):
        warned = replace(lifted, envelope=(ends, (50, 350))).warnings()
        assert warned[0].endswith(f"(30 to 165 rpm, 100 bar; {words} in the envelope).")


ENVELOPE = """
[envelope]
speed = ["30 rpm", "300 rpm"]
supply_pressure = ["70 bar", "35 MPa"]
"""


def test_without_ranges_a_map_covers_the_envelope_of_the_file(small_map, monkeypatch):
    """At each point a result of the small map, for where the points lie is all that is asked."""
    metrics = type("Metrics", (), {})()
    vars(metrics).update({name: np.zeros(6) for name in small_map.results})
    monkeypatch.setattr(
        "camring.analyses.operating_map.results_of_many",
        lambda *_, **__: Many(metrics, np.zeros(6, int)),
    )
    asked = parse_motor_file(SOUND + ENVELOPE)
    found = operating_map(asked, points="3x2")
    assert found.axes[0].shown.tolist() == [30, 165, 300]
    assert found.axes[1].shown.tolist() == [70, 350]
    assert found.in_envelope.all()
    beyond = operating_map(asked, speed="50..100 rad/s", pressure="20..400 bar", points="3x2")
    assert beyond.envelope[0] == pytest.approx((np.pi, 10 * np.pi))
    assert beyond.in_envelope.tolist() == [[False, False]] * 3
    plain = operating_map(FILE, points="3x2")
    assert plain.envelope is None
    assert plain.axes[0].shown.tolist() == [15, 232.5, 450]


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
    assert len((out / "map.csv").read_text().splitlines()) == 1 + 12
    again = run(*asked, "--format", "svg")
    assert again.exit_code == 2
    assert "exists" in again.stderr
    done = run(*asked, "--format", "none", "--force", "--json")
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert np.shape(said["results"]["efficiency"]) == (4, 3)
    assert [each["unit"] for each in said["axes"]] == ["rpm", "bar"]


def test_another_motor_stands_beside_on_the_same_axes(motor, tmp_path):
    """As given and the best: both over the values of the first, whatever the other's envelope."""
    leaky, out = tmp_path / "leaky.toml", tmp_path / "map"
    leaky.write_text(with_line('leakage_coefficient = "2e-12 m^3/(s*Pa)"') + ENVELOPE)
    values = ("--speed", "90, 100, 300 rpm", "--pressure", "100..350 bar", "--points", "3x2")
    asked = ("map", motor, "--out", out, *values, "--results", "efficiency")
    assert run(*asked).exit_code == 0
    alone = (out / "map.csv").read_text()
    done = run(*asked, "--beside", leaky, "--force")
    assert done.exit_code == 0, done.output
    assert str(leaky) in done.output.replace("\n", "")
    assert {path.name for path in out.iterdir()} == {
        "map.csv", "map_beside.csv", "efficiency.png"
    }  # fmt: skip
    assert (out / "map.csv").read_text() == alone
    heads, *rows = csv.reader(alone.splitlines())
    _, *others = csv.reader((out / "map_beside.csv").read_text().splitlines())
    efficiency = heads.index("efficiency [%]")
    for row, other in zip(rows, others, strict=True):
        assert row[:2] == other[:2]
        assert float(other[efficiency]) < float(row[efficiency])
    said = json.loads(run(*asked, "--beside", leaky, "--force", "--json").stdout)
    assert np.shape(said["beside"]["results"]["efficiency"]) == (3, 2)
    assert said["beside"]["input"] == str(leaky)
    refused = run(*asked, "--beside", leaky, "--force", "--point", "3")
    assert refused.exit_code == 2
    leaky.write_text(
        leaky.read_text().replace('return_pressure = "10 bar"', 'return_pressure = "120 bar"')
    )
    refused = run(*asked, "--beside", leaky, "--force")
    assert refused.exit_code == 2
    assert "leaky.toml: envelope.supply_pressure begins at" in refused.stderr.replace("\n", " ")
    assert (out / "map_beside.csv").exists()
    assert run(*asked, "--force").exit_code == 0
    assert not (out / "map_beside.csv").exists()  # it belonged to the earlier map


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
        (["--beside", "missing.toml"], "missing.toml"),
        (["--beside", "missing.toml", "--charge"], "does not go with --charge"),
    ],
)
def test_a_map_that_cannot_be_is_refused_and_leaves_nothing(motor, tmp_path, arguments, words):
    done = run("map", motor, "--out", tmp_path / "map", *arguments)
    assert done.exit_code == 2, done.output
    assert words in done.stderr
    assert not (tmp_path / "map").exists()


def test_ranges_are_even_in_the_unit_they_are_written_in():
    from camring.files.motor.keys import key_map

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
