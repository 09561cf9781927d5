"""A simulated motor as a table for people or one document for programs."""

import json
import platform
from importlib.metadata import version
from math import pi
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from camring.analyses.simulation import Simulated
from camring.files.errors import InputError
from camring.files.json_numbers import finite
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.files.quantities import GROUPS, QUANTITIES, significant
from camring.metrics.efficiency import MOTOR, PUMP, working_as
from camring.metrics.radial_load import ring_orders, shaft_orders
from camring.presentation.console import console
from camring.version import __version__

PARTS_SAID = 3  # of the radial force, by order
DOES_NOT_START = " At some angles it does not start by itself."


def print_table(found: Simulated) -> None:
    """Every result with its unit, one column for each operating point."""
    out = console()
    out.print(_results(found))
    for sentence in (
        *starts_in_words(found),
        *braking_in_words(found),
        *idle_lobes_in_words(found),
        *radial_loads_in_words(found),
        *left_out_in_words(found),
    ):
        out.print(sentence, markup=False)
    if found.numerical_error:
        worst, most = max(found.numerical_error), max(each.elements for each in found.climbed)
        wanted = found.climbed[0].accuracy
        out.print(
            f"Numerical error: at most {worst:.1g} of any result (estimated; {wanted:g} wanted, "
            f"{most} elements a lobe)."
        )
    print_fitted_cam(found.file, out)
    print_verdict(found, out)


def starts_in_words(found: Simulated) -> list[str]:
    """The least torque with which the shaft starts under pressure, both ways, by ISO 4392."""
    said = []
    for place, point in enumerate(found.file.system.operating_points):
        if float(point.pressure_drop) < 0:
            continue  # nothing starts where the load drives
        start = _start(found, place)
        said.append(
            f"Starting torque{_where(found, place)}: at least "
            f"{significant(start['starting_torque'])} N·m, "
            f"{significant(100 * start['starting_efficiency'], 3)} % of ideal; the other way "
            f"{significant(start['starting_torque_backwards'])} N·m, "
            f"{significant(100 * start['starting_efficiency_backwards'], 3)} %."
            + DOES_NOT_START
            * (min(start["starting_torque"], start["starting_torque_backwards"]) <= 0)
        )
    return said


def braking_in_words(found: Simulated) -> list[str]:
    """What the machine does where the load drives it: holds back, takes oil in, gives some."""
    said = []
    for place, point in enumerate(found.file.system.operating_points):
        results = found.outcome.results[place]
        if float(point.pressure_drop) > 0 or working_modes(found)[place] != PUMP:
            continue
        delivers = results["port_power"] < 0
        share = f"{100 * results['port_efficiency']:.3g} %" if delivers else "none"
        said.append(
            f"Braking{_where(found, place)}: it holds back {significant(-results['mean_torque'])} "
            f"N·m, takes in {significant(6e4 * results['supply_flow'])} L/min and delivers "
            f"{significant(6e4 * results['return_flow'])}; counted by what it delivers its "
            f"efficiency is {share}."
        )
    return said


def idle_lobes_in_words(found: Simulated) -> list[str]:
    """What they take from the shaft, at each operating point that has a mode."""
    return [
        f"Idle lobes{_where(found, place)}: they take {significant(drag)} N·m from the shaft."
        for place, drag in enumerate(found.idle_drags)
        if found.file.system.operating_points[place].idle_lobes
    ]


def radial_loads_in_words(found: Simulated) -> list[str]:
    """The side load of pistons that do not oppose each other, and how it turns."""
    said = []
    for place, cycle in enumerate(found.cycles):
        orders = shaft_orders(cycle.motor)
        if found.outcome.failure or not len(orders):
            continue
        load = found.radial_loads[place]
        largest = sorted(zip(load.by_order, orders, strict=True), reverse=True)[:PARTS_SAID]
        parts = ", ".join(
            f"{significant(1e-3 * float(part), 3)} at {order:+d}".replace("-", "−")
            for part, order in largest
        )
        said.append(
            f"Radial force on shaft and ring{_where(found, place)}: at most "
            f"{significant(1e-3 * float(load.largest), 3)} kN; its largest parts turn so often a "
            f"revolution, kN: {parts}."
        )
    return said


def left_out_in_words(found: Simulated) -> list[str]:
    """What a motor may have and this file does not, whose results would be zeros."""
    motor, missing = found.file.system.motor, []
    if motor.thermal is None:
        missing.append("case temperature ([thermal])")
    if motor.manifold is None and motor.return_manifold is None:
        missing.append("manifolds and their lines ([motor.manifold], [motor.return_manifold])")
    return [f"Not in this motor file, so not modelled: {', '.join(missing)}."] if missing else []


def _radial_load(found: Simulated, place: int) -> dict[str, Any]:
    """As numbers, orders as keys."""
    motor, load = found.cycles[place].motor, found.radial_loads[place]
    turning = zip(shaft_orders(motor), load.by_order, strict=True)
    outwards = zip(ring_orders(motor), load.outwards_by_order, strict=True)
    return {
        "largest": float(load.largest),
        "mean": float(load.mean),
        "by_order": {str(order): float(part) for order, part in turning},
        "outwards": float(load.outwards),
        "outwards_by_order": {str(order): float(part) for order, part in outwards},
    }


def _where(found: Simulated, place: int) -> str:
    return f" at operating point {place + 1}" if len(found.outcome.results) > 1 else ""


