"""The motor that is exported: a file's own, or the best of a study."""

from pathlib import Path

from camring.files.errors import InputError
from camring.files.motor import MotorFile, read_motor_file
from camring.files.motor.document import printable
from camring.studies.database import DATABASE_NAME
from camring.studies.study_folder import BEST_NAME, GIVEN_NAME

__all__ = ["motor_of"]


def motor_of(path: Path) -> MotorFile:
    """The motor file at a path, or the best motor of the study in a folder.

    Raises
    ------
    InputError
        When neither is there.
    """
    if not path.is_dir():
        return read_motor_file(path)
    if (path / BEST_NAME).is_file():
        return read_motor_file(path / BEST_NAME)
    shown = printable(path)
    if (path / DATABASE_NAME).is_file():
        raise InputError(
            shown,
            f"is a study without {BEST_NAME}: it was stopped, or found nothing better",
            f"go on with `camring resume {shown}`, or export {printable(path / GIVEN_NAME)}",
        )
    raise InputError(shown, "is a folder without a study", "name a motor file, or a study's folder")
