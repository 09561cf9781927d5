"""What to know before fitted numbers are used, in plain words and with a way out."""

from collections.abc import Sequence

import numpy as np

from camring.fitting.better_rows import BETTER_MEASURED, ELSEWHERE, OTHERWISE, telling
from camring.fitting.constants import AbstractFit
from camring.fitting.doubts import FAR, lone_sentences
from camring.fitting.fitted_numbers import short
from camring.fitting.measurements.temperatures import OIL_TEMPERATURE
from camring.fitting.missing_laws import missing_law
from camring.search.confidence import drift

MOST_CHANCE = 3.0  # standard deviations of pure chance
TOO_MUCH, TOO_LITTLE = 2.0, 0.3  # scatter over what the standard deviations say
WITH_VISCOSITY = ("motor.gap.clearance", "motor.valve_plate.gap", "motor.reference_viscosity")
ONE_TEMPERATURE = 3.0  # K between rows that are of one temperature
_OF_A_PORT = (
    *(0.4, 1.0),
    "it is no port's any more and stands for other losses that grow with speed; fit "
    "viscous_damping or [motor.churning] with it, or check the port area",
)
USUAL_OF_ITS_KIND = {
    "motor.valve_plate.discharge_coefficient": _OF_A_PORT,
    "motor.valve_plate.supply_discharge_coefficient": _OF_A_PORT,
    "motor.valve_plate.return_discharge_coefficient": _OF_A_PORT,
    "fluid.bulk_modulus": (
        *(4e8, 3e9),
        "it is no oil's any more and stands for another loss of flow; check the displacement, "
        "the dead volume and the leakage",
    ),
    "motor.roller.friction": (0.0, 0.05, "it stands for another loss of torque"),
    "motor.side_friction": (0.0, 0.2, "it stands for another loss of torque"),
}
"""Lowest and highest of real machines, SI; a slit has 0.6, a rounded port 0.9 (Merritt, 1967)."""
NEARLY_ONE = 1.2  # highest over lowest
_OF_FLOW = {"supply_flow", "return_flow", "volumetric_efficiency", "case_drain", "input_power"}
_OF_TORQUE = {"mean_torque", "hydromechanical_efficiency", "output_power"}
_MADE_OF = {
    "hydromechanical_efficiency": {"mean_torque"},
    "volumetric_efficiency": {"supply_flow"},
    "efficiency": {"mean_torque", "supply_flow"},
    "port_efficiency": {"mean_torque", "return_flow"},
    "return_flow": {"supply_flow", "case_drain"},
    "output_power": {"mean_torque"},
    "input_power": {"supply_flow"},
}


def warnings_of(found: AbstractFit) -> list[str]:
    """The sentences, the gravest first."""
    return [
        *_unsettled(found),
        *_far(found),
        *lone_sentences(found),
        *_unbelievable(found),
        *_one_place(found),
        *_one_temperature(found),
        *_untold(found),
        *_tangled(found),
        *_at_limits(found),
        *_systematic(found),
        *_scatter(found),
        *_twice(found),
    ]


def _unsettled(found: AbstractFit) -> list[str]:
    if found.squares.settled:
        return []
    return ["The fit did not come to rest; its numbers and intervals are not to be trusted."]


def _far(found: AbstractFit) -> list[str]:
    said = []
    for result in found.table.values:
        here = found.of(result)
        size = np.sqrt(np.mean(found.measured[here] ** 2))
        missed = np.sqrt(np.mean((found.modelled - found.measured)[here] ** 2))
        if missed > FAR * size:
            said.append(
                f"{result.replace('_', ' ')}: the fitted motor still misses it by "
                f"{100 * missed / size:.0f} %; look at the column's unit, at absolute and gauge "
                "pressures, and at the displacement of the motor file."
            )
    return said


def _unbelievable(found: AbstractFit) -> list[str]:
    """Numbers that are no longer what their key is named after."""
    said = []
    for number, value in zip(found.numbers, found.values.tolist(), strict=True):
        if number.key not in USUAL_OF_ITS_KIND:
            continue
        low, high, instead = USUAL_OF_ITS_KIND[number.key]
        if not low <= value <= high:
            said.append(
                f"{number.key} of {number.written(value, 3)} is outside what such a thing has "
                f"({number.written(low, 3)} to {number.written(high, 3)}): {instead}."
            )
    return said


def _one_place(found: AbstractFit) -> list[str]:
    """Rows at one operating point tell how much is lost there, hardly which law loses it."""
    conditions = {"shaft_speed": "speed", _pressure(found): "pressure"}
    rows = np.unique(found.rows)
    for name in conditions:
        values = np.abs(found.table.conditions[name][rows])
        if np.max(values) > NEARLY_ONE * np.min(values):
            return []
    measured, numbers = set(found.table.values), [number.key for number in found.numbers]
    said = "These rows lie at nearly one speed and pressure: "
    if "efficiency" not in measured or (measured & _OF_FLOW and measured & _OF_TORQUE):
        said += "they tell how much is lost there, not which law loses it elsewhere"
    else:  # of the results only the whole efficiency holds both friction and leakage
        kinds = "efficiency"
        said += f"{kinds} alone does not tell friction from leakage there, and {_listed(numbers)} "
        said += ("stands" if len(numbers) == 1 else "stand") + " for both"
    return [f"{said}; the intervals are of chance only. Measure torque and flow {ELSEWHERE}."]


