"""What a motor's modes are by counting alone: shares, orders that survive, balance.

Pistons and the pattern of lobes that drive look the same after each turn that both share.
With two such places or more the radial forces on shaft and ring cancel, in the dynamic
model too, and torque holds multiples of the lowest common multiple of pistons and pattern.
"""

from dataclasses import dataclass
from math import gcd, lcm

import numpy as np

from camring.analyses.pushing import pushes_everywhere, some_split_pushes_everywhere
from camring.files.modes import modes_of
from camring.files.motor import MotorFile
from camring.geometry.cam import AbstractCam, RadialCam
from camring.geometry.idle_lobes import pattern_repeats
from camring.metrics.displacement import rises_between_knots
from camring.physics.rotation import in_mode

__all__ = ["Mode", "balanced_splits", "cam_repeats", "modes", "splits_in_words"]

ALIKE = 1e-9  # of the stroke, to which lobes are equal
NO_START = (
    " At some angles no piston stands on a rising flank that is fed: there it gives no torque "
    "and does not start."
)


@dataclass(frozen=True)
class Mode:
    """One mode of a motor.

    Attributes
    ----------
    share
        Of the full displacement.
    idle
        Lobes that idle, counted from 1.
    repeats
        How often a revolution cam and pattern of idle lobes repeat.
    cam_repeats
        How often a revolution the cam alone repeats.
    """

    name: str
    pistons: int
    lobes: int
    idle: tuple[int, ...]
    repeats: int
    share: float
    cam_repeats: int

    @property
    def alike(self) -> bool:
        """Whether all lobes are equal."""
        return self.cam_repeats == self.lobes

    @property
    def order(self) -> int:
        """Torque holds multiples of this shaft order only."""
        return lcm(self.pistons, self.repeats)

    @property
    def balanced(self) -> bool:
        """Whether the radial forces of all pistons cancel."""
        return gcd(self.pistons, self.repeats) > 1

    @property
    def pushes_everywhere(self) -> bool:
        """Whether at every angle some piston pushes; else the motor does not start at some.

        With rising flanks of half a lobe (`analyses.pushing`).
        """
        return pushes_everywhere(self.pistons, self.lobes, tuple(each - 1 for each in self.idle))

    @property
    def sentence(self) -> str:
        """All of this in words."""
        return self._counted + NO_START * (not self.pushes_everywhere)

    @property
    def _counted(self) -> str:
        few = len(self.idle) == 1
        lobes = ", ".join(map(str, self.idle))
        times = "once" if self.repeats == 1 else f"{self.repeats} times"
        said = (
            f"Mode {self.name}: lobe{'s' * (not few)} {lobes} idle, {100 * self.share:.3g} % of "
            f"the displacement{' of equal lobes' * self.alike}. The pattern repeats {times} a "
            f"revolution: with {self.pistons} pistons torque holds orders {self.order}, "
            f"{2 * self.order}, ..., and "
        )
        if self.balanced:
            return said + "radial forces cancel."
        counts = self.pistons, self.lobes, self.cam_repeats
        said += "radial forces do not cancel; they do "
        if not balanced_splits(*counts):
            return f"{said}in {splits_in_words(*counts)}."
        return f"{said}when {splits_in_words(*counts)} idle."


def balanced_splits(
    pistons: int, lobes: int, cam_repeats: int | None = None
) -> tuple[tuple[int, int], ...]:
    """Numbers of idle lobes that leave radial forces balanced, and how often their pattern repeats.

    Of equal lobes, unless the cam repeats less often than it has lobes.

    >>> balanced_splits(8, 6), balanced_splits(7, 6)
    (((2, 2), (4, 2)), ())
    """
    shared = gcd(pistons, cam_repeats or lobes)
    found: dict[int, int] = {}
    for times in range(shared, 1, -1):
        if shared % times == 0:
            for idle in range(times, lobes, times):
                found.setdefault(idle, times)
    return tuple(sorted(found.items()))


def splits_in_words(pistons: int, lobes: int, cam_repeats: int | None = None) -> str:
    """Which numbers of lobes may idle without a side load, and what of the torque is then left.

    >>> splits_in_words(10, 6)
    '2 of 6 lobes (torque orders 10, 20, ...) or 4 of 6 lobes (no torque at some angles)'
    >>> splits_in_words(7, 6)
    'no split of 7 pistons on 6 lobes'
    """
    shared = gcd(pistons, cam_repeats or lobes)
    found = []
    for idle, most in balanced_splits(pistons, lobes, cam_repeats):
        left = "no torque at some angles"
        for times in range(most, 1, -1):
            if gcd(shared, idle) % times == 0 and (
                some_split_pushes_everywhere(pistons, lobes, idle, times) is not False
            ):
                order = lcm(pistons, times)
                left = f"torque orders {order}, {2 * order}, ..."
                break
        found.append(f"{idle} of {lobes} lobes ({left})")
    return " or ".join(found) or f"no split of {pistons} pistons on {lobes} lobes"


def cam_repeats(cam: AbstractCam, lobes: int) -> int:
    """How often a revolution a cam repeats, equal lobes of a free ring counted, too."""
    if not isinstance(cam, RadialCam):
        return cam.repeats
    whole = np.tile(np.asarray(cam.control_radii), cam.repeats)
    for times in (each for each in range(lobes, cam.repeats, -1) if lobes % each == 0):
        step, rest = divmod(len(whole), times)
        if not rest and np.allclose(
            np.roll(whole, step), whole, rtol=0, atol=ALIKE * np.ptp(whole)
        ):
            return times
    return cam.repeats


def modes(file: MotorFile) -> tuple[Mode, ...]:
    """The modes of a motor file, in its order."""
    motor = file.system.motor
    repeats = cam_repeats(motor.cam, motor.lobes)
    alike = repeats == motor.lobes

    def share(idle: tuple[int, ...]) -> float:
        if alike:
            return 1 - len(idle) / motor.lobes
        return float(rises_between_knots(in_mode(motor, idle)) / rises_between_knots(motor))

    return tuple(
        Mode(
            name,
            motor.pistons,
            motor.lobes,
            tuple(lobe + 1 for lobe in idle),
            gcd(repeats, pattern_repeats(idle, motor.lobes)),
            share(idle),
            repeats,
        )
        for name, idle in modes_of(file.document["motor"].get("modes", {}), motor.lobes).items()
    )
