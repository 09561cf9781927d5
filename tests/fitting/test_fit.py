"""`camring fit`: constants of a motor from rows that the motor made itself."""

import dataclasses
import json

import equinox as eqx
import numpy as np
import pytest
from motor_files import SOUND, added, with_line
from typer.testing import CliRunner

from camring.cli.app import app
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.fitting import batch_rows
from camring.fitting.doubts import Unfitted, require_fit, standardised
from camring.fitting.fit import fit
from camring.fitting.fitted_numbers import numbers_named
from camring.fitting.measurements.displacement import (
    geometric_displacement,
    implied_displacement,
)
from camring.fitting.measurements.operating_points import operating_points_of
from camring.fitting.measurements.table import parse_measured_table
from camring.fitting.simulated_rows import Bench
from camring.physics.piston_state import sample_angles
from camring.presentation.fitting import document
from camring.programs.compiled import simulate_compiled, summarise_compiled

TRUTH = {
    "motor.leakage_coefficient": 2.3e-13,
    "motor.viscous_damping": 60.0,
    "motor.roller.friction": 0.012,
    "motor.valve_plate.discharge_coefficient": 0.6,
}
ROWS = [(rpm, bar) for rpm in (20, 100, 250) for bar in (100, 180, 300)]
HEAD = "shaft speed [rpm],supply pressure [bar],mean torque [Nm],supply flow [L/min]"


def table(torque, flow):
    """The rows as CSV, torque in N m and flow in m3/s."""
    rows = (
        f"{rpm},{bar},{float(t)!r},{6e4 * float(q)!r}"
        for (rpm, bar), t, q in zip(ROWS, torque, flow, strict=True)
    )
    return "\n".join([HEAD, *rows])


@pytest.fixture(scope="module")
def file():
    return parse_motor_file(SOUND)


@pytest.fixture(scope="module")
def made(file):
    """Torque and flow of the motor with the true constants."""
    numbers = numbers_named(file, list(TRUTH))
    bench = Bench(file, parse_measured_table(table(np.ones(9), np.ones(9))), numbers)
    ratios = np.array([TRUTH[each.key] / each.scale for each in numbers])
    point = np.where([each.by_logarithm for each in numbers], np.log(ratios), ratios)
    return bench(point)[0].reshape(2, -1)


@pytest.fixture(scope="module")
def exact(file, made):
    return fit(file, parse_measured_table(table(*made)), list(TRUTH))


def test_constants_that_made_the_rows_are_found_again(exact):
    found = dict(zip((each.key for each in exact.numbers), exact.values, strict=True))
    for key, true in TRUTH.items():
        print(f"{key}: {found[key] / true - 1:+.1e}")
        assert found[key] == pytest.approx(true, rel=1e-4)
    assert exact.squares.settled
    np.testing.assert_allclose(exact.modelled, exact.measured, rtol=1e-6)
    assert np.max(np.abs(exact.before / exact.measured - 1)) > 0.01


def test_with_noise_the_true_constants_lie_near_their_intervals(file, made):
    """How often they lie inside is tested where it costs nothing, in test_least_squares.py."""
    random = np.random.default_rng(11)
    noisy = made * (1 + 0.002 * random.normal(size=made.shape))
    found = fit(file, parse_measured_table(table(*noisy)), list(TRUTH))
    true = np.array(list(TRUTH.values()))
    reach = np.maximum(found.high - found.values, found.values - found.low)
    assert np.all(np.abs(found.values - true) < 2 * reach)
    torque = found.of("mean_torque")
    assert 0.0008 < np.mean(found.deviation[torque] / found.measured[torque]) < 0.005


def test_density_and_discharge_coefficient_cannot_be_distinguished(file, made):
    """Flow through a port knows only Cd / sqrt(density)."""
    of = ["fluid.density", "discharge_coefficient", "leakage_coefficient", "motor.roller.friction"]
    found = fit(file, parse_measured_table(table(*made)), of)
    assert found.tangled == ((0, 1),)
    assert found.correlation[0, 1] == pytest.approx(1, abs=1e-6)
    assert not found.determined(0)
    assert not found.determined(1)
    assert found.determined(3)
    stated = json.loads(document(found, []))["numbers"]
    assert stated["fluid.density"]["high"] is None
    assert stated["motor.roller.friction"]["high"] > stated["motor.roller.friction"]["low"]
    said = " ".join(found.warnings)
    assert "fluid.density and motor.valve_plate.discharge_coefficient: these rows do not" in said
    assert "apart at all; keep one as given, for example --of" in said
    assert "leakage_coefficient,roller.friction." in said


