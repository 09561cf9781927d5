"""What an engineer asks of a motor before simulating it: counts, orders, timing, limits."""

import json
from math import gcd, isfinite, lcm
from types import SimpleNamespace
from typing import cast

import numpy as np
from rich.markup import escape
from rich.table import Table

from camring.analyses.envelope_facts import EnvelopeFacts, envelope_document, print_envelope
from camring.analyses.modes import Mode, cam_repeats, modes, splits_in_words
from camring.analyses.simulation import Simulated, timing_of
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.ring_body import body_in_words, outer_diameter_of
from camring.files.shapes.profile_like import control_range
from camring.files.unit_spellings import ATMOSPHERE_SAID, says_gauge
from camring.files.units import from_si
from camring.numerics.quantity import ArrayLike
from camring.physics.motor import Motor
from camring.presentation.console import console
from camring.presentation.limits import MARGIN_BASES, constraints_of
from camring.presentation.records import Constraint, Design
from camring.presentation.simulation import (
    print_fitted_cam,
    print_verdict,
    title,
    versions,
    written,
)


def print_facts(found: Simulated, envelope: EnvelopeFacts | None) -> None:
    """Facts, port timing, limits with margins, the envelope, warnings."""
    out = console()
    facts = Table(title=escape(title(found)), title_justify="left", box=None, show_header=False)
    for name, value in {**_hardware(found), **_operating_points(found), **_timing(found)}.items():
        facts.add_row(name, escape(value))
    out.print(facts)
    out.print()
    out.print(_limits(found))
    out.print(MARGIN_BASES, markup=False)
    if envelope is not None:
        out.print()
        print_envelope(envelope, out)
    for mode in modes(found.file):
        out.print(mode.sentence, markup=False)
    print_fitted_cam(found.file, out)
    print_verdict(found, out)


def _periods(motor: Motor) -> tuple[int, int, int]:
    """How often a revolution the cam repeats, what pistons share with that, the torque's order."""
    repeats = cam_repeats(motor.cam, motor.lobes)
    return repeats, gcd(motor.pistons, repeats), lcm(motor.pistons, repeats)


def _hardware(found: Simulated) -> dict[str, str]:
    motor, results = found.file.system.motor, found.outcome.results[0]
    repeats, shared, order = _periods(motor)
    radial = "cancels" if shared > 1 else "does not cancel"
    space = found.file.design_space
    return {
        "Pistons, lobes": f"{motor.pistons} on {motor.lobes}, in {motor.pistons // shared} phases",
        "Common divisor": f"{shared}: the radial load on the shaft {radial}",
        "Torque orders": f"{order}, {2 * order}, {3 * order}, ... of the shaft",
        "Idle without a side load": splits_in_words(motor.pistons, motor.lobes, repeats),
        "Displacement": written("displacement", _of_all_lobes(found, "displacement")),
        "Stroke": written("stroke", results["stroke"]),
        "Ideal torque": written("ideal_torque", _of_all_lobes(found, "ideal_torque")),
        "Smallest chamber": written("min_volume", results["min_volume"]),
        "Cam": _cam(found),
        "Ring": body_in_words(found.file, found.greatest_radius),
        "Design space": "none" if space is None else f"{space.dimension} coordinates",
    }


def _of_all_lobes(found: Simulated, result: str) -> float:
    """A result that goes with the displacement, though the first operating point have a mode."""
    mode = found.file.system.operating_points[0].mode
    share = next((each.share for each in modes(found.file) if each.name == mode), 1.0)
    return float(found.outcome.results[0][result]) / share


def _operating_points(found: Simulated) -> dict[str, str]:
    """What the motor is asked for, in the units in which a wrong one shows."""
    points = found.file.system.operating_points
    several = len(points) > 1
    said = {"  Atmosphere": ATMOSPHERE_SAID} if says_gauge(found.file.document) else {}
    return {
        f"Operating point{f' {place}' if several else ''}": (
            f"{from_si(float(point.shaft_speed), 'rpm'):.5g} rpm, "
            f"{float(point.supply_pressure) / 1e5:.5g} to {float(point.return_pressure) / 1e5:.5g} "
            f"bar, case {float(point.case_pressure) / 1e5:.5g} bar"
            + (f", mode {point.mode}" if point.mode else "")
            + (", in reverse" if point.reverse else "")
        )
        for place, point in enumerate(points, start=1)
    } | said


