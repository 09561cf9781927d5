"""Validated is said only when every limit, gain and result holds through both other eyes."""

import json
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path

import equinox as eqx
import pytest

import camring
from camring.evaluation.outcome import EnvelopeNumbers, Outcome, failed
from camring.reference import independent_results
from camring.studies import validation
from camring.studies.envelope_check import begin_check
from camring.studies.reference_processes import SecondSolver
from camring.studies.validation import (
    BEST,
    EYES,
    FINER,
    GIVEN,
    INDEPENDENT,
    Validation,
    solve_again,
    validate,
)
from camring.workflows import optimisation

EXAMPLE = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"

RESULTS = {
    "torque_ripple": 0.08,
    "efficiency": 0.96,
    "min_pressure": 1e6,
    "max_pressure": 2.5e7,
    "leakage_loss": 1e-6,
    "input_power": 5e4,
}


def outcome(objective, margin=0.1, **results):
    return Outcome(
        objective=objective,
        physical_objective=objective,
        constraints={"max_contact_stress": -margin, "min_pressure": -0.3},
        results=[{**RESULTS, **results}],
    )


@pytest.fixture
def verdict_of():
    """Validation whose eyes see what they are given: verdict_of(given, best, eye=changed best)."""

    def answer(given, best, **seen):
        views = {
            name: {eye: replace(what) for eye in EYES}
            for name, what in ((GIVEN, given), (BEST, best))
        }
        for key, what in seen.items():
            which, eye = key.split("_")
            views[which][eye] = what
        return validate(7, GIVEN, BEST, {GIVEN: given, BEST: best}, views)

    return answer


def test_a_gain_that_both_eyes_see_is_validated(verdict_of):
    found = verdict_of(outcome(0.13), outcome(0.05, torque_ripple=0.01))
    assert found.validated
    assert found.sentence.startswith("Validated")
    assert Validation.from_json(found.to_json()) == Validation.from_json(found.to_json())


@pytest.mark.parametrize("eye", [FINER, INDEPENDENT])
def test_a_limit_that_one_eye_sees_broken_is_not(verdict_of, eye):
    found = verdict_of(outcome(0.13), outcome(0.05), **{f"best_{eye}": outcome(0.05, margin=-1e-9)})
    assert not found.validated
    assert "max_contact_stress" in found.sentence


@pytest.mark.parametrize("eye", [FINER, INDEPENDENT])
def test_a_gain_that_one_eye_does_not_see_is_not(verdict_of, eye):
    found = verdict_of(outcome(0.13), outcome(0.05), **{f"best_{eye}": outcome(0.052)})
    assert not found.validated
    assert "gain" in found.sentence


@pytest.mark.parametrize("which", [GIVEN, BEST])
def test_a_result_that_one_eye_sees_otherwise_is_not(verdict_of, which):
    given, best = outcome(0.13), outcome(0.05)
    changed = {GIVEN: given, BEST: best}[which]
    otherwise = replace(changed, results=[{**changed.results[0], "efficiency": 0.9605}])
    found = verdict_of(given, best, **{f"{which}_independent": otherwise})
    assert not found.validated
    assert "efficiency" in found.sentence


def test_a_loss_of_nothing_is_assessed_beside_the_power(verdict_of):
    best = outcome(0.05)
    doubled = replace(best, results=[{**RESULTS, "leakage_loss": 2e-6}])
    assert verdict_of(outcome(0.13), best, best_independent=doubled).validated


def test_a_result_that_is_no_number_is_not_validated(verdict_of):
    best = outcome(0.05)
    lost = replace(best, results=[{**RESULTS, "efficiency": float("nan")}])
    found = verdict_of(outcome(0.13), best, best_independent=lost)
    assert not found.validated
    json.loads(found.to_json(), parse_constant=pytest.fail)


def test_an_eye_that_sees_nothing_does_not_validate(verdict_of):
    blind = failed("LSODA gave up")
    found = verdict_of(outcome(0.13), outcome(0.05), best_independent=blind)
    assert not found.validated
    assert "LSODA gave up" in found.sentence


def test_a_law_without_a_second_solver_is_a_verdict_of_its_own(verdict_of):
    unknown = failed("no second solver for SealRingLeakage")
    seen = {"given_independent": unknown, "best_independent": unknown}
    found = verdict_of(outcome(0.13), outcome(0.05), **seen)
    assert not found.validated
    assert found.sentence.startswith("Not validated: no second solver for SealRingLeakage.")
    assert "at finer resolution" in found.sentence
    assert [check.name for check in found.checks if not check.passed] == ["a second solver"]
    broken = verdict_of(
        outcome(0.13), outcome(0.05), best_finer=outcome(0.05, margin=-1e-3), **seen
    )
    assert "max_contact_stress" in broken.sentence


