"""Designs of one motor file, judged: from a point of the unit box to an outcome."""

import math
from dataclasses import dataclass
from functools import lru_cache

import jax
import numpy as np
from jaxtyping import Array, Float

from camring.interfaces.compiled import Solved, assess, judge_solved, slopes, solve
from camring.interfaces.config import MotorFile, missing_design_space, parse_motor_file
from camring.interfaces.motor_program import motor_program, named
from camring.interfaces.record import Outcome
from camring.numerics.verdict import Verdict
from camring.objective.baseline import approximate
from camring.objective.design_space import AbstractSpace, DesignSpace, leaf
from camring.objective.objective import Assessment, Goal
from camring.objective.slopes import Slopes
from camring.physics.resolution import Resolution
from camring.physics.system import System

Point = Float[np.ndarray, " dimension"]
CHUNK = 64  # one compiled program for any number of points


@dataclass(frozen=True)
class MotorEvaluator:
    """Judges designs; travels to other processes as the text of the motor file."""

    text: str

    def __call__(self, point: Point) -> Outcome:
        """What the simulation says about one design."""
        model, solved = model_of(self.text), _solved(self.text, point.tobytes())
        return outcome_of(
            judge_solved(solved, model.goal),
            approximation=float(model.approximate(point[None])[0]),
            design=_values(model.space, solved.system),
        )

    def approximate(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, " points"]:
        """The linear model's guess of the objective at many points."""
        return model_of(self.text).approximate(points)

    def slopes(
        self, point: Point
    ) -> tuple[Float[np.ndarray, " dimension"], Float[np.ndarray, "constraint dimension"]]:
        """Gradient of the objective without penalty, and that of each constraint in its order."""
        return _slopes(self.text, np.asarray(point, dtype=float).tobytes())


@lru_cache(maxsize=4)  # a search asks for slopes where it has just been
def _solved(text: str, point: bytes) -> Solved:
    model = model_of(text)
    return solve(model.system_at(np.frombuffer(point)), model.goal)


@lru_cache(maxsize=4096)
def _slopes(text: str, point: bytes) -> tuple[np.ndarray, np.ndarray]:
    model, at = model_of(text), np.frombuffer(point)
    found: Slopes = jax.device_get(
        slopes(model.space, model.system, at, _solved(text, point), model.goal)
    )
    of_constraints = [found.constraints[name] for name in model.goal.constraints.names()]
    return np.asarray(found.objective), np.stack(of_constraints)


class Model:
    """A motor file made ready for many evaluations."""

    def __init__(self, motor_file: MotorFile) -> None:
        if motor_file.design_space is None:
            raise missing_design_space(motor_file.path)
        self.file = motor_file
        self.system: System = motor_file.system
        self.goal: Goal = motor_file.goal
        self.space: DesignSpace = motor_file.design_space

    def system_at(self, point: Point) -> System:
        return applied(self.space, self.system, point)

    def approximate(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, " points"]:
        found = np.empty(len(points))
        for start in range(0, len(points), CHUNK):
            rows = points[start : start + CHUNK]
            padded = np.concatenate([rows, np.broadcast_to(rows[:1], (CHUNK, rows.shape[1]))])
            values = _approximate(self.space, self.system, self.goal, padded[:CHUNK])
            found[start : start + CHUNK] = np.asarray(values)[: len(rows)]
        return found


def _values(space: DesignSpace, design: System) -> dict[str, float | list[float]]:
    """What the variables are in one design, SI, by path in the motor file."""
    paths = {
        key: at[0]
        for each in space.variables
        for key, at in zip(each.keys, each.leaves, strict=True)
    }
    if space.cam is not None:
        paths[space.cam_key] = space.cam_key
    return {key: np.asarray(leaf(path)(design)).tolist() for key, path in paths.items()}


@lru_cache(maxsize=4)
def model_of(text: str) -> Model:
    """The motor file of a text, read once."""
    return Model(parse_motor_file(text))


def applied(space: AbstractSpace, system: System, point: Point) -> System:
    """The system of one design, from one compiled program."""
    return named(_applied(space, system, point), system.motor.name)


@motor_program
def _applied(space: AbstractSpace, system: System, point: Point) -> System:
    return space.apply(system, point)


@motor_program
def _approximate(
    space: DesignSpace, system: System, goal: Goal, points: Float[np.ndarray, "points dimension"]
) -> Float[Array, " points"]:
    return jax.vmap(lambda point: approximate(space.apply(system, point), goal))(points)


def outcome_of(
    assessment: Assessment, approximation: float = math.nan, design: dict | None = None
) -> Outcome:
    """The assessment as plain numbers; a faulty one has no objective but says why."""
    found: Assessment = jax.device_get(assessment)
    sentences = [Verdict(code).explain() for code in found.faults]
    failure = "; ".join(dict.fromkeys(sentence for sentence in sentences if sentence)) or None
    if failure is None and not math.isfinite(found.objective):
        failure = "the objective is not a finite number"
    return Outcome(
        objective=math.nan if failure else float(found.objective),
        physical_objective=math.nan if failure else float(found.physical_objective),
        approximation=approximation,
        constraints={name: float(value) for name, value in found.constraints.items()},
        terms=[
            {name: float(values[place]) for name, values in found.terms.items()}
            for place in range(len(found.metrics))
        ],
        results=[
            {name: float(value) for name, value in vars(metrics).items()}
            for metrics in found.metrics
        ],
        design=design or {},
        failure=failure,
    )


def assess_file(motor_file: MotorFile, resolution: Resolution | None = None) -> Outcome:
    """The motor of a file as it stands."""
    return outcome_of(assess(motor_file.system, motor_file.goal, resolution))
