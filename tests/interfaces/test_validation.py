"""Validated is said only when every limit, gain and result holds through both other eyes."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import camring
from camring.interfaces import validation
from camring.interfaces.record import Outcome, failed
from camring.interfaces.validation import (
    BEST,
    EYES,
    FINER,
    GIVEN,
    INDEPENDENT,
    Validation,
    validate,
)

EXAMPLE = Path(__file__).parents[2] / "examples" / "wheel_motor.toml"

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
def look(monkeypatch):
    """A validation whose eyes see what they are told: look(given, best, eye=changed best)."""

    def judged(given, best, **seen):
        views = {
            name: {eye: replace(what) for eye in EYES}
            for name, what in ((GIVEN, given), (BEST, best))
        }
        for key, what in seen.items():
            which, eye = key.split("_")
            views[which][eye] = what
        monkeypatch.setattr(validation, "look_again", lambda file: views[file])
        return validate(7, GIVEN, BEST, {GIVEN: given, BEST: best})

    return judged


def test_a_gain_that_both_eyes_see_is_validated(look):
    found = look(outcome(0.13), outcome(0.05, torque_ripple=0.01))
    assert found.validated
    assert found.sentence.startswith("Validated")
    assert Validation.from_json(found.to_json()) == Validation.from_json(found.to_json())


@pytest.mark.parametrize("eye", [FINER, INDEPENDENT])
def test_a_limit_that_one_eye_sees_broken_is_not(look, eye):
    found = look(outcome(0.13), outcome(0.05), **{f"best_{eye}": outcome(0.05, margin=-1e-9)})
    assert not found.validated
    assert "max_contact_stress" in found.sentence


@pytest.mark.parametrize("eye", [FINER, INDEPENDENT])
def test_a_gain_that_one_eye_does_not_see_is_not(look, eye):
    found = look(outcome(0.13), outcome(0.05), **{f"best_{eye}": outcome(0.052)})
    assert not found.validated
    assert "gain" in found.sentence


@pytest.mark.parametrize("which", [GIVEN, BEST])
def test_a_result_that_one_eye_sees_otherwise_is_not(look, which):
    given, best = outcome(0.13), outcome(0.05)
    changed = {GIVEN: given, BEST: best}[which]
    otherwise = replace(changed, results=[{**changed.results[0], "efficiency": 0.9605}])
    found = look(given, best, **{f"{which}_independent": otherwise})
    assert not found.validated
    assert "efficiency" in found.sentence


def test_a_loss_of_nothing_is_judged_beside_the_power(look):
    best = outcome(0.05)
    doubled = replace(best, results=[{**RESULTS, "leakage_loss": 2e-6}])
    assert look(outcome(0.13), best, best_independent=doubled).validated


def test_a_result_that_is_no_number_is_not_validated(look):
    best = outcome(0.05)
    lost = replace(best, results=[{**RESULTS, "efficiency": float("nan")}])
    found = look(outcome(0.13), best, best_independent=lost)
    assert not found.validated
    json.loads(found.to_json(), parse_constant=pytest.fail)


def test_an_eye_that_sees_nothing_does_not_validate(look):
    blind = failed("LSODA gave up")
    found = look(outcome(0.13), outcome(0.05), best_independent=blind)
    assert not found.validated
    assert "LSODA gave up" in found.sentence


def test_a_feasible_design_may_cost_objective_when_the_given_one_breaks_limits(look):
    assert look(outcome(0.05, margin=-0.2), outcome(0.06)).validated


def test_the_real_eyes_see_the_same_motor():
    motor_file = camring.read_motor_file(EXAMPLE)
    from camring.interfaces.evaluator import assess_file

    claimed = assess_file(motor_file)
    found = validate(0, motor_file, motor_file, {GIVEN: claimed, BEST: claimed})
    assert found.validated, found.sentence
