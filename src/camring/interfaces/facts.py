"""What an engineer asks of a motor before simulating it: counts, orders, timing, limits."""

import json
from math import gcd, isfinite
from types import SimpleNamespace
from typing import cast

import numpy as np
from rich.table import Table

from camring.interfaces.config.document import printable
from camring.interfaces.json_numbers import finite
from camring.interfaces.report.data import Constraint, Design
from camring.interfaces.report.limits import MARGIN_BASES, constraints_of
from camring.interfaces.simulated import Simulated, timing_of
from camring.interfaces.simulation_output import (
    console,
    print_verdict,
    title,
    versions,
    written,
)
from camring.interfaces.units import from_si
from camring.numerics.quantity import ArrayLike


def print_facts(found: Simulated) -> None:
    """Facts, port timing, limits with margins, warnings."""
    out = console()
    facts = Table(title=title(found), title_justify="left", box=None, show_header=False)
    for name, value in {**_hardware(found), **_duties(found), **_timing(found)}.items():
        facts.add_row(name, value)
    out.print(facts)
    out.print()
    out.print(_limits(found))
    out.print(MARGIN_BASES, markup=False)
    print_verdict(found, out)


def _hardware(found: Simulated) -> dict[str, str]:
    motor, results = found.file.system.motor, found.outcome.results[0]
    shared = gcd(motor.pistons, motor.cam.repeats)
    order = motor.surviving_order
    radial = "cancels" if shared > 1 else "does not cancel"
    space = found.file.design_space
    return {
        "Pistons, lobes": f"{motor.pistons} on {motor.lobes}, in {motor.distinct_phases} phases",
        "Common divisor": f"{shared}: the radial load on the shaft {radial}",
        "Torque orders": f"{order}, {2 * order}, {3 * order}, ... of the shaft",
        "Displacement": written("displacement", results["displacement"]),
        "Stroke": written("stroke", results["stroke"]),
        "Ideal torque": written("ideal_torque", results["ideal_torque"]),
        "Smallest chamber": written("min_volume", results["min_volume"]),
        "Cam": _cam(found),
        "Design space": "none" if space is None else f"{space.dimension} coordinates",
    }


def _duties(found: Simulated) -> dict[str, str]:
    """What the motor is asked for, in the units in which a wrong one shows."""
    points = found.file.system.operating_points
    several = len(points) > 1
    return {
        f"Operating point{f' {place}' if several else ''}": (
            f"{from_si(float(point.shaft_speed), 'rpm'):.5g} rpm, "
            f"{float(point.supply_pressure) / 1e5:.5g} to {float(point.return_pressure) / 1e5:.5g} "
            f"bar, case {float(point.case_pressure) / 1e5:.5g} bar"
            + (", in reverse" if point.reverse else "")
        )
        for place, point in enumerate(points, start=1)
    }


def _cam(found: Simulated) -> str:
    cam = found.file.system.motor.cam
    period = "a lobe" if cam.repeats > 1 else "the ring"
    kind = "radial" if type(cam).__name__.startswith("Radial") else "planar"
    return f"{kind} spline of degree {cam.degree}, {cam.control_count} control values {period}"


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


def document(found: Simulated) -> str:
    """One JSON document, SI."""
    file, motor = found.file, found.file.system.motor
    timing = timing_of(file)
    return json.dumps(
        finite(
            {
                "input": printable(file.path),
                "name": motor.name,
                "versions": versions(),
                "pistons": motor.pistons,
                "lobes": motor.lobes,
                "common_divisor": gcd(motor.pistons, motor.cam.repeats),
                "distinct_phases": motor.distinct_phases,
                "surviving_order": motor.surviving_order,
                "displacement": found.outcome.results[0]["displacement"],
                "stroke": found.outcome.results[0]["stroke"],
                "timing": {name: float(value) for name, value in vars(timing).items()},
                "design_space": [] if file.design_space is None else list(file.design_space.names),
                "constraints": found.outcome.constraints,
                "feasible": not found.outcome.failure and not found.broken,
                "failure": found.outcome.failure,
                "warnings": found.warnings(),
            }
        ),
        indent=1,
        allow_nan=False,
    )