def _start(found: Simulated, place: int) -> dict[str, float]:
    """Of one operating point, its own direction first."""
    start, point = found.starts[place], found.file.system.operating_points[place]
    ways = {"": point.reverse, "_backwards": not point.reverse}
    return {
        f"{name}{way}": float(getattr(start, name)(reverse))
        for way, reverse in ways.items()
        for name in ("starting_torque", "starting_efficiency")
    }


def print_fitted_cam(file: MotorFile, out: Console) -> None:
    """How near the cam is to the profile that the file names."""
    if file.fitted_cam is not None:
        out.print(_plain(file.fitted_cam.sentence))


def working_modes(found: Simulated) -> list[str]:
    """What the machine works as at each operating point: motor, pump or brake."""
    return [
        str(working_as(each["input_power"], each["output_power"])) for each in found.outcome.results
    ]


def print_verdict(found: Simulated, out: Console) -> None:
    """Warnings, and whether the constraints hold."""
    for sentence in found.warnings():
        out.print(f"[yellow]Warning:[/yellow] {_plain(sentence)}")
    broken = found.broken
    if found.outcome.failure:
        out.print("[red]The simulation failed; its numbers mean nothing.[/red]")
    elif broken:
        out.print(f"[red]Broken:[/red] {', '.join(broken)}.")
    else:
        out.print(f"[green]All {len(found.outcome.constraints)} constraints hold.[/green]")


def title(found: Simulated) -> str:
    """The motor's name, else its file's."""
    return found.file.system.motor.name or printable(found.file.path)


def _results(found: Simulated) -> Table:
    table = Table(title=_plain(title(found)), title_justify="left", box=None, pad_edge=False)
    table.add_column("")
    table.add_column("")
    for point, mode in zip(found.file.system.operating_points, working_modes(found), strict=True):
        speed = float(point.shaft_speed) * 30 / pi
        pressure = f"{float(point.supply_pressure) / 1e5:.4g} bar"
        if float(point.pressure_drop) < 0:
            pressure += f"\nagainst {float(point.return_pressure) / 1e5:.4g} bar"
        way = (
            f"\n{point.mode}" * bool(point.mode)
            + "\nreverse" * point.reverse
            + f"\n{mode}" * (mode != MOTOR)
        )
        table.add_column(f"{speed:.4g} rpm\n{pressure}{way}", justify="right")
    for name, quantities in GROUPS:
        table.add_row(f"[bold]{name}[/bold]")
        for quantity in quantities:
            if quantity.rare and not any(each[quantity.name] for each in found.outcome.results):
                continue
            values = [quantity.written(each[quantity.name]) for each in found.outcome.results]
            table.add_row(f"  {quantity.label}", quantity.unit, *values)
    return table


def _plain(text: str) -> str:
    """Text in which brackets are brackets and no style of the terminal's."""
    from rich.markup import escape

    return escape(text)


def document(found: Simulated) -> str:
    """One JSON document, SI, under the names of docs/theory.md section 10."""
    file, outcome = found.file, found.outcome
    records: list[dict[str, Any]] = []
    for place, results in enumerate(outcome.results):
        record: dict[str, Any] = {**results, "operating_mode": working_modes(found)[place]}
        record |= _start(found, place)
        if found.idle_drags[place]:
            record["idle_drag"] = found.idle_drags[place]
        if not outcome.failure:
            record["radial_load"] = _radial_load(found, place)
        record["periodicity_residual"] = float(found.cycles[place].periodicity_residual)
        if found.errors:
            record["numerical_error"] = found.numerical_error[place]
            record["errors"] = found.errors[place]
            record["elements"] = found.climbed[place].elements
            record["accuracy_reached"] = found.climbed[place].reached
        records.append(record)
    return json.dumps(
        finite(
            {
                "input": printable(file.path),
                "name": file.system.motor.name,
                "versions": versions(),
                "results": records,
                "profile": None if file.fitted_cam is None else file.fitted_cam.document(),
                "objective": outcome.objective,
                "physical_objective": outcome.physical_objective,
                "constraints": outcome.constraints,
                "feasible": not outcome.failure and not found.broken,
                "numerical_error": max(found.numerical_error) if found.errors else None,
                "accuracy": found.climbed[0].accuracy if found.errors else None,
                "accuracy_reached": all(each.reached for each in found.climbed)
                if found.errors
                else None,
                "failure": outcome.failure,
                "warnings": found.warnings(),
            }
        ),
        indent=1,
        allow_nan=False,
    )


def versions() -> dict[str, str]:
    """What computed the numbers."""
    return {
        "camring": __version__,
        "python": platform.python_version(),
        "jax": version("jax"),
        "numpy": version("numpy"),
    }


def written(name: str, si: float) -> str:
    """A result with its unit, for people."""
    quantity = QUANTITIES.get(name)
    if quantity is None:
        return significant(si)
    return f"{quantity.written(si)} {quantity.unit}".rstrip()


def draw_start(found: Simulated, picture: Path, point: int) -> Path:
    """The starting torque over the angle, at one operating point.

    Raises
    ------
    InputError
        When there is no operating point of this number.
    """
    from camring.plots import save
    from camring.plots import starting as drawn

    count = len(found.starts)
    if not 1 <= point <= count:
        raise InputError("--point", f"is {point} of {count}", f"give a number from 1 to {count}")
    return save(drawn(found.starts[point - 1]), picture)
