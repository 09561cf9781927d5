"""Waveforms and results as CSV for people and as MAT for lookup tables."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camring.exchange.waveforms.units import EVERYDAY, RESULT, everyday_result
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.quantities import QUANTITIES

if TYPE_CHECKING:
    import xarray

__all__ = ["explanation", "result_rows", "waveform_columns", "write_csv", "write_matlab",
           "write_results_csv"]  # fmt: skip

_PLAIN = str.maketrans({"·": " ", "²": "2", "³": "3"})
_CONDITIONS = ("shaft_speed", "supply_pressure", "return_pressure", "case_pressure", "weight")


def explanation(dataset: "xarray.Dataset") -> list[str]:
    """Whose waveforms these are, who wrote them, and which way the angle runs."""
    comment = str(dataset.attrs["comment"])
    return [
        " ".join(str(dataset.attrs["title"]).split()),
        str(dataset.attrs["history"]),
        comment[:1].upper() + comment[1:] + ".",
    ]


def waveform_columns(dataset: "xarray.Dataset") -> list[tuple[str, str, np.ndarray]]:
    """Name, everyday unit and values (point, angle) of each waveform of the dataset."""
    return [
        # Adding zero turns -0 into 0.
        (name, EVERYDAY[name].unit, EVERYDAY[name].factor * dataset[name].to_numpy() + 0.0)
        for name in map(str, dataset.data_vars)
        if not name.startswith(RESULT)
    ]


def result_rows(dataset: "xarray.Dataset") -> Iterator[tuple[str, str, str, np.ndarray]]:
    """Name, words, unit and values of conditions and results, one for each operating point."""
    for name in _CONDITIONS:
        everyday = EVERYDAY[name]
        values = everyday.factor * dataset[name].to_numpy()
        yield name, dataset[name].attrs["long_name"], everyday.unit, values
    for key, variable in dataset.data_vars.items():
        name = str(key).removeprefix(RESULT)
        if name == key:
            continue
        quantity, values = QUANTITIES.get(name), variable.to_numpy()
        if quantity is None:
            unit, factor = everyday_result(name, variable.attrs["units"])
            yield name, variable.attrs["long_name"], unit, factor * values
        else:
            # Plain letters: a spreadsheet may take the file for one of another encoding.
            unit = (quantity.unit or "1").translate(_PLAIN)
            yield name, quantity.label, unit, quantity.factor * values


def write_csv(dataset: "xarray.Dataset", place: Path, decimal: Decimal = Decimal.POINT) -> None:
    """One row for each operating point and angle."""
    columns = waveform_columns(dataset)
    angle = EVERYDAY["angle"].factor * dataset["angle"].to_numpy()
    text = csv_table(
        [
            "operating_point",
            named("angle", EVERYDAY["angle"].unit),
            *(named(name, unit) for name, unit, _ in columns),
        ],
        (
            [int(number), *(f"{v:.9g}" for v in row)]
            for point, number in enumerate(dataset["operating_point"].to_numpy())
            for row in np.stack([angle, *(each[point] for _, _, each in columns)], axis=1)
        ),
        remarks=explanation(dataset),
        decimal=decimal,
    )
    place.write_text(text, encoding="utf-8", newline="")


def write_results_csv(
    dataset: "xarray.Dataset", place: Path, decimal: Decimal = Decimal.POINT
) -> None:
    """One row for each operating point, its conditions first."""
    rows = list(result_rows(dataset))
    text = csv_table(
        ["operating_point", *(named(name, unit) for name, _, unit, _ in rows)],
        (
            [int(number), *(float(f"{values[point]:.9g}") for *_, values in rows)]
            for point, number in enumerate(dataset["operating_point"].to_numpy())
        ),
        remarks=explanation(dataset)[:2],
        decimal=decimal,
    )
    place.write_text(text, encoding="utf-8", newline="")


def write_matlab(dataset: "xarray.Dataset", place: Path) -> None:
    """A MAT file (version 5) in SI, for lookup tables.

    `angle` is a column, each waveform a matrix of angle by operating point, the
    condition a row; `results.NAME` is a row too; `units.NAME` and `about` are text.
    """
    from scipy.io import savemat

    variables: dict[str, Any] = {"angle": dataset["angle"].to_numpy()[:, None]}
    units: dict[str, Any] = {"angle": "rad"}
    results: dict[str, Any] = {}
    result_units: dict[str, Any] = {}
    for key, variable in dataset.data_vars.items():
        name = str(key)
        if name.startswith(RESULT):
            results[name.removeprefix(RESULT)] = variable.to_numpy()[None, :]
            result_units[name.removeprefix(RESULT)] = variable.attrs["units"]
        else:
            variables[name] = variable.to_numpy().T
            units[name] = variable.attrs["units"]
    for name in _CONDITIONS:
        variables[name] = dataset[name].to_numpy()[None, :]
        units[name] = dataset[name].attrs["units"]
    if results:
        variables["results"] = results
        units["results"] = result_units
    about = " ".join(explanation(dataset))
    with open(place, "wb") as file:
        savemat(
            file, {**variables, "units": units, "about": about}, long_field_names=True,
            do_compression=True,
        )  # fmt: skip
