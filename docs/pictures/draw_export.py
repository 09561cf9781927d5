"""Draws docs/pictures/export_sheet.svg: the sheet of the wheel motor.

Run from the root of a checkout: `python docs/pictures/draw_export.py`.
"""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

from camring.exchange.drawings import export
from camring.files.motor import read_motor_file

HERE = Path(__file__).parent
MOTOR = HERE.parent.parent / "examples" / "wheel_motor.toml"


def sheet() -> str:
    """The sheet as the command writes it, of no particular day."""
    with TemporaryDirectory() as folder:
        export(read_motor_file(MOTOR), folder, only=["sheet"])
        text = (Path(folder) / "sheet.svg").read_text(encoding="utf-8")
    text = text.replace(str(MOTOR), f"examples/{MOTOR.name}")
    # The day it was drawn is no news to a reader of the guide.
    return re.sub(r"\b\d{4}-\d\d-\d\d\b", "2026-01-01", text)


if __name__ == "__main__":
    (HERE / "export_sheet.svg").write_text(sheet(), encoding="utf-8")
