"""The last steps of a study: best motor, validation, report."""

from collections.abc import Callable, Mapping, Sequence

from camring.interfaces.config import MotorFile, parse_motor_file
from camring.interfaces.finished import Finished
from camring.interfaces.own_evaluator import from_fact
from camring.interfaces.record import Record, best_of, closest_of
from camring.interfaces.report import write_report
from camring.interfaces.study_folder import StudyFolder, write_safely
from camring.interfaces.validation import BEST, GIVEN, Check, Validation, validate


def finish(
    study: StudyFolder,
    given: MotorFile,
    records: Sequence[Record],
    facts: Mapping[str, str],
    say: Callable[[str], None],
) -> Finished:
    """Writes best.toml, validation.json and report.html into the study's folder.

    It reads the study's database through the report only, so it may run in
    another thread than the one that writes there.
    """
    best = best_of(records)
    if best is None:
        validation = _nothing_found(records)
        study.best_path.unlink(missing_ok=True)
    else:
        command = from_fact(facts["evaluator"]) if "evaluator" in facts else None
        say(
            "Looking again at finer resolution and with SciPy's stiff solver"
            + (f", and asking `{command}` again." if command else ".")
        )
        text = given.with_design(best.point.tolist())
        claimed = {GIVEN: records[0].outcome, BEST: best.outcome}
        motor = parse_motor_file(text, study.best_path)
        validation = validate(best.trial, given, motor, claimed, command)
        write_safely(study.best_path, text.encode())
    write_safely(study.validation_path, validation.to_json().encode())
    say("Writing the report.")
    write_report(study.path)
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
    )


def _nothing_found(records: Sequence[Record]) -> Validation:
    """No design keeps every limit: which one comes closest, and what it breaks."""
    closest = closest_of(records)
    if closest is None:
        reason = f"; the last: {records[-1].outcome.failure}" if records else ""
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
