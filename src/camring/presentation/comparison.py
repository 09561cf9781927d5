"""A comparison as a table for people, one document for programs, or a picture."""

import json
import re
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from camring.analyses.comparison import Comparison
from camring.files.errors import InputError
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.point_names import name_of
from camring.files.quantities import GROUPS, Quantity
from camring.metrics.efficiency import BRAKE
from camring.presentation.console import console
from camring.presentation.simulation import versions, working_modes

# A mark beside each colour; blue and orange differ for every eye.
BEST, WORST = "▲", "▽"
STYLES = {BEST: "bold bright_blue", WORST: "dark_orange"}
NEXT_TO_NOTHING = 1e-4  # relative; motors nearer than this are equally good


def print_comparison(found: Comparison) -> None:
    """Results side by side for each operating point, then the inputs that differ."""
    out = console()
    count = len(found.motors[0].simulated.outcome.results)
    for place in range(count):
        out.print(_results(found, place))
        out.print()
    out.print(f"[{STYLES[BEST]}]{BEST}[/] best   [{STYLES[WORST]}]{WORST}[/] worst")
    out.print(_differences(found))
    for sentence in found.notes:
        out.print(f"[yellow]Note:[/yellow] {escape(sentence)}")
    for each in found.motors:
        for sentence in each.simulated.warnings():
            out.print(f"[yellow]Warning:[/yellow] {escape(each.label)}: {escape(sentence)}")
        broken = each.simulated.broken
        if broken:
            out.print(
                f"[red]Broken[/red] by {escape(each.label)}, of its own limits: "
                f"{', '.join(broken)}."
            )


def _results(found: Comparison, place: int) -> Table:
    table = Table(
        box=None, pad_edge=False, title=escape(_title(found, place)), title_justify="left"
    )
    table.add_column("")
    table.add_column("")
    for each in found.motors:
        table.add_column(escape(each.label), justify="right", overflow="fold")
    results = [each.simulated.outcome.results[place] for each in found.motors]
    works_as = {working_modes(each.simulated)[place] for each in found.motors}
    alike = len(works_as) == 1 and BRAKE not in works_as
    for name, quantities in GROUPS:
        rows = []
        for quantity in quantities:
            values = [each[quantity.name] for each in results]
            if quantity.rare and not any(values):
                continue
            # A pump's efficiency is another ratio than a motor's, and a brake has none.
            compared = alike or not quantity.name.endswith("efficiency")
            cells = _marked(quantity, values) if compared else map(quantity.written, values)
            rows.append((f"  {quantity.label}", quantity.unit, *cells))
        table.add_row(f"[bold]{name}[/bold]")
        for row in rows:
            table.add_row(*row)
    return table


def _title(found: Comparison, place: int) -> str:
    points = [each.simulated.file.system.operating_points[place] for each in found.motors]
    titles = [name_of(point) for point in points]
    same = len(set(titles)) == 1
    return f"Operating point {place + 1}: {titles[0] if same else ' | '.join(titles)}"


def _marked(quantity: Quantity, values: list[float]) -> list[str]:
    written = [quantity.written(value) for value in values]
    marks = marked(quantity, values)
    return [
        f"[{STYLES[mark]}]{text} {mark}[/]" if mark else f"{text}  "
        for text, mark in zip(written, marks, strict=True)
    ]


def marked(quantity: Quantity, values: list[float]) -> list[str]:
    """`BEST`, `WORST` or nothing for each value; nothing at all where they hardly differ."""
    sound = [value for value in values if isfinite(value)]
    none = [""] * len(values)
    if quantity.better == 0 or len(sound) < len(values):
        return none
    low, high = min(sound), max(sound)
    span, size = high - low, max(abs(low), abs(high))
    if span <= NEXT_TO_NOTHING * size:
        return none
    best, worst = (high, low) if quantity.better > 0 else (low, high)
    near = NEXT_TO_NOTHING * span
    return [
        BEST if abs(value - best) <= near else WORST if abs(value - worst) <= near else ""
        for value in values
    ]


def _differences(found: Comparison) -> Table | str:
    if not found.differences:
        return "Their inputs do not differ."
    table = Table(box=None, pad_edge=False, title="Inputs that differ", title_justify="left")
    table.add_column("", overflow="fold")
    for each in found.motors:
        table.add_column(escape(each.label), justify="right", overflow="fold")
    for key, values in found.differences.items():
        shown = _rounded([each or "" for each in values])
        table.add_row(escape(key), *(escape(value) if value else "–" for value in shown))
    return table


def _rounded(values: Sequence[str]) -> list[str]:
    """Numbers with so many digits as people read, where they still differ by them."""
    short = [
        re.sub(r"-?\d+\.\d{6,}(?!\d|e)", lambda found: f"{float(found[0]):.6g}", each)
        for each in values
    ]
    return short if len(set(short)) == len(set(values)) else list(values)


def document(found: Comparison) -> str:
    """One JSON document, SI, results under the names of docs/theory.md section 10."""
    return json.dumps(
        finite(
            {
                "versions": versions(),
                "motors": [
                    {
                        "label": each.label,
                        "input": printable(each.simulated.file.path),
                        "name": each.simulated.file.system.motor.name,
                        "results": [
                            {**one, "operating_mode": mode}
                            for one, mode in zip(
                                each.simulated.outcome.results,
                                working_modes(each.simulated),
                                strict=True,
                            )
                        ],
                        "constraints": dict(each.simulated.outcome.constraints),
                        "feasible": not each.simulated.outcome.failure
                        and not each.simulated.broken,
                        "failure": each.simulated.outcome.failure,
                        "warnings": each.simulated.warnings(),
                    }
                    for each in found.motors
                ],
                "differences": found.differences,
                "notes": found.notes,
            }
        ),
        indent=1,
        allow_nan=False,
    )


def refuse(picture: Path) -> None:
    """Refuse a picture that could not be written, before anything is computed."""
    from camring.plots import require_matplotlib

    require_matplotlib()
    from camring.plots.style import require_picture

    require_picture(picture)


def draw(found: Comparison, picture: Path, point: int) -> Path:
    """The motors' waveforms over each other, at one operating point.

    Raises
    ------
    InputError
        When there is no operating point of this number.
    """
    from camring.plots import save, waveforms

    count = len(found.motors[0].simulated.cycles)
    if not 1 <= point <= count:
        raise InputError("--point", f"is {point} of {count}", f"give a number from 1 to {count}")
    cycles = [each.simulated.cycles[point - 1] for each in found.motors]
    return save(waveforms(*cycles, labels=[each.label for each in found.motors]), picture)
