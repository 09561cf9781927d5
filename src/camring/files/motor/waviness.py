"""The table `[tolerances.waviness]`: amplitudes of waves round the ring, by their order."""

import re
from typing import Any

import numpy as np

from camring.files.errors import InputError, quote
from camring.files.motor.entries import Number, Unfit
from camring.files.motor.tables import MotorTable
from camring.geometry.cam import RadialCam
from camring.numerics.quantity import real
from camring.objective.tolerances import Waviness
from camring.physics.system import System

FIELD = "tolerances.waviness"
AMPLITUDE = Number("a wave's amplitude, half its height", '"2 um"', unit="m", high=1e-3)
PER_WAVE = 4  # control values that a wave needs to look like one


def build_waviness(
    given: Any, motor: MotorTable, system: System
) -> tuple[Waviness, tuple[str, ...]]:
    """Waves on the ring, and each amplitude in words.

    An order is a number of waves in a revolution. Unless all are multiples of the lobes,
    or the cam is a free ring already, the ring is described lobe by lobe.

    Raises
    ------
    InputError
        For a key that is no order, an order too fine for the control radii, a planar cam.
    """
    if not isinstance(given, dict) or not given:
        raise InputError(FIELD, f"is {quote(given)}", 'write 3 = "2 um" in it, amplitude by order')
    cam = system.motor.cam
    if not isinstance(cam, RadialCam):
        raise InputError(
            FIELD, "needs a radial cam", 'leave it out, or write motor.cam with "radial"'
        )
    amplitudes = {_order(key): _amplitude(key, value) for key, value in given.items()}
    if len(amplitudes) < len(given):
        raise InputError(FIELD, "has one order twice", "give each order one amplitude")
    orders = tuple(sorted(amplitudes))
    finest = cam.control_count * cam.repeats // PER_WAVE
    if orders[-1] > finest:
        raise InputError(
            f"{FIELD}.{orders[-1]}",
            f"is finer than {cam.control_count * cam.repeats} control radii a revolution can "
            f"carry, {PER_WAVE} to a wave",
            f"give orders up to {finest}, or more control radii",
        )
    unfold = cam.repeats > 1 and any(order % cam.repeats for order in orders)
    texts = {_order(key): str(value) for key, value in given.items()}
    waves = Waviness(orders, real(np.array([amplitudes[each] for each in orders])), unfold)
    return waves, tuple(f"{texts[each]}, any phase" for each in orders)


def _order(key: str) -> int:
    if re.fullmatch(r"[1-9][0-9]{0,3}", key):
        return int(key)
    raise InputError(
        f"{FIELD}.{key if key.isidentifier() else quote(key)}",
        "is no order",
        'give whole numbers of waves in a revolution, such as 3 = "2 um"',
    )


def _amplitude(key: str, value: Any) -> float:
    try:
        return AMPLITUDE.read(value)
    except Unfit as error:
        raise InputError(f"{FIELD}.{key}", error.problem, error.way_out) from None
