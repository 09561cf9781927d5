"""From a study's folder, or from motor files, to everything a report shows."""

import json
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from camring.analyses.simulation import Simulated, simulated
from camring.evaluation.record import Record, best_of, closest_of
from camring.evaluation.user_programs.evaluator import from_fact
from camring.files.errors import InputError
from camring.files.motor import MotorFile, parse_motor_file, read_motor_file
from camring.files.motor.document import printable
from camring.files.quantities import QUANTITIES, significant
from camring.presentation.envelope import WholeEnvelope, read_envelope
from camring.presentation.limits import constraints_of
from camring.presentation.records import Design, ReportData, Verdict
from camring.report.as_evaluated import as_evaluated, who_evaluated
from camring.report.coordinates import coordinates_of, variables_of
from camring.report.provenance import provenance_of
from camring.report.simulation import design_of
from camring.report.study_motors import StudyMotors, study_motors
from camring.report.trials import search_of, starting_note
from camring.report.verdicts import read_verdict, validated_trial
from camring.studies.given_up import given_up, sentences
from camring.studies.study_folder import FOUND_BY, StudyFolder
from camring.studies.validation import BEST

__all__ = ["gather", "gather_comparison", "gather_single"]

OVERTAKEN = (
    "The best design was found after the last validation and has not been validated; "
    "`camring resume` does so."
)
DAMAGED = "The study is damaged, and the best of what is left was not checked."
# Facts of the study that are for people; the others are for the program.
_SETTINGS = ("method", "seed", "budget")


def gather(folder: str | Path, at_hand: StudyMotors | None = None) -> ReportData:
    """Everything about a study, its best motor simulated anew beside the given one.

    Parameters
    ----------
    at_hand
        The motors where they have been simulated; others than the study's are left alone.

    Raises
    ------
    InputError
        When the folder holds no study, or its motor file cannot be read.
    """
    study = StudyFolder.open(Path(folder), write=False)
    try:
        kept = study.store.sound()
    finally:
        study.close()
    records, memory, facts = kept.records, kept.memory, kept.facts
    given = read_motor_file(study.given_path)
    best_record = best_of(records)
    chosen = best_record
    best = _best_motor(study, given, best_record)
    last, label = best, BEST
    if best is None:
        best_record, last = _closest(given, records), None
        label = "closest"
        if best_record is not None:
            last = parse_motor_file(
                given.with_design(best_record.point.tolist(), FOUND_BY), study.best_path
            )
    system = given.system
    weights = [float(point.weight) for point in system.operating_points]
    space = given.design_space
    points: list[np.ndarray] = [] if space is None else [space.locate(system)]
    if best_record is not None and last is not None:
        points.append(best_record.point)
    motors = at_hand
    if motors is None or motors.texts != tuple(each.text for each in (given, last) if each):
        motors = study_motors(given, last, label, points[-1] if len(points) == 2 else None)
    found, designs = motors.found, motors.designs
    given_trial = _given_trial(records, points)
    if "evaluator" in facts:
        first = next((each for each in records if each.trial == given_trial), None)
        found, designs = as_evaluated(found, designs, [first, best_record][: len(found)])
    verdict, overtaken = _verdict_on(study, chosen, weights, damaged=bool(kept.damage))
    stale = best is None or overtaken
    envelope = None if stale else read_envelope(study.validation_path)
    return ReportData(
        title=_title(given),
        subtitle=_subtitle(designs[-1]),
        designs=designs,
        verdict=verdict,
        envelope=envelope,
        constraints=constraints_of(found, designs),
        warnings=(
            *kept.remarks(),
            *([] if kept.damage or overtaken else _altered(study, best, chosen)),
            *_outside(envelope),
            *who_evaluated(facts),
            *sentences(
                given_up(records, None if best is None else best_record, weights), study.given_path
            ),
            *_warnings(found[-1:], designs[-1:]),
        ),
        variables=variables_of(given, points) if len(points) == len(designs) else (),
        search=search_of(
            records,
            weights,
            coordinates_of(given),
            memory,
            stopped=facts.get("stopped", ""),
            given=given_trial,
            best=None if best is None or best_record is None else best_record.trial,
            notes=_notes(records, facts),
        ),
        sensitivities=motors.sensitivities,
        provenance=provenance_of(
            facts.get("given_name", given.path.name),
            given.text,
            "" if best is None else best.text,
            _settings(facts, records),
        ),
    )


def gather_single(motor_file: MotorFile) -> ReportData:
    """One motor as it is."""
    found = simulated(motor_file)
    design = design_of("motor", found)
    return ReportData(
        title=_title(motor_file),
        subtitle=_subtitle(design),
        designs=(design,),
        constraints=constraints_of([found], [design]),
        warnings=tuple(found.warnings()),
        provenance=provenance_of(motor_file.path.name, motor_file.text),
    )


def gather_comparison(motor_files: Sequence[MotorFile]) -> ReportData:
    """Several motors side by side, named by their files; limits are those of the first.

    They need as many operating points each, for these stand side by side too.

    Raises
    ------
    InputError
        When there are fewer than two motors, or their operating points differ in number.
    """
    _require_comparable(motor_files)
    found = [simulated(file, estimate=False) for file in motor_files]
    designs = tuple(
        design_of(label, each) for label, each in zip(_labels(motor_files), found, strict=True)
    )
    first = motor_files[0]
    return ReportData(
        title=" · ".join(design.label for design in designs),
        subtitle=f"{len(designs)} motors side by side",
        designs=designs,
        constraints=constraints_of(found, designs),
        warnings=_warnings(found, designs),
        provenance=provenance_of(first.path.name, first.text),
    )


