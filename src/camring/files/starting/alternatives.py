"""The motors that a catalogue's data allow, as a table for people."""

import numpy as np
from rich.console import Console
from rich.table import Table

from camring.files.starting.sizing import Demand, Sketches

MOST_ROWS = 8


def print_alternatives(found: Sketches, demand: Demand, out: Console, chosen: int = 0) -> None:
    """The best motor of each count, ranked; the chosen one is marked."""
    within = (
        f", at most {1e3 * demand.outer_diameter:.4g} mm of outer diameter"
        if np.isfinite(demand.outer_diameter)
        else ""
    )
    table = Table(
        title=f"{demand.displacement * 1e3:.4g} L/rev at {demand.pressure / 1e5:.4g} bar and "
        f"{demand.shaft_speed * 30 / np.pi:.4g} rpm{within}",
        title_justify="left",
        box=None,
        pad_edge=False,
    )
    for heading in (
        "",
        "Pistons\nx lobes",
        "Bore\nmm",
        "Stroke\nmm",
        "Outer\ndia. mm",
        "Reached\nL/rev",
        "Stress\nGPa",
        "Angle\ndeg",
        "Order",
        "Ripple\n%",
        "Effic.\n%",
    ):
        table.add_column(heading, justify="right")
    for place in range(min(len(found), MOST_ROWS)):
        table.add_row(*_row(found, place, place == chosen))
    out.print(table)
    if len(found) > MOST_ROWS:
        out.print(f"... and {len(found) - MOST_ROWS} more; --counts 10x8 asks for one of them.")
    out.print(
        "Outer diameter of the ring; then closed forms for a sine cam: greatest contact stress and "
        "pressure angle, first torque order of the shaft, geometric ripple (one-sided), "
        "efficiency at rated speed."
    )


def _row(found: Sketches, place: int, chosen: bool) -> tuple[str, ...]:
    sketch = found.sketch
    pistons, lobes = int(sketch.pistons[place]), int(sketch.lobes[place])
    return (
        ">" if chosen else "",
        f"{pistons} x {lobes}",
        f"{1e3 * sketch.bore[place]:.0f}",
        f"{1e3 * sketch.stroke[place]:.1f}",
        f"{2e3 * found.outer_radius[place]:.0f}",
        f"{1e3 * sketch.displacement[place]:.4g}",
        f"{found.contact_stress[place] / 1e9:.2f}",
        f"{np.degrees(found.pressure_angle[place]):.1f}",
        f"{np.lcm(pistons, lobes)}",
        f"{100 * found.torque_ripple[place]:.2f}",
        f"{100 * found.efficiency[place]:.1f}",
    )
