"""Starting points: the library, motors from a catalogue's data, and what is refused."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from motor_files import SOUND, added, with_line
from new_command import CATALOGUE, new, refused
from typer.testing import CliRunner

from benchmarks.shipped_motors import everywhere, published_rows
from camring.analyses.simulation import simulated
from camring.evaluation.crowding import crowded
from camring.files.motor.motor_file import parse_motor_file, read_motor_file
from camring.files.starting.library import class_of, library
from camring.files.starting.sizing import combinations
from camring.files.starting.template import template
from camring.geometry.block import guided_length
from camring.metrics.estimate import (
    Conditions,
    Sketch,
    efficiency,
    hydromechanical_efficiency,
    volumetric_efficiency,
)

RUN = CliRunner()
EXAMPLES = Path(__file__).parents[2] / "examples"
MOTORS = library()
SHIPPED = {
    **MOTORS,
    "template": template("sine"),
    "tolerances": (EXAMPLES / "wheel_tolerances.toml").read_text(),
}
OF_ONE_PROGRAM = ("skid", "wheel", "template")
"""Eight pistons on six lobes, as what `camring new` writes below: one compilation."""


def sketch_of(file):
    """A motor with a sine cam as the closed forms know it."""
    motor, fluid, point = file.system.motor, file.system.fluid, file.system.operating_points[0]
    radius = np.asarray(motor.cam.pitch_radius(np.linspace(0, motor.cam.period, 721)).value)
    return Sketch(
        motor.pistons,
        motor.lobes,
        float(motor.piston.bore),
        np.ptp(radius),
        (radius.min() + radius.max()) / 2,
        float(motor.roller.radius),
        float(motor.roller.length),
        float(motor.valve_plate.port_area),
        float(motor.dead_volume),
        float(motor.piston.mass),
        float(motor.viscous_damping(fluid)),
        float(motor.leakage_conductance(fluid, point.supply_pressure, point.case_pressure)),
        float(motor.friction.roller),
        float(motor.friction.side),
    )


def conditions_at(file, point):
    oil = file.system.fluid
    pressures = (point.supply_pressure, point.return_pressure, point.case_pressure)
    return Conditions(
        float(point.shaft_speed),
        *map(float, pressures),
        float(oil.density),
        float(oil.bulk_modulus),
    )


def displacement(file):
    """From the control radii alone: the spline's own stroke at the dead centres, m3."""
    motor = file.system.motor
    angle = np.linspace(0, motor.cam.period, 721)
    stroke = float(np.ptp(motor.cam.pitch_radius(angle).value))
    return motor.pistons * motor.lobes * float(motor.piston.area) * stroke


class TestLibrary:
    def test_spans_a_wheel_to_a_drum(self):
        litres = [1e3 * displacement(parse_motor_file(text)) for text in MOTORS.values()]
        assert len(litres) >= 8
        assert litres == sorted(litres)
        assert litres[0] == pytest.approx(0.2, rel=0.01)
        assert litres[-1] == pytest.approx(30, rel=0.01)

    @pytest.mark.parametrize("name", MOTORS)
    def test_each_reads_fits_and_has_the_displacement_that_it_says(self, name):
        text = MOTORS[name]
        file = parse_motor_file(text)
        motor = file.system.motor
        stated = float(re.search(r"([\d.]+) L/rev", motor.name)[1]) * 1e-3
        # "Mill motor, 13 L/rev" is 13.2; the band of the file is the exact statement.
        assert displacement(file) == pytest.approx(stated, rel=0.02)
        low, high = file.goal.constraints.displacement
        assert displacement(file) == pytest.approx((low + high) / 2, rel=0.002)
        inner = float(np.min(motor.cam.pitch_radius(np.linspace(0, motor.cam.period, 721)).value))
        assert guided_length(motor.pistons, float(motor.piston.bore), inner) > motor.piston.bore
        assert 2 * motor.roller.radius < motor.piston.bore
        assert (motor.pistons, motor.lobes) in combinations()
        assert file.design_space.dimension >= 10
        assert class_of(text)
        assert "no maker's data" in text

    @pytest.mark.parametrize("name", ["wheel", "winch", "mill"])
    def test_the_reference_machines_are_the_examples(self, name):
        example = (EXAMPLES / f"{name}_motor.toml").read_text()
        assert tomllib.loads(MOTORS[name]) == tomllib.loads(example)

    def test_a_table_shows_every_motor(self):
        said = new("--list").stdout
        assert all(re.search(rf"^{name} +[\d.]+ ", said, re.M) for name in MOTORS)

    def test_like_writes_one_as_it_stands(self, tmp_path):
        path = tmp_path / "motor.toml"
        done = new(path, "--like", "drum")
        assert done.exit_code == 0
        assert path.read_text() == MOTORS["drum"]

    def test_a_misspelt_name_gets_its_neighbour(self, tmp_path):
        assert "you probably meant winch" in refused(tmp_path / "m.toml", "--like", "whinch")
        assert "camring new --list" in refused(tmp_path / "m.toml", "--like", "zzz")
        assert list(tmp_path.iterdir()) == []