def _cam(found: Simulated) -> str:
    cam = found.file.system.motor.cam
    period = "a lobe" if cam.repeats > 1 else "the ring"
    kind = "radial" if type(cam).__name__.startswith("Radial") else "planar"
    said = f"{kind} spline of degree {cam.degree}, {cam.control_count} control values {period}"
    ranges = control_range(cam)
    return said if ranges is None else f"{said}, which range over {1e3 * ranges[0]:.5g} mm"


def _timing(found: Simulated) -> dict[str, str]:
    timing = timing_of(found.file)

    def after(angle: ArrayLike) -> str:
        turned = float(np.degrees(angle))
        return f"{abs(turned):.2f} deg {'after' if turned >= 0 else 'before'}"

    def gap(angle: ArrayLike, needed: ArrayLike, what: str) -> str:
        shut, wanted = float(np.degrees(angle)), float(np.degrees(needed))
        if shut < 0:
            return f"both open over {-shut:.2f} deg"
        enough = f"{wanted:.2f} deg of motion" if isfinite(wanted) else "more than the stroke"
        return f"both shut over {shut:.2f} deg; full {what} takes {enough}"

    return {
        "Inner dead centre": (
            f"return closes {after(timing.return_closes)}, "
            f"supply opens {after(timing.supply_opens)}"
        ),
        "  Pre-compression": gap(timing.inner_gap, timing.compression_needed, "pre-compression"),
        "Outer dead centre": (
            f"supply closes {after(timing.supply_closes)}, "
            f"return opens {after(timing.return_opens)}"
        ),
        "  Pre-expansion": gap(timing.outer_gap, timing.expansion_needed, "pre-expansion"),
    }


def _limits(found: Simulated) -> Table:
    table = Table("Constraint", "Limit", "Value", "Margin", box=None, title_justify="left")
    for limit in _rows(found):
        holds = limit.margins[0] >= 0
        colour = "green" if holds else "red"
        margin = f"[{colour}]{100 * limit.margins[0]:+.3g} %[/{colour}]"
        table.add_row(limit.name, limit.limit, limit.values[0], margin)
    return table


def _rows(found: Simulated) -> tuple[Constraint, ...]:
    """The limits ask a design for nothing but its results; waves and profile are not needed."""
    numbers = SimpleNamespace(
        results=[SimpleNamespace(metrics=each) for each in found.outcome.results]
    )
    return constraints_of([found], [cast(Design, numbers)])


def document(found: Simulated, envelope: EnvelopeFacts | None) -> str:
    """One JSON document, SI."""
    holds = envelope is None or envelope.holds
    file, motor = found.file, found.file.system.motor
    _, shared, order = _periods(motor)
    timing = timing_of(file)
    return json.dumps(
        finite(
            {
                "input": printable(file.path),
                "name": motor.name,
                "versions": versions(),
                "pistons": motor.pistons,
                "lobes": motor.lobes,
                "common_divisor": shared,
                "distinct_phases": motor.pistons // shared,
                "surviving_order": order,
                "displacement": _of_all_lobes(found, "displacement"),
                "stroke": found.outcome.results[0]["stroke"],
                "modes": [_mode(each) for each in modes(file)],
                "outer_diameter": outer_diameter_of(file, found.greatest_radius),
                "profile": None if file.fitted_cam is None else file.fitted_cam.document(),
                "timing": {name: float(value) for name, value in vars(timing).items()},
                "design_space": [] if file.design_space is None else list(file.design_space.names),
                "constraints": found.outcome.constraints,
                "envelope": None if envelope is None else envelope_document(envelope),
                "feasible": not found.outcome.failure and not found.broken and holds,
                "failure": found.outcome.failure,
                "warnings": found.warnings(),
            }
        ),
        indent=1,
        allow_nan=False,
    )


def _mode(mode: Mode) -> dict[str, object]:
    return {
        "name": mode.name,
        "idle_lobes": list(mode.idle),
        "share": mode.share,
        "pattern_repeats": mode.repeats,
        "surviving_order": mode.order,
        "balanced": mode.balanced,
    }