def test_a_search_says_before_it_begins_what_it_cannot_validate(tmp_path, monkeypatch):
    class Enough(Exception):
        pass

    said = []

    class Listener(optimisation.Silent):
        def say(self, sentence):
            said.append(sentence)

    def search(*_):
        assert said == ["The best design will not be validated: no second solver for Seal."]
        raise Enough

    missing = "no second solver for Seal"
    monkeypatch.setattr(optimisation, "without_second_solver", lambda file: missing)
    monkeypatch.setattr(optimisation, "search", search)
    with pytest.raises(Enough):
        optimisation.optimise(EXAMPLE, tmp_path / "study", theory=False, watch=Listener)


def test_only_a_law_written_once_has_no_second_solver():
    file = camring.read_motor_file(EXAMPLE)
    assert validation.without_second_solver(file) is None

    class SealRing:
        pass

    own = eqx.tree_at(lambda s: s.motor.leakage, file.system, SealRing())
    missing = validation.without_second_solver(replace(file, system=own))
    assert missing == "no second solver for SealRing"


def test_a_feasible_design_may_cost_objective_when_the_given_one_breaks_limits(verdict_of):
    assert verdict_of(outcome(0.05, margin=-0.2), outcome(0.06)).validated


def test_the_real_eyes_see_the_same_motor():
    motor_file = camring.read_motor_file(EXAMPLE)
    from camring.evaluation.evaluator import assess_file

    claimed = assess_file(motor_file)
    with SecondSolver() as second:
        seen = solve_again(motor_file, second)
    both = {GIVEN: seen, BEST: seen}
    found = validate(0, motor_file, motor_file, {GIVEN: claimed, BEST: claimed}, both)
    assert found.validated, found.sentence


def test_other_eyes_count_the_share_that_an_envelope_has_in_the_objective():
    share = EnvelopeNumbers({}, {}, share=0.5)
    claimed = replace(outcome(0.63), envelope=share)
    seen = dict.fromkeys(EYES, outcome(0.13))
    found = validate(
        0, GIVEN, BEST, {GIVEN: claimed, BEST: claimed}, {GIVEN: seen, BEST: seen}
    ).views[BEST][FINER]
    assert found["objective"] == found["physical_objective"] == pytest.approx(0.63)


class Changed(SecondSolver):
    """A second solver whose results are changed before they are seen."""

    def __init__(self, change):
        self.change = change
        super().__init__()

    def begin(self, *asked):
        answer = Future()
        answer.set_result(self.change(independent_results(*asked)))
        return answer


def test_a_limit_on_what_the_second_solver_does_not_compute_is_not_validated():
    motor_file = camring.read_motor_file(EXAMPLE)
    assert motor_file.goal.constraints.max_contact_stress is not None
    from camring.evaluation.evaluator import assess_file

    claimed = assess_file(motor_file)

    def half(results):
        return {n: v for n, v in results.items() if n != "max_contact_stress"}

    with Changed(half) as second:
        seen = solve_again(motor_file, second)
    both = {GIVEN: seen, BEST: seen}
    found = validate(0, motor_file, motor_file, {GIVEN: claimed, BEST: claimed}, both)
    assert not found.validated
    assert "by SciPy's stiff solver" in found.sentence
    assert "no finite number for max contact stress" in found.sentence
    assert "max_contact_stress" not in seen[INDEPENDENT].results[0]


def test_a_motor_beside_itself_loses_nothing_by_the_second_solvers_rounding():
    """Another one is held to the given motor's ripple by either solver."""
    given = camring.read_motor_file(EXAMPLE.with_name("wheel_motor.toml"))
    shift = given.system.motor.valve_plate.shift
    other = replace(
        given, system=eqx.tree_at(lambda s: s.motor.valve_plate.shift, given.system, shift + 1e-4)
    )

    def louder(results):
        return {**results, "torque_ripple": 2 * results["torque_ripple"]}

    with Changed(louder) as second:
        itself, beside = (begin_check(given, best, second)() for best in (given, other))
    for check, wanted in ((itself, False), (beside, True)):
        assert len(check.second) >= 8
        assert ("max_ripple_ratio" in {name for name, _ in check.second.values()}) is wanted
        assert any(g > 0 for _, g in check.second.values()) is wanted