class TestEfficiency:
    """What radial-piston motors lose on a test bench: rows and sources in docs/validation.md."""

    @pytest.mark.parametrize("name", SHIPPED)
    def test_each_loses_what_its_class_loses(self, name):
        """By closed forms, which the simulation confirms below."""
        file = parse_motor_file(SHIPPED[name])
        sketch, points = sketch_of(file), file.system.operating_points
        slowest = min(points, key=lambda each: float(each.shaft_speed))
        published = [share for _, litres, share, _ in published_rows() if litres > 2]
        slow = hydromechanical_efficiency(sketch, conditions_at(file, slowest))
        assert 0.92 < slow < 0.96
        assert min(published) < slow < max(published) + 0.005
        for each in points:
            assert volumetric_efficiency(sketch, conditions_at(file, each)) < 1
            assert 0.88 < efficiency(sketch, conditions_at(file, each)) < 0.95

    @pytest.mark.parametrize("name", SHIPPED)
    def test_each_runs_from_a_tenth_of_its_speed_and_a_fifth_of_its_pressure(self, name):
        file = parse_motor_file(SHIPPED[name])
        envelope, points = file.envelope, file.system.operating_points
        fastest, highest = (
            max(float(getattr(each, of)) for each in points)
            for of in ("shaft_speed", "supply_pressure")
        )
        assert envelope.speed == pytest.approx((fastest / 10, fastest))
        assert envelope.supply_pressure == pytest.approx((highest / 5, highest))
        # A motor that is its own mirror image does the same both ways.
        plate = file.system.motor.valve_plate
        as_wide = plate.notch is None and plate.supply.width == plate.return_.width
        centred = plate.shift == 0 and plate.return_.centre == pytest.approx(
            3 * float(plate.supply.centre)
        )
        assert (as_wide and centred) or not envelope.both_directions

    @pytest.mark.parametrize("name", OF_ONE_PROGRAM)
    def test_simulated_each_does_so_and_keeps_every_limit_all_over_its_envelope(self, name):
        file = parse_motor_file(SHIPPED[name])
        found, sketch = everywhere(file, points=3), sketch_of(file)
        assert not np.any(found.faults)
        for limit, by in found.limits.items():
            assert np.all(by <= 0), limit
        assert np.all(found.metrics.volumetric_efficiency[:2] < 1)
        assert 0.92 < found.metrics.hydromechanical_efficiency[1] < 0.96
        for place, each in enumerate(file.system.operating_points):
            expected = float(efficiency(sketch, conditions_at(file, each)))
            assert 0.88 < found.metrics.efficiency[place] < 0.95
            assert found.metrics.efficiency[place] == pytest.approx(expected, abs=0.01)


