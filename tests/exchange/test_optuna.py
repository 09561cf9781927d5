"""Optuna driven by our strategies, and our studies in its storage."""

import json
import math
import warnings

import numpy as np
import optuna
import pytest
from command_line import EXAMPLE
from optuna.distributions import FloatDistribution
from optuna.trial import TrialState
from typer.testing import CliRunner

import camring
from camring.cli.app import app
from camring.evaluation.outcome import SAFETY, Outcome, failed
from camring.evaluation.record import Record
from camring.exchange.optuna.box import Box
from camring.exchange.optuna.past import ASKED, past_of
from camring.files.errors import InputError
from camring.search.minimise import minimise
from camring.search.problem import Problem
from camring.search.strategies import Task, strategy_named
from camring.studies.study_folder import StudyFolder

optuna.logging.set_verbosity(optuna.logging.ERROR)
SPACE = {"x": FloatDistribution(-1.0, 1.5), "y": FloatDistribution(1e-2, 10.0, log=True)}
BOX = Box(SPACE)


def values_at(x, y):
    """Objective and constraint; the left edge fails."""
    if x < -0.9:
        raise ValueError("too far left")
    return (x - 0.3) ** 2 + (math.log(y) - 1.0) ** 2, x + 0.1 * y - 0.3


def objective(trial):
    x = trial.suggest_float("x", -1.0, 1.5)
    y = trial.suggest_float("y", 1e-2, 10.0, log=True)
    value, limit = values_at(x, y)
    trial.set_user_attr("limit", limit)
    return value


def sampler(strategy="cma-es", **choices):
    limits = {"constraints_func": lambda trial: (trial.user_attrs["limit"],)}
    return camring.optuna.CamringSampler(strategy, **{"seed": 3, "space": SPACE} | limits | choices)


def study_of(count, function=objective, **choices):
    study = optuna.create_study(sampler=sampler(**choices))
    study.optimize(function, n_trials=count, catch=(ValueError,))
    return study


def params(study):
    return [trial.params for trial in study.trials]


def by_minimise(strategy, count, seed=3):
    def evaluate(points):
        found = values_at(**BOX.values(points[0]))
        return [(found[0], np.array([found[1]]), math.nan, None)]

    task = Task(2, count)
    return minimise(Problem(2, 1, evaluate), strategy_named(strategy, task), count, seed)


@pytest.mark.parametrize(
    ("strategy", "count"),
    [("cma-es", 40), ("nelder-mead", 40), ("cobyqa", 20), ("scbo", 6), ("bayesian", 6)],
)
def test_optuna_proposes_the_points_of_minimise_bit_for_bit(strategy, count):
    ours = by_minimise(strategy, count)
    study = study_of(count, strategy=strategy, budget=count)
    assert params(study) == [BOX.values(one.point) for one in ours.history]
    assert study.best_value == ours.best.objective
    assert study.best_trial.constraints["0"] <= 0


def test_what_a_study_tells_is_what_minimise_tells():
    """History and memory, hence whatever a strategy makes of them."""
    study = study_of(40, strategy="nelder-mead")
    ours = by_minimise("nelder-mead", 40)
    past = past_of(study.trials, BOX, "nelder-mead 3 None 1", 1.0)
    assert past.memory == ours.memory
    for seen, one in zip(past.history, ours.history, strict=True):
        assert (seen.trial, seen.objective, seen.failure) == (one.trial, one.objective, one.failure)
        assert seen.point.tobytes() == one.point.tobytes()
        assert seen.constraints.tobytes() == one.constraints.tobytes()


def test_a_study_in_a_database_goes_on_in_another_process(tmp_path):
    storage = f"sqlite:///{tmp_path / 'kept.db'}"
    for _ in range(2):  # nothing but the storage is left from the first
        study = optuna.create_study(
            study_name="a", storage=storage, sampler=sampler(), load_if_exists=True
        )
        study.optimize(objective, n_trials=7, catch=(ValueError,))
    assert params(study) == params(study_of(14))


