"""A study as it stands in its folder, to be read at any time, also while it runs."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camring.evaluation.record import Record, best_of
from camring.files.motor import MotorFile, read_motor_file
from camring.objective.terms import Weights, term_weights
from camring.studies.database import StudyDamaged
from camring.studies.study_folder import StudyFolder


@dataclass(frozen=True, eq=False)
class Study:
    """Everything that a study has kept, at one instant.

    Attributes
    ----------
    given
        The motor file that it began with.
    records
        Every evaluation, in order.
    facts
        Seed, budget, versions and what else is noted about the study, as text.
    memory
        What the search remembers, JSON-able.
    remarks
        What is damaged and therefore left out, and what cannot be verified as it was kept
        without checksums; a sentence each.
    """

    folder: Path
    given: MotorFile
    records: Sequence[Record]
    facts: Mapping[str, str]
    memory: Mapping[str, Any]
    remarks: Sequence[str] = ()

    @property
    def best(self) -> Record | None:
        """The best design that keeps every limit."""
        return best_of(self.records)

    @property
    def stopped(self) -> str:
        """Why the search ended; empty while it has not."""
        return self.facts.get("stopped", "")

    @property
    def leave_one_out(self) -> Mapping[str, Any]:
        """Errors of the surrogates, as last computed; empty when there was none."""
        return json.loads(self.facts.get("leave_one_out", "{}"))

    def objectives(self, weights: Weights) -> np.ndarray:
        """`J_phys` of every evaluation under other weights, without simulating again.

        From the raw terms of each operating point; NaN where an evaluation failed.
        """
        factors = term_weights(weights)
        shares = np.array([float(p.weight) for p in self.given.system.operating_points])
        found = np.full(len(self.records), np.nan)
        for place, record in enumerate(self.records):
            if not record.failed:
                each = [
                    sum(factor * terms[name] for name, factor in factors.items())
                    for terms in record.outcome.terms
                ]
                found[place] = shares @ each / np.sum(shares)
                envelope = record.outcome.envelope
                if envelope is not None:
                    ripple = np.array(envelope.results["torque_ripple"])
                    found[place] += weights.envelope_ripple * np.mean(ripple**2)
        return found


def open_study(folder: str | Path, *, leave_out_damaged: bool = False) -> Study:
    """Reads a study, and compares every part of it with its checksum.

    Parameters
    ----------
    leave_out_damaged
        Whether to read a damaged study as far as it is sound; `remarks` then say what is
        missing. Trials of `records` then have gaps.

    Raises
    ------
    InputError
        When the folder holds no study, an unknown version, or a changed motor file.
    StudyDamaged
        When anything in it is not what was kept; the damage is named by trial.

    Examples
    --------
    >>> study = camring.open_study("study")  # doctest: +SKIP
    >>> min(each.outcome.objective for each in study.records)  # doctest: +SKIP
    """
    opened = StudyFolder.open(Path(folder), write=False)
    try:
        kept = opened.store.sound()
    finally:
        opened.close()
    if kept.damage and not leave_out_damaged:
        raise StudyDamaged(Path(folder), kept.damage)
    return Study(
        Path(folder),
        read_motor_file(opened.given_path),
        kept.records,
        kept.facts,
        kept.memory,
        kept.remarks(),
    )


__all__ = ["Study", "open_study"]
