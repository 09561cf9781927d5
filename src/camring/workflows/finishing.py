"""The last steps of a study: best motor, validation, report."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future

from camring.evaluation.outcome import Outcome
from camring.evaluation.record import Record, best_of, closest_of
from camring.evaluation.user_programs.evaluator import from_fact
from camring.files.motor import MotorFile, parse_motor_file
from camring.files.whole_file import write_safely
from camring.presentation.study import Finished
from camring.report import write_report
from camring.report.study_motors import StudyMotors, study_motors
from camring.studies.envelope_check import begin_check
from camring.studies.given_up import given_up
from camring.studies.reference_processes import SecondSolver
from camring.studies.study_folder import FOUND_BY, StudyFolder
from camring.studies.validation import (
    BEST,
    GIVEN,
    Check,
    Validation,
    begin_again,
    validate,
    without_second_solver,
)


def finish(
    study: StudyFolder,
    given: MotorFile,
    records: Sequence[Record],
    facts: Mapping[str, str],
    say: Callable[[str], None],
    given_again: Future[dict[str, Outcome]],
    second: SecondSolver,
) -> Finished:
    """Writes best.toml, validation.json and report.html into the study's folder.

    Parameters
    ----------
    given_again
        `solve_again` of the given motor, begun while the search went on.
    second
        What solves the best motor, while the report's pictures are computed here.

    Notes
    -----
    It reads the study's database through the report only, so it may run in
    another thread than the one that writes there.
    """
    best = best_of(records)
    motors: StudyMotors | None = None
    if best is None:
        validation = _nothing_found(records)
        study.store.require_in_place()
        study.best_path.unlink(missing_ok=True)
    else:
        command = from_fact(facts["evaluator"]) if "evaluator" in facts else None
        eyes = "" if without_second_solver(given) else " and with SciPy's stiff solver"
        asked = f", and asking `{command}` again" if command else ""
        say(f"Looking again at finer resolution{eyes}{asked}.")
        text = given.with_design(best.point.tolist(), FOUND_BY)
        claimed = {GIVEN: records[0].outcome, BEST: best.outcome}
        motor = parse_motor_file(text, study.best_path)
        best_again = begin_again(motor, second)
        envelope = begin_check(given, motor, second)
        motors = study_motors(given, motor, BEST, best.point)
        again = {GIVEN: given_again.result(), BEST: best_again()}
        validation = validate(best.trial, given, motor, claimed, again, command, envelope())
        study.store.require_in_place()
        # A design that a former run validated is not the one that comes now: between the two
        # writes a kill leaves a design without a validation, and never one with another's.
        study.validation_path.unlink(missing_ok=True)
        write_safely(study.best_path, text.encode())
    write_safely(study.validation_path, validation.to_json().encode())
    say("Writing the report.")
    write_report(study.path, motors)
    return Finished(
        folder=study.path,
        given_file=given,
        given=records[0],
        best=best,
        evaluations=len(records),
        stopped=facts.get("stopped", ""),
        surrogates=facts.get("leave_one_out", ""),
        validation=validation,
        report=study.report_path,
        warnings=() if motors is None else tuple(motors.found[-1].warnings()),
        given_up=given_up(
            records, best, [float(point.weight) for point in given.system.operating_points]
        ),
    )


def _nothing_found(records: Sequence[Record]) -> Validation:
    """No design keeps every limit: which one comes closest, and what it breaks."""
    closest = closest_of(records)
    if closest is None:
        reason = f"; the last: {records[-1].failure}" if records else ""
        return Validation(-1, False, f"Not validated: every evaluation failed{reason}.", [], {})
    worst = max(closest.outcome.constraints, key=lambda name: closest.outcome.constraints[name])
    excess = closest.outcome.constraints[worst]
    sentence = (
        f"Infeasible: no design keeps every limit; the closest, trial {closest.trial}, breaks "
        f"{worst} by {excess:.3g} of its scale."
    )
    checks = [
        Check(name, value <= 0, f"margin {-value:.4g}")
        for name, value in closest.outcome.constraints.items()
    ]
    return Validation(closest.trial, False, sentence, checks, {})
