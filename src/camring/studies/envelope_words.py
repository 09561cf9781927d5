"""What a check of an envelope comes to, in sentences and as a document."""

from math import pi
from typing import Any

import numpy as np

from camring.objective.envelope import EFFICIENCY_LOSS, RIPPLE_RATIO
from camring.studies.envelope_check import EnvelopeCheck

RPM, BAR = 2 * pi / 60, 1e5
WORDS = {
    "min_contact_force": "rollers lift off",
    "min_pressure": "chambers cavitate",
    "max_pressure": "chamber pressure exceeds its limit",
    "max_contact_stress": "contact stress exceeds its limit",
    RIPPLE_RATIO: "torque ripple exceeds what is allowed over the given motor's",
    EFFICIENCY_LOSS: "efficiency falls further below the given motor's than allowed",
}


def range_in_words(check: EnvelopeCheck) -> str:
    """`70 to 350 bar, 30 to 300 rpm, at 10 bar charge, both ways`."""
    envelope = check.envelope
    low, high = (each / BAR for each in envelope.supply_pressure)
    slow, fast = (each / RPM for each in envelope.speed)
    back = sorted({f"{each / BAR:.4g}" for each in envelope.return_pressure}, key=float)
    words = [
        f"{low:.4g} to {high:.4g} bar",
        f"{slow:.4g} to {fast:.4g} rpm",
        f"at {' to '.join(back)} bar charge",
    ]
    if envelope.temperatures:
        cold, hot = (each - 273.15 for each in envelope.temperatures)
        words.append(f"oil of {cold:.4g} to {hot:.4g} degC")
    if envelope.both_directions:
        words.append("both ways")
    return ", ".join(words)


def runs_in_words(check: EnvelopeCheck, motor: int = -1) -> str:
    """Where one of the motors runs without lift-off or cavitation."""
    limits, metrics = check.limits[motor], check.motors[motor].metrics
    # A file need not limit both; then what they limit speaks for itself.
    contact = limits.get("min_contact_force", -np.asarray(metrics.min_contact_force))
    pressure = limits.get("min_pressure", -np.asarray(metrics.vapour_margin))
    sound = (contact <= 0) & (pressure <= 0) & (check.motors[motor].faults == 0)
    if sound.all():
        return f"runs without lift-off or cavitation from {range_in_words(check)}"
    pressures = check.grid.supply_pressure
    lowest = max(pressures[~sound])
    above = pressures[pressures > lowest]
    count = int(np.count_nonzero(~sound))
    broken = f"lifts its rollers or cavitates at {count} of {len(sound)} points from "
    if not len(above):
        return broken + range_in_words(check) + ", at full pressure too"
    return (
        f"{broken}{range_in_words(check)}: it runs at every speed from "
        f"{above.min() / BAR:.4g} bar only"
    )


def broken_in_words(check: EnvelopeCheck) -> list[str]:
    """For each limit that the better motor breaks where the given one keeps it, where."""
    if check.best is None:
        return []
    given, best = check.limits
    said = []
    for name, values in best.items():
        worse = (values > 0) & ~(given[name] > 0)
        if not worse.any():
            continue
        pressures, speeds = check.grid.supply_pressure[worse], check.grid.shaft_speed[worse]
        place = int(np.argmax(np.where(worse, values, -np.inf)))
        said.append(
            f"{WORDS.get(name, name.replace('_', ' ') + ' is broken')} from "
            f"{_span(pressures / BAR)} bar at {_span(speeds / RPM)} rpm, at "
            f"{int(worse.sum())} of {len(worse)} points where the given motor's do not "
            f"({name} by {values[place]:.3g} of its scale at {check.grid.text(place)})"
        )
    return said


def unasked_in_words(check: EnvelopeCheck) -> str:
    """What a user should know whose file has no envelope; empty where there is nothing."""
    found = broken_in_words(check)
    if not found:
        return ""
    return (
        "Outside its operating points the best design is worse than the given motor: "
        + "; ".join(found)
        + ". Nothing was asked there: add [envelope] with the speeds and supply pressures in "
        "which the motor must run, and its limits will hold in them."
    )


def document_of(check: EnvelopeCheck) -> dict[str, Any]:
    """Plain numbers in SI, for `validation.json` and the report's picture."""
    grid = check.grid
    designs = {}
    for name, motor in zip(("given", "best"), range(len(check.motors)), strict=False):
        metrics = check.motors[motor].metrics
        designs[name] = {
            "limits": {key: values.tolist() for key, values in check.limits[motor].items()},
            "torque_ripple": np.asarray(metrics.torque_ripple).tolist(),
            "efficiency": np.asarray(metrics.efficiency).tolist(),
            "broken": check.broken(motor).tolist(),
            "binding": check.binding(motor),
            "sentence": runs_in_words(check, motor),
        }
    return {
        "asked": check.asked,
        "range": range_in_words(check),
        "speed": grid.shaft_speed.tolist(),
        "supply_pressure": grid.supply_pressure.tolist(),
        "return_pressure": grid.return_pressure.tolist(),
        "backwards": grid.backwards.tolist(),
        "fluid": grid.fluid.tolist(),
        "designs": designs,
        "second_solver": [
            {"point": place, "limit": name, "g": g} for place, (name, g) in check.second.items()
        ],
        "warning": unasked_in_words(check) if not check.asked else "",
    }


def _span(values: np.ndarray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
