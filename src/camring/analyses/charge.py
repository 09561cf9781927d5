"""How much pressure the return side needs at each speed, so that rollers stay on the ring."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from camring.analyses.operating_map import point_of
from camring.evaluation.simulations import repeated, results_of_many
from camring.files.motor import MotorFile
from camring.numerics.quantity import real
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

__all__ = ["ChargeCurve", "charge_curve", "charge_pressures"]

ATMOSPHERE = 101325.0  # Pa, in a case that drains to tank
HIGHEST = 3e7  # Pa; beyond it no charge pump goes
NEAR = 50.0  # Pa, of the margin that is sought as zero
_MOST_STEPS = 25
HARMONICS = 600  # as every map has, so that one program serves both

Speeds = Float[np.ndarray, " speed"]
Margin = Callable[[Speeds], Speeds]


@dataclass(frozen=True, eq=False)
class ChargeCurve:
    """The least return pressure over speed; where the point brakes, the least supply pressure.

    Attributes
    ----------
    speed
        rad/s.
    pressure
        Least pressure of the low side, Pa absolute; NaN where none up to 300 bar suffices, or
        a simulation failed.
    by_contact
        Whether it is the rollers that ask for it; else it is air that would be released.
    drop, case_pressure
        Between the ports, negative where it brakes, and in the case, Pa; both held.
    case_given
        Whether the motor file gives the case pressure; else it drains to tank.
    """

    speed: Speeds
    pressure: Speeds
    by_contact: np.ndarray
    drop: float
    case_pressure: float
    case_given: bool

    @property
    def note(self) -> str:
        """What is held, in a sentence."""
        case = "as the file gives it" if self.case_given else "drained to tank"
        side, braking = ("supply", ", braking,") if self.drop < 0 else ("return", "")
        return (
            f"Charge pressure: the least absolute {side} pressure at which every roller stays on "
            f"the ring and no chamber falls below air release, at a pressure difference of "
            f"{abs(self.drop) / 1e5:.4g} bar{braking} and a case at "
            f"{self.case_pressure / 1e5:.4g} bar ({case})."
        )


def charge_curve(file: MotorFile, speeds: Speeds, operating_point: int = 1) -> ChargeCurve:
    """The charge pressure of a motor file at speeds, rad/s.

    Parameters
    ----------
    operating_point
        Number of the operating point, counted from 1, whose pressure difference is kept. Its
        case pressure is kept where the file gives one; else the case drains to tank, as it must
        not rise with the return pressure that is sought.

    Raises
    ------
    InputError
        When there is no operating point of this number.
    """
    point = point_of(file, operating_point)
    given = file.document["operating_points"][operating_point - 1].get("case_pressure") is not None
    case = float(point.case_pressure) if given else ATMOSPHERE
    drop = float(point.pressure_drop)
    pressure, by_contact = charge_pressures(
        file.system.motor, file.system.fluid, point, speeds, case
    )
    return ChargeCurve(speeds, pressure, by_contact, drop, case, given)


def charge_pressures(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    speeds: Speeds,
    case_pressure: float,
) -> tuple[Speeds, np.ndarray]:
    """The least pressures of the low side, Pa, and where it is the contact that asks for them.

    The high side rises with it, so that the difference stays: the supply, or the return where
    the machine brakes.

    Parameters
    ----------
    speeds
        rad/s.
    """
    motors, fluids = repeated(motor, len(speeds)), repeated(fluid, len(speeds))
    drop, air = float(point.pressure_drop), float(fluid.atmospheric_pressure)
    area, ones = float(motor.piston.area), np.ones(len(speeds))

    def margins(low: Speeds) -> tuple[Speeds, Speeds]:
        """Pressures by which contact and air release are kept."""
        asked = replace(
            point,
            shaft_speed=real(speeds),
            supply_pressure=real(low + max(drop, 0.0)),
            return_pressure=real(low + max(-drop, 0.0)),
            case_pressure=real(case_pressure * ones),
            weight=real(ones),
        )
        found, faults = results_of_many(motors, fluids, asked, harmonics=HARMONICS)
        sound = np.asarray(faults) == 0
        contact = np.where(sound, found.min_contact_force / area, np.nan)
        return contact, np.where(sound, found.air_release_margin, np.nan)

    pressure = _least(lambda low: np.minimum(*margins(low)), air * ones)
    contact, released = margins(np.where(np.isfinite(pressure), pressure, air))
    return pressure, contact <= released


def _least(margin: Margin, lowest: Speeds) -> Speeds:
    """The least pressure at or above `lowest` with a margin of zero, each by itself.

    The margin rises about as much as the pressure: a bracket is found so, and then narrowed by
    false positions (Illinois), all speeds together.
    """
    low, at_low = lowest.copy(), margin(lowest)
    # Where the lowest will do, it is the answer.
    done = at_low >= -NEAR
    failed = np.isnan(at_low)
    high, at_high = low.copy(), at_low.copy()
    for step in range(_MOST_STEPS):
        asking = ~done & ~failed & (at_high < 0)
        if not np.any(asking):
            break
        low, at_low = np.where(asking, high, low), np.where(asking, at_high, at_low)
        # Further each time, so that a margin which does not rise is given up soon.
        high = np.where(asking, high - 1.2 * 3.0**step * at_high + NEAR, high)
        failed |= asking & (high > HIGHEST)
        at_high = np.where(asking & ~failed, margin(np.minimum(high, HIGHEST)), at_high)
        failed |= np.isnan(at_high)
    found = np.where(done, low, high)
    failed |= ~done & (at_high < 0)
    close, side = done | failed | (at_high <= NEAR), np.zeros(len(found))
    for _ in range(_MOST_STEPS):
        if np.all(close):
            break
        between = low - at_low * (high - low) / np.where(close, 1.0, at_high - at_low)
        tried = np.where(close, found, between)
        at = margin(np.minimum(tried, HIGHEST))
        failed |= ~close & np.isnan(at)
        found = np.where(close, found, tried)
        close |= failed | (np.abs(at) <= NEAR)
        above = at > 0
        # An end that stays twice counts half, so that the bracket closes from both sides.
        stays = np.where(side == np.where(above, 1, -1), 0.5, 1.0)
        side = np.where(above, 1, -1)
        at_low = np.where(above, stays * at_low, at)
        at_high = np.where(above, at, stays * at_high)
        low, high = np.where(above, low, tried), np.where(above, tried, high)
    return np.where(failed | ~close, np.nan, found)