class TestCatalogue:
    def test_writes_the_marked_motor_and_shows_the_others(self, tmp_path):
        path = tmp_path / "motor.toml"
        done = new(path, "--displacement", "2 L/rev", *CATALOGUE, "--outer-diameter", "500 mm")
        assert done.exit_code == 0
        rows = re.findall(r"^(>?) +(\d+) x (\d+) ", done.stdout, re.M)
        assert len(rows) > 4
        assert [mark for mark, *_ in rows] == [">"] + [""] * (len(rows) - 1)
        file = read_motor_file(path)
        assert [str(file.system.motor.pistons), str(file.system.motor.lobes)] == [*rows[0][1:]]
        assert displacement(file) == pytest.approx(2e-3, rel=1e-4)
        assert file.design_space.dimension > 10

    def test_what_it_writes_simulates_as_it_promised(self, tmp_path):
        path = tmp_path / "motor.toml"
        done = new(path, "--displacement", "2 L/rev", *CATALOGUE, "--counts", "8x6")
        row = next(line for line in done.stdout.splitlines() if line.startswith(">"))
        _, _, _, _, _, _, _, reached, stress, angle, order, _, promised = row.split()
        file = read_motor_file(path)
        found = everywhere(file, points=3)
        assert not np.any(found.faults)
        for limit, by in found.limits.items():
            assert np.all(by <= 0), limit
        results = found.metrics
        assert results.displacement[0] * 1e3 == pytest.approx(float(reached), rel=0.01)
        assert results.max_contact_stress[0] / 1e9 == pytest.approx(float(stress), rel=0.02)
        assert np.degrees(results.max_pressure_angle[0]) == pytest.approx(float(angle), rel=0.01)
        assert results.efficiency[0] * 100 == pytest.approx(float(promised), abs=0.5)
        assert file.system.motor.surviving_order == int(order)

    @pytest.mark.parametrize("text", ["2000 cm3/rev", "2000 cm^3", "2 dm^3/rev", "0.002 m^3/rev"])
    def test_a_displacement_may_be_written_as_data_sheets_do(self, text):
        said = new("--displacement", text, *CATALOGUE, "--counts", "10x8").stdout
        assert said.startswith("2 L/rev at 250 bar and 100 rpm")

    def test_a_band_of_displacement_may_say_per_revolution(self):
        text = with_line('displacement = ["0.39636 L/rev", "404.36 cm3/rev"]')
        low, high = parse_motor_file(text).goal.constraints.displacement
        assert (low, high) == pytest.approx((396.36e-6, 404.36e-6))

    @pytest.mark.parametrize("count", [(10, 7), (14, 10), (9, 6), (22, 16)])
    def test_every_count_gives_a_file_that_reads(self, tmp_path, count):
        path = tmp_path / "motor.toml"
        counts = f"{count[0]}x{count[1]}"
        done = new(path, "--displacement", "2 L/rev", *CATALOGUE, "--counts", counts)
        assert done.exit_code == 0, done.output
        assert read_motor_file(path).system.motor.pistons == count[0]

    @pytest.mark.parametrize(
        ("options", "words"),
        [
            (["--displacement", "2.5 L/rev"], "--pressure is missing"),
            (["--displacement", "2.5", *CATALOGUE], "without a unit"),
            (["--displacement", "2.5 kg/rev", *CATALOGUE], "not a volume"),
            (["--displacement", "2500 L/rev", *CATALOGUE], "give one between them"),
            (["--displacement", "2 L/rev", *CATALOGUE, "--counts", "ten"], '"10x8"'),
            (["--displacement", "2 L/rev", *CATALOGUE, "--counts", "4x8"], "no torque"),
            (["--like", "winch", *CATALOGUE], "does not go with --like"),
            (["--list", "--like", "winch"], "does not go with --list"),
            (["--like", "winch"], "FILE is missing"),
        ],
    )
    def test_what_cannot_be_used_is_refused(self, options, words):
        assert words in refused(*options)

    @pytest.mark.parametrize(
        ("option", "value", "way_out"),
        [
            ("--outer-diameter", "300 mm", r"give at least (\d+ mm)"),
            ("--pressure", "900 bar", r"give at most (\d+ bar)"),
            ("--speed", "3000 rpm", r"give at most (\d+ rpm)"),
            ("--speed", "5000 rpm", r"give at most (\d+ rpm)"),
        ],
    )
    def test_the_way_out_of_the_impossible_is_one(self, option, value, way_out):
        options = {"--displacement": "2.5 L/rev", "--pressure": "250 bar", "--speed": "100 rpm"}
        given = [part for pair in {**options, option: value}.items() for part in pair]
        said = refused(*given)
        assert said.startswith(f"camring: {option} is {value}")
        found = re.search(way_out, said)
        assert found, said
        again = [part for pair in {**options, option: found[1]}.items() for part in pair]
        assert new(*again).exit_code == 0


class TestCrowding:
    def test_pistons_and_rollers_that_do_not_fit_are_warnings(self):
        text = with_line('bore = "55 mm"').replace('radius = "12 mm"', 'radius = "34 mm"')
        said = " ".join(simulated(parse_motor_file(text), estimate=False).warnings())
        # Eight bores meet at 27.5 / sin(22.5 deg) = 71.86 mm; the rollers' centres stand at 85.
        assert "run into each other at a radius of 71.86 mm" in said
        assert "leaves 13.1 mm" in said
        assert "The rollers run into each other" in said
        assert "The rollers, 68 mm across, are wider than the pistons of 55 mm" in said

    def test_a_given_gap_says_how_long_a_piston_is(self):
        gap = 'clearance = "15 um"\nlength = "50 mm"'
        text = added("[motor.gap]", gap, added("[fluid]", 'viscosity = "46 cSt"'))
        motor = parse_motor_file(text).system.motor
        # 30 mm bores meet at 39.2 mm.
        assert crowded(motor, 0.0893) == []
        assert "of that gap takes 50 mm" in crowded(motor, 0.0891)[0]

    def test_the_template_fits(self):
        assert crowded(parse_motor_file(SOUND).system.motor, 0.085) == []
