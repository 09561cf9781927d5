"""A motor file fitted to measured rows: its constants, how sure they are, what is not determined.

Each row is simulated at its own operating point; the slopes of every result by every
fitted number are exact, so that a fit needs about ten passes over the rows.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool

from camring.files.errors import InputError
from camring.files.motor import MotorFile, read_motor_file
from camring.fitting.constants import AbstractFit
from camring.fitting.doubts import doubts as doubts_about
from camring.fitting.fitted_file import fitted_text
from camring.fitting.fitted_numbers import numbers_named
from camring.fitting.measurements.displacement import (
    ImpliedDisplacement,
    implied_displacement,
)
from camring.fitting.measurements.table import MeasuredTable, read_measured_table
from camring.fitting.simulated_rows import Bench
from camring.fitting.warnings import warnings_of
from camring.search.confidence import determined
from camring.search.least_squares import EXPECTED, SquaresFit, fit_squares

Say = Callable[[str], None]
SURE = 0.3  # standard error, of a number, up to which it is fitted without being named
FEWEST_VALUES = 2  # one tells no number and how sure it is


@dataclass(frozen=True, eq=False)
class Fit(AbstractFit):
    """Constants of a motor fitted to a table, and what is to be said of them.

    Its attributes are those of `camring.fitting.constants.AbstractFit`.
    """

    @property
    def text(self) -> str:
        """A complete motor file with the fitted numbers."""
        return fitted_text(self)

    @property
    def warnings(self) -> list[str]:
        """What to know before these numbers are used, a sentence each."""
        return warnings_of(self)

    @property
    def doubts(self) -> list[str]:
        """Why this is no fit at all, a sentence each; none where it may be used."""
        return doubts_about(self)


def fit(
    motor: str | Path | MotorFile,
    measured: str | Path | MeasuredTable,
    of: Sequence[str] | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    force: bool = False,
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
    columns
        Headers of the table by what they are, as `read_measured_table` takes them.
    force
        Fit although the rows imply another displacement than the file's.

    Raises
    ------
    InputError
        For a table or a key that cannot be used, fewer values than numbers need, or rows
        of another displacement.
    CamringError
        When a row cannot be simulated with the numbers given.

    Examples
    --------
    >>> found = camring.fit("motor.toml", "measured.csv")  # doctest: +SKIP
    >>> dict(zip([each.key for each in found.numbers], found.values))  # doctest: +SKIP
    """
    file = motor if isinstance(motor, MotorFile) else read_motor_file(motor)
    table = (
        measured if isinstance(measured, MeasuredTable) else read_measured_table(measured, columns)
    )
    for sentence in table.notes:
        say(sentence)
    numbers = numbers_named(file, of)
    model = Bench(file, table, numbers)
    implied = implied_displacement(
        table, [each for each, _ in model.operating_points], file.system.motor
    )
    if implied.sentence:
        say(implied.sentence)
    if not implied.fits and not force:
        raise InputError(
            model.name,
            f"is of another motor than {file.path.name}: {implied.sentence.rstrip('.')}",
            "check the units of the columns and the motor file, or fit all the same with --force",
        )
    if len(model.measured) < FEWEST_VALUES:
        raise _too_few(model, 1)
    start = np.array([each.start for each in numbers])
    say(f"Simulating {len(table.lines)} rows, and what {len(numbers)} numbers change in them.")
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
        raise _too_few(model, len(kept))
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
    return _fit(model, kept, chosen, squares, implied)


def _too_few(model: "Bench", numbers: int) -> InputError:
    count = len(model.measured)
    return InputError(
        model.name,
        f"holds too few measured values, {count}, for {numbers} to fit",
        "add rows, or name fewer numbers with --of" if numbers > 1 else "add rows",
    )


def _chosen(model: "Bench", slopes: np.ndarray) -> Bool[np.ndarray, " number"]:
    size = np.array(
        [np.sqrt(np.mean(model.measured[model.group == g] ** 2)) or 1.0 for g in model.group]
    )
    expected = np.where(np.isnan(model.given_deviation), EXPECTED * size, model.given_deviation)
    return determined(slopes / expected[:, None], SURE)


def _fit(
    model: "Bench",
    kept: tuple,
    chosen: np.ndarray,
    squares: SquaresFit,
    implied: ImpliedDisplacement,
) -> Fit:
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
        displacement=implied,
    )
