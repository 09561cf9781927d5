"""A displacement: the volume of one revolution, with or without saying so."""

import re
from dataclasses import dataclass
from typing import Any

from camring.interfaces.config.entries import Number, Unfit
from camring.interfaces.errors import quote

_TURN = re.compile(r"\s*/\s*(rev|revolution|turn|r|U)\s*$")


@dataclass(frozen=True)
class PerTurn(Number):
    """A number counted for each turn of the shaft: `"2.5 L/rev"` is 0.0025 m3, like `"2.5 L"`.

    The turn is one, not 2 pi radians: that is what data sheets mean.
    """

    def convert(self, value: Any) -> float:
        if not isinstance(value, str) or not _TURN.search(value):
            return super().convert(value)
        alone = _TURN.sub("", value)
        try:
            return super().convert(alone)
        except Unfit as error:
            told = error.problem.replace(quote(alone), quote(value))
            raise Unfit(told, error.way_out) from None
