"""A study's given and best motor as its report shows them: what takes time to compute."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camring.analyses.simulation import Simulated, simulated
from camring.files.motor import MotorFile
from camring.presentation.records import Design, Sensitivity
from camring.report.sensitivity import sensitivities_of
from camring.report.simulation import design_of
from camring.studies.validation import GIVEN


@dataclass(frozen=True, eq=False)
class StudyMotors:
    """Motors by their files' texts, simulated and sampled.

    Attributes
    ----------
    sensitivities
        Of results to the design's coordinates at the last motor; none beside a given one alone.
    """

    texts: tuple[str, ...]
    found: Sequence[Simulated]
    designs: tuple[Design, ...]
    sensitivities: tuple[Sensitivity, ...]


def study_motors(
    given: MotorFile, last: MotorFile | None, label: str, point: np.ndarray | None
) -> StudyMotors:
    """The given motor and perhaps another one, at a point of its design space."""
    files = [each for each in (given, last) if each is not None]
    # The validation estimates the errors, finer and with another solver.
    found = [simulated(each, estimate=False) for each in files]
    designs = tuple(
        design_of(name, each) for name, each in zip((GIVEN, label), found, strict=False)
    )
    return StudyMotors(
        texts=tuple(each.text for each in files),
        found=found,
        designs=designs,
        sensitivities=() if point is None else sensitivities_of(given, point),
    )
