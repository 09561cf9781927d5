"""What a design without an objective says of itself."""

import dataclasses
import math
from types import SimpleNamespace

import pytest

from camring.evaluation.assessed import outcome_of
from camring.evaluation.outcome import Outcome


@dataclasses.dataclass
class Found:
    """What `outcome_of` reads of an assessment."""

    objective: float
    constraints: dict
    undercut: float
    faults: tuple = (0,)
    terms: dict = dataclasses.field(default_factory=dict)

    @property
    def physical_objective(self):
        return self.objective

    @property
    def metrics(self):
        return (SimpleNamespace(min_undercut_factor=self.undercut),)


def failure(found) -> str | None:
    outcome = outcome_of(found)
    assert isinstance(outcome, Outcome)
    assert math.isnan(outcome.objective) == bool(outcome.failure)
    return outcome.failure


def test_a_design_with_an_objective_has_not_failed():
    assert failure(Found(1.5, {"max_pressure": -0.1}, 0.7)) is None


def test_an_undercut_ring_is_named_with_its_factor():
    said = failure(Found(math.inf, {"max_contact_stress": math.inf}, -0.431))
    assert "undercut the ring (least undercut factor -0.431, it must exceed 0)" in said


@pytest.mark.parametrize(
    ("constraints", "words"),
    [({"max_pressure": math.nan, "displacement": -1.0}, "max pressure"), ({}, "the objective")],
)
def test_what_has_no_number_is_named(constraints, words):
    assert failure(Found(math.nan, constraints, 0.7)) == f"no finite number for {words}"
