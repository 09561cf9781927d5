"""The report of a study: one HTML file that needs nothing but a browser.

`gather` collects, `render` turns what was collected into the page, and
`write_report` does both for a study's folder. Collecting simulates and loads
JAX; rendering knows plain records only, so any source can be drawn.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camring.presentation.records import ReportData
    from camring.report.contents import gather, gather_comparison, gather_single
    from camring.report.page import render
    from camring.report.write import write_page, write_report

__all__ = [
    "ReportData",
    "gather",
    "gather_comparison",
    "gather_single",
    "render",
    "write_page",
    "write_report",
]

_HOMES = {
    "ReportData": "camring.presentation.records",
    "gather": "camring.report.contents",
    "gather_comparison": "camring.report.contents",
    "gather_single": "camring.report.contents",
    "render": "camring.report.page",
    "write_page": "camring.report.write",
    "write_report": "camring.report.write",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
