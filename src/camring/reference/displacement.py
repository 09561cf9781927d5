"""What a piston rises on fed lobes, by the second solver: from one turning point to the next."""

from math import pi

import numpy as np

from camring.reference.chamber import Chamber

__all__ = ["rises_on_fed_lobes"]


def rises_on_fed_lobes(chamber: Chamber) -> float:
    """In one period of the cam; all of it where no lobe idles.

    Lobes last from inner dead centre to inner dead centre as plate and lobes imply them.
    """
    curve, m = chamber.curve, chamber.machine
    turning = curve.turning_points()
    if not m.idle_lobes:
        at = np.append(turning, turning[0] + m.period) if len(turning) else np.zeros(2)
        return float(np.sum(np.maximum(np.diff(curve.jet(at)[0]), 0)))
    pitch = 2 * pi / m.lobes
    start = round((m.supply.centre + m.return_.centre) / 2 / pitch - 0.5)
    around = np.concatenate([turning + k * m.period for k in range(-2, 3)])
    total = 0.0
    for lobe in range(m.lobes // m.repeats):
        if lobe in m.idle_lobes:
            continue
        low, high = (start + lobe) * pitch, (start + lobe + 1) * pitch
        inside = np.sort(around[(around > low) & (around < high)])
        at = np.concatenate([[low], inside, [high]])
        total += float(np.sum(np.maximum(np.diff(curve.jet(at)[0]), 0)))
    return total