def test_what_is_left_over_in_an_order_is_reported(exact):
    """Four readings of each row; torque misses by a curve over pressure, flow by chance."""
    bar = np.array([bar for _, bar in ROWS] * 2, dtype=float)
    curve = np.where(exact.of("mean_torque"), ((bar - 200) / 100) ** 2 - 0.7, 0.0)
    chance = np.where(exact.of("supply_flow"), np.random.default_rng(0).normal(size=(4, 18)), 0.0)
    left = (curve + chance).ravel() * 0.01
    measured = np.tile(exact.measured, 4)
    often = dataclasses.replace(
        exact,
        rows=np.tile(exact.rows, 4),
        results=exact.results * 4,
        measured=measured,
        modelled=measured * (1 + left),
        deviation=0.01 * measured,
        squares=dataclasses.replace(exact.squares, slopes=np.tile(exact.squares.slopes, (4, 1))),
    )
    systematic = [each for each in often.warnings if "is no chance" in each]
    assert len(systematic) == 1
    assert systematic[0].startswith("mean torque: what is left follows")
    assert not any("is no chance" in sentence for sentence in exact.warnings)


def test_rows_at_one_operating_point_are_reported(exact):
    """Three nearly equal rows, of torque and flow or of efficiency alone."""
    ones, conditions = np.ones(9), exact.table.conditions
    near = {name: values[0] * (1 + 0.01 * np.arange(9)) for name, values in conditions.items()}
    assert not any("one speed and pressure" in each for each in exact.warnings)
    both = dataclasses.replace(exact, table=dataclasses.replace(exact.table, conditions=near))
    said = [each for each in both.warnings if "one speed and pressure" in each]
    assert len(said) == 1
    assert "not which law loses it elsewhere" in said[0]
    alone = dataclasses.replace(
        exact,
        table=dataclasses.replace(
            exact.table,
            conditions=near,
            values={"efficiency": ones},
            deviations={"efficiency": ones},
        ),
        results=("efficiency",) * 18,
    )
    drained = dataclasses.replace(
        alone, table=dataclasses.replace(alone.table, values={"case_drain": ones})
    )
    drained = dataclasses.replace(drained, results=("case_drain",) * 18)
    drained.table.deviations["case_drain"] = ones
    said = [each for each in drained.warnings if "one speed and pressure" in each]
    assert "friction" not in said[0]  # none enters the drain
    said = [each for each in alone.warnings if "one speed and pressure" in each]
    assert "efficiency alone does not tell friction from leakage there" in said[0]
    assert "stand for both" in said[0]


def test_a_column_in_the_wrong_unit_is_reported(exact):
    wrong = dataclasses.replace(
        exact, measured=np.where(exact.of("supply_flow"), 60, 1) * exact.measured
    )
    far = [each for each in wrong.warnings if "still misses" in each]
    assert len(far) == 1
    assert far[0].startswith("supply flow: the fitted motor still misses it by 98 %; look at the")


def test_the_same_measurement_twice_is_reported(exact):
    ones, table = np.ones(9), exact.table
    twice = dataclasses.replace(
        exact,
        table=dataclasses.replace(
            table,
            values={**table.values, "efficiency": ones},
            deviations={**table.deviations, "efficiency": ones},
        ),
        rows=np.append(exact.rows, np.arange(9)),
        results=exact.results + 9 * ("efficiency",),
        measured=np.append(exact.measured, ones),
        modelled=np.append(exact.modelled, ones),
        deviation=np.append(exact.deviation, ones),
    )
    said = [each for each in twice.warnings if "counts twice" in each]
    assert len(said) == 1
    assert said[0].startswith("efficiency is computed from mean torque and supply flow")