def _one_temperature(found: AbstractFit) -> list[str]:
    """Laws that follow the viscosity, from rows of a single one."""
    followed = [
        short(number.key)
        for number in found.numbers
        if number.key in WITH_VISCOSITY
        or (number.key == "motor.leakage_coefficient" and _is_viscous(found))
    ]
    temperatures = found.table.conditions.get(OIL_TEMPERATURE)
    if not followed or (temperatures is not None and np.ptp(temperatures) > ONE_TEMPERATURE):
        return []
    goes, they = ("goes", "it does") if len(followed) == 1 else ("go", "they do")
    return [
        f"These rows are of one oil temperature: {_listed(followed)} {goes} with the viscosity in "
        f"the model, and whether {they} in this motor the rows do not tell. Measure at two "
        "temperatures, 30 K apart, with a column oil temperature [degC]."
    ]


def _is_viscous(found: AbstractFit) -> bool:
    return hasattr(found.file.system.motor.leakage, "reference_viscosity")


def _untold(found: AbstractFit) -> list[str]:
    said = []
    for place, number in enumerate(found.numbers):
        if any(place in group for group in found.tangled):
            continue
        if found.determined(place):
            if found.squares.free[place] and found.low[place] == 0 == number.entry.low:
                said.append(
                    f"{number.key}: these rows tell only that it is below "
                    f"{number.written(found.high[place], 3)}; it may as well be zero."
                )
            continue
        said.append(
            f"{number.key}: these rows do not tell it, its interval is wider than ten times "
            f"itself; {_leave_out(found, place)}{BETTER_MEASURED.get(number.key, OTHERWISE)}."
        )
    return said


def _tangled(found: AbstractFit) -> list[str]:
    said = []
    for group in found.tangled:
        keys = [found.numbers[place].key for place in group]
        pairs = [abs(found.correlation[a, b]) for a in group for b in group if a != b]
        how, otherwise = "do not tell them apart at all", ""
        if max(pairs) < 1 - 1e-6:
            how = f"hardly tell them apart (correlation {max(pairs):.2f})"
            otherwise = f", or {telling(keys)}"
        said.append(
            f"{_listed(keys)}: these rows {how}; keep one as given, for example "
            f"--of {_others(found, _least_sure(found, group))}{otherwise}."
        )
    return said


def _at_limits(found: AbstractFit) -> list[str]:
    said = []
    for place in np.flatnonzero(~found.squares.free):
        number, value = found.numbers[place], float(found.values[place])
        low = abs(found.squares.point[place] - number.bounds[0]) < 1e-9
        if low and number.entry.low == 0:
            what, instead = "goes to nothing: these rows want none of it", "take it as it is"
        else:
            what = f"ends at its limit, {number.written(value)}"
            instead = "fit with it what else may take its place"
        said.append(f"{number.key} {what}; {_leave_out(found, int(place))}{instead}.")
    return said


def _least_sure(found: AbstractFit, group: Sequence[int]) -> int:
    """The one of a group whose interval is the widest beside itself."""
    wide = [(found.high[p] - found.low[p]) / abs(found.values[p] or 1.0) for p in group]
    return group[int(np.argmax(wide))]


def _systematic(found: AbstractFit) -> list[str]:
    """Results whose residuals are no chance."""
    table, said = found.table, []
    for result in table.values:
        here = found.of(result)
        residuals = ((found.modelled - found.measured) / found.deviation)[here]
        if np.all(np.abs(residuals * found.deviation[here]) < 1e-6 * np.abs(found.measured[here])):
            continue
        rows = found.rows[here]
        followed = {
            words: drift(residuals, table.conditions[name][rows])
            for name, words in (("shaft_speed", "speed"), (_pressure(found), "pressure"))
        }
        words, most = max(followed.items(), key=lambda each: each[1])
        law, name = missing_law(found, result), result.replace("_", " ")
        if most > MOST_CHANCE:
            said.append(
                f"{name}: what is left follows {words} and is no chance; a law of the motor is too "
                "simple for these rows, and the intervals are too narrow"
                f"{f'. {law}' if law else ''}."
            )
        elif law:
            said.append(f"{name}: what is left has the shape of a loss. {law}.")
    return said


def _pressure(found: AbstractFit) -> str:
    return "supply_pressure" if "supply_pressure" in found.table.conditions else "pressure_drop"


def _scatter(found: AbstractFit) -> list[str]:
    known = all(np.all(np.isfinite(found.table.deviations[r][found.rows[found.of(r)]]))
                for r in found.table.values)  # fmt: skip
    scatter = found.squares.confidence.scatter
    if not known or TOO_LITTLE < scatter < TOO_MUCH:
        return []
    if scatter >= TOO_MUCH:
        return [
            f"The model misses the rows by {scatter:.2g} times their standard deviations; the "
            "intervals are wider by as much."
        ]
    return [
        f"The model meets the rows to {scatter:.2g} of their standard deviations; these are too "
        "large, and so are the intervals."
    ]


def _twice(found: AbstractFit) -> list[str]:
    names = set(found.table.values)
    for result, parts in _MADE_OF.items():
        if result in names and parts <= names:
            shown = [each.replace("_", " ") for each in sorted(parts)]
            return [
                f"{result.replace('_', ' ')} is computed from {_listed(shown)}: the same "
                "measurement counts twice, and the intervals are too narrow; write one name in "
                "brackets to leave it out."
            ]
    return []


def _leave_out(found: AbstractFit, place: int) -> str:
    others = _others(found, place)
    return f"leave it out with --of {others}, or " if others else ""


def _others(found: AbstractFit, place: int) -> str:
    """What to name with --of instead: all but this one and those that end at a limit."""
    kept = [at for at in np.flatnonzero(found.squares.free) if at != place]
    return ",".join(short(found.numbers[at].key) for at in kept)


def _listed(words: Sequence[str]) -> str:
    return " and ".join((", ".join(words[:-1]), words[-1])) if len(words) > 1 else words[0]
