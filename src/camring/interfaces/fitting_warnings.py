"""What to know before fitted numbers are used, in plain words and with a way out."""

from collections.abc import Sequence

import numpy as np

from camring.interfaces.fitted_numbers import short
from camring.interfaces.fitting import Fit
from camring.search.confidence import drift

MOST_CHANCE = 3.0  # standard deviations of pure chance
FAR = 0.2  # of a result's size: no constant of a law explains so much
TOO_MUCH, TOO_LITTLE = 2.0, 0.3  # scatter over what the standard deviations say
BETTER_MEASURED = {
    "motor.leakage_coefficient": "measure case drain",
    "motor.gap.clearance": "measure case drain",
    "motor.viscous_damping": "measure torque at higher speeds",
    "motor.roller.friction": "measure torque at other pressures",
    "motor.side_friction": "measure torque at other pressures",
    "motor.valve_plate.discharge_coefficient": "measure torque at higher speeds",
    "fluid.bulk_modulus": "measure ripple",
}
ELSEWHERE = "at other speeds and pressures"
OTHERWISE = f"measure {ELSEWHERE}"
NEARLY_ONE = 1.2  # highest over lowest
_OF_FLOW = {"supply_flow", "volumetric_efficiency", "case_drain", "input_power"}
_OF_TORQUE = {"mean_torque", "hydromechanical_efficiency", "output_power"}
_MADE_OF = {
    "hydromechanical_efficiency": {"mean_torque"},
    "volumetric_efficiency": {"supply_flow"},
    "efficiency": {"mean_torque", "supply_flow"},
    "output_power": {"mean_torque"},
    "input_power": {"supply_flow"},
}


def warnings_of(found: Fit) -> list[str]:
    """The sentences, the gravest first."""
    return [
        *_unsettled(found),
        *_far(found),
        *_one_place(found),
        *_untold(found),
        *_tangled(found),
        *_at_limits(found),
        *_systematic(found),
        *_scatter(found),
        *_twice(found),
    ]


def _unsettled(found: Fit) -> list[str]:
    if found.squares.settled:
        return []
    return ["The fit did not come to rest; its numbers and intervals are not to be trusted."]


def _far(found: Fit) -> list[str]:
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


def _one_place(found: Fit) -> list[str]:
    """Rows at one operating point tell how much is lost there, hardly which law loses it."""
    duties = {"shaft_speed": "speed", _pressure(found): "pressure"}
    rows = np.unique(found.rows)
    for name in duties:
        values = np.abs(found.table.duties[name][rows])
        if np.max(values) > NEARLY_ONE * np.min(values):
            return []
    measured, numbers = set(found.table.values), [number.key for number in found.numbers]
    said = "These rows lie at nearly one speed and pressure: "
    if measured & _OF_FLOW and measured & _OF_TORQUE:
        said += "they tell how much is lost there, not which law loses it elsewhere"
    else:
        kinds = _listed([name.replace("_", " ") for name in found.table.values])
        said += f"{kinds} alone does not tell friction from leakage there, and {_listed(numbers)} "
        said += ("stands" if len(numbers) == 1 else "stand") + " for both"
    return [f"{said}; the intervals are of chance only. Measure torque and flow {ELSEWHERE}."]


def _untold(found: Fit) -> list[str]:
    said = []
    for place, number in enumerate(found.numbers):
        if any(place in group for group in found.tangled):
            continue
        if found.told(place):
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


def _tangled(found: Fit) -> list[str]:
    said = []
    for group in found.tangled:
        keys = [found.numbers[place].key for place in group]
        pairs = [abs(found.correlation[a, b]) for a in group for b in group if a != b]
        how, otherwise = "do not tell them apart at all", ""
        if max(pairs) < 1 - 1e-6:
            how = f"hardly tell them apart (correlation {max(pairs):.2f})"
            otherwise = f", or {OTHERWISE}"
        said.append(
            f"{_listed(keys)}: these rows {how}; keep one as given, for example "
            f"--of {_others(found, _least_sure(found, group))}{otherwise}."
        )
    return said


def _at_limits(found: Fit) -> list[str]:
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


def _least_sure(found: Fit, group: Sequence[int]) -> int:
    """The one of a group whose interval is the widest beside itself."""
    wide = [(found.high[p] - found.low[p]) / abs(found.values[p] or 1.0) for p in group]
    return group[int(np.argmax(wide))]


def _systematic(found: Fit) -> list[str]:
    """Results whose residuals are no chance."""
    table, said = found.table, []
    for result in table.values:
        here = found.of(result)
        residuals = ((found.modelled - found.measured) / found.deviation)[here]
        if np.all(np.abs(residuals * found.deviation[here]) < 1e-6 * np.abs(found.measured[here])):
            continue
        rows = found.rows[here]
        for name, words in (("shaft_speed", "speed"), (_pressure(found), "pressure")):
            others = table.duties[_pressure(found) if name == "shaft_speed" else "shaft_speed"]
            order = np.lexsort((others[rows], table.duties[name][rows]))
            if drift(residuals[order]) > MOST_CHANCE:
                said.append(
                    f"{result.replace('_', ' ')}: what is left follows {words} and is no chance; "
                    "a law of the motor is too simple for these rows, and the intervals are too "
                    "narrow."
                )
                break
    return said


def _pressure(found: Fit) -> str:
    return "supply_pressure" if "supply_pressure" in found.table.duties else "pressure_drop"


def _scatter(found: Fit) -> list[str]:
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


def _twice(found: Fit) -> list[str]:
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


def _leave_out(found: Fit, place: int) -> str:
    others = _others(found, place)
    return f"leave it out with --of {others}, or " if others else ""


def _others(found: Fit, place: int) -> str:
    """What to name with --of instead: all but this one and those that end at a limit."""
    kept = [at for at in np.flatnonzero(found.squares.free) if at != place]
    return ",".join(short(found.numbers[at].key) for at in kept)


def _listed(words: Sequence[str]) -> str:
    return " and ".join((", ".join(words[:-1]), words[-1])) if len(words) > 1 else words[0]
