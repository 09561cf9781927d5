"""One number for many samples of a result, and how it changes with each of them.

A statistic gives its value and its weights, its derivatives by the samples: with the
samples' own slopes at hand, `weights @ slopes` is the exact slope of the statistic.
Both here go with the samples: `statistic(a + b v) = a + b statistic(v)` for `b > 0`.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from jaxtyping import Float
from scipy.optimize import brentq
from scipy.special import ndtr

SMOOTHING = 0.2  # of the standard deviation; widens a normal's 95 % point by 2 % of 1.64 of them
EQUAL = 1e-13  # of the samples' size; a spread below it is rounding


class Weighed(NamedTuple):
    """A statistic of some samples."""

    value: float
    weights: Float[np.ndarray, " sample"]
    """Derivatives by the samples; their sum is 1."""


class Statistic(Protocol):
    """What is to become small, or to stay below zero, of a result that scatters."""

    def __call__(self, samples: Float[np.ndarray, " sample"]) -> Weighed:
        """Its value and weights."""
        ...

    def __str__(self) -> str:
        """In words."""
        ...


@dataclass(frozen=True)
class MeanPlus:
    """Mean plus so many standard deviations, which are those of the samples as a population."""

    sigmas: float

    def __call__(self, samples: Float[np.ndarray, " sample"]) -> Weighed:
        mean, deviation, turn = _spread(samples)
        return Weighed(mean + self.sigmas * deviation, 1 / len(samples) + self.sigmas * turn)

    def __str__(self) -> str:
        return f"mean + {self.sigmas:g} standard deviations"


@dataclass(frozen=True)
class SmoothQuantile:
    """The value that this share of the samples lies below, smoothed.

    Each sample counts as a normal distribution with a fifth of the samples' standard
    deviation, so the quantile has a slope everywhere and no sample decides it alone
    (a kernel estimate; Nadaraya 1964). The widening errs on the safe side above 50 %.
    """

    share: float

    def __call__(self, samples: Float[np.ndarray, " sample"]) -> Weighed:
        mean, deviation, turn = _spread(samples)
        if deviation == 0:
            return Weighed(mean, np.full(len(samples), 1 / len(samples)))
        scaled = (samples - mean) / deviation

        def below(place: float) -> float:
            return float(np.mean(ndtr((place - scaled) / SMOOTHING))) - self.share

        ends = scaled.min() - 10 * SMOOTHING, scaled.max() + 10 * SMOOTHING
        place = float(brentq(below, *ends, xtol=1e-15, rtol=1e-14))
        # notation: F(t, v, h) = share; dt = sum(k dv)/sum(k) + sum(k z)/sum(k) dh
        z = (place - scaled) / SMOOTHING
        k = np.exp(-(z**2) / 2)
        weights = k / k.sum() + (k @ z) / k.sum() * SMOOTHING * turn
        return Weighed(mean + deviation * place, weights)

    def __str__(self) -> str:
        return f"{100 * self.share:g} % quantile"


def _spread(
    samples: Float[np.ndarray, " sample"],
) -> tuple[float, float, Float[np.ndarray, " sample"]]:
    """Mean, standard deviation, and the latter's derivatives; no spread at all has none."""
    mean = float(np.mean(samples))
    deviation = float(np.std(samples))
    if deviation <= EQUAL * float(np.max(np.abs(samples))):
        return mean, 0.0, np.zeros(len(samples))
    return mean, deviation, (samples - mean) / (len(samples) * deviation)


__all__ = ["MeanPlus", "SmoothQuantile", "Statistic", "Weighed"]
