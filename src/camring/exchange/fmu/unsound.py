"""Where the numbers of a table leave what the model describes: lift-off and cavitation.

A table reaches further than a motor is for: it brakes, it comes near standstill. What
happens inside the motor file's envelope is kept apart from what happens outside.
"""

from collections.abc import Sequence
from itertools import groupby

import numpy as np
from jaxtyping import Bool, Float

from camring.exchange.fmu.axes import BAR, RPM
from camring.exchange.fmu.places import Found
from camring.files.motor import MotorFile
from camring.physics.envelope import Envelope, Range

__all__ = ["inside", "unsound_places"]

_SAME = 1e-9  # relative: a corner of the envelope is inside
_MOST_GROUPS = 6

Places = Float[np.ndarray, "place axis"]


def unsound_places(file: MotorFile, places: Places, found: Found, case: float) -> list[str]:
    """A sentence for each kind of fault, driving inside and outside the envelope and braking.

    Parameters
    ----------
    places
        Speed (rad/s), pressure drop and lower port pressure above the case (Pa).
    case
        The case pressure, Pa absolute.
    """
    driving = places[:, 0] * places[:, 1] > 0
    braking = places[:, 0] * places[:, 1] < 0
    if file.envelope is None:
        parts = [(driving, "Driving")]
    else:
        within = inside(file.envelope, places, case)
        parts = [
            (driving & within, "Driving inside the envelope"),
            (driving & ~within, "Driving outside the envelope, which the motor is not for"),
        ]
    faults = (
        (found.least_force < 0, "the roller lifts off the ring"),
        (
            found.lowest_pressure < float(file.system.fluid.vapour_pressure),
            "the oil would cavitate",
        ),
    )
    said = [
        f"{name}, {what} for a part of the cycle at {np.count_nonzero(where & unsound)} of "
        f"{np.count_nonzero(where)} points, which the table takes no notice of: "
        f"{_values(places[where & unsound])}."
        for where, name in [*parts, (braking, "Braking")]
        for unsound, what in faults
        if (where & unsound).any()
    ]
    if file.envelope is None and any(each.startswith("Driving") for each in said):
        said.append(
            "The motor file does not say where the motor must run: with [envelope] in it the table "
            "covers that and no more of driving; or narrow --speed, --pressure and --low-pressure."
        )
    return said


def inside(envelope: Envelope, places: Places, case: float) -> Bool[np.ndarray, " place"]:
    """Which places lie in an envelope, as a motor: driven by its supply port, or by the other
    one backwards where the envelope has both directions."""
    speed, drop, low = places.T
    back = case + low
    turns = (speed > 0) & (drop > 0)
    if envelope.both_directions:
        turns |= (speed < 0) & (drop < 0)
    return (
        turns
        & _between(np.abs(speed), envelope.speed)
        & _between(back + np.abs(drop), envelope.supply_pressure)
        & _between(back, envelope.return_pressure)
    )


def _between(values: np.ndarray, limits: Range) -> np.ndarray:
    low, high = limits
    return (values >= low * (1 - _SAME)) & (values <= high * (1 + _SAME))


def _values(places: Places) -> str:
    """The axis values: speeds that have the same pressure drops together."""
    speeds = np.abs(places[:, 0])
    of_speed = [
        (speed, tuple(np.unique(np.abs(places[speeds == speed, 1])))) for speed in np.unique(speeds)
    ]
    groups = [
        ([speed for speed, _ in members], drops)
        for drops, members in (
            (drops, list(each)) for drops, each in groupby(of_speed, key=lambda each: each[1])
        )
    ]
    said = [
        f"{_listed([s / RPM for s in those])} rpm with pressure drops of "
        f"{_listed([d / BAR for d in drops])} bar"
        for those, drops in groups[:_MOST_GROUPS]
    ]
    left = sum(len(those) for those, _ in groups[_MOST_GROUPS:])
    if left:
        highest = groups[-1][0][-1] / RPM
        said.append(f"and {left} more speeds up to {highest:.3g} rpm")
    return "; ".join(said)


def _listed(values: Sequence[float]) -> str:
    if len(values) > 4:
        return f"{values[0]:.3g}, {values[1]:.3g} … {values[-1]:.3g}"
    return ", ".join(f"{value:.3g}" for value in values)
