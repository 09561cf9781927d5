"""A design while the hand moves it: every operating point side by side, in one call.

The batch program answers in a third of the time that the solver for one motor takes, and is
read from disk in a hundredth. It differs from it by 2e-4 of most results and 1e-3 of flow ripples
(`docs/notes/batch.md`), so what rests is solved anew by `evaluation.evaluated`.
"""

from dataclasses import replace
from typing import Any

import jax
import numpy as np

from camring.metrics.batch_shown import OF_ONE_PISTON, seen_batch
from camring.metrics.shown import ORDERS, Waves, sample_count
from camring.objective.objective import Goal
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.rotation import turned
from camring.physics.system import System
from camring.programs.batch_program import BatchProgram
from camring.studio.evaluation import Evaluated, evaluated, faults_in, highest_order, limits_of

RESOLUTION = BatchResolution()

_seen = BatchProgram(seen_batch)


def followed(system: System, goal: Goal) -> Evaluated:
    """Without cycles where the motor can be simulated side by side, else `evaluated`.

    Points of several modes are motors of several structures, which cannot.
    """
    if not fits(system.motor) or any(each.idle_lobes for each in system.operating_points):
        return evaluated(system, goal)
    motor, points = system.motor, system.operating_points
    count = sample_count(motor.lobes // motor.cam.repeats) - 1
    given = [(*_forwards(motor, point), system.fluid) for point in points]
    motors, operated, fluids = _side_by_side(given)
    found = _seen(motors, fluids, operated, goal.harmonics, count, RESOLUTION)
    rows, waves = np.asarray(found.rows).T, np.asarray(found.waves)
    results = rows[:, :-1]
    return Evaluated(
        system,
        (),
        tuple(_waves(waves[..., k], motor, goal.harmonics) for k in range(len(points))),
        results,
        limits_of(system, goal.constraints, results),
        faults_in(rows[:, -1]),
    )


def _forwards(motor: Motor, point: OperatingPoint) -> tuple[Motor, OperatingPoint]:
    """The motor as the point turns it, without the word for which way: one program for both."""
    if not (point.reverse or motor.from_behind):
        return motor, point
    return replace(turned(motor, point), from_behind=False), replace(point, reverse=False)


def _side_by_side(trees: list[Any]) -> Any:
    return jax.tree.map(lambda *leaves: np.moveaxis(np.array(leaves), 0, -1), *trees)


def _waves(ones: np.ndarray, motor: Motor, harmonics: int) -> Waves:
    """With both ends of the period, and all pistons together."""
    wave: dict[str, Any] = dict(zip(OF_ONE_PISTON, ones, strict=True))
    torque = _of_all_pistons(wave.pop("torque"), motor)
    flow = _of_all_pistons(wave.pop("supply_flow"), motor)
    shown: dict[str, Any] = {
        **{name: np.append(each, each[0]) for name, each in wave.items()},
        "torque": np.append(torque, torque[0]),
        "torque_orders": _orders(torque, motor, harmonics),
        "flow_orders": _orders(flow, motor, harmonics),
    }
    return Waves(**shown)


def _of_all_pistons(wave: np.ndarray, motor: Motor) -> np.ndarray:
    """The same at every place; between places a straight line."""
    phases, count = motor.distinct_phases, len(wave)
    if count % phases == 0:
        each = np.tile(wave.reshape(phases, -1).sum(axis=0), phases)
    else:
        places = np.arange(count) + count / phases * np.arange(phases)[:, None]
        each = np.interp(places, np.arange(count), wave, period=count).sum(axis=0)
    return motor.pistons // phases * each


def _orders(wave: np.ndarray, motor: Motor, harmonics: int) -> np.ndarray:
    """Peak amplitudes at multiples of the surviving order, as in `metrics.shown`."""
    amplitude = 2 * np.abs(np.fft.rfft(wave)) / len(wave)
    first = motor.surviving_order
    orders = np.arange(first, highest_order(motor, harmonics) + 1, first)[:ORDERS]
    return amplitude[np.minimum(orders // motor.cam.repeats, len(amplitude) - 1)]
