"""Designs evaluated by a user's own program, and where it is silent by our simulation.

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

from camring.evaluation.assessed import outcome_of
from camring.evaluation.batch import evaluate_many
from camring.evaluation.evaluator import MotorEvaluator, model_of
from camring.evaluation.outcome import Outcome, failed
from camring.evaluation.user_programs.command import CommandFailed, Results, UserCommand
from camring.evaluation.user_programs.numbers import (
    Impossible,
    doubts_about,
    guessed_units,
    not_believed,
    require_possible,
)
from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.named_units import read_units, si_units
from camring.metrics.result_scale import RIPPLES
from camring.metrics.summary import Metrics
from camring.objective.objective import Goal
from camring.objective.slopes import results_used
from camring.physics.system import System
from camring.programs.compiled import assess_metrics

NAMES = tuple(each.name for each in fields(Metrics))
FILE_NAME = "motor.toml"
INTERFACE = 1


DOZENS = 64  # points that a search asks of at once


@dataclass(frozen=True)
class UserEvaluator:
    """Evaluates designs by a command; travels to other processes as text."""

    text: str
    command: UserCommand

    def __call__(self, point: Float[np.ndarray, " dimension"]) -> Outcome:
        """What program and simulation together say about one design."""
        model = model_of(self.text)
        simulation = MotorEvaluator(self.text)
        ours = simulation(point)
        unit_point = point.tolist()
        motor_text = model.file.with_design(unit_point)
        is_given = np.allclose(point, model.space.locate(model.system), rtol=0, atol=1e-9)
        try:
            given = ask(self.command, motor_text, ours.design, model.system_at(point))
            self._require_believed(given, ours, is_given)
        except CommandFailed as error:
            return replace(failed(f"{self.command}: {error}", self.names), design=ours.design)
        assessed = overlaid(model.system_at(point), model.goal, ours, given)
        return simulation.with_envelope(assessed, point)

    @property
    def names(self) -> tuple[str, ...]:
        """The limits of an outcome, in its order."""
        return MotorEvaluator(self.text).names

    names_by_point = names

    def _require_believed(self, given: Results, ours: Outcome, is_given: bool) -> None:
        """Raises `NotBelieved` for the given motor, `Impossible` for any other design.

        Where our simulation fails there is nothing to compare with.
        """
        units = self.command.units
        try:
            require_possible(given)
        except Impossible as error:
            if is_given:
                raise not_believed([str(error)], guessed_units(given)) from None
            raise
        doubts = {} if ours.failure else doubts_about(given, ours.results, units)
        if doubts and is_given:
            units_seen = {name: unit or si_units()[name] for name, (_, unit) in doubts.items()}
            raise not_believed([said for said, _ in doubts.values()], units_seen)
        # A search moves a ripple by any factor, and two models of it not in step.
        for name, (said, _) in doubts.items():
            if name not in RIPPLES:
                raise Impossible(f"its {said}")

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


def ask(command: UserCommand, text: str, design: Mapping[str, Any], system: System) -> Results:
    """The program's results for the motor of a file, which is the system.

    Raises
    ------
    CommandFailed
        When it gives none.
    """
    points = [
        {each.name: _plain(getattr(point, each.name)) for each in fields(point)}
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


def ask_about(command: UserCommand, motor_file: MotorFile) -> Results:
    """The program's results for a motor file as it stands; see `ask`."""
    space, system = motor_file.design_space, motor_file.system
    design = {} if space is None else space.document_values(system, space.locate(system))
    found = ask(command, motor_file.text, design, system)
    require_possible(found)
    return found


def overlaid(
    system: System, goal: Goal, ours: Outcome, given: Sequence[Mapping[str, float]]
) -> Outcome:
    """Assessed anew with the program's results in place of ours.

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
    metrics = tuple(
        Metrics(**{name: jnp.asarray(each.get(name, math.nan)) for name in NAMES}) for each in whole
    )
    assessed = outcome_of(assess_metrics(system, goal, metrics), design=dict(ours.design))
    approximation = math.nan if ours.failure else ours.physical_objective
    return replace(assessed.with_results_in(whole), approximation=approximation)


def names_given(given: Sequence[Mapping[str, float]]) -> list[str]:
    """Results that the program gave at any operating point, in the order of ours."""
    found = {name for each in given for name in each}
    return [name for name in NAMES if name in found]


def to_fact(command: UserCommand) -> str:
    """The command as a study keeps it."""
    document = {"command": command.words, "timeout": command.timeout, "folder": command.folder}
    return json.dumps({**document, **({"units": dict(command.units)} if command.units else {})})


def from_fact(text: str) -> UserCommand:
    """The inverse of `to_fact`.

    Raises
    ------
    InputError
        When a study says anything else than what `to_fact` writes.
    """
    try:
        kept = json.loads(text)
        words, folder = kept["command"], kept["folder"]
        if not words or not all(isinstance(each, str) for each in (*words, folder)):
            raise TypeError
        units = read_units(kept.get("units", {}), "units")
        return UserCommand(tuple(words), float(kept["timeout"]), folder, units)
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(
            "evaluator", "of this study is no command that can be read", "begin a new study"
        ) from None


def _plain(value: Any) -> float | str | list[int]:
    """A number, the name of a mode, or the lobes that idle in it, counted from 0."""
    if isinstance(value, str):
        return value
    return list(value) if isinstance(value, tuple) else float(value)
