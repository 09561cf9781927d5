"""A displacement: the volume of one revolution, with or without saying so."""

from dataclasses import dataclass
from typing import Any

from camring.files.errors import quote
from camring.files.motor.entries import Number, Unfit
from camring.files.unit_spellings import of_one_turn


@dataclass(frozen=True)
class PerTurn(Number):
    """A number counted for each turn of the shaft: `"2.5 L/rev"` is 0.0025 m3, like `"2.5 L"`.

    The turn is one, not 2 pi radians: that is what data sheets mean.
    """

    def convert(self, value: Any) -> float:
        alone = of_one_turn(value) if isinstance(value, str) else value
        if alone == value:
            return super().convert(value)
        try:
            return super().convert(alone)
        except Unfit as error:
            problem = error.problem.replace(quote(alone), quote(value))
            raise Unfit(problem, error.way_out) from None
