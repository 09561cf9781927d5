"""The tables of a motor file that say what is wanted: objective, limits, search."""

from typing import Annotated as Key

from camring.files.motor.entries import Count, Number, Word, band
from camring.files.motor.per_turn import PerTurn
from camring.files.motor.table import FULL_TURN, Table, pressure_entry


def _weight(meaning: str, example: str) -> Number:
    return Number(f"the weight of {meaning}", example, high=1e6)


class ObjectiveTable(Table):
    """[objective]: the weights of docs/theory.md section 8."""

    torque_ripple: Key[float, _weight("squared torque ripple", "10")] = 10.0
    pressure_ripple: Key[float, _weight("squared pressure ripple", "0.02")] = 0.02
    efficiency: Key[float, _weight("one minus efficiency", "1")] = 1.0
    spectrum: Key[float, _weight("the spectral sum", "1")] = 1.0
    jerk: Key[float, _weight("the mean squared jerk", "0.02")] = 0.02
    spectral_pressure: Key[float, _weight("pressure in the spectral sum", "0.01")] = 0.01
    spectral_torque: Key[float, _weight("torque in the spectral sum", "1")] = 1.0
    envelope_ripple: Key[
        float, _weight("the mean squared torque ripple over the envelope", "10")
    ] = 0.0
    penalty: Key[float, Number("the factor of squared violations", "100", high=1e9)] = 100.0
    harmonics: Key[
        int, Count("the number of shaft orders in ripples and sums", "600", high=20000)
    ] = 600


def _limit(
    meaning: str, example: str, unit: str = "1", low: float = 0.0, high: float = 1e12
) -> Number:
    return Number(f"the limit of {meaning}", example, unit=unit, low=low, high=high)


class ConstraintsTable(Table):
    """[constraints]: results with their sense; a limit that is not given is none."""

    min_pressure: Key[
        float | None,
        pressure_entry("the least chamber pressure (unless given, the vapour pressure)", '"3 kPa"'),
    ] = None
    max_pressure: Key[
        float | None, pressure_entry("the greatest chamber pressure", '"300 bar"', 1)
    ] = None
    max_contact_stress: Key[
        float | None, _limit("Hertzian contact stress", '"1.8 GPa"', "Pa", 1.0)
    ] = None
    min_contact_force: Key[
        float | None, _limit("the force of roller on ring", '"0 N"', "N", -1e9)
    ] = None
    max_pressure_angle: Key[
        float | None, _limit("the pressure angle", '"30 deg"', "rad", 1e-6, FULL_TURN / 4)
    ] = None
    min_undercut_factor: Key[
        float | None, _limit("the undercut factor", "0.25", low=-10.0, high=10.0)
    ] = None
    max_velocity: Key[float | None, _limit("piston speed", '"2 m/s"', "m/s", 1e-9)] = None
    max_acceleration: Key[
        float | None, _limit("piston acceleration", '"500 m/s^2"', "m/s^2", 1e-9)
    ] = None
    max_jerk: Key[float | None, _limit("piston jerk", '"1e5 m/s^3"', "m/s^3", 1e-9)] = None
    max_case_temperature_rise: Key[
        float | None,
        Number(
            "the limit of how much warmer case and films are than the oil that comes in",
            '"30 K"',
            unit="K",
            difference=True,
            low=0.1,
            high=200.0,
        ),
    ] = None
    min_damping_ratio: Key[float | None, _limit("the damping ratio", "0.001", high=10.0)] = None
    min_mean_torque: Key[float | None, _limit("the mean torque", '"1.5 kN*m"', "N*m", -1e9)] = None
    min_l10_life: Key[
        float | None, _limit("the rating life of ring and rollers", '"5000 h"', "s", 1.0)
    ] = None
    displacement: Key[
        tuple[float, float] | None,
        band(PerTurn("the limit of the volume per revolution", '"400 cm^3"', unit="m^3", high=1e3)),
    ] = None
    stroke: Key[
        tuple[float, float] | None, band(_limit("the stroke", '"12 mm"', "m", 0.0, 100.0))
    ] = None
    lift: Key[
        tuple[float, float] | None, band(_limit("the lift", '"12 mm"', "m", -100.0, 100.0))
    ] = None


GRADIENT, SCBO, BAYESIAN = "gradient", "scbo", "bayesian"
METHODS = (GRADIENT, SCBO, BAYESIAN)
"""Searches for motors; those of another name come from `search.strategies.STRATEGIES`."""


class SearchTable(Table):
    """[search]"""

    budget: Key[int, Count("the number of model evaluations", "300", high=1_000_000)] = 300
    seed: Key[int, Count("the number all chance comes from", "0", low=0, high=2**31)] = 0
    method: Key[
        str,
        Word(
            "how designs are sought: down exact slopes from several starts, or by a model "
            "learned from the evaluations alone, in a trust region or in the whole box",
            '"gradient"',
            words=METHODS,
        ),
    ] = GRADIENT
    mode: Key[
        str,
        Word(
            "how the bayesian search learns limits: one surrogate for each, or a penalty in one",
            '"separate"',
            words=("separate", "penalised"),
        ),
    ] = "separate"
    kappa: Key[
        float, Number("the standard deviations that the bayesian search hopes for", "2", high=20)
    ] = 2.0
    refinement: Key[
        float,
        Number(
            "the share of the bayesian search's budget for the descent at its end", "0.2", high=1.0
        ),
    ] = 0.2
