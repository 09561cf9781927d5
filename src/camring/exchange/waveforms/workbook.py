"""Waveforms and results as a workbook: a summary, charts that Excel draws, the numbers."""

from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camring.exchange.waveforms.tables import explanation, result_rows, waveform_columns
from camring.exchange.waveforms.units import EVERYDAY
from camring.files.errors import InputError

if TYPE_CHECKING:
    import xarray

__all__ = ["write_workbook"]

_HEAD_ROWS = 2  # names and units
_A4 = 9
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")  # Okabe and Ito
_CHARTS = (
    ("Shaft torque", ("torque",)),
    ("Chamber pressure", ("chamber_pressure",)),
    ("Flow into the chamber", ("supply_flow", "return_flow")),
    ("Piston lift", ("lift",)),
    ("Contact force", ("contact_force",)),
    ("Contact stress", ("contact_stress",)),
)


def write_workbook(dataset: "xarray.Dataset", place: Path) -> None:
    """An XLSX file with the sheets Summary, Charts and one of numbers for each point.

    Raises
    ------
    InputError
        When the extra is missing.
    """
    try:
        import xlsxwriter
    except ImportError as error:
        raise InputError(
            "--waveforms",
            "ends in .xlsx, which needs XlsxWriter, and that is not installed",
            'install it with `pip install "camring[excel]"`, or write .csv',
        ) from error
    # Text is text: a name that begins with "=" must not compute, nor an address be a link.
    # Parts in memory: a full disk would leave those on disk behind.
    plain = {"strings_to_formulas": False, "strings_to_urls": False, "in_memory": True}
    book = xlsxwriter.Workbook(str(place), {"nan_inf_to_errors": True, **plain})
    book.set_properties(
        {"title": explanation(dataset)[0], "comments": " ".join(explanation(dataset)[1:])}
    )
    bold = book.add_format({"bold": True})
    _summary(book.add_worksheet("Summary"), dataset, bold)
    charts = book.add_worksheet("Charts")
    points = [int(number) for number in dataset["operating_point"].to_numpy()]
    for place_of, number in enumerate(points):
        _numbers(book.add_worksheet(f"Point {number}"), dataset, place_of, bold)
    charts.set_paper(_A4)
    charts.set_landscape()
    charts.fit_to_pages(1, 1)
    _draw(book, charts, dataset, points)
    book.close()


def _summary(sheet: Any, dataset: "xarray.Dataset", bold: Any) -> None:
    for row, line in enumerate(explanation(dataset)):
        sheet.write_string(row, 0, line, bold if row == 0 else None)
    first = len(explanation(dataset)) + 1
    points = dataset["operating_point"].to_numpy()
    sheet.write_row(first, 0, ["", "Unit", *(f"Point {number}" for number in points)], bold)
    for row, (_, words, unit, values) in enumerate(result_rows(dataset), first + 1):
        sheet.write_row(row, 0, [words[:1].upper() + words[1:], unit, *map(float, values)])
    sheet.set_column(0, 0, 36)
    sheet.set_column(1, 1 + len(points), 12)
    sheet.freeze_panes(first + 1, 2)
    sheet.set_paper(_A4)
    sheet.fit_to_pages(1, 0)


def _numbers(sheet: Any, dataset: "xarray.Dataset", point: int, bold: Any) -> None:
    columns = _columns(dataset, point)
    for column, (name, unit, values) in enumerate(columns):
        sheet.write_string(0, column, name, bold)
        sheet.write_string(1, column, unit)
        sheet.write_column(_HEAD_ROWS, column, values.tolist())
    sheet.set_column(0, len(columns) - 1, 16)
    sheet.freeze_panes(_HEAD_ROWS, 1)


def _columns(dataset: "xarray.Dataset", point: int) -> list[tuple[str, str, np.ndarray]]:
    angle = EVERYDAY["angle"].factor * dataset["angle"].to_numpy()
    waves = [(name, unit, values[point]) for name, unit, values in waveform_columns(dataset)]
    return [("angle", EVERYDAY["angle"].unit, angle), *waves]


def _draw(book: Any, sheet: Any, dataset: "xarray.Dataset", points: list[int]) -> None:
    """Charts of the whole revolution, all operating points in each."""
    names = [name for name, *_ in _columns(dataset, 0)]
    last = _HEAD_ROWS + dataset.sizes["angle"] - 1
    for place, (title, shown) in enumerate(_CHARTS):
        chart = book.add_chart({"type": "scatter", "subtype": "straight"})
        for drawn, (number, name) in enumerate(product(points, shown)):
            column, tab = names.index(name), f"Point {number}"
            series_name = f"{tab}, {name.replace('_', ' ')}" if len(shown) > 1 else tab
            chart.add_series(
                {
                    "name": series_name,
                    "categories": [tab, _HEAD_ROWS, 0, last, 0],
                    "values": [tab, _HEAD_ROWS, column, last, column],
                    "line": {"width": 1.25, "color": _COLOURS[drawn % len(_COLOURS)]},
                }
            )
        chart.set_title({"name": title, "name_font": {"size": 12}})
        chart.set_x_axis({"name": "Shaft angle, deg", "min": 0, "max": 360, "major_unit": 30,
                          "label_position": "low"})  # fmt: skip
        chart.set_y_axis({"name": f"{title}, {EVERYDAY[shown[0]].unit}"})
        chart.set_legend({"position": "bottom"})
        chart.set_size({"width": 620, "height": 340})
        sheet.insert_chart(18 * (place // 2), 10 * (place % 2), chart)
