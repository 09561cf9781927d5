"""Designs judged by a user's own program, and where it is silent by our simulation.

Our simulation of the same design is never wasted: its objective is the approximation
on which the search leans, so that what has to be learned at the program's price is only
what our model lacks.
"""

import json
import math
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from camring.interfaces.compiled import judge_metrics
from camring.interfaces.config import MotorFile
from camring.interfaces.evaluator import MotorEvaluator, model_of, outcome_of
from camring.interfaces.many import evaluate_many
from camring.interfaces.own_command import CommandFailed, OwnCommand, Results
from camring.interfaces.record import Outcome, failed
from camring.metrics.summary import Metrics
from camring.objective.objective import Goal
from camring.objective.slopes import results_used
from camring.physics.system import System

NAMES = tuple(each.name for each in fields(Metrics))
FILE_NAME = "motor.toml"
INTERFACE = 1


DOZENS = 64  # points that a search asks of at once


@dataclass(frozen=True)
class OwnEvaluator:
    """Judges designs by a command; travels to other processes as text."""

    text: str
    command: OwnCommand

    def __call__(self, point: Float[np.ndarray, " dimension"]) -> Outcome:
        """What program and simulation together say about one design."""
        model = model_of(self.text)
        ours = MotorEvaluator(self.text)(point)
        unit_point = point.tolist()
        motor_text = model.file.with_design(unit_point)
        try:
            given = ask(self.command, motor_text, ours.design, model.system_at(point))
        except CommandFailed as error:
            names = model.goal.constraints.names()
            return replace(failed(f"{self.command}: {error}", names), design=ours.design)
        return overlaid(model.system_at(point), model.goal, ours, given)

    def approximate(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, " points"]:
        """Our own simulation's objective at many points; NaN where it fails."""
        model = model_of(self.text)
        found = evaluate_many(
            model.space, model.system, model.goal, np.asarray(points), threads=1, chunk=DOZENS
        )
        sound = np.all(np.asarray(found.faults) == 0, axis=0)
        return np.where(sound, np.asarray(found.physical_objective), np.nan)


def ask(command: OwnCommand, text: str, design: Mapping[str, Any], system: System) -> Results:
    """The program's results for the motor of a file, which is the system.

    Raises
    ------
    CommandFailed
        When it gives none.
    """
    points = [
        {each.name: float(getattr(point, each.name)) for each in fields(point)}
        for point in system.operating_points
    ]
    with tempfile.TemporaryDirectory(prefix="camring-") as folder:
        path = Path(folder) / FILE_NAME
        path.write_text(text, encoding="utf-8")
        question = {
            "interface": INTERFACE,
            "motor_file": str(path),
            "design": dict(design),
            "operating_points": len(points),
            "points": points,
        }
        return command.results(question, NAMES, len(points))


def ask_about(command: OwnCommand, motor_file: MotorFile) -> Results:
    """The program's results for a motor file as it stands; see `ask`."""
    space, system = motor_file.design_space, motor_file.system
    design = {} if space is None else space.document_values(system, space.locate(system))
    return ask(command, motor_file.text, design, system)


def overlaid(
    system: System, goal: Goal, ours: Outcome, given: Sequence[Mapping[str, float]]
) -> Outcome:
    """Judged anew with the program's results in place of ours.

    Parameters
    ----------
    ours
        What our simulation says of the same design. Its objective without penalty becomes
        the approximation. Its failure remains one unless the program gave every result
        that the goal uses.
    """
    if not ours.results:
        return ours
    whole = [{**before, **after} for before, after in zip(ours.results, given, strict=True)]
    used = set(results_used(goal))
    if ours.failure and not all(used <= after.keys() for after in given):
        return replace(ours, failure=f"our simulation: {ours.failure}")
    metrics = tuple(Metrics(**{name: jnp.asarray(each[name]) for name in NAMES}) for each in whole)
    judged = outcome_of(judge_metrics(system, goal, metrics), design=dict(ours.design))
    approximation = math.nan if ours.failure else ours.physical_objective
    return replace(judged, approximation=approximation)


def names_given(given: Sequence[Mapping[str, float]]) -> list[str]:
    """Results that the program gave at any operating point, in the order of ours."""
    found = {name for each in given for name in each}
    return [name for name in NAMES if name in found]


def to_fact(command: OwnCommand) -> str:
    """The command as a study keeps it."""
    return json.dumps(
        {"command": command.words, "timeout": command.timeout, "folder": command.folder}
    )


def from_fact(text: str) -> OwnCommand:
    """The inverse of `to_fact`."""
    kept = json.loads(text)
    return OwnCommand(tuple(kept["command"]), kept["timeout"], kept["folder"])
