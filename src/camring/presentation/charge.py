"""The charge pressure over speed as a file, a picture, a table and a document."""

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from camring.analyses.charge import ChargeCurve
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.errors import InputError
from camring.files.motor.document import printable
from camring.files.new_file import write_new_file
from camring.files.units import from_si

__all__ = ["ChargeFiles", "charge_document", "print_charge"]

SHOWN = 12  # rows on a terminal


class ChargeFiles:
    """`charge.csv` and its picture in a folder, refused before anything is computed.

    Raises
    ------
    InputError
        When one is there already and may not be replaced.
    """

    def __init__(self, folder: Path, picture_format: str, replace: bool, decimal: Decimal) -> None:
        from camring.plots import drawable

        self.table, self.replace, self.decimal = folder / "charge.csv", replace, decimal
        drawn = picture_format != "none" and drawable()
        self.picture = folder / f"charge.{picture_format}" if drawn else None
        for place in filter(None, (self.table, self.picture)):
            if place.exists() and not replace:
                raise InputError(
                    printable(place), "exists", "give another --out, or --force to replace it"
                )

    def write(self, found: ChargeCurve) -> list[Path]:
        """Both files, into a folder that is there."""
        rows = [
            (f"{rpm:.6g}", f"{bar:.6g}" if np.isfinite(bar) else "", cause)
            for rpm, bar, cause in _rows(found)
        ]
        names = [named("speed", "rpm"), named("min_charge_pressure", "bar"), "asked for by"]
        text = csv_table(names, rows, remarks=[found.note], decimal=self.decimal)
        written = [self.table]
        if self.picture is not None:
            from camring.plots import charge, save

            written.append(save(charge(found), self.picture))
        write_new_file(self.table, text, replace=self.replace)
        return written


def _rows(found: ChargeCurve) -> list[tuple[float, float, str]]:
    causes = np.where(found.by_contact, "rollers", "air release")
    return [
        (from_si(float(speed), "rpm"), float(pressure) / 1e5, str(cause))
        for speed, pressure, cause in zip(found.speed, found.pressure, causes, strict=True)
    ]


def print_charge(found: ChargeCurve, out: Console) -> None:
    """A short table, and what was held."""
    rows = _rows(found)
    chosen = np.unique(np.linspace(0, len(rows) - 1, min(SHOWN, len(rows))).round().astype(int))
    table = Table("Speed, rpm", "Charge pressure, bar", "Asked for by", box=None, pad_edge=False)
    for place in chosen.tolist():
        rpm, bar, cause = rows[place]
        known = np.isfinite(bar)
        table.add_row(f"{rpm:.4g}", f"{bar:.4g}" if known else "–", cause if known else "")
    out.print(table)
    out.print(found.note, markup=False)


def charge_document(found: ChargeCurve) -> dict[str, Any]:
    """For programs, SI."""
    return {
        "speed": found.speed.tolist(),
        "min_charge_pressure": found.pressure.tolist(),
        "by_contact": found.by_contact.tolist(),
        "pressure_difference": found.drop,
        "case_pressure": found.case_pressure,
    }