def test_the_written_file_is_the_motor_with_these_numbers_and_says_where_from(exact):
    again = parse_motor_file(exact.text)
    lines = exact.text.splitlines()
    assert lines[0].startswith("# Fitted with `camring fit` ")
    assert "18 values of 9 rows" in lines[0]
    assert any(line.startswith("#   motor.roller.friction = 0.012, 95 % from") for line in lines)
    number = numbers_named(again, list(TRUTH))
    for each, value in zip(number, exact.values, strict=True):
        assert each.given == pytest.approx(value, rel=1e-5)
    rest = "\n".join(lines[len(TRUTH) + 2 :])
    assert rest.count("leakage_coefficient = ") == SOUND.count("leakage_coefficient = ")
    # A file that is fitted again tells of the last fit alone.
    anew = fit(again, exact.table, list(TRUTH))
    assert anew.text.count("# Fitted with") == 1
    assert "bore" in anew.text


def test_case_drain_is_the_leakage_of_all_pistons_at_their_mean_pressure(file):
    system = file.system
    cycle = simulate_compiled(system.motor, system.fluid, system.operating_points[0], None)
    angle = system.motor.cam.period * (np.arange(20_000) + 0.5) / 20_000
    pressure = eqx.filter_jit(lambda c, a: sample_angles(c, a).chamber_pressure)(cycle, angle)
    above = float(np.mean(pressure)) - float(cycle.point.case_pressure)
    expected = system.motor.pistons * float(system.motor.leakage.coefficient) * above
    assert float(summarise_compiled(cycle).case_drain) == pytest.approx(expected, rel=1e-5)


def test_unless_named_the_numbers_that_the_rows_tell_are_fitted(file, made):
    found = fit(file, parse_measured_table(table(*made)))
    fitted, left = ({each.key for each in some} for some in (found.numbers, found.left))
    assert {"motor.leakage_coefficient", "motor.roller.friction"} <= fitted
    # Both take torque with the load; one motor alone does not tell which.
    assert "motor.side_friction" in left
    assert not found.tangled
    assert not any("do not tell" in sentence for sentence in found.warnings)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, made):
    place = tmp_path_factory.mktemp("fit")
    (place / "motor.toml").write_text(SOUND)
    rows = table(*made).replace(".", "#").replace(",", ";").replace("#", ",")
    (place / "bench.csv").write_text("# Row names\n" + rows, encoding="utf-8-sig")
    return place


def command(folder, *words):
    files = [str(folder / "motor.toml"), str(folder / "bench.csv")]
    return CliRunner().invoke(app, ["fit", *files, *words])


def test_the_command_shows_writes_and_draws(folder):
    """From semicolons and decimal commas, as a German spreadsheet writes them."""
    out, picture = folder / "fitted.toml", folder / "fit.png"
    done = command(
        folder, "--of", ",".join(TRUTH), "--out", str(out), "--picture", str(picture), "--json"
    )
    assert done.exit_code == 0, done.output
    stated = json.loads(done.stdout)
    for key, true in TRUTH.items():
        assert stated["numbers"][key]["fitted"] == pytest.approx(true, rel=1e-4)
    assert stated["residuals"]["mean_torque"]["relative"] < 1e-6
    assert len(stated["values"]) == 2 * len(ROWS)
    assert stated["values"][0]["line"] == 3
    assert parse_motor_file(out.read_text()).system.motor.pistons == 8
    assert picture.read_bytes().startswith(b"\x89PNG")
    again = command(folder, "--out", str(out))
    assert again.exit_code == 2
    assert "exists; choose another name, or replace it with --force" in again.stderr


def without_noise(exact, measured):
    """The fit to other measured values, with one per cent for deviation."""
    return dataclasses.replace(exact, measured=measured, deviation=0.01 * np.abs(exact.modelled))


def test_a_wrong_row_is_named_by_its_line_and_standardised_residual(exact):
    chance = 1 + 0.004 * np.random.default_rng(2).normal(size=len(exact.modelled))
    sound = without_noise(exact, exact.modelled * chance)
    assert not any("stands alone" in each for each in sound.warnings)
    assert sound.doubts == []
    place = int(np.flatnonzero(exact.of("mean_torque"))[5])
    wrong = sound.measured.copy()
    wrong[place] *= 10
    found = without_noise(exact, wrong)
    line = exact.table.lines[exact.rows[place]]
    said = [each for each in found.warnings if "stands alone" in each]
    assert len(said) == 1
    assert said[0].startswith(f"Line {line}: mean torque of ")
    assert "standard deviations of the others away" in said[0]
    assert abs(standardised(found)[place]) > 100
    assert f"Line {line} stands alone." in found.doubts
    with pytest.raises(Unfitted, match=r"nothing was written; .* --force"):
        require_fit(found)


