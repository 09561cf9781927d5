"""A motor file fitted to measured rows: its constants, how sure they are, what is not told.

Each row is simulated at its own operating point; the slopes of every result by every
fitted number are exact, so that a fit needs about ten passes over the rows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from camring.interfaces.bench import Bench
from camring.interfaces.config import MotorFile, read_motor_file
from camring.interfaces.errors import InputError
from camring.interfaces.fitted_numbers import FittedNumber, numbers_named
from camring.interfaces.measured_table import MeasuredTable, read_measured_table
from camring.search.confidence import told
from camring.search.least_squares import EXPECTED, SquaresFit, fit_squares

Say = Callable[[str], None]
SURE = 0.3  # standard error, of a number, up to which it is fitted without being named
WIDEST = 10.0  # of a number, an interval that still tells something


@dataclass(frozen=True, eq=False)
class Fit:
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

    def of(self, result: str) -> Bool[np.ndarray, " value"]:
        """Which values are of a result."""
        return np.array([each == result for each in self.results])

    @property
    def text(self) -> str:
        """A complete motor file with the fitted numbers."""
        from camring.interfaces.fitted_file import fitted_text

        return fitted_text(self)

    @property
    def warnings(self) -> list[str]:
        """What to know before these numbers are used, a sentence each."""
        from camring.interfaces.fitting_warnings import warnings_of

        return warnings_of(self)

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

    def told(self, place: int) -> bool:
        """Whether the rows tell a number at all: its interval is not wider than ten of it."""
        value, low, high = abs(self.values[place]), self.low[place], self.high[place]
        if not self.squares.free[place]:
            return True
        return bool(high <= WIDEST * low or high - low <= WIDEST * value)


def fit(
    motor: str | Path | MotorFile,
    measured: str | Path | MeasuredTable,
    of: Sequence[str] | None = None,
    *,
    say: Say = lambda sentence: None,
) -> Fit:
    """Fit constants of a motor file to measured rows by weighted least squares.

    Parameters
    ----------
    motor
        A motor file, or its path.
    measured
        A table as from `read_measured_table`, or its path.
    of
        Keys of the numbers to fit, as in `[design_space]`. Without them those of
        `fitted_numbers.USUAL` that the rows can tell.

    Raises
    ------
    InputError
        For a table or a key that cannot be used, or fewer values than numbers need.
    CamringError
        When a row cannot be simulated with the numbers given.
    """
    file = motor if isinstance(motor, MotorFile) else read_motor_file(motor)
    table = measured if isinstance(measured, MeasuredTable) else read_measured_table(measured)
    numbers = numbers_named(file, of)
    model = Bench(file, table, numbers)
    start = np.array([each.start for each in numbers])
    values, slopes = model(start)
    model.require_sound(values)
    chosen = np.ones(len(numbers), dtype=bool)
    if of is None:
        chosen = _chosen(model, slopes)
        if not np.any(chosen):
            raise InputError(
                model.name,
                f"tells none of {', '.join(each.key for each in numbers)}",
                "add rows at other speeds and pressures, or name one with --of",
            )
    kept = tuple(each for each, take in zip(numbers, chosen, strict=True) if take)
    if len(model.measured) <= len(kept):
        raise InputError(
            model.name,
            f"holds too few measured values, {len(model.measured)}, for {len(kept)} to fit",
            "add rows, or name fewer numbers with --of",
        )
    say(
        f"Fitting {len(kept)} {'number' if len(kept) == 1 else 'numbers'} to "
        f"{len(model.measured)} values of {len(table.lines)} rows."
    )
    bounds = np.array([each.bounds for each in kept])
    squares = fit_squares(
        lambda point: model.at(point, chosen),
        model.measured,
        start[chosen],
        bounds[:, 0],
        bounds[:, 1],
        group=model.group,
        deviation=model.given_deviation,
    )
    return _fit(model, kept, chosen, squares)


def _chosen(model: "Bench", slopes: np.ndarray) -> Bool[np.ndarray, " number"]:
    size = np.array(
        [np.sqrt(np.mean(model.measured[model.group == g] ** 2)) or 1.0 for g in model.group]
    )
    expected = np.where(np.isnan(model.given_deviation), EXPECTED * size, model.given_deviation)
    return told(slopes / expected[:, None], SURE)


def _fit(model: "Bench", kept: tuple, chosen: np.ndarray, squares: SquaresFit) -> Fit:
    width = np.full(len(kept), np.nan)
    width[squares.free] = squares.confidence.half_width
    each = list(zip(kept, squares.point.tolist(), width.tolist(), strict=True))
    ends = np.array([number.ends(point, half) for number, point, half in each])
    values = np.array([number.value(point) for number, point, _ in each])
    left = [each for each, take in zip(model.numbers, chosen, strict=True) if not take]
    return Fit(
        file=model.file,
        table=model.table,
        numbers=kept,
        values=values,
        low=ends[:, 0],
        high=ends[:, 1],
        left=tuple(left),
        rows=model.rows,
        results=model.results,
        measured=model.measured,
        modelled=squares.values,
        before=model.as_given(),
        deviation=squares.deviation,
        squares=squares,
    )
