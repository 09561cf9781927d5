"""Built motors: tolerances of nothing, the same bits, slopes, and the folders of commands."""

import csv
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from camring.analyses.tolerance import ToleranceStudy
from camring.cli.app import app
from camring.evaluation.built_motors import OBJECTIVE, built
from camring.files.motor import parse_motor_file
from camring.objective.point_shares import of_all_points, point_shares
from camring.physics.batch_cycle import BatchResolution
from camring.presentation import robust as robust_output
from camring.presentation import tolerance as tolerance_output
from camring.presentation.built_motors import kept_sentence
from camring.search.scatter.contributions import by_regression, by_slopes
from camring.search.scatter.distributions import deviates
from camring.search.scatter.robust import RobustFunction
from camring.search.scatter.statistic import MeanPlus, SmoothQuantile
from camring.studies import built_gradients as built_designs
from camring.studies.built_gradients import BuiltDesigns
from camring.studies.robust import GIVEN, NOMINAL, ROBUST, RobustDesign

MILL = (Path(__file__).parents[1] / "derivation" / "mill_motor.toml").read_text()
LINES = """
[tolerances]
"motor.valve_plate.shift" = "{shift}"
"motor.bore" = {{ plus_minus = "{bore}", distribution = "normal" }}
"""
SEARCH = BatchResolution.search()


def mill(shift="0.2 deg", bore="20 um"):
    return parse_motor_file(MILL + LINES.format(shift=shift, bore=bore))


@pytest.fixture(scope="module")
def scatter():
    return built(mill(), 128, 3, resolution=SEARCH)


def test_tolerances_of_nothing_give_the_motor_as_drawn_exactly(scatter):
    found = built(mill("0 deg", "0 mm"), 16, 0, resolution=SEARCH)
    for name, values in found.results.items():
        assert set(values.tolist()) == {found.nominal[name]}, name
        assert found.nominal[name] == scatter.nominal[name]
    assert found.keeps_limits.all() or not found.keeps_limits.any()


def test_the_same_seed_gives_the_same_bits_another_one_about_the_same(scatter):
    again, other = (built(mill(), 128, seed, resolution=SEARCH) for seed in (3, 4))
    for name, values in scatter.results.items():
        assert values.tobytes() == again.results[name].tobytes()
        assert not np.array_equal(values, other.results[name])
        assert np.mean(other.results[name]) == pytest.approx(
            np.mean(values), abs=0.2 * np.std(values)
        )


def test_displacement_scatters_with_the_square_of_the_bore(scatter):
    """To first order twice the bore's share, whatever the shift does."""
    values = scatter.results["displacement"]
    bore = float(mill().system.motor.piston.bore)
    share = np.std(values) / np.mean(values)
    assert share == pytest.approx(2 * 10e-6 / bore, rel=0.02)
    found = by_regression(scatter.deviates, values, [0, 1])
    assert found.variances[1] == pytest.approx(np.var(values), rel=0.02)
    assert found.explained == pytest.approx(1, abs=1e-4)


@pytest.fixture(scope="module")
def designs():
    return BuiltDesigns(mill(), TestSlopes.CHANCES)


def test_results_of_all_points_are_worst_or_mean():
    values = np.array([[1.0, 4.0], [3.0, 2.0]])
    full, other = (SimpleNamespace(weight=weight, idle_lobes=()) for weight in (3.0, 1.0))
    system = SimpleNamespace(operating_points=(full, other))
    assert of_all_points(system, "max_pressure", values).tolist() == [3, 4]
    assert of_all_points(system, "min_pressure", values).tolist() == [1, 2]
    assert of_all_points(system, "efficiency", values).tolist() == [1.5, 3.5]
    assert of_all_points(system, "displacement", values).tolist() == [1.5, 3.5]
    assert point_shares(system, "max_pressure", values[:, 0]).tolist() == [0, 1]


