"""Rows that stand alone against the fitted motor, and reasons not to use a fit at all."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from camring.files.errors import CamringError
from camring.files.quantities import Quantity, significant
from camring.files.result_names import quantity
from camring.fitting.constants import AbstractFit
from camring.objective.measurable import CASE_DRAIN

FEWEST = 5  # values of a result, before one of them can stand alone
STANDS_ALONE = 6.0  # standardised residuals
SEEN = 0.03  # of a value: a smaller miss is no slip of the pen
FAR = 0.2  # of a result's size: no constant of a law explains so much
IMPOSSIBLE = {"fluid.bulk_modulus": (2e8, 5e9)}  # SI; no oil has less or more, air and all
TO_NORMAL = 1.4826  # median deviation of a normal distribution to its standard deviation
LEAST_SCATTER = 1e-5  # of a result's size: exact rows have none
MOST_NAMED = 5


class Unfitted(CamringError):
    """A fit that does not fit, so that nothing was written."""

    exit_code = 3


class LoneRow(NamedTuple):
    """A value far from the fitted motor while the others of its result are near.

    Attributes
    ----------
    place
        Among the fit's values.
    standardised
        Modelled minus measured, less the median of its result, over the standard
        deviation that the others show.
    """

    place: int
    standardised: float


def shown(name: str) -> Quantity:
    """How a measured result is written."""
    if name == CASE_DRAIN:
        return Quantity(name, "Case drain", "L/min", 6e4)
    return quantity(name)


def standardised(found: AbstractFit) -> Float[np.ndarray, " value"]:
    """Residuals over the scatter of their result, by medians that a wrong row does not move."""
    left = (found.modelled - found.measured) / _size(found)
    scaled = np.full(len(left), np.nan)
    for result in found.table.values:
        here = found.of(result)
        middle = np.median(left[here])
        scatter = TO_NORMAL * np.median(np.abs(left[here] - middle))
        floor = LEAST_SCATTER * np.sqrt(np.mean((found.measured[here] / _size(found)[here]) ** 2))
        scaled[here] = (left[here] - middle) / max(scatter, floor)
    return scaled


def _size(found: AbstractFit) -> Float[np.ndarray, " value"]:
    """What residuals are compared in: given deviations, or those that the fit found."""
    given = np.array(
        [found.table.deviations[name][row]
         for row, name in zip(found.rows, found.results, strict=True)]
    )  # fmt: skip
    return np.where(np.isfinite(given), given, found.deviation)


def lone_rows(found: AbstractFit) -> list[LoneRow]:
    """The farthest first."""
    scaled = standardised(found)
    missed = np.abs(found.modelled - found.measured)
    far = (np.abs(scaled) > STANDS_ALONE) & (missed > SEEN * np.abs(found.measured))
    for result in found.table.values:
        here = found.of(result)
        if np.sum(here) < FEWEST:
            far &= ~here
    order = sorted(np.flatnonzero(far).tolist(), key=lambda place: -abs(scaled[place]))
    return [LoneRow(place, float(scaled[place])) for place in order]


def lone_sentences(found: AbstractFit) -> list[str]:
    """The rows by line, with how far they are."""
    rows = lone_rows(found)
    said = [_sentence(found, each) for each in rows[:MOST_NAMED]]
    if len(rows) > MOST_NAMED:
        said.append(f"{len(rows) - MOST_NAMED} more values stand alone like these.")
    return said


def _sentence(found: AbstractFit, row: LoneRow) -> str:
    name = found.results[row.place]
    how = shown(name)
    measured, modelled = (
        significant(how.value(float(each[row.place])), 4)
        for each in (found.measured, found.modelled)
    )
    return (
        f"Line {found.table.lines[found.rows[row.place]]}: {name.replace('_', ' ')} of {measured} "
        f"{how.unit} stands alone; the fitted motor has {modelled} {how.unit}, "
        f"{abs(row.standardised):.3g} standard deviations of the others away. Check the row, or "
        "take it out."
    ).replace("  ", " ")


def doubts(found: AbstractFit) -> list[str]:
    """Why this is no fit, a sentence each; none where it may be used."""
    said = []
    implied = found.displacement
    if not implied.fits:
        said.append(f"{implied.sentence} They are not of one motor, or a unit is wrong.")
    if not found.squares.settled:
        said.append("The fit did not come to rest.")
    for result in found.table.values:
        here = found.of(result)
        size = np.sqrt(np.mean(found.measured[here] ** 2))
        missed = np.sqrt(np.mean((found.modelled - found.measured)[here] ** 2))
        if missed > FAR * size:
            said.append(f"It misses {result.replace('_', ' ')} by {100 * missed / size:.0f} %.")
    lines = [
        found.table.lines[found.rows[each.place]]
        for each in lone_rows(found)
        if abs(found.modelled - found.measured)[each.place] > FAR * abs(found.measured[each.place])
    ]
    if lines:
        named = sorted(set(lines))[:MOST_NAMED]
        what = "Line {} stands" if len(named) == 1 else "Lines {} stand"
        said.append(f"{what.format(', '.join(map(str, named)))} alone.")
    for number, value in zip(found.numbers, found.values.tolist(), strict=True):
        low, high = IMPOSSIBLE.get(number.key, (-np.inf, np.inf))
        if not low <= value <= high:
            said.append(
                f"{number.key} of {number.written(value, 3)} is that of no oil "
                f"({number.written(low, 3)} to {number.written(high, 3)})."
            )
    return said


def require_fit(found: AbstractFit) -> None:
    """Raises where the fit is none, with the reasons."""
    reasons = doubts(found)
    if reasons:
        raise Unfitted(
            f"{' '.join(reasons)} So nothing was written; check the rows and their units, "
            "or write it all the same with --force."
        )
