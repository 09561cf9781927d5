"""Chance for numbers that scatter: one stream of common random numbers, each in its distribution.

Deviates are standardised, mean 0 and variance 1, so that a slope by one of them is
a standard deviation of the result to first order. The same count and seed give the
same bits: two designs looked at with them differ by the designs alone.
"""

from collections.abc import Sequence
from math import sqrt
from typing import Literal, TypeAlias

import numpy as np
from jaxtyping import Float

from camring.search.sampling import generator, sobol

Kind: TypeAlias = Literal["uniform", "normal", "phase"]
"""`phase` is a wave of given amplitude whose phase is uniform: two deviates, cosine and sine."""

KINDS: tuple[Kind, ...] = ("uniform", "normal", "phase")
WIDTHS: dict[Kind, int] = {"uniform": 1, "normal": 1, "phase": 2}
STREAM = 7  # apart from every other use of the same seed


def standardised(
    kind: Kind, share: Float[np.ndarray, " sample"]
) -> Float[np.ndarray, "sample deviate"]:
    """Where this share of a distribution lies below; mean 0, variance 1, uncorrelated.

    A uniform deviate is within the root of three, a pair of a phase on the circle
    whose radius is the root of two.
    """
    if kind == "uniform":
        return sqrt(3) * (2 * share - 1)[:, None]
    if kind == "normal":
        from scipy.special import ndtri  # slow to import, for whoever has no tolerances

        return ndtri(share)[:, None]
    turn = 2 * np.pi * share
    return sqrt(2) * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def deviates(kinds: Sequence[Kind], count: int, seed: int) -> Float[np.ndarray, "count deviate"]:
    """Scrambled Sobol points through the distributions; see `WIDTHS` for the columns.

    Most even where `count` is a power of two. No share is 0 or 1, so all are finite.
    """
    points = sobol(count, len(kinds), generator(seed, 0, STREAM))
    # Sobol's numbers are multiples of 2^-30, 0 among them: the middle of each cell instead.
    points = points + 2.0**-31
    columns = [standardised(kind, points[:, place]) for place, kind in enumerate(kinds)]
    return np.concatenate(columns, axis=1)


def owners(kinds: Sequence[Kind]) -> list[int]:
    """For each column of `deviates` the place of the number that it belongs to."""
    return [place for place, kind in enumerate(kinds) for _ in range(WIDTHS[kind])]


__all__ = ["KINDS", "WIDTHS", "Kind", "deviates", "owners", "standardised"]
