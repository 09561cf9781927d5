"""Many motors built to one drawing: every result of each, with chances common to all designs."""

from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Bool, Float

from camring.evaluation.answers import Arrays, Remember, forget
from camring.evaluation.batch import Points, evaluate_many
from camring.files.motor import MotorFile, missing_tolerances
from camring.files.motor.tolerances import Tolerances
from camring.files.quantities import Quantity
from camring.files.result_names import quantity
from camring.metrics.summary import Metrics
from camring.objective.design_space import DesignSpace
from camring.objective.point_shares import of_all_points
from camring.physics.batch_cycle import BatchResolution
from camring.search.scatter.distributions import deviates

RESULTS = (
    "torque_ripple",
    "flow_ripple",
    "return_flow_ripple",
    "efficiency",
    "case_drain",
    "displacement",
    "mean_torque",
    "max_pressure",
    "min_pressure",
    "max_contact_stress",
    "min_contact_force",
)
"""Results shown; `objective` stands before them."""

OBJECTIVE = "objective"
TOGETHER = 16384  # motors that are built, or remembered, at a time


@dataclass(frozen=True, eq=False)
class Scatter:
    """One design as drawn and as built so many times.

    Attributes
    ----------
    deviates
        Standardised, of each sample.
    nominal
        Results of the design as drawn, by the same program.
    results
        Objective (without penalty) and results of the samples, SI, each of all operating
        points together (`objective.point_shares`). NaN where the simulation failed.
    by_point
        Every result there is of every operating point, shape (point, sample).
    constraints
        Each limit's `g` of every sample; kept at 0 or below.
    """

    deviates: Float[np.ndarray, "sample deviate"]
    nominal: dict[str, float]
    results: dict[str, Float[np.ndarray, " sample"]]
    by_point: dict[str, Float[np.ndarray, "point sample"]]
    constraints: dict[str, Float[np.ndarray, " sample"]]
    nominal_constraints: dict[str, float]

    @property
    def sound(self) -> Bool[np.ndarray, " sample"]:
        """Which samples have results."""
        return np.isfinite(self.results[OBJECTIVE])

    @property
    def keeps_limits(self) -> Bool[np.ndarray, " sample"]:
        """Which samples keep every limit; a failed one keeps none."""
        return self.sound & np.all(np.array(list(self.constraints.values())) <= 0, axis=0)

    def broken_by(self) -> dict[str, float]:
        """The share of samples that break each limit, where any does."""
        shares = {name: float(np.mean(~(g <= 0))) for name, g in self.constraints.items()}
        return {name: share for name, share in shares.items() if share > 0}

    def quantile(self, name: str, share: float) -> float:
        """Of the samples of a result that did not fail."""
        return float(np.nanquantile(self.results[name], share))


def tolerances_of(file: MotorFile) -> Tolerances:
    """The tolerances of a file.

    Raises
    ------
    InputError
        When it has none.
    """
    if file.tolerances is None:
        raise missing_tolerances(file.path)
    return file.tolerances


def built(
    file: MotorFile,
    count: int,
    seed: int,
    design: DesignSpace | None = None,
    point: Float[np.ndarray, " coordinate"] | None = None,
    resolution: BatchResolution | None = None,
    remember: Remember = forget,
) -> Scatter:
    """A design of a file, built so many times within its tolerances.

    Parameters
    ----------
    design, point
        Which design; the given motor unless given.
    resolution
        How finely; for final results unless given.
    remember
        Keeps each part of the motors, for a run that goes on after this one.
    """
    tolerances = tolerances_of(file)
    chances = deviates(tolerances.kinds, count, seed)
    at = np.zeros(0) if point is None else np.asarray(point, dtype=float)
    # The first is the motor as drawn.
    amounts = np.concatenate([np.zeros((1, chances.shape[1])), chances])
    points = np.concatenate([np.broadcast_to(at, (len(amounts), len(at))), amounts], axis=1)
    space = tolerances.about(design)
    names, limit_names = [each.name for each in fields(Metrics)], file.goal.constraints.names()

    def part(some: Points) -> Arrays:
        """Objective, every result of every operating point, and limits; NaN where one failed."""
        found = evaluate_many(space, file.system, file.goal, some, resolution or BatchResolution())
        sound = np.all(np.asarray(found.faults) == 0, axis=0)
        numbers = (
            np.asarray(found.physical_objective),
            np.array([[getattr(each, name) for each in found.metrics] for name in names]),
            np.array([found.constraints[name] for name in limit_names]).reshape(-1, len(some)),
        )
        return tuple(np.where(sound, each, np.nan) for each in numbers)

    asked = remember("built", part)
    parts = [asked(points[k : k + TOGETHER]) for k in range(0, len(points), TOGETHER)]
    whole = [np.concatenate(each, axis=-1) for each in zip(*parts, strict=True)]
    by_point = dict(zip(names, whole[1], strict=True))
    results = {OBJECTIVE: whole[0]}
    results |= {name: of_all_points(file.system, name, by_point[name]) for name in RESULTS}
    limits = dict(zip(limit_names, whole[2], strict=True))
    return Scatter(
        deviates=chances,
        nominal={name: float(values[0]) for name, values in results.items()},
        results={name: values[1:] for name, values in results.items()},
        by_point={name: values[:, 1:] for name, values in by_point.items()},
        constraints={name: values[1:] for name, values in limits.items()},
        nominal_constraints={name: float(values[0]) for name, values in limits.items()},
    )


def shown(name: str) -> Quantity:
    """How a result is written; the objective, too."""
    return Quantity(OBJECTIVE, "Objective", "", 1.0, -1) if name == OBJECTIVE else quantity(name)


def labelled(name: str) -> str:
    """A result with its unit, for an axis."""
    found = shown(name)
    return f"{found.label}, {found.unit}" if found.unit else found.label


__all__ = [
    "OBJECTIVE",
    "RESULTS",
    "Scatter",
    "built",
    "labelled",
    "shown",
    "tolerances_of",
]
