"""Functions of the angle as Chebyshev series in pieces, in the second solver."""

from bisect import bisect_right
from collections.abc import Sequence
from math import pi

import numpy as np
from scipy.fft import dct

ORDER = 16
NODES = np.cos(pi * np.arange(ORDER + 1) / ORDER)[::-1]


def series_of(values: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients from values at the nodes."""
    found = dct(values[::-1], type=1) / ORDER
    found[0] /= 2
    found[-1] /= 2
    return found


class PeriodicSeries:
    """A periodic function, one series between two neighbouring edges."""

    def __init__(self, edges: Sequence[float], series: Sequence[np.ndarray]) -> None:
        self.edges = np.asarray(edges, float)
        self.period = float(self.edges[-1] - self.edges[0])
        self._series = np.stack(series)
        self._edge_list: list[float] = self.edges.tolist()
        self._falling: list[list[float]] = [row[:0:-1].tolist() for row in self._series]
        self._constant: list[float] = self._series[:, 0].tolist()

    def scalar(self, angle: float) -> float:
        """Value at one angle, by Clenshaw's recurrence; fast, for right-hand sides."""
        edges = self._edge_list
        home = edges[0] + (angle - edges[0]) % self.period
        index = min(bisect_right(edges, home) - 1, len(self._constant) - 1)
        start, end = edges[index], edges[index + 1]
        x = (2 * home - start - end) / (end - start)
        double = 2 * x
        one = two = 0.0
        for coefficient in self._falling[index]:
            one, two = coefficient + double * one - two, one
        return self._constant[index] + x * one - two

    def __call__(self, angle: np.ndarray) -> np.ndarray:
        """Values at any angles."""
        home = self.edges[0] + np.mod(np.asarray(angle, float) - self.edges[0], self.period)
        index = np.searchsorted(self.edges, home, side="right") - 1
        index = np.clip(index, 0, len(self._series) - 1)
        start, end = self.edges[index], self.edges[index + 1]
        x = (2 * home - start - end) / (end - start)
        one, two = np.zeros_like(x), np.zeros_like(x)
        for k in range(ORDER, 0, -1):
            one, two = self._series[index, k] + 2 * x * one - two, one
        return self._series[index, 0] + x * one - two