def test_the_displacement_of_a_motor_with_two_speeds_is_that_of_all_its_lobes():
    full = SimpleNamespace(weight=1.0, idle_lobes=())
    half = SimpleNamespace(weight=3.0, idle_lobes=(0, 2, 4))
    values = np.array([400.0, 200.0])
    both = SimpleNamespace(operating_points=(full, half))
    assert of_all_points(both, "displacement", values) == 400
    assert of_all_points(both, "efficiency", values) == 250
    reduced = SimpleNamespace(operating_points=(half, half))
    assert of_all_points(reduced, "displacement", values) == 300
    unweighted = SimpleNamespace(
        operating_points=(SimpleNamespace(weight=0.0, idle_lobes=()), half)
    )
    assert of_all_points(unweighted, "displacement", values) == 200


class TestSlopes:
    """Of one design built four times, side by side."""

    CHANCES = deviates(("uniform", "normal"), 4, 1)

    @pytest.mark.parametrize("statistic", [MeanPlus(2.0), SmoothQuantile(0.9)], ids=str)
    def test_slopes_of_a_statistic_are_central_differences(self, designs, statistic):
        point = designs.space.locate(mill().system) * 0.9 + 0.04
        function = RobustFunction(designs.scattered, designs.slopes, statistic, MeanPlus(1.0))
        direction = np.random.default_rng(2).standard_normal(len(point))
        step = 1e-3 * direction / np.linalg.norm(direction)
        above, below = function.outputs(point + step), function.outputs(point - step)
        objective, limits = function.slopes(point)
        assert objective @ step == pytest.approx((above[0] - below[0]) / 2, rel=2e-2)
        place = mill().goal.constraints.names().index("displacement_low")
        rise = (above[1][place] - below[1][place]) / 2
        assert limits[place] @ step == pytest.approx(rise, rel=2e-2, abs=1e-9)

    def test_the_samples_are_those_of_the_deviates(self, designs):
        """Twice the same motor: the nominal one, built with deviates or drawn with them."""
        file = mill()
        at = file.design_space.locate(file.system)
        there = designs.scattered(at).objective
        drawn = built(file, 4, 1, resolution=SEARCH)
        np.testing.assert_allclose(there, drawn.results[OBJECTIVE], rtol=2e-3)


def test_one_by_one_puts_everything_where_side_by_side_does(monkeypatch):
    """A motor of which objective and limits are linear in the coordinates."""
    names = mill().goal.constraints.names()
    rows = np.arange(3.0 * len(names)).reshape(len(names), 3)

    def assessed(point, goal):
        # In a compiled dictionary's order, which is that of the alphabet.
        limits = dict(sorted(zip(names, rows @ point, strict=True)))
        assert tuple(limits) != tuple(names)
        return SimpleNamespace(physical_objective=point.sum(), constraints=limits, faults=[0])

    def sloped(space, given, point, solved, goal):
        return SimpleNamespace(
            objective=np.ones(3), constraints=dict(zip(names, rows, strict=True))
        )

    monkeypatch.setattr(built_designs, "applied", lambda space, system, point: point)
    monkeypatch.setattr(built_designs, "solve", lambda point, goal: point)
    monkeypatch.setattr(built_designs, "assess_solved", assessed)
    monkeypatch.setattr(built_designs, "slopes", sloped)
    points = np.random.default_rng(0).random((5, 3))
    found = built_designs._OneByOne(mill(), None, points)
    np.testing.assert_allclose(found.scattered.objective, points.sum(axis=1))
    np.testing.assert_allclose(found.scattered.constraints, rows @ points.T)
    slopes = found.slopes(2)
    assert slopes.objective.shape == (2, 5)
    np.testing.assert_array_equal(slopes.constraints, np.repeat(rows[:, :2, None], 5, axis=2))


def study(scatter):
    slopes = {name: by_slopes(np.ones(2), [0, 1], v) for name, v in scatter.results.items()}
    planes = {
        name: by_regression(scatter.deviates, values, [0, 1])
        for name, values in scatter.results.items()
    }
    return ToleranceStudy(mill(), scatter, slopes, planes, 3, 0.5)


