"""A fit as tables for people, one document for programs, and the files it writes."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.table import Table

from camring.files.errors import InputError, quote
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.new_file import require_new, write_new_file
from camring.files.quantities import significant
from camring.files.visible import say
from camring.fitting.doubts import shown, standardised
from camring.fitting.fit import Fit
from camring.presentation.console import console
from camring.presentation.simulation import versions

CORRELATIONS_FROM = 2
TINY = 1e-4


def columns_named(texts: Sequence[str]) -> dict[str, str]:
    """Headers by what they are, from texts such as `torque=M [Nm]`.

    Raises
    ------
    InputError
        For a text without `=`, or a name given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, sign, header = (part.strip() for part in text.partition("="))
        if not (name and sign and header) or name in found:
            raise InputError(
                f"--column {quote(text)}",
                "names a column twice" if name in found else "is not of the form NAME=HEADER",
                'write, for example, --column torque="M [Nm]"',
            )
        found[name] = header
    return found


def require_places(out: Path, picture: Path | None, *, force: bool) -> None:
    """Refuse what could not be written, before work begins."""
    require_new(out, replace=force)
    if picture is not None:
        from camring.plots import require_matplotlib

        require_matplotlib()

        from camring.plots.style import require_picture

        require_picture(picture)
        require_new(picture, replace=force)


def write(found: Fit, out: Path, picture: Path | None, *, force: bool) -> list[Path]:
    """The fitted motor file and the picture; what was written."""
    write_new_file(out, found.text, replace=force)
    if picture is None:
        return [out]
    from camring.plots import fitted, save

    return [out, save(fitted(found), picture)]


def show(found: Fit) -> None:
    """Numbers with their intervals, correlations, residuals, warnings."""
    out = console()
    out.print(_numbers(found))
    if len(found.numbers) >= CORRELATIONS_FROM:
        out.print()
        out.print(_correlations(found))
    out.print()
    out.print(_residuals(found))
    if found.left:
        keys = ", ".join(each.key for each in found.left)
        out.print(
            f"Kept as given, as these rows do not tell them beside the others: {keys}. "
            "--of fits what you name.",
            markup=False,
        )
    if found.table.left_out:
        out.print(f"{found.table.left_out} rows without a result were left out.", markup=False)
    for sentence in found.warnings:
        out.print(f"[yellow]Warning:[/yellow] {escape(sentence)}")


def _numbers(found: Fit) -> Table:
    table = Table(title="Fitted numbers", title_justify="left", box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    for name in ("given", "fitted", "95 % from", "to"):
        table.add_column(name, justify="right")
    table.add_column("")
    for place, number in enumerate(found.numbers):
        low, high = (number.shown(each[place]) for each in (found.low, found.high))
        ends = [_plain(low), _plain(high)]
        if not found.squares.free[place]:
            ends = ["at a limit", ""]
        elif not found.determined(place):
            ends = [_rough(low), _rough(high)]
        value, given = _plain(number.shown(found.values[place])), _plain(number.shown(number.given))
        table.add_row(number.key, given, value, *ends, number.unit)
    return table


def _plain(value: float, digits: int = 4) -> str:
    """Leakage coefficients are far below what `significant` takes for zero."""
    if 0 < abs(value) < TINY:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    return significant(value, digits)


def _rough(value: float) -> str:
    return _plain(value, 2) if np.isfinite(value) else "∞"


def _correlations(found: Fit) -> Table:
    table = Table(
        title="Correlation of their errors", title_justify="left", box=None, pad_edge=False
    )
    table.add_column("", no_wrap=True)
    for place in range(len(found.numbers)):
        table.add_column(f"({place + 1})", justify="right")
    for place, number in enumerate(found.numbers):
        row = found.correlation[place, : place + 1]
        cells = ["–" if np.isnan(each) else f"{each:+.2f}".replace("-", "−") for each in row]
        table.add_row(f"({place + 1}) {number.key}", *cells)
    return table


def _residuals(found: Fit) -> Table:
    table = Table(
        title="Modelled minus measured, rms", title_justify="left", box=None, pad_edge=False
    )
    table.add_column("")
    for name in ("values", "as given", "fitted", "", "of size, %"):
        table.add_column(name, justify="left" if name == "" else "right")
    for name in found.table.values:
        each, determined = shown(name), residuals_of(found, name)
        table.add_row(
            each.label,
            str(determined["values"]),
            significant(each.value(determined["rms_as_given"]), 3),
            significant(each.value(determined["rms"]), 3),
            each.unit,
            significant(100 * determined["relative"], 2),
        )
    return table


def residuals_of(found: Fit, result: str) -> dict:
    """Of one result: how many values, rms as given and fitted in SI, fitted over its size."""
    here = found.of(result)
    measured = found.measured[here]

    def rms(values: np.ndarray) -> float:
        return float(np.sqrt(np.mean(values**2)))

    fitted = rms(found.modelled[here] - measured)
    size = rms(measured)
    return {
        "values": int(np.sum(here)),
        "rms_as_given": rms(found.before[here] - measured),
        "rms": fitted,
        "relative": fitted / size if size else float("nan"),
    }


def document(found: Fit, written: list[Path]) -> str:
    """One JSON document, SI; intervals that are open have no number."""
    squares = found.squares
    return json.dumps(
        finite(
            {
                "input": printable(found.file.path),
                "measured": printable(found.table.path),
                "versions": versions(),
                "implied_displacement": {
                    "by_flow": found.displacement.by_flow,
                    "by_torque": found.displacement.by_torque,
                    "given": found.displacement.given,
                },
                "numbers": {
                    number.key: {
                        "given": number.given,
                        "fitted": float(found.values[place]),
                        "low": float(found.low[place]),
                        "high": float(found.high[place]),
                        "determined": found.determined(place),
                        "at_limit": not bool(squares.free[place]),
                    }
                    for place, number in enumerate(found.numbers)
                },
                "kept_as_given": [each.key for each in found.left],
                "correlation": found.correlation.tolist(),
                "degrees_of_freedom": squares.confidence.degrees_of_freedom,
                "scatter": squares.confidence.scatter,
                "residuals": {name: residuals_of(found, name) for name in found.table.values},
                "values": [
                    {
                        "line": found.table.lines[row],
                        "result": result,
                        "measured": float(measured),
                        "modelled": float(modelled),
                        "standard_deviation": float(deviation),
                        "standardised_residual": float(scaled),
                    }
                    for row, result, measured, modelled, deviation, scaled in zip(
                        found.rows,
                        found.results,
                        found.measured,
                        found.modelled,
                        found.deviation,
                        standardised(found),
                        strict=True,
                    )
                ],
                "evaluations": squares.evaluations,
                "notes": list(found.table.notes),
                "warnings": found.warnings,
                "doubts": found.doubts,
                "written": [printable(each) for each in written],
            }
        ),
        indent=1,
        allow_nan=False,
    )


def say_written(written: list[Path], *, as_json: bool) -> None:
    """Which files there are now."""
    say(f"Wrote {' and '.join(str(each) for each in written)}.", err=as_json)
