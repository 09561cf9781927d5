"""One motor over shaft speed and pressure difference, both signs of both: four quadrants.

Quadrants are counted as on a drawing: in the first the motor drives forwards, in the third
backwards; in the second and fourth the load drives it against the pressure, and it brakes.
"""

from dataclasses import replace

import jax
import numpy as np
from jaxtyping import Float

from camring.analyses.grid import Axis, Grid
from camring.analyses.oil_use import unread_viscosity
from camring.analyses.operating_map import limits_of, map_axes, point_of
from camring.analyses.ranges import point_counts
from camring.evaluation.simulations import Many, repeated, results_of_many
from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.numerics.quantity import real
from camring.physics.mirror import has_mirror_image
from camring.physics.operating_point import OperatingPoint

__all__ = ["DIFFERENCE", "quadrants"]

DIFFERENCE = "operating_points.pressure_difference"
ON_EACH_AXIS = 24
BAR = 1e5


def quadrants(
    file: MotorFile,
    *,
    speed: str | None = None,
    pressure: str | None = None,
    points: str | None = None,
    operating_point: int = 1,
) -> Grid:
    """Every result of a motor over signed speed and signed pressure difference.

    The difference is that of the port that drives forwards over the other one. The lower of
    both pressures is held, as is the case's; a case that the file does not give stands at it.

    Parameters
    ----------
    speed, pressure
        Ranges of the first quadrant as `operating_map` takes them, its default where there is
        none; the others are its mirror images.
    points
        Values on each axis over both signs, `"24x24"`, even numbers.
    operating_point
        Number of the operating point, counted from 1, whose low and case pressure are kept.

    Returns
    -------
    Results as the shaft turns: torque is negative where the load drives it.

    Raises
    ------
    InputError
        For ranges that are none, odd numbers of values, or a motor that turns one way only.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> found = camring.quadrants(
    ...     file, speed="50 rpm..150 rpm", pressure="100 bar..300 bar", points="4x4"
    ... )
    >>> torque = found.results["mean_torque"]
    >>> torque.shape, bool((torque[-1, -1] > 0) & (torque[0, -1] < 0))
    ((4, 4), True)
    """
    point = point_of(file, operating_point)
    motor, low = file.system.motor, float(point.lower_pressure)
    if not has_mirror_image(motor):
        raise InputError(
            "--quadrants",
            "asks for both directions, but a relief notch lies at the opening edge of its window, "
            "and backwards that edge closes, which the model does not have",
            "leave the notch out of [motor.valve_plate], or map one direction",
        )
    counts = point_counts(points, 2, ON_EACH_AXIS)
    if any(count % 2 for count in counts):
        raise InputError(
            "--points",
            f"is {'x'.join(map(str, counts))}, but as many values lie on each side of zero",
            f"give even numbers, such as {ON_EACH_AXIS}x{ON_EACH_AXIS}",
        )
    one_way = map_axes(file, speed, pressure, operating_point, tuple(n // 2 for n in counts))
    drops = _both_signs(one_way[1].si("Pa") - low)
    axes = (
        replace(one_way[0], shown=_both_signs(one_way[0].shown)),
        Axis(DIFFERENCE, "bar", np.array([float(f"{drop / BAR:.12g}") for drop in drops])),
    )
    turning, drop = (
        each.ravel() for each in np.meshgrid(axes[0].si("rad/s"), drops, indexing="ij")
    )
    found = _simulated(file, operating_point, turning, drop)
    case = _case(file, operating_point)
    kept = f"low side {low / BAR:.4g} bar, case {case / BAR:.4g} bar"
    title = f"{file.system.motor.name or file.path.stem}\n{kept}"
    grid = Grid.of(axes, *found, limits_of(file), title, unread_viscosity(file))
    return replace(grid, quadrants=True)


def _simulated(
    file: MotorFile, operating_point: int, turning: np.ndarray, drop: np.ndarray
) -> Many:
    """Forwards and backwards are two batches, put together in the order asked for."""
    system, point = file.system, point_of(file, operating_point)
    low, case = float(point.lower_pressure), _case(file, operating_point)
    # Backwards it is the other port that feeds.
    fed = np.where(turning < 0, -drop, drop)
    parts, order = [], []
    for backwards in (False, True):
        chosen = np.flatnonzero((turning < 0) == backwards)
        asked = OperatingPoint(
            shaft_speed=real(np.abs(turning[chosen])),
            supply_pressure=real(low + np.maximum(fed[chosen], 0)),
            return_pressure=real(low + np.maximum(-fed[chosen], 0)),
            case_pressure=real(np.full(len(chosen), case)),
            weight=real(np.ones(len(chosen))),
            reverse=backwards,
            idle_lobes=point.idle_lobes,
            mode=point.mode,
        )
        motors, fluids = repeated(system.motor, len(chosen)), repeated(system.fluid, len(chosen))
        parts.append(results_of_many(motors, fluids, asked, harmonics=file.goal.harmonics))
        order.append(chosen)
    place = np.argsort(np.concatenate(order))
    return jax.tree.map(lambda *each: np.concatenate(each)[place], *parts)


def _case(file: MotorFile, number: int) -> float:
    """What the file gives, else the low side's pressure."""
    point = point_of(file, number)
    given = file.document["operating_points"][number - 1].get("case_pressure") is not None
    return float(point.case_pressure if given else point.lower_pressure)


def _both_signs(values: Float[np.ndarray, " place"]) -> Float[np.ndarray, " place"]:
    values = np.sort(values)
    return np.concatenate([-values[::-1], values])
