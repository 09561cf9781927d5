"""How the best design answers when each variable is moved a little, all else held."""

from collections.abc import Sequence

import numpy as np

from camring.evaluation.evaluator import applied
from camring.files.motor import MotorFile
from camring.files.quantities import significant
from camring.physics.system import System
from camring.presentation.records import Sensitivity
from camring.report.coordinates import coordinates_of
from camring.report.simulation import results_of

__all__ = ["RESULTS", "sensitivities_of"]

STEP = 0.02  # of the width of the bounds, each way
RESULTS = ("torque_ripple", "efficiency", "max_contact_stress")


def sensitivities_of(
    motor_file: MotorFile, point: Sequence[float] | np.ndarray
) -> tuple[Sensitivity, ...]:
    """Weighted means of a few results with every coordinate moved down and up.

    Parameters
    ----------
    point
        The unit point about which to look.
    """
    space, system = motor_file.design_space, motor_file.system
    if space is None:
        return ()

    def results(unit_point: np.ndarray) -> dict[str, float]:
        moved = applied(space, system, unit_point)
        return _mean_results(moved, motor_file.goal.harmonics)

    centre = np.asarray(point, dtype=float)
    middle = results(centre)
    rows = []
    for place, coordinate in enumerate(coordinates_of(motor_file)):
        ends = []
        for way in (-1.0, 1.0):
            moved = centre.copy()
            moved[place] = np.clip(moved[place] + way * STEP, 0.0, 1.0)
            ends.append(results(moved))
        step = STEP * abs(coordinate.high - coordinate.low)
        shown = f"± {significant(step, 2)} {coordinate.unit}".rstrip()
        rows += [
            Sensitivity(coordinate.name, name, ends[0][name], ends[1][name], middle[name], shown)
            for name in RESULTS
        ]
    return tuple(rows)


def _mean_results(system: System, harmonics: int) -> dict[str, float]:
    """The weighted mean over the operating points; for limits the worst would mislead here."""
    weights = np.array([float(point.weight) for point in system.operating_points])
    each = results_of(system, harmonics)
    return {
        name: float(np.average([metrics[name] for metrics in each], weights=weights))
        for name in RESULTS
    }
