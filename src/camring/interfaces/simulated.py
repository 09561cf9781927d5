"""The motor of a file, simulated and judged: what `simulate` and `check` print."""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np

from camring.interfaces.beside import scale_of
from camring.interfaces.compiled import assess, cycles, summarise_compiled
from camring.interfaces.config import MotorFile
from camring.interfaces.crowding import crowded
from camring.interfaces.evaluator import outcome_of
from camring.interfaces.record import Outcome
from camring.metrics.error_estimate import error_estimate
from camring.metrics.summary import Metrics
from camring.metrics.timing import Timing, port_timing
from camring.physics.resolution import Resolution

if TYPE_CHECKING:
    from camring.physics.cycle import Cycle

_NO_RESULTS = ("power_residual",)


@dataclass(frozen=True, eq=False)
class Simulated:
    """A motor file, what the simulation says of it, and how far that can be trusted.

    Attributes
    ----------
    outcome
        Results and constraints; with a sentence in `failure` when they mean nothing.
    cycles
        One for each operating point.
    errors
        Estimated absolute error of each result, SI, for each operating point.
    """

    file: MotorFile
    outcome: Outcome
    cycles: tuple["Cycle", ...]
    errors: tuple[dict[str, float], ...]

    @property
    def numerical_error(self) -> tuple[float, ...]:
        """For each operating point the largest error of any result, relative."""
        return tuple(
            max(_relative(name, errors, results) for name in errors if name not in _NO_RESULTS)
            for errors, results in zip(self.errors, self.outcome.results, strict=True)
        )

    @property
    def broken(self) -> dict[str, float]:
        """Constraints that do not hold, and by how much."""
        return {name: g for name, g in self.outcome.constraints.items() if not g <= 0}

    def warnings(self) -> list[str]:
        """What a reader of the results should know, a sentence each."""
        found = [self.outcome.failure] if self.outcome.failure else []
        several = len(self.outcome.results) > 1
        for place, results in enumerate(self.outcome.results):
            where = f" at operating point {place + 1}" if several else ""
            found += [sentence.format(where) for sentence in _about(results, self.file)]
        for gap, side in zip(_gaps(timing_of(self.file)), ("inner", "outer"), strict=True):
            if gap < -1e-9:
                found.append(
                    f"Supply and return windows overlap by {-degrees(gap):.3g} deg at the "
                    f"{side} dead centre: the ports short-circuit there."
                )
        if self.outcome.results:
            lowest = self.outcome.results[0]["min_lift"]
            inner = float(self.cycles[0].reference_radius) + lowest
            found += crowded(self.file.system.motor, inner)
        # An undercut is the same at every operating point.
        return list(dict.fromkeys(found))


def simulated(file: MotorFile, *, estimate: bool = True) -> Simulated:
    """Simulate a motor at every operating point and judge it by its constraints.

    Parameters
    ----------
    estimate
        Whether to look a second time at a coarser resolution for the error.
    """
    system, goal, resolution = file.system, file.goal, Resolution()
    # Compiling both programs is nearly all the work of a first run; two threads share it.
    helper = ThreadPoolExecutor(max_workers=1)
    try:
        second = helper.submit(_results, file, resolution.second_look()) if estimate else None
        found = cycles(system, resolution)
        outcome = outcome_of(assess(system, goal, resolution))
        if all(int(cycle.verdict.code) == 0 for cycle in found):
            # An undercut's infinite stress spoils the objective, not the results.
            outcome = replace(outcome, failure=None)
        errors: tuple[dict[str, float], ...] = ()
        if second is not None:
            pairs = zip(_results(file, resolution), second.result(), strict=True)
            errors = tuple(_plain(error_estimate(*pair)) for pair in pairs)
    finally:
        helper.shutdown(wait=False, cancel_futures=True)
    return Simulated(file, outcome, found, errors)


def _results(file: MotorFile, resolution: Resolution) -> list[Metrics]:
    found = cycles(file.system, resolution)
    return [summarise_compiled(cycle, file.goal.harmonics) for cycle in found]


def _plain(metrics: Metrics) -> dict[str, float]:
    return {name: float(value) for name, value in vars(metrics).items()}


def timing_of(file: MotorFile) -> Timing:
    """Port timing at the first operating point, in plain numbers."""
    import jax

    system = file.system
    return jax.device_get(
        jax.jit(port_timing)(system.motor, system.fluid, system.operating_points[0])
    )


def _gaps(timing: Timing) -> tuple[float, float]:
    return float(timing.inner_gap), float(timing.outer_gap)


def _relative(name: str, errors: dict[str, float], results: Any) -> float:
    scale = scale_of(name, results)
    if name == "min_contact_force":
        scale = max(scale, abs(results["ideal_torque"] / results["stroke"]))
    error = errors[name] / scale if scale > 0 else errors[name]
    return error if math.isfinite(error) else math.inf


def _about(results: Any, file: MotorFile) -> list[str]:
    """Sentences with a place for the operating point."""
    said = []
    if results["min_undercut_factor"] <= 0:
        said.append(
            "The roller undercuts the ring: the undercut factor falls to "
            f"{results['min_undercut_factor']:.3g}, so no such ring can be ground and its "
            "contact stress means nothing; take a smaller roller or a smoother cam."
        )
    vapour = float(file.system.fluid.vapour_pressure)
    if results["min_pressure"] < vapour:
        said.append(
            f"The chamber pressure falls to {results['min_pressure'] / 1e5:.4g} bar{{}}, below "
            f"the vapour pressure of {vapour / 1e5:.3g} bar: the oil would cavitate."
        )
    if results["min_contact_force"] < 0:
        said.append(
            f"The roller leaves the ring{{}}: the radial force falls to "
            f"{results['min_contact_force']:.4g} N."
        )
    if not np.isfinite(results["efficiency"]) or not 0 < results["efficiency"] < 1:
        said.append("The motor delivers no sensible power{}: look at its timing.")
    return said