def test_numbers_that_are_no_longer_their_things_get_a_warning(exact):
    keys = [each.key for each in exact.numbers]
    values = exact.values.copy()
    values[keys.index("motor.valve_plate.discharge_coefficient")] = 0.186
    odd = dataclasses.replace(exact, values=values)
    said = [each for each in odd.warnings if "no port's any more" in each]
    assert len(said) == 1
    assert "discharge_coefficient of 0.186" in said[0]
    assert not any("any more" in each for each in exact.warnings)


def test_the_displacement_that_rows_imply_is_near_that_of_their_motor(file, made):
    rows = parse_measured_table(table(*made))
    implied = implied_displacement(
        rows, [p for p, _ in operating_points_of(file, rows)], file.system.motor
    )
    true = geometric_displacement(file.system.motor)
    motor = file.system.motor
    radius = np.asarray(motor.cam.pitch_radius(np.linspace(0, motor.cam.period, 30_001)).value)
    strokes = motor.pistons * motor.lobes * np.ptp(radius)
    assert true == pytest.approx(strokes * np.pi / 4 * float(motor.piston.bore) ** 2, rel=1e-6)
    assert true < implied.by_flow < 1.1 * true
    assert 0.8 * true < implied.by_torque < true
    assert implied.fits


def test_rows_of_another_motor_are_refused_before_anything_is_fitted(file, made):
    """Flow in gallons under a header of litres, and a seventh of the torque."""
    torque, flow = made
    for wrong in (table(torque, flow / 7), table(torque / 7, flow), table(7 * torque, flow)):
        with pytest.raises(
            InputError, match=r"is of another motor .* imply a displacement of"
        ) as e:
            fit(file, parse_measured_table(wrong), list(TRUTH))
        assert "cm³/rev (flow over speed) and" in str(e.value)
        assert "or fit all the same with --force" in str(e.value)


def test_one_row_is_too_few_and_that_is_what_is_said(file):
    one = parse_measured_table(f"{HEAD}\n100,200,1000,\n")
    for of in (None, ["leakage_coefficient"]):
        with pytest.raises(InputError, match="too few measured values, 1, for 1 to fit; add rows"):
            fit(file, one, of)


def test_equal_operating_points_are_simulated_once(file, made, monkeypatch):
    """Four readings of each row, to other digits: nine simulations, not thirty-six."""
    near = [table(*(made * (1 + 1e-4 * turn))) for turn in range(4)]
    rows = parse_measured_table("\n".join([near[0], *(e.partition("\n")[2] for e in near[1:])]))
    bench = Bench(file, rows, numbers_named(file, list(TRUTH)))
    asked, compiled = [], batch_rows._side_by_side

    def counted(designs, *those):
        asked.append(designs.motor.dead_volume.shape[-1])
        return compiled(designs, *those)

    monkeypatch.setattr("camring.evaluation.simulations.CHUNK", 9)
    monkeypatch.setattr("camring.fitting.batch_rows._side_by_side", counted)
    values = bench.as_given()
    assert len(rows.lines) == 36
    assert asked == [9]
    np.testing.assert_array_equal(values[:9], values[9:18])


def test_rows_that_go_one_by_one_are_those_that_go_side_by_side(file, made, monkeypatch):
    """For motors that batches cannot hold, and rows that two resolutions do not agree on."""
    rows, numbers = parse_measured_table(table(*made)), numbers_named(file, list(TRUTH))
    given = np.array([each.as_given for each in numbers])
    values, slopes = Bench(file, rows, numbers)(given)
    monkeypatch.setattr("camring.fitting.batch_rows.fits", lambda motor: False)
    alone, slopes_alone = Bench(file, rows, numbers)(given)
    np.testing.assert_allclose(values, alone, rtol=1e-5)
    size = np.max(np.abs(slopes_alone), axis=0)
    np.testing.assert_allclose(slopes / size, slopes_alone / size, atol=1e-4)


