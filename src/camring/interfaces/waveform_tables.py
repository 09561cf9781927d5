"""Waveforms and results as CSV for people and as MAT for lookup tables."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camring.interfaces.report.quantities import QUANTITIES
from camring.interfaces.waveform_file import RESULT
from camring.interfaces.waveform_units import EVERYDAY, everyday_result

if TYPE_CHECKING:
    import xarray

__all__ = ["explanation", "result_rows", "waveform_columns", "write_csv", "write_matlab",
           "write_results_csv"]  # fmt: skip

_PLAIN = str.maketrans({"·": " ", "²": "2", "³": "3"})
_DUTY = ("shaft_speed", "supply_pressure", "return_pressure", "case_pressure", "weight")


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
    """Name, words, unit and values of the duty and each result, one for each operating point."""
    for name in _DUTY:
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


def write_csv(dataset: "xarray.Dataset", place: Path) -> None:
    """One row for each operating point and angle; names, then units, above them."""
    columns = waveform_columns(dataset)
    angle = EVERYDAY["angle"].factor * dataset["angle"].to_numpy()
    with open(place, "w", encoding="utf-8", newline="") as file:
        _comment(file, explanation(dataset))
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["operating_point", "angle", *(name for name, _, _ in columns)])
        table.writerow(["1", EVERYDAY["angle"].unit, *(unit for _, unit, _ in columns)])
        for point, number in enumerate(dataset["operating_point"].to_numpy()):
            values = np.stack([angle, *(each[point] for _, _, each in columns)], axis=1)
            table.writerows([number, *(f"{v:.9g}" for v in row)] for row in values)


def write_results_csv(dataset: "xarray.Dataset", place: Path) -> None:
    """One row for each operating point, duty first; names, then units, above them."""
    rows = list(result_rows(dataset))
    with open(place, "w", encoding="utf-8", newline="") as file:
        _comment(file, explanation(dataset)[:2])
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["operating_point", *(name for name, *_ in rows)])
        table.writerow(["1", *(unit for _, _, unit, _ in rows)])
        for point, number in enumerate(dataset["operating_point"].to_numpy()):
            table.writerow([number, *(f"{values[point]:.9g}" for *_, values in rows)])


def write_matlab(dataset: "xarray.Dataset", place: Path) -> None:
    """A MAT file (version 5) in SI, for lookup tables.

    `angle` is a column, each waveform a matrix of angle by operating point, the
    duty a row; `results.NAME` is a row too; `units.NAME` and `about` are text.
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
    for name in _DUTY:
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


def _comment(file: Any, lines: list[str]) -> None:
    for line in lines:
        file.write(f"# {line}\n")