def test_one_sampler_serves_several_studies():
    shared = sampler()
    one, two = (optuna.create_study(sampler=shared) for _ in range(2))
    for _ in range(9):
        for study in (one, two):
            study.optimize(objective, n_trials=1, catch=(ValueError,))
    assert params(one) == params(two) == params(study_of(9))


def test_a_study_that_maximises_is_the_mirror_image():
    study = optuna.create_study(sampler=sampler(), direction="maximize")
    study.optimize(lambda trial: -objective(trial), n_trials=15, catch=(ValueError,))
    assert params(study) == params(study_of(15))


def test_failed_and_pruned_trials_are_passed_on_as_such():
    def moody(trial):
        value = objective(trial)
        if trial.number == 2:
            raise ValueError("licence server is down")
        if trial.number == 3:
            trial.report(value + 1, step=5)
            raise optuna.TrialPruned
        if trial.number == 4:
            raise optuna.TrialPruned
        return math.nan if trial.number == 5 else value

    study = study_of(7, moody, strategy="nelder-mead")
    past = past_of(study.trials, BOX, "nelder-mead 3 None 1", 1.0)
    assert [one.failed for one in past.history] == [False, False, True, False, True, True, False]
    assert past.history[3].objective == study.trials[3].intermediate_values[5]
    assert "FAIL" in past.history[2].failure


def test_a_constraint_without_a_value_is_a_failure_and_no_crash():
    func = {"constraints_func": lambda trial: (math.nan if trial.number == 1 else -1.0,)}
    study = study_of(4, **func)
    past = past_of(study.trials, BOX, "cma-es 3 None 1", 1.0)
    assert [one.failed for one in past.history] == [False, True, False, False]


def test_an_enqueued_trial_is_learned_from_and_answers_no_question():
    """It takes its place before the question that is open; a simplex does not hear of it."""
    best = {"x": 0.1, "y": math.e}
    for strategy, heard in (("bayesian", True), ("nelder-mead", False)):
        study = study_of(2, strategy=strategy)
        study.enqueue_trial(best)
        study.optimize(objective, n_trials=2)
        assert study.trials[2].params == best
        assert ASKED not in study.trials[2].system_attrs
        past = past_of(study.trials[:3], BOX, f"{strategy} 3 None 1", 1.0)
        points = [BOX.values(one.point)["x"] for one in past.history]
        asked = [trial.params["x"] for trial in study.trials[:2]]
        assert points == pytest.approx([asked[0], 0.1, asked[1]] if heard else asked)


def test_trials_under_way_are_not_asked_for_again():
    study = optuna.create_study(sampler=sampler("bayesian", batch=2))
    trials = [study.ask() for _ in range(4)]
    places = {(t.suggest_float("x", -1, 1.5), t.suggest_float("y", 1e-2, 10, log=True))
              for t in trials}  # fmt: skip
    assert len(places) == 4


def test_without_a_space_the_first_trial_is_the_middle_and_the_second_our_first():
    study = study_of(4, space=None)
    assert study.trials[0].params == pytest.approx({"x": 0.25, "y": math.sqrt(0.1)})
    assert all(ASKED in trial.system_attrs for trial in study.trials[1:])


def test_whole_numbers_and_steps_are_kept_and_not_repeated():
    def counted(trial):
        n = trial.suggest_int("n", 1, 4)
        m = trial.suggest_int("m", 1, 64, log=True)
        s = trial.suggest_float("s", 0.0, 1.0, step=0.25)
        return (n - 3) ** 2 + (m - 8) ** 2 + s

    study = optuna.create_study(sampler=camring.optuna.CamringSampler())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study.optimize(counted, n_trials=8)
    seen = [tuple(sorted(trial.params.items())) for trial in study.trials]
    assert len(set(seen)) == 8
    assert all(trial.state == TrialState.COMPLETE for trial in study.trials)


