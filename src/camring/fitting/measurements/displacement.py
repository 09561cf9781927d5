"""The displacement that measured rows imply, before any law of the motor is asked.

Flow over speed is displacement over volumetric efficiency, torque over pressure drop is
displacement times hydromechanical efficiency; both are near it in every motor worth
measuring. Medians, so that a wrong row does not count.
"""

from dataclasses import dataclass
from math import isfinite, isnan, nan, pi

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.fitting.measurements.table import MeasuredTable
from camring.geometry.cam import AbstractCam
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.programs.motor_program import motor_program

MOST_PAIRED = 300  # rows; more say the same
APART = 0.2  # of the highest speed: nearer rows tell no slope
FLOW_BAND = (0.85, 1.25)
"""Of the displacement given, what flow over speed may imply: compression and leakage add."""
FLOW_AT_ONE_SPEED = (0.9, 4.0)  # leakage is in it
TORQUE_BAND = (0.5, 1.08)
"""Of the displacement given, what torque over pressure drop may imply: friction takes."""
BRAKING_BAND = (0.92, 2.0)  # to braking it adds


@dataclass(frozen=True)
class ImpliedDisplacement:
    """Displacements in m3 a revolution; NaN where the rows hold no such result.

    Attributes
    ----------
    by_flow, by_torque
        Of the rows. Without rows at several speeds leakage is in `by_flow`.
    given
        Of the motor file.
    one_speed
        Whether all rows have nearly one speed.
    brakes
        Whether all rows with a torque brake.
    """

    by_flow: float
    by_torque: float
    given: float
    one_speed: bool
    brakes: bool = False

    @property
    def fits(self) -> bool:
        """Whether rows and motor file can be of one motor."""
        flow = FLOW_AT_ONE_SPEED if self.one_speed else FLOW_BAND
        torque = BRAKING_BAND if self.brakes else TORQUE_BAND
        return all(
            isnan(found) or low * self.given <= found <= high * self.given
            for found, (low, high) in ((self.by_flow, flow), (self.by_torque, torque))
        )

    @property
    def sentence(self) -> str:
        """What the rows imply beside what the file has; empty where they imply nothing."""
        parts = [
            f"{1e6 * value:.4g} cm³/rev ({how})"
            for value, how in (
                (self.by_flow, f"flow over speed{', with leakage' * self.one_speed}"),
                (self.by_torque, "torque over pressure drop"),
            )
            if isfinite(value)
        ]
        if not parts:
            return ""
        said = f"The rows imply a displacement of {' and '.join(parts)}"
        return f"{said}; the motor file's is {1e6 * self.given:.4g} cm³/rev."


def implied_displacement(
    table: MeasuredTable, points: list[OperatingPoint], motor: Motor
) -> ImpliedDisplacement:
    """From the measured flow and torque of all rows.

    Parameters
    ----------
    points
        Operating point of each row.
    """
    turns = np.abs(np.array([float(each.shaft_speed) for each in points])) / (2 * pi)
    drops = np.array([float(each.supply_pressure) - float(each.return_pressure) for each in points])
    braking = drops < 0
    empty = np.full(len(points), nan)
    flow = np.abs(table.values.get("supply_flow", empty))
    torque = np.abs(table.values.get("mean_torque", empty))
    # Friction takes from a motor's torque and adds to a brake's: the rows that drive tell, if any.
    told_by_brakes = not np.any(np.isfinite(torque) & ~braking)
    chosen = np.where(told_by_brakes | ~braking, torque, nan)
    by_flow, one_speed = _over_speed(flow, turns)
    return ImpliedDisplacement(
        by_flow=by_flow,
        by_torque=_median(2 * pi * chosen / np.maximum(abs(drops), 1.0)),
        given=geometric_displacement(motor),
        one_speed=one_speed,
        brakes=told_by_brakes,
    )


def geometric_displacement(motor: Motor) -> float:
    """Pistons times their rises in one revolution times their area, m3."""
    cam = motor.cam
    radius = np.asarray(_radii_around(cam))
    rises = cam.repeats * float(np.sum(np.maximum(np.diff(radius), 0.0)))
    return motor.pistons * rises * float(motor.piston.area)


@motor_program
def _radii_around(cam: AbstractCam) -> Float[Array, " place"]:
    """As one program: step by step JAX would compile each."""
    return cam.pitch_radius(jnp.linspace(0.0, cam.period, 4001)).value


def _over_speed(
    flow: Float[np.ndarray, " row"], turns: Float[np.ndarray, " row"]
) -> tuple[float, bool]:
    """Median slope of flow over speed of all pairs of rows; at one speed their ratio."""
    known = np.flatnonzero(np.isfinite(flow))
    if not len(known):
        return nan, False
    known = known[:: max(1, len(known) // MOST_PAIRED)]
    first, second = np.triu_indices(len(known), 1)
    run = (turns[known][second] - turns[known][first]).astype(float)
    rise = flow[known][second] - flow[known][first]
    apart = np.abs(run) > APART * np.max(turns[known])
    if not np.any(apart):
        return _median(flow[known] / np.maximum(turns[known], 1e-9)), True
    return _median(rise[apart] / run[apart]), False


def _median(values: Float[np.ndarray, " value"]) -> float:
    return float(np.median(values[np.isfinite(values)])) if np.any(np.isfinite(values)) else nan
