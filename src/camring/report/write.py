"""A report on disk: the old one or the new one, never half of either."""

from pathlib import Path
from typing import TYPE_CHECKING

from camring.files.errors import InputError
from camring.files.whole_file import write_safely
from camring.presentation.records import ReportData
from camring.report.page import render

if TYPE_CHECKING:
    from camring.report.study_motors import StudyMotors

__all__ = ["write_page", "write_report"]

_BEGINNING = b"<!DOCTYPE html>"


def write_report(folder: str | Path, at_hand: "StudyMotors | None" = None) -> Path:
    """Gather a study and write its `report.html`; the path of the file.

    Parameters
    ----------
    at_hand
        The study's motors where they have been simulated.

    Raises
    ------
    InputError
        When the folder holds no study, or cannot be written.
    """
    from camring.report.contents import gather
    from camring.studies.study_folder import REPORT_NAME

    return write_page(Path(folder) / REPORT_NAME, gather(folder, at_hand))


def write_page(path: Path, data: ReportData) -> Path:
    """Write a report to a file of any name, replacing at most an older page.

    Raises
    ------
    InputError
        When something that is no HTML page stands there, or the place cannot be written.
    """
    from camring.studies.study_folder import unwritable

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
