"""From a study's folder, or from motor files, to everything a report shows."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from camring.interfaces.config import MotorFile, parse_motor_file, read_motor_file
from camring.interfaces.record import Record, best_of
from camring.interfaces.report.coordinates import coordinates_of, variables_of
from camring.interfaces.report.data import Design, ReportData, Verdict
from camring.interfaces.report.limits import constraints_of
from camring.interfaces.report.provenance import provenance_of
from camring.interfaces.report.quantities import QUANTITIES, significant
from camring.interfaces.report.sensitivity import sensitivities_of
from camring.interfaces.report.simulation import design_of
from camring.interfaces.report.trials import search_of, starting_note
from camring.interfaces.report.verdicts import read_verdict
from camring.interfaces.study_folder import StudyFolder

__all__ = ["gather", "gather_comparison", "gather_single"]

# Facts of the study that are for people; the others are for the program.
_SETTINGS = ("seed", "budget")


def gather(folder: str | Path) -> ReportData:
    """Everything about a study, its best motor simulated anew beside the given one.

    Raises
    ------
    InputError
        When the folder holds no study, or its motor file cannot be read.
    """
    study = StudyFolder.open(Path(folder), write=False)
    try:
        records, memory, facts = study.store.records(), study.store.memory(), study.store.facts()
    finally:
        study.close()
    given = read_motor_file(study.given_path)
    best_record = best_of(records)
    best = _best_motor(study, given, best_record)
    files = [given] if best is None else [given, best]
    designs = tuple(
        design_of(label, file.system, harmonics=file.goal.harmonics)
        for label, file in zip(("given", "best"), files, strict=False)
    )
    system = given.system
    weights = [float(point.weight) for point in system.operating_points]
    space = given.design_space
    points: list[np.ndarray] = [] if space is None else [space.locate(system)]
    if best_record is not None and best is not None:
        points.append(best_record.point)
    return ReportData(
        title=_title(given),
        subtitle=_subtitle(designs[-1]),
        designs=designs,
        verdict=_verdict(study, best, weights),
        constraints=constraints_of(given.goal.constraints, [f.system for f in files], designs),
        variables=variables_of(given, points) if len(points) == len(designs) else (),
        search=search_of(
            records,
            weights,
            coordinates_of(given),
            memory,
            stopped=facts.get("stopped", ""),
            given=_given_trial(records, points),
            best=None if best_record is None else best_record.trial,
            notes=_notes(records, facts),
        ),
        sensitivities=sensitivities_of(given, points[-1]) if len(points) == 2 else (),
        provenance=provenance_of(
            facts.get("given_name", given.path.name),
            given.text,
            "" if best is None else best.text,
            _settings(facts, records),
        ),
    )


def gather_single(motor_file: MotorFile) -> ReportData:
    """One motor as it is."""
    design = design_of("motor", motor_file.system, harmonics=motor_file.goal.harmonics)
    return ReportData(
        title=_title(motor_file),
        subtitle=_subtitle(design),
        designs=(design,),
        constraints=constraints_of(motor_file.goal.constraints, [motor_file.system], [design]),
        provenance=provenance_of(motor_file.path.name, motor_file.text),
    )


def gather_comparison(motor_files: Sequence[MotorFile]) -> ReportData:
    """Several motors side by side, named by their files; limits are those of the last."""
    designs = tuple(
        design_of(file.path.stem, file.system, harmonics=file.goal.harmonics)
        for file in motor_files
    )
    last = motor_files[-1]
    return ReportData(
        title=" · ".join(design.label for design in designs),
        subtitle=f"{len(designs)} motors side by side",
        designs=designs,
        constraints=constraints_of(
            last.goal.constraints, [file.system for file in motor_files], designs
        ),
        provenance=provenance_of(last.path.name, last.text),
    )


def _best_motor(
    study: StudyFolder, given: MotorFile, best_record: Record | None
) -> MotorFile | None:
    """The motor of best.toml, or while the study still runs that of the best trial."""
    if study.best_path.is_file():
        return read_motor_file(study.best_path)
    if best_record is None or given.design_space is None:
        return None
    return parse_motor_file(given.with_design(best_record.point.tolist()), study.best_path)


def _verdict(study: StudyFolder, best: MotorFile | None, weights: Sequence[float]) -> Verdict:
    found = read_verdict(study.validation_path, weights)
    if found is not None:
        return found
    if best is None:
        return Verdict(False, "No design that keeps every limit has been found.")
    return Verdict(False, "The study has not come to its validation yet.")


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
        name = facts.get("given_name", "MOTOR.toml")
        settings["To repeat"] = f"camring optimise {name} --out FOLDER {options}"
    seconds = sum(record.seconds for record in records)
    settings["Evaluations"] = f"{len(records)}, {seconds:.3g} s of computing"
    return settings


def _title(motor_file: MotorFile) -> str:
    return motor_file.system.motor.name or motor_file.path.stem


def _subtitle(design: Design) -> str:
    metrics = design.results[0].metrics
    displacement = QUANTITIES["displacement"]
    return (
        f"{design.facts.pistons} pistons on {design.facts.lobes} lobes, "
        f"bore {significant(1e3 * design.facts.bore, 3)} mm, "
        f"stroke {significant(1e3 * metrics['stroke'], 4)} mm, "
        f"{displacement.written(metrics['displacement'])} {displacement.unit}"
    )
