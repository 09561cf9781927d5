"""A map or a sweep as files and words: CSV, pictures, a table, one document."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.markup import escape
from rich.table import Table

from camring.analyses.grid import Grid
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.errors import InputError, quote
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.motor.keys import nearest
from camring.files.new_file import write_new_file
from camring.files.result_names import quantity, result_names
from camring.files.visible import say
from camring.files.whole_file import make_folder
from camring.presentation.console import console
from camring.presentation.simulation import versions

LONGEST_TABLE = 60  # rows on a terminal
MOST_RESULTS = 12  # pictures of a map, panels of a sweep


def chosen_results(text: str | None, default: Sequence[str]) -> tuple[str, ...]:
    """Result names from `efficiency,torque_ripple`.

    Raises
    ------
    InputError
        For a name that is none, with its nearest neighbour; for too many.
    """
    if text is None:
        return tuple(default)
    names = [name for name in text.replace(",", " ").split() if name]
    known = list(result_names())
    for name in names:
        if name not in known:
            close = nearest(name, known)
            raise InputError(
                f"--results {quote(name)}",
                "is no result",
                f"you probably meant {close}" if close else "give some of " + ", ".join(known),
            )
    if not 1 <= len(set(names)) <= MOST_RESULTS:
        raise InputError(
            "--results", f"names {len(set(names))} results", f"name 1 to {MOST_RESULTS}"
        )
    return tuple(dict.fromkeys(names))


class Folder:
    """Where the files of one map or sweep go, refused before anything is computed.

    Parameters
    ----------
    path
        The folder, made if it is not there.
    csv_name
        Name of its table.
    pictures
        Names of its pictures, without ending; none without a format.
    picture_format
        `png`, `svg`, `pdf` or `none`; without matplotlib it is `none`, which is said.
    replace
        Whether files of these names may be replaced.
    decimal
        What parts decimals in the table.

    Raises
    ------
    InputError
        When a file of these names is there already, or the place is no folder.
    """

    def __init__(
        self,
        path: Path,
        csv_name: str,
        pictures: Sequence[str],
        picture_format: str,
        replace: bool,
        decimal: Decimal = Decimal.POINT,
    ) -> None:
        self.path, self.replace, self.decimal = path, replace, decimal
        self.table = path / csv_name
        self.other_table = self.table.with_stem(f"{self.table.stem}_beside")
        drawn = pictures if picture_format != "none" and _drawable() else ()
        self.pictures = {name: path / f"{name}.{picture_format}" for name in drawn}
        if path.exists() and not path.is_dir():
            raise InputError(printable(path), "is no folder", "give --out another name")
        if not replace:
            for place in (self.table, self.other_table, *self.pictures.values()):
                if place.exists():
                    raise InputError(
                        printable(place), "exists", "give another --out, or --force to replace it"
                    )

    def write(self, grid: Grid, names: Sequence[str], beside: Grid | None = None) -> list[Path]:
        """The table, and one picture for each name (all in one where one number varies).

        Parameters
        ----------
        beside
            Another motor over the same numbers, which each picture shows first and on the same
            scale; its table ends in `_beside.csv`.
        """
        try:
            make_folder(self.path)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(
                printable(self.path), f"cannot be made ({reason})", "choose another place"
            ) from None
        # The table comes last: where it stands, whatever was asked for stands beside it.
        if self.replace:
            for earlier in (self.table, self.other_table, *self.pictures.values()):
                earlier.unlink(missing_ok=True)
        written = self._draw(grid, names, beside)
        tables = {} if beside is None else {self.other_table: beside}
        for place, content in {**tables, self.table: grid}.items():
            write_new_file(place, csv_text(content, self.decimal), replace=self.replace)
        return [self.table, *tables, *written]

    def _draw(self, grid: Grid, names: Sequence[str], beside: Grid | None) -> list[Path]:
        if not self.pictures:
            return []
        from camring.plots import quadrant_map, result_map, result_maps, save, sweep_curves

        over_two = quadrant_map if grid.quadrants else result_map
        all_of = [grid] if beside is None else [beside, grid]
        written = []
        for name, place in self.pictures.items():
            if len(grid.axes) == 1:
                written.append(save(sweep_curves(grid, names), place))
            elif not any(np.any(np.isfinite(each.results[name])) for each in all_of):
                say(f"No picture of {name}: it has no value at any point.", err=True)
            elif beside is not None:
                written.append(save(result_maps(all_of, name), place))
            else:
                written.append(save(over_two(grid, name), place))
        return written


def _drawable() -> bool:
    from camring.plots import drawable

    return drawable()


def csv_text(grid: Grid, decimal: Decimal = Decimal.POINT) -> str:
    """A row for each point with every result, NaN where there is none, and why in the last."""
    names = result_names()
    columns = [grid.shown(name) for name in names]
    return csv_table(
        [
            *(named(axis.key, axis.unit) for axis in grid.axes),
            *(named(name, quantity(name).unit) for name in names),
            "fault",
        ],
        (
            [
                *(float(axis.shown[k]) for axis, k in zip(grid.axes, place, strict=True)),
                *(float(column[place]) for column in columns),
                grid.why(place),
            ]
            for place in np.ndindex(grid.faults.shape)
        ),
        decimal=decimal,
    )


def document(
    grid: Grid,
    source: Path,
    point: int,
    charge: dict[str, Any] | None = None,
    beside: tuple[Path, Grid] | None = None,
) -> str:
    """One JSON document: axes in their units, results in SI as nested lists, null for none."""
    return json.dumps(
        finite(
            {
                "input": printable(source),
                "versions": versions(),
                "operating_point": point,
                "axes": [
                    {"key": axis.key, "unit": axis.unit, "values": axis.shown.tolist()}
                    for axis in grid.axes
                ],
                **_content(grid),
                "envelope": _envelope(grid),
                **({} if charge is None else {"charge": charge}),
                **({} if beside is None else {"beside": _beside(*beside)}),
            }
        ),
        allow_nan=False,
    )


def _content(grid: Grid) -> dict[str, Any]:
    return {
        "results": {name: values.tolist() for name, values in grid.results.items()},
        "operating_mode": grid.mode.tolist(),
        "faults": grid.faults.tolist(),
        "limits": grid.limits,
        "warnings": grid.warnings(),
    }


def _beside(source: Path, grid: Grid) -> dict[str, Any]:
    return {"input": printable(source), **_content(grid)}


def _envelope(grid: Grid) -> list[dict[str, object]] | None:
    """Where the motor must run, axis by axis as `axes`; None where the file does not say."""
    if grid.envelope is None:
        return None
    return [
        {"key": axis.key, "unit": axis.unit, "range": list(ends)}
        for axis, ends in zip(grid.axes, grid.envelope, strict=True)
    ]


def print_grid(grid: Grid, names: Sequence[str], headed: bool = False) -> None:
    """The values over one number, the range and the best place of each result, warnings."""
    out = console()
    if headed:
        out.print(f"[bold]{escape(grid.title.partition(chr(10))[0])}[/bold]")
    if len(grid.axes) == 1 and len(grid.axes[0].shown) <= LONGEST_TABLE:
        out.print(_values(grid, names))
    out.print(_ranges(grid, names))
    for sentence in grid.warnings():
        out.print(f"[yellow]Note:[/yellow] {escape(sentence)}")


def _values(grid: Grid, names: Sequence[str]) -> Table:
    table = Table(title=escape(grid.title), title_justify="left", box=None, pad_edge=False)
    axis = grid.axes[0]
    table.add_column(escape(axis.label), justify="right")
    for name in names:
        shown = quantity(name)
        table.add_column(f"{shown.label}\n{shown.unit}", justify="right")
    table.add_column("", no_wrap=True)
    marks = [
        ("lifts off", grid.results["min_contact_force"] < 0),
        ("cavitates", grid.results["vapour_margin"] < 0),
        ("no result", ~grid.sound),
    ]
    for place in range(len(axis.shown)):
        values = [quantity(name).written(float(grid.results[name][place])) for name in names]
        said = ", ".join(words for words, where in marks if where[place])
        table.add_row(f"{axis.shown[place]:.6g}", *values, f"[yellow]{said}[/yellow]")
    return table


def _ranges(grid: Grid, names: Sequence[str]) -> Table:
    """Lowest and highest of each result, and where; the good end in bold."""
    table = Table(box=None, pad_edge=False)
    for head in ("", "", "lowest", "at", "highest", "at"):
        table.add_column(head, justify="left" if head in ("", "at") else "right")
    for name in names:
        shown, values = quantity(name), grid.results[name]
        if not np.any(np.isfinite(values)):
            table.add_row(shown.label, shown.unit, "–", "", "–", "")
            continue
        cells = []
        for find, good in ((np.nanargmin, -1), (np.nanargmax, 1)):
            place = np.unravel_index(int(find(values)), values.shape)
            at = ", ".join(axis.text(int(k)) for axis, k in zip(grid.axes, place, strict=True))
            mark = " ▲" if shown.better == good else ""
            cells += [f"{shown.written(float(values[place]))}{mark}", at]
        table.add_row(shown.label, shown.unit, *cells)
    table.caption = "▲ the better end"
    table.caption_justify = "left"
    return table
