"""A study as it stands in its folder, to be read at any time, also while it runs."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camring.interfaces.config import MotorFile, read_motor_file
from camring.interfaces.record import Record, best_of
from camring.interfaces.study_folder import StudyFolder
from camring.objective.terms import Weights, term_weights


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
    """

    folder: Path
    given: MotorFile
    records: Sequence[Record]
    facts: Mapping[str, str]
    memory: Mapping[str, Any]

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
        return found


def open_study(folder: str | Path) -> Study:
    """Reads a study.

    Raises
    ------
    InputError
        When the folder holds no study, an unknown version, or a changed motor file.
    """
    opened = StudyFolder.open(Path(folder), write=False)
    try:
        store = opened.store
        records, facts, memory = store.records(), store.facts(), store.memory()
    finally:
        opened.close()
    return Study(Path(folder), read_motor_file(opened.given_path), records, facts, memory)


__all__ = ["Study", "open_study"]
