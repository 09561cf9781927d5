"""Designs of one motor file, evaluated: from a point of the unit box to an outcome."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TypeAlias, TypeVar

import jax
import numpy as np
from jaxtyping import Array, Float

from camring.evaluation.assessed import outcome_of
from camring.evaluation.batch import padded
from camring.evaluation.envelope_batch import SolvedAtPoints, solved_at_points
from camring.evaluation.envelope_outcome import EnvelopeGoal
from camring.evaluation.operating_points import OperatingPoints, SolvedDesign
from camring.evaluation.outcome import Outcome
from camring.files.motor import MotorFile, missing_design_space, parse_motor_file
from camring.objective.baseline import approximate
from camring.objective.design_space import AbstractSpace, DesignSpace, leaf
from camring.objective.objective import Goal
from camring.objective.slopes import Slopes
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.programs.compiled import assess
from camring.programs.motor_program import motor_program, named

Point: TypeAlias = Float[np.ndarray, " dimension"]
Found = TypeVar("Found")

CHUNK = 64  # one compiled program for any number of points but one


@dataclass(frozen=True)
class MotorEvaluator:
    """Evaluates designs; travels to other processes as the text of the motor file.

    Gradients come when they are asked for, and of a third of a descent's designs they are:
    computing them ahead took more from the next design than it gave.
    """

    text: str

    def __call__(self, point: Point) -> Outcome:
        """What the simulation says about one design."""
        model = model_of(self.text)
        beside = _beside(_in_envelope, self.text, point.tobytes()) if model.envelope else None
        solved = _solved(self.text, point.tobytes())
        outcome = outcome_of(
            solved.assessment,
            approximation=float(model.approximate(point[None])[0]),
            design=_values(model.space, solved.system),
        )
        if beside is not None:
            beside.result()
        return self.with_envelope(outcome, point)

    def with_envelope(self, outcome: Outcome, point: Point) -> Outcome:
        """The outcome of a design, completed by what the file's envelope says of it."""
        envelope = model_of(self.text).envelope
        if envelope is None:
            return outcome
        return envelope.added(outcome, _in_envelope(self.text, point.tobytes()).found)

    @property
    def names(self) -> tuple[str, ...]:
        """The limits of an outcome, in its order."""
        model = model_of(self.text)
        return model.goal.constraints.names() if model.envelope is None else model.envelope.names

    @property
    def names_by_point(self) -> tuple[str, ...]:
        """The limits as a descent sees them: at each point of the envelope by themselves."""
        model = model_of(self.text)
        return self.names if model.envelope is None else model.envelope.names_by_point()

    def approximate(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, " points"]:
        """The linear model's guess of the objective at many points."""
        return model_of(self.text).approximate(points)

    def slopes(
        self, point: Point
    ) -> tuple[Float[np.ndarray, " dimension"], Float[np.ndarray, "constraint dimension"]]:
        """Gradients of the objective without penalty and of the limits in `names_by_point`."""
        return _slopes(self.text, np.asarray(point, dtype=float).tobytes())


@lru_cache(maxsize=4)  # a search asks for slopes where it has just been
def _solved(text: str, point: bytes) -> SolvedDesign:
    model, at = model_of(text), np.frombuffer(point)
    return model.operating.solved(at, model.system_at(at))


@lru_cache(maxsize=4096)
def _slopes(text: str, point: bytes) -> tuple[np.ndarray, np.ndarray]:
    model = model_of(text)
    if model.envelope is None:
        found = _operating_slopes(text, point)
    else:
        here = _in_envelope(text, point)
        beside = _beside(_operating_slopes, text, point)
        in_envelope, found = here.slopes(), beside.result()
        assessed = _solved(text, point).assessment
        return model.envelope.gradients(
            here.found,
            in_envelope,
            np.asarray(found.objective),
            {name: np.asarray(row) for name, row in found.constraints.items()},
            {name: float(g) for name, g in assessed.constraints.items()},
            MotorEvaluator(text).names_by_point,
        )
    of_constraints = [found.constraints[name] for name in model.goal.constraints.names()]
    return np.asarray(found.objective), np.stack(of_constraints)


def _operating_slopes(text: str, point: bytes) -> Slopes:
    """Of objective and limits, as the operating points have them."""
    return _solved(text, point).slopes()


def _beside(function: Callable[[str, bytes], Found], text: str, point: bytes) -> Future[Found]:
    """A function of a design, computed on another core while this thread goes on."""
    return _other_core().submit(function, text, point)


@cache
def _other_core() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "camring-beside")


@lru_cache(maxsize=4)
def _in_envelope(text: str, point: bytes) -> SolvedAtPoints:
    model, at = model_of(text), np.frombuffer(point)
    envelope = model.envelope
    assert envelope is not None
    return solved_at_points(
        model.space,
        model.system,
        model.goal,
        envelope.envelope,
        envelope.grid,
        at,
        lambda: model.system_at(at),
    )


class Model:
    """A motor file made ready for many evaluations."""

    def __init__(self, motor_file: MotorFile) -> None:
        if motor_file.design_space is None:
            raise missing_design_space(motor_file.path)
        self.file = motor_file
        self.system: System = motor_file.system
        self.goal: Goal = motor_file.goal
        self.space: DesignSpace = motor_file.design_space
        self.operating = OperatingPoints(self.space, self.system, self.goal)
        self.envelope = None if motor_file.envelope is None else EnvelopeGoal(motor_file)

    def system_at(self, point: Point) -> System:
        return applied(self.space, self.system, point)

    def approximate(
        self, points: Float[np.ndarray, "points dimension"]
    ) -> Float[np.ndarray, " points"]:
        found = np.empty(len(points))
        chunk = 1 if len(points) == 1 else CHUNK
        for start in range(0, len(points), chunk):
            rows = points[start : start + chunk]
            values = _approximate(self.space, self.system, self.goal, padded(rows, chunk))
            found[start : start + chunk] = np.asarray(values)[: len(rows)]
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


def assess_file(motor_file: MotorFile, resolution: Resolution | None = None) -> Outcome:
    """The motor of a file as it stands."""
    return outcome_of(assess(motor_file.system, motor_file.goal, resolution))
