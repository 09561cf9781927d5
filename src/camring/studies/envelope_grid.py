"""At which points a finished design is simulated over its envelope."""

from camring.physics.envelope import Envelope
from camring.physics.system import System

ONE_WAY, BOTH_WAYS = (12, 9), (9, 7)
"""Speeds and pressures of the finer grid: some 110 points for each other condition."""

LEAST_SHARE = 0.1
"""Of pressure drop and speed, from where a file without an envelope is looked at."""


def usual_envelope(system: System) -> Envelope:
    """From a tenth to all of the pressure drop, at speeds from a tenth of the highest.

    Of the operating points that run on all lobes, if there are any: an envelope is of all lobes.
    """
    every = system.operating_points
    points = tuple(each for each in every if not each.idle_lobes) or every
    speeds = [float(point.shaft_speed) for point in points]
    back = [float(point.lower_pressure) for point in points]
    drop = max(abs(float(point.pressure_drop)) for point in points)
    same = all(float(each.case_pressure) == float(each.return_pressure) for each in points)
    return Envelope(
        speed=(min(LEAST_SHARE * max(speeds), min(speeds)), max(speeds)),
        supply_pressure=(max(back) + LEAST_SHARE * drop, max(back) + drop),
        return_pressure=(min(back), max(back)),
        case_pressure=None if same else max(float(point.case_pressure) for point in points),
        both_directions=len({point.reverse for point in points}) > 1,
    )