def _require_comparable(motor_files: Sequence[MotorFile]) -> None:
    if len(motor_files) < 2:
        raise InputError("a comparison", "needs at least two motor files", "name another one")
    counts = [len(file.system.operating_points) for file in motor_files]
    for file, count in zip(motor_files, counts, strict=True):
        if count != counts[0]:
            raise InputError(
                printable(file.path),
                f"has {count} operating points, but {printable(motor_files[0].path)} has "
                f"{counts[0]}",
                "give both files the same operating points",
            )


def _labels(motor_files: Sequence[MotorFile]) -> list[str]:
    """The files' names without ending, numbered where two are the same."""
    stems = [file.path.stem.replace("_", " ") for file in motor_files]
    return [
        stem if stems.count(stem) == 1 else f"{stem} {place + 1}"
        for place, stem in enumerate(stems)
    ]


def _warnings(found: Sequence[Simulated], designs: Sequence[Design]) -> tuple[str, ...]:
    """What the reader should know, with the design's name in front."""
    return tuple(
        f"{design.label.capitalize()}: {sentence}"
        for each, design in zip(found, designs, strict=True)
        for sentence in each.warnings()
    )


def _outside(envelope: WholeEnvelope | None) -> tuple[str, ...]:
    """What the best design does outside its operating points, where the file asks nothing."""
    return (envelope.warning,) if envelope is not None and envelope.warning else ()


def _best_motor(
    study: StudyFolder, given: MotorFile, best_record: Record | None
) -> MotorFile | None:
    """The motor of the best trial, as the database has it: best.toml has no checksum.

    Of a damaged study it is the best of what is left, which may be another.
    """
    if best_record is None or given.design_space is None:
        return None
    return parse_motor_file(
        given.with_design(best_record.point.tolist(), FOUND_BY), study.best_path
    )


def _altered(study: StudyFolder, best: MotorFile | None, best_record: Record | None) -> list[str]:
    """That best.toml is another motor than the one that is shown and was validated."""
    if best is None or best_record is None:
        return []
    try:
        written = study.best_path.read_bytes()
    except OSError:
        return []
    if written == best.text.encode():
        return []
    return [
        f"{study.best_path.name} is no longer as the study wrote it: shown is trial "
        f"{best_record.trial} as the study keeps it. `camring resume "
        f"{shlex.quote(printable(study.path))}` writes the file anew; keep changes under another "
        "name."
    ]


def _closest(given: MotorFile, records: Sequence[Record]) -> Record | None:
    """Where no design keeps every limit: the one nearest to it, unless that is the given one."""
    record = closest_of(records)
    if record is None or given.design_space is None:
        return None
    start = given.design_space.locate(given.system)
    return None if np.allclose(record.point, start, rtol=0, atol=1e-9) else record


def _verdict_on(
    study: StudyFolder, chosen: Record | None, weights: Sequence[float], *, damaged: bool
) -> tuple[Verdict, bool]:
    """What the validation said of the chosen design, and whether a better one has followed it.

    A validation without a best design is of trial -1: of no other design, then.
    """
    validated = validated_trial(study.validation_path)
    other = chosen is not None and validated != chosen.trial
    overtaken = other and validated is not None and validated >= 0
    if other and damaged:
        return Verdict(False, DAMAGED), overtaken
    if overtaken:
        return Verdict(False, OVERTAKEN), overtaken
    found = read_verdict(study.validation_path, weights)
    if found is not None:
        return found, overtaken
    if chosen is None:
        return Verdict(False, "No design that keeps every limit has been found."), overtaken
    return Verdict(False, "The study has not come to its validation yet."), overtaken


def _given_trial(records: Sequence[Record], points: Sequence[np.ndarray]) -> int | None:
    """The trial that evaluated the given motor."""
    if not points:
        return None
    for record in records:
        if np.allclose(record.point, points[0], rtol=0, atol=1e-9):
            return record.trial
    return None


def _notes(records: Sequence[Record], facts: Mapping[str, str]) -> list[str]:
    try:
        first = len(json.loads(facts.get("first_points", "[]")))
    except ValueError:
        first = 0
    note = starting_note(records, first, facts.get("theory") == "true")
    return [note] if note else []


def _settings(facts: Mapping[str, str], records: Sequence[Record]) -> dict[str, str]:
    settings = {name.capitalize(): facts[name] for name in _SETTINGS if name in facts}
    if "seed" in facts and "budget" in facts:
        options = f"--seed {facts['seed']} --budget {facts['budget']}"
        if "method" in facts:
            options += f" --method {facts['method']}"
        if facts.get("theory") == "false":
            options += " --no-theory"
        if "evaluator" in facts:
            command = from_fact(facts["evaluator"])
            settings["Evaluator"] = f"{command}, at most {command.timeout:g} s each"
            words = shlex.quote(shlex.join(command.words))
            options += f" --evaluator {words} --timeout {command.timeout:g}"
            options += "".join(f" --unit {name}={unit}" for name, unit in command.units)
        name = facts.get("given_name", "MOTOR.toml")
        settings["To repeat"] = f"camring optimise {name} --out FOLDER {options}"
    seconds = sum(record.seconds for record in records)
    settings["Evaluations"] = f"{len(records)}, {seconds:.3g} s of computing"
    return settings


def _title(motor_file: MotorFile) -> str:
    return motor_file.system.motor.name or motor_file.path.stem.replace("_", " ")


def _subtitle(design: Design) -> str:
    metrics = design.results[0].metrics
    displacement = QUANTITIES["displacement"]
    return (
        f"{design.facts.pistons} pistons on {design.facts.lobes} lobes, "
        f"bore {significant(1e3 * design.facts.bore, 3)} mm, "
        f"stroke {significant(1e3 * metrics['stroke'], 4)} mm, "
        f"{displacement.written(metrics['displacement'])} {displacement.unit}"
    )
