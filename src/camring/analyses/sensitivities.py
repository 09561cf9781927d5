"""How a design changes with the numbers in it, and what its limits cost, from exact slopes."""

from dataclasses import dataclass
from os import fspath
from pathlib import Path

import jax
import numpy as np
from jaxtyping import Float

from camring.evaluation.assessed import outcome_of
from camring.evaluation.evaluator import applied
from camring.evaluation.record import best_of
from camring.files.errors import CamringError, InputError
from camring.files.motor import missing_design_space, read_motor_file
from camring.objective.point_shares import point_shares
from camring.objective.slopes import results_used
from camring.programs.compiled import assess_solved, slopes_with_results, solve
from camring.search.multipliers import multipliers
from camring.studies.study_folder import StudyFolder

SHARE = 0.01  # of a variable's range, and of a limit
RESULTS = ("torque_ripple", "efficiency", "displacement", "max_contact_stress", "max_pressure")
BINDING = 2e-3  # of its scale; a limit nearer than that binds
AT_BOUND = 2e-3  # of a variable's range; descents stop when J stands still, not quite at a bound
STATIONARY = 0.1  # of the slope of the objective; below it a design counts as an optimum


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """One design.

    Attributes
    ----------
    objective
        `J_phys`, without penalty.
    per_variable
        Change of objective and results when a variable goes up by 1 % of its range, SI.
        Results of all operating points together (`objective.point_shares`).
    margins
        Of each limit; negative where broken.
    bought
        Fall of the objective if a binding limit were relaxed by 1 % of its scale.
    at_bounds
        Likewise for variables at a bound, that bound moved out by 1 % of the range.
    left
        Share of the objective's slope that no binding limit explains; small at an optimum.
    """

    place: Path
    source: str
    objective: float
    results: dict[str, float]
    variables: tuple[str, ...]
    per_variable: dict[str, Float[np.ndarray, " variable"]]
    margins: dict[str, float]
    bought: dict[str, float]
    at_bounds: dict[str, float]
    left: float

    @property
    def is_optimum(self) -> bool:
        """Whether multipliers mean something."""
        return self.left < STATIONARY


def sensitivities(motor: str | Path) -> Sensitivities:
    """Slopes of a motor file as it stands, or of a study's best design.

    Raises
    ------
    InputError
        Without a design space, or for a study without a design that keeps every limit.
    CamringError
        When the simulation fails.
    """
    place = Path(fspath(motor))
    if place.is_dir():
        file, point, source = _best_of_study(place)
    else:
        file, point, source = read_motor_file(place), None, "the motor as it stands"
    space, goal = file.design_space, file.goal
    if space is None:
        raise missing_design_space(file.path)
    if point is None:
        point = space.locate(file.system)
    solved = solve(applied(space, file.system, point), goal)
    outcome = outcome_of(assess_solved(solved, goal))
    if outcome.failure:
        raise CamringError(f"There are no slopes: {outcome.failure}.")
    names = [name for name in RESULTS if name in results_used(goal)]
    found, of_results = jax.device_get(slopes_with_results(space, file.system, point, solved, goal))
    values = {name: np.array([each[name] for each in outcome.results]) for name in names}
    shares = {name: point_shares(file.system, name, values[name]) for name in names}
    slopes = {"objective": np.asarray(found.objective)}
    for name in names:
        slopes[name] = shares[name] @ np.stack([each[name] for each in of_results])
    binding = [name for name, value in outcome.constraints.items() if value > -BINDING]
    sides = [
        (f"{name} at its {end} bound", sign * row)
        for name, at, row in zip(space.names, point, np.eye(space.dimension), strict=True)
        for end, sign, near in (("lower", -1.0, at), ("upper", 1.0, 1 - at))
        if near < AT_BOUND
    ]
    rows = [np.asarray(found.constraints[name]) for name in binding] + [row for _, row in sides]
    factors, left = multipliers(slopes["objective"], np.reshape(rows, (-1, space.dimension)))
    return Sensitivities(
        place=place,
        source=source,
        objective=outcome.physical_objective,
        results={name: float(shares[name] @ values[name]) for name in names},
        variables=space.names,
        per_variable={name: SHARE * each for name, each in slopes.items()},
        margins={name: -value for name, value in outcome.constraints.items()},
        bought=dict(zip(binding, (SHARE * factors).tolist(), strict=False)),
        at_bounds={
            name: float(SHARE * factor)
            for (name, _), factor in zip(sides, factors[len(binding) :], strict=True)
        },
        left=left,
    )


def _best_of_study(place: Path) -> tuple:
    study = StudyFolder.open(place, write=False)
    try:
        best = best_of(study.store.records())
        if best is None:
            raise InputError(
                str(place),
                "holds no design that keeps every limit",
                "go on with `camring resume`, or name a motor file",
            )
        file = read_motor_file(study.given_path)
    finally:
        study.close()
    return file, np.asarray(best.point), f"the best design of the study, trial {best.trial}"
