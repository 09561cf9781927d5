"""Why no motor can be had for a catalogue's data: the number, the limit and the way out."""

from math import ceil, floor, isfinite, pi

import numpy as np

from camring.files.errors import InputError
from camring.files.starting import sizing_rules as rules
from camring.files.starting.sizing import Demand, Sketches, candidates, displacements, shortfalls

# Asked in this order: what a user can change with least regret comes first.
_ASKED = ("outer_diameter", "contact_stress", "contact", "ports", "pressure_angle", "block")


def refusal(demand: Demand, counts: list[tuple[int, int]] | None) -> InputError:
    """The rule that stands in the way, as a sentence.

    One rule whose removal alone would leave a motor; else the one that the sketch
    which comes nearest to keeping all of them misses by most.
    """
    found = candidates(demand, counts)
    if not len(found):
        return _no_bore(demand, counts)
    missed = shortfalls(found, demand)
    stacked = np.stack([missed[name] for name in missed])
    for rule in _ASKED:
        others = np.max(np.stack([missed[name] for name in missed if name != rule]), axis=0)
        left = np.flatnonzero(others <= 1e-9)
        if len(left):
            nearest = left[np.argmin(missed[rule][left])]
            return _sentence(rule, found, int(nearest), demand)
    nearest = int(np.argmin(np.max(stacked, axis=0)))
    worst = list(missed)[int(np.argmax(stacked[:, nearest]))]
    return _sentence(worst, found, nearest, demand)


def _no_bore(demand: Demand, counts: list[tuple[int, int]] | None) -> InputError:
    low, high = (1e3 * each for each in displacements(counts))
    return InputError(
        "--displacement",
        f"is {demand.displacement * 1e3:.4g} L/rev, but bores of 12 to 130 mm and strokes of "
        f"{rules.STROKES[0]:g} to {rules.STROKES[1]:g} bores give {low:.2g} to {high:.2g} L/rev",
        "give one between them" if counts is None else "give one between them, or other --counts",
    )


def _sentence(rule: str, found: Sketches, place: int, demand: Demand) -> InputError:
    one = found.taken(np.array([place]))
    who = (
        f"a motor of {demand.displacement * 1e3:.4g} L/rev at {demand.pressure / 1e5:.4g} bar "
        f"and {demand.shaft_speed * 30 / pi:.4g} rpm"
    )
    if rule == "outer_diameter":
        needed = 2 * float(one.outer_radius[0])
        smaller = demand.displacement * (demand.outer_diameter / needed) ** 3
        return InputError(
            "--outer-diameter",
            f"is {1e3 * demand.outer_diameter:.4g} mm, but {who} needs {1e3 * needed:.0f} mm",
            f"give at least {ceil(1e3 * needed)} mm, or about {_down(1e3 * smaller)} L/rev",
        )
    if rule in ("contact_stress", "undercut_factor"):
        stress = float(one.contact_stress[0])
        kept = demand.pressure * (rules.STRESS_WANTED / stress) ** 2
        return InputError(
            "--pressure",
            f"is {demand.pressure / 1e5:.4g} bar, at which the rollers of {who} press on the ring "
            f"with {stress / 1e9:.3g} GPa, above the {rules.STRESS_WANTED / 1e9:g} GPa of a "
            "sketch",
            f"give at most {floor(kept / 1e5)} bar" + _or_larger(demand),
        )
    limit = rules.PORT_DROP_LIMIT * (demand.pressure - float(one.return_pressure[0]))
    if rule == "ports" and limit > 0:  # else rollers would ask for more return than supply
        drop = float(one.port_drop[0])
        return InputError(
            "--speed",
            f"is {demand.shaft_speed * 30 / pi:.4g} rpm, at which the ports of {who} would "
            f"throttle {drop / 1e5:.3g} bar away, above {limit / 1e5:.3g} bar",
            f"give at most {_down(demand.shaft_speed * 30 / pi * (limit / drop) ** 0.5)} rpm",
        )
    if rule in ("contact", "ports"):
        back, most = float(one.return_pressure[0]), rules.RETURN_PRESSURES[1]
        spare = most - rules.RETURN_SPARE - rules.CASE_PRESSURE
        asked = back - rules.RETURN_SPARE - rules.CASE_PRESSURE
        # At that return pressure the ports have their say as well.
        left = rules.PORT_DROP_LIMIT * (demand.pressure - most) / float(one.port_drop[0])
        slower = min(spare / asked, left) ** 0.5
        return InputError(
            "--speed",
            f"is {demand.shaft_speed * 30 / pi:.4g} rpm, at which the rollers of {who} would "
            f"leave the ring without {back / 1e5:.0f} bar of return pressure, above "
            f"{most / 1e5:.0f} bar",
            f"give at most {_down(demand.shaft_speed * 30 / pi * slower)} rpm",
        )
    if rule == "pressure_angle":
        return InputError(
            "--displacement",
            f"is {demand.displacement * 1e3:.4g} L/rev, for which the pressure angle would be "
            f"{np.degrees(float(one.pressure_angle[0])):.3g} deg, above "
            f"{np.degrees(rules.ANGLE_WANTED):.3g} deg",
            "give a smaller one" + _or_larger(demand),
        )
    return InputError(
        "--displacement",
        f"is {demand.displacement * 1e3:.4g} L/rev, for which the bores would leave "
        f"{1e3 * float(one.wall[0]):.2g} mm of block between them, less than "
        f"{1e3 * rules.LEAST_WALL * float(one.sketch.bore[0]):.2g} mm",
        "give a smaller one" + _or_larger(demand),
    )


def _or_larger(demand: Demand) -> str:
    return ", or a larger --outer-diameter" if isfinite(demand.outer_diameter) else ""


def _down(value: float) -> str:
    """Two digits, rounded down, so that the way out is one."""
    scale = 10.0 ** (floor(np.log10(value)) - 1)
    return f"{floor(value / scale) * scale:.6g}"
