"""The table `[evaluator]`: a user's own program or FMU that judges designs."""

from typing import Annotated as Key

from camring.interfaces.config.entries import Number, Numbers, Text
from camring.interfaces.config.table import Table
from camring.interfaces.errors import InputError

USUAL_TIMEOUT = 600.0


class EvaluatorTable(Table):
    """[evaluator]: which program or FMU to run for each design, and how long to wait."""

    command: Key[
        list[str] | None,
        Numbers(
            "the program and its arguments, each in quotes",
            '["python", "my_model.py"]',
            item=Text("a word of the command", '"my_model.py"'),
            most=50,
        ),
    ] = None
    fmu: Key[
        str | None,
        Text("in place of it: the file that maps the variables of an FMU", '"machine.toml"'),
    ] = None
    timeout: Key[
        float,
        Number("the time after which it is stopped", '"60 s"', unit="s", low=1e-3, high=1e7),
    ] = USUAL_TIMEOUT

    def require_one(self) -> None:
        """Raises `InputError` unless there is either a command or an FMU."""
        if (self.command is None) == (self.fmu is None):
            which = "neither" if self.command is None else "both"
            raise InputError(
                "[evaluator]", f"names {which} of command and fmu", "give the one that judges"
            )
