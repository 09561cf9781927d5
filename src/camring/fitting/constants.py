"""Constants of a motor fitted to measured rows, and how sure they are."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from camring.files.motor import MotorFile
from camring.fitting.fitted_numbers import FittedNumber
from camring.fitting.measurements.displacement import ImpliedDisplacement
from camring.fitting.measurements.table import MeasuredTable
from camring.search.least_squares import SquaresFit

WIDEST = 10.0  # of a number, an interval that still tells something


@dataclass(frozen=True, eq=False)
class AbstractFit:
    """Constants of a motor fitted to a table.

    Attributes
    ----------
    numbers
        Those fitted, in the order of all that follows.
    values, low, high
        SI; the 95 % interval, which is from zero or to infinity where the rows tell nothing
        and NaN where the number stands at a limit of its key.
    left
        Numbers kept as given because the rows do not tell them, when none were named.
    rows, results
        Of each measured value: its row in the table, its result.
    measured, modelled, before, deviation
        Of each measured value: the table's, that of the fit, that of the file as given,
        the standard deviation; SI.
    squares
        The fit in its own coordinates.
    displacement
        What the rows imply, beside the motor file's.
    """

    file: MotorFile
    table: MeasuredTable
    numbers: tuple[FittedNumber, ...]
    values: Float[np.ndarray, " number"]
    low: Float[np.ndarray, " number"]
    high: Float[np.ndarray, " number"]
    left: tuple[FittedNumber, ...]
    rows: Int[np.ndarray, " value"]
    results: tuple[str, ...]
    measured: Float[np.ndarray, " value"]
    modelled: Float[np.ndarray, " value"]
    before: Float[np.ndarray, " value"]
    deviation: Float[np.ndarray, " value"]
    squares: SquaresFit
    displacement: ImpliedDisplacement

    def of(self, result: str) -> Bool[np.ndarray, " value"]:
        """Which values are of a result."""
        return np.array([each == result for each in self.results])

    @property
    def correlation(self) -> Float[np.ndarray, "number number"]:
        """Of the errors of the fitted numbers; NaN beside one that stands at a limit."""
        found = np.full((len(self.numbers),) * 2, np.nan)
        free = np.flatnonzero(self.squares.free)
        found[np.ix_(free, free)] = self.squares.confidence.correlation
        return found

    @property
    def tangled(self) -> tuple[tuple[int, ...], ...]:
        """Places of numbers that the rows do not tell apart, a group each."""
        free = np.flatnonzero(self.squares.free)
        return tuple(tuple(int(free[p]) for p in g) for g in self.squares.confidence.tangled)

    def determined(self, place: int) -> bool:
        """Whether the rows tell a number at all: its interval is not wider than ten of it."""
        value, low, high = abs(self.values[place]), self.low[place], self.high[place]
        if not self.squares.free[place]:
            return True
        return bool(high <= WIDEST * low or high - low <= WIDEST * value)