def test_what_it_cannot_search_is_refused_in_a_sentence():
    study = optuna.create_study(sampler=camring.optuna.CamringSampler())
    with pytest.raises(InputError, match="knows numbers only"):
        study.optimize(lambda t: t.suggest_categorical("law", ["plain", "air"]) == "air", 1)
    both = optuna.create_study(directions=["minimize"] * 2, sampler=sampler())
    with pytest.raises(InputError, match="has 2 objectives"):
        both.optimize(objective, 1)
    for each in ("automatic", "differences", "gradient"):
        with pytest.raises(InputError, match="choose bayesian"):
            camring.optuna.CamringSampler(each)
    with pytest.raises(InputError, match="seed is -1"):
        camring.optuna.CamringSampler(seed=-1)


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A study of four evaluations, made of numbers alone."""
    folder = tmp_path_factory.mktemp("optuna") / "wheel"
    given = camring.read_motor_file(EXAMPLE)
    names, size = given.goal.constraints.names(), given.design_space.dimension
    study = StudyFolder.create(folder, EXAMPLE.read_bytes(), {"seed": "5", "method": "bayesian"})
    fine = dict.fromkeys(names, -0.5)
    outcomes = [
        Outcome(3.0, fine, 2.5, results=[{"efficiency": 0.9, "stroke": math.nan}]),
        failed("no orbit", names),
        Outcome(1.0, fine | {names[0]: -SAFETY / 2}, 1.0),  # nearer to a limit than allowed
        Outcome(2.0, fine, 2.0),
    ]
    for place, outcome in enumerate(outcomes):
        record = Record(place, "initial", np.full(size, place / 3), outcome, 1e9 + place, 0.25)
        study.store.append(record, {})
    study.close()
    return folder


def test_a_study_reads_back_from_optuna_s_storage(kept, tmp_path):
    storage = f"sqlite:///{tmp_path / 'x.db'}"
    said = CliRunner().invoke(app, ["export", str(kept), "--optuna", storage, "--json"])
    assert json.loads(said.stdout) == {"storage": storage, "name": "wheel", "trials": 4, "best": 3}
    read = optuna.load_study(study_name="wheel", storage=storage)
    ours = camring.open_study(kept)
    assert read.best_trial.number == ours.best.trial == 3
    assert [trial.value for trial in read.trials] == [3.0, None, 1.0, 2.0]
    assert [trial.state.name for trial in read.trials] == ["COMPLETE", "FAIL"] + ["COMPLETE"] * 2
    space, system = ours.given.design_space, ours.given.system
    for trial, record in zip(read.trials, ours.records, strict=True):
        assert trial.params == pytest.approx(space.describe(system, record.point), abs=1e-15)
    first, lost = (trial.user_attrs for trial in read.trials[:2])
    assert (first["efficiency, point 1"], first["seconds"], first["phase"]) == (
        0.9,
        0.25,
        "initial",
    )
    assert "stroke, point 1" not in first  # NaN is no JSON
    assert lost["failure"] == "no orbit"
    assert read.trials[2].duration.total_seconds() == 0.25
    assert read.user_attrs["constraints"] == list(ours.given.goal.constraints.names())


def test_a_study_there_is_not_overwritten_without_a_word(kept, tmp_path):
    storage = f"sqlite:///{tmp_path / 'x.db'}"
    camring.export_to_optuna(kept, storage)
    with pytest.raises(InputError, match="is a study in that storage already"):
        camring.export_to_optuna(kept, storage)
    assert camring.export_to_optuna(kept, storage, replace=True).trials == 4
    assert camring.export_to_optuna(kept, storage, name="again").name == "again"
    for wrong in ("x.db", f"sqlite:///{tmp_path}/no/folder.db"):
        with pytest.raises(InputError, match="cannot be used as Optuna's storage"):
            camring.export_to_optuna(kept, wrong)
    with pytest.raises(InputError, match="is no folder of a study"):
        camring.export_to_optuna(tmp_path / "nothing", storage)