def test_numbers_that_no_file_gives_are_reported(file):
    for keys, said in (
        (["motor.leakage_coeficient"], "you probably meant motor.leakage_coefficient"),
        (["leakage"], "you probably meant motor.leakage_coefficient"),
        (["bulk_modulos"], "you probably meant fluid.bulk_modulus"),
        (["motor.pistons"], "is not a number of motor or oil that can be fitted"),
        (["operating_points.speed"], "is not a number of motor or oil"),
        (["motor.gap.clearance"], "give motor.gap.clearance a value in motor.toml"),
        (["fluid.air_fraction"], 'set fluid.law = "aerated" in the motor file to fit it'),
        ([], "--of names nothing"),
    ):
        with pytest.raises(InputError, match="--of") as stated:
            numbers_named(file, keys)
        assert said in str(stated.value), stated.value
    assert numbers_named(file, ["friction"])[0].key == "motor.roller.friction"


def test_numbers_below_zero_and_at_zero_begin_where_the_file_has_them():
    file = parse_motor_file(with_line('shift = "-0.4 deg"'))
    turned, side = numbers_named(file, ["motor.valve_plate.shift", "side_friction"])
    assert turned.value(turned.as_given) == pytest.approx(np.radians(-0.4))
    assert turned.start == turned.as_given
    assert turned.written(turned.value(turned.start)) == "-0.4 deg"
    assert side.value(side.as_given) == 0
    assert side.bounds[0] < side.start < side.bounds[1]


def test_an_interval_may_reach_zero_only_where_the_number_may(file):
    leak, modulus = numbers_named(file, ["leakage_coefficient", "bulk_modulus"])
    assert leak.ends(0.0, 2.0) == pytest.approx((0.0, 3 * leak.given))
    assert leak.ends(0.0, 0.1) == pytest.approx((0.9 * leak.given, 1.1 * leak.given))
    low, high = modulus.ends(0.0, 2.0)
    assert (low, high) == pytest.approx((modulus.given / np.exp(2), modulus.given * np.exp(2)))


def test_usual_numbers_are_those_of_the_motors_laws(file):
    usual = [each.key for each in numbers_named(file, None)]
    assert "motor.gap.clearance" not in usual
    assert usual[-2:] == ["motor.roller.friction", "motor.side_friction"]  # given as zero
    gap = added("[motor.gap]", 'clearance = "15 um"\nlength = "30 mm"')
    gap = gap.replace("[fluid]\n", '[fluid]\nviscosity = "46 mm^2/s"\n')
    assert "motor.gap.clearance" in [e.key for e in numbers_named(parse_motor_file(gap), None)]


def test_fewer_values_than_numbers_are_refused(file):
    few = parse_measured_table(f"{HEAD}\n100,200,1000,\n100,300,1500,\n")
    with pytest.raises(InputError, match="too few measured values, 2, for 4 to fit; add rows"):
        fit(file, few, list(TRUTH))


def test_rows_in_which_the_machine_brakes_tell_as_much(file):
    """A third of the rows against the load: their torque is negative, their constants the same."""
    numbers = numbers_named(file, list(TRUTH))
    low = [f"{rpm},{bar},10" for rpm, bar in ROWS[:6]]
    braking = [f"{rpm},10,{bar}" for rpm, bar in ROWS[6:]]
    head = HEAD.replace("supply pressure [bar]", "supply pressure [bar],return pressure [bar]")

    def rows(torque, flow):
        ends = zip([*low, *braking], torque, flow, strict=True)
        lines = (f"{start},{float(t)!r},{6e4 * float(q)!r}" for start, t, q in ends)
        return parse_measured_table("\n".join([head, *lines]))

    bench = Bench(file, rows(np.ones(9), np.ones(9)), numbers)
    ratios = np.array([TRUTH[each.key] / each.scale for each in numbers])
    point = np.where([each.by_logarithm for each in numbers], np.log(ratios), ratios)
    torque, flow = bench(point)[0].reshape(2, -1)
    assert np.all(torque[:6] > 0)
    assert np.all(torque[6:] < 0)
    found = fit(file, rows(torque, flow), list(TRUTH))
    assert found.displacement.fits
    assert not found.displacement.brakes
    np.testing.assert_allclose(found.values, list(TRUTH.values()), rtol=1e-4)
    only = [point for point, _ in bench.operating_points[6:]]
    some = parse_measured_table(
        "\n".join([head, *(f"{b},{t!r},{6e4 * q!r}" for b, t, q in zip(
            braking, torque[6:].tolist(), flow[6:].tolist(), strict=True))])
    )  # fmt: skip
    implied = implied_displacement(some, only, file.system.motor)
    assert implied.brakes
    assert implied.by_torque > implied.given
    assert implied.fits
