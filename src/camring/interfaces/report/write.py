"""A report on disk: the old one or the new one, never half of either."""

from pathlib import Path

from camring.interfaces.errors import InputError
from camring.interfaces.report.data import ReportData
from camring.interfaces.report.page import render

__all__ = ["write_page", "write_report"]

_BEGINNING = b"<!DOCTYPE html>"


def write_report(folder: str | Path) -> Path:
    """Gather a study and write its `report.html`; the path of the file.

    Raises
    ------
    InputError
        When the folder holds no study, or cannot be written.
    """
    from camring.interfaces.report.gathering import gather
    from camring.interfaces.study_folder import REPORT_NAME

    return write_page(Path(folder) / REPORT_NAME, gather(folder))


def write_page(path: Path, data: ReportData) -> Path:
    """Write a report to a file of any name, replacing at most an older page.

    Raises
    ------
    InputError
        When something that is no HTML page stands there, or the place cannot be written.
    """
    from camring.interfaces.study_folder import unwritable, write_safely

    if path.is_dir():
        raise InputError(str(path), "is a folder", "give the name of a file, such as report.html")
    try:
        if path.exists() and not path.read_bytes().startswith(_BEGINNING):
            raise InputError(
                str(path),
                "exists and is no report that camring wrote",
                "give a new name, or remove that file yourself",
            )
        write_safely(path, render(data).encode("utf-8"))
    except OSError as error:
        raise unwritable(path, error) from error
    return path
