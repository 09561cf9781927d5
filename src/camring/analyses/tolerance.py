"""What a motor's tolerances make of its results, and which tolerance is to blame."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import jax
import numpy as np
from jaxtyping import Float

from camring.evaluation.answers import Remember, forget
from camring.evaluation.built_motors import OBJECTIVE, RESULTS, Scatter, built, tolerances_of
from camring.evaluation.evaluator import applied
from camring.files.errors import CamringError
from camring.files.motor import MotorFile
from camring.objective.point_shares import point_shares
from camring.programs.compiled import slopes_with_results, solve
from camring.search.scatter.contributions import Contributions, by_regression, by_slopes
from camring.search.scatter.distributions import owners

USUAL_SAMPLES = 1024
Say = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class ToleranceStudy:
    """A motor as it stands, with its tolerances.

    Attributes
    ----------
    by_slopes, by_regression
        Of each result the variance that each tolerance brings, by exact slopes at the
        motor as drawn, and by a plane through the samples.
    sampling_seconds
        What all samples took; the first time in a process with compiling.
    """

    file: MotorFile
    scatter: Scatter
    by_slopes: dict[str, Contributions]
    by_regression: dict[str, Contributions]
    seed: int
    sampling_seconds: float

    def first_order(self, name: str) -> float:
        """Standard deviation of a result by slopes alone."""
        return float(np.sqrt(np.sum(self.by_slopes[name].variances)))


def study_tolerances(
    file: MotorFile,
    samples: int = USUAL_SAMPLES,
    seed: int = 0,
    say: Say = lambda sentence: None,
    remember: Remember = forget,
) -> ToleranceStudy:
    """Builds the motor so many times, and takes its slopes by every tolerance.

    Parameters
    ----------
    remember
        Keeps the motors that are built, for a run that goes on after this one.

    Raises
    ------
    InputError
        Without `[tolerances]`.
    CamringError
        When the motor as drawn cannot be simulated.
    """
    tolerances = tolerances_of(file)
    say("Taking slopes by every tolerance.")
    slopes = _slopes(file)
    say(f"Building the motor {samples} times.")
    began = time.monotonic()
    scatter = built(file, samples, seed, remember=remember)
    took = time.monotonic() - began
    if not np.isfinite(scatter.nominal[OBJECTIVE]):
        raise CamringError("The motor as drawn cannot be simulated; see `camring simulate`.")
    owner = owners(tolerances.kinds)
    sound = scatter.sound
    values = {name: each[sound] for name, each in scatter.results.items()}
    return ToleranceStudy(
        file=file,
        scatter=scatter,
        by_slopes={name: by_slopes(each, owner, values[name]) for name, each in slopes.items()},
        by_regression={
            name: by_regression(scatter.deviates[sound], each, owner)
            for name, each in values.items()
        },
        seed=seed,
        sampling_seconds=took,
    )


def _slopes(file: MotorFile) -> dict[str, Float[np.ndarray, " deviate"]]:
    """Of objective and results at the motor as drawn, by every standardised deviate."""
    space = tolerances_of(file).about(None)
    drawn = np.zeros(space.dimension)
    solved = solve(applied(space, file.system, drawn), file.goal)
    found, of_results = jax.device_get(
        slopes_with_results(space, file.system, drawn, solved, file.goal, RESULTS)
    )
    slopes = {OBJECTIVE: np.asarray(found.objective)}
    for name in RESULTS:
        values = np.array([float(getattr(each, name)) for each in solved.metrics])
        slopes[name] = point_shares(file.system, name, values) @ np.stack(
            [s[name] for s in of_results]
        )
    return slopes


__all__ = ["ToleranceStudy", "study_tolerances"]