def test_the_folder_holds_every_motor_and_a_picture(scatter, tmp_path):
    tolerance_output.write(study(scatter), tmp_path / "scatter")
    rows = list(csv.reader((tmp_path / "scatter" / "samples.csv").open()))
    names = rows[0]
    assert len(rows) == 1 + 128
    bore = np.array([float(row[names.index("motor.bore [m]")]) for row in rows[1:]])
    np.testing.assert_allclose(bore, 10e-6 * scatter.deviates[:, 1], rtol=1e-12)
    ripple = [float(row[names.index("torque_ripple [%]")]) for row in rows[1:]]
    np.testing.assert_allclose(ripple, 100 * scatter.results["torque_ripple"], rtol=1e-12)
    assert (tmp_path / "scatter" / "scatter.svg").read_text().startswith("<?xml")


def test_the_document_and_the_table_say_the_same(scatter, capsys):
    found = study(scatter)
    said = json.loads(tolerance_output.document(found))
    assert said["results"]["efficiency"]["nominal"] == scatter.nominal["efficiency"]
    assert said["keep_every_limit"] == np.mean(scatter.keeps_limits)
    tolerance_output.show(found)
    printed = capsys.readouterr().out
    assert "motor.bore"[6:] in printed
    assert "of 128 motors keep every limit" in printed


def test_a_failed_motor_keeps_no_limit(scatter):
    results = {name: values.copy() for name, values in scatter.results.items()}
    results[OBJECTIVE][5] = np.nan
    spoiled = type(scatter)(**{**vars(scatter), "results": results})
    assert not spoiled.keeps_limits[5]
    assert "1 could not be simulated" in kept_sentence(spoiled)


@pytest.fixture
def robust(scatter):
    """A robust design that is better by a tenth in everything."""
    better = {name: 0.9 * values for name, values in scatter.results.items()}
    file = mill()
    at = file.design_space.locate(file.system)
    return RobustDesign(
        file=file,
        statistic=SmoothQuantile(0.95),
        of_limits=SmoothQuantile(0.95),
        points={GIVEN: at, NOMINAL: at, ROBUST: 0.9 * at},
        scatters={
            GIVEN: scatter,
            NOMINAL: scatter,
            ROBUST: type(scatter)(**{**vars(scatter), "results": better}),
        },
        promised=0.1,
        search_samples=64,
        evaluations=(10, 20),
        seconds=(1.0, 2.0),
        stopped="It stopped.",
    )


def test_who_wins_is_reported(robust, tmp_path):
    assert robust_output.better(robust)
    assert any("10 % less" in each for each in robust_output.sentences(robust))
    robust_output.write(robust, tmp_path / "out")
    names = {each.name for each in (tmp_path / "out").iterdir()}
    assert names == {
        "comparison.svg",
        "nominal.toml",
        "robust.toml",
        "nominal_samples.csv",
        "robust_samples.csv",
    }
    parse_motor_file((tmp_path / "out" / "robust.toml").read_text())
    assert json.dumps(robust_output.document(robust, tmp_path))


def test_a_robust_design_that_is_worse_is_not_praised(robust, tmp_path):
    swapped = {**robust.scatters, NOMINAL: robust.scatters[ROBUST], ROBUST: robust.scatters[GIVEN]}
    worse = RobustDesign(**{**vars(robust), "scatters": swapped})
    assert not robust_output.better(worse) or robust_output.broken(worse, NOMINAL)
    assert any("% more" in each for each in robust_output.sentences(worse))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["tolerance", "MOTOR"], "has no table [tolerances]"),
        (["tolerance", "MOTOR", "--out", "FOLDER"], "exists"),
        (["robust", "MOTOR", "--out", "NEW"], "has no table [tolerances]"),
        (["robust", "MOTOR", "--out", "FOLDER"], "exists"),
        (["robust", "MOTOR", "--out", "NEW", "--quantile", "0.9", "--sigmas", "2"], "exclude"),
    ],
)
def test_commands_refuse_in_one_sentence(tmp_path, arguments, words):
    motor = tmp_path / "motor.toml"
    motor.write_text(MILL)
    places = {"MOTOR": str(motor), "FOLDER": str(tmp_path), "NEW": str(tmp_path / "new")}
    found = CliRunner().invoke(app, [places.get(each, each) for each in arguments])
    assert found.exit_code == 2
    assert words in found.stderr.replace("\n", " ")
    assert not (tmp_path / "new").exists()
