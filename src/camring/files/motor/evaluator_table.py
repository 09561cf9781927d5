"""The table `[evaluator]`: a user's own program or FMU that evaluates designs."""

from dataclasses import dataclass
from typing import Annotated as Key
from typing import Any

from camring.files.errors import InputError, quote
from camring.files.motor.entries import Entry, Number, Numbers, Text, Unfit
from camring.files.motor.table import Table
from camring.files.named_units import read_units

USUAL_TIMEOUT = 600.0


@dataclass(frozen=True)
class UnitsOfResults(Entry):
    """A table of results and units."""

    def read(self, value: Any) -> dict[str, str]:
        if not isinstance(value, dict):
            raise Unfit(f"is {quote(value)} but must be a table in braces", self.way_out)
        try:
            return dict(read_units(value, ""))
        except InputError as error:
            raise Unfit(error.problem, error.way_out, error.field) from None


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
    units: Key[
        dict[str, str] | None,
        UnitsOfResults("a unit for each result that is not in SI", '{ max_pressure = "bar" }'),
    ] = None

    def require_one(self) -> None:
        """Raises `InputError` unless there is either a command or an FMU."""
        if (self.command is None) == (self.fmu is None):
            which = "neither" if self.command is None else "both"
            raise InputError(
                "[evaluator]", f"names {which} of command and fmu", "give the one that evaluates"
            )
