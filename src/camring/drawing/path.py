"""Curves as SVG paths: only the points that the eye would miss."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from camring.drawing.svg import number

__all__ = ["polyline", "simplified"]

# Pixels a curve may leave its data; a tenth of a hairline.
TOLERANCE = 0.04


def _vertical(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of inner points over the chord between the ends of a stretch."""
    run, rise = x[-1] - x[0], y[-1] - y[0]
    if abs(run) < 1e-12:
        return np.hypot(x[1:-1] - x[0], y[1:-1] - y[0])
    return np.abs(y[1:-1] - y[0] - (x[1:-1] - x[0]) * rise / run)


def _normal(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance of inner points from the line through the ends of a stretch."""
    run, rise = x[-1] - x[0], y[-1] - y[0]
    length = float(np.hypot(run, rise)) or 1e-12
    return np.abs((x[1:-1] - x[0]) * rise - (y[1:-1] - y[0]) * run) / length


def simplified(
    x: np.ndarray, y: np.ndarray, tolerance: float = TOLERANCE, *, plane: bool = False
) -> np.ndarray:
    """Which points to keep so that the rest lie within `tolerance` of the kept chords.

    Ramer-Douglas-Peucker, shape (point,) of booleans. For a function of `x` the
    distance is vertical, so that a value read off the drawn curve is the datum
    to within the tolerance; in the plane it is normal to the chord.
    """
    measure: Callable[[np.ndarray, np.ndarray], np.ndarray] = _normal if plane else _vertical
    count = len(x)
    keep = np.zeros(count, dtype=bool)
    # A loop's ends may coincide, so it starts from more than two fixed points.
    fixed = np.unique(np.linspace(0, count - 1, 9 if plane else 2).astype(int))
    keep[fixed] = True
    waiting = list(pairwise(fixed))
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        away = measure(x[first : last + 1], y[first : last + 1])
        worst = int(np.argmax(away))
        if away[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            waiting += [(first, middle), (middle, last)]
    return keep


def _finite_runs(x: np.ndarray, y: np.ndarray) -> list[slice]:
    """Stretches in which both coordinates are finite."""
    good = np.concatenate([[False], np.isfinite(x) & np.isfinite(y), [False]])
    edges = np.flatnonzero(good[1:] != good[:-1])
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def polyline(x: np.ndarray, y: np.ndarray, *, plane: bool = False) -> str:
    """The `d` attribute of a curve in paper coordinates; gaps where data are not finite.

    `plane = True` is for curves that are no function of `x`, such as loops.
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    pieces = []
    for run in _finite_runs(x, y):
        xs, ys = x[run], y[run]
        if len(xs) > 2:
            keep = simplified(xs, ys, plane=plane)
            xs, ys = xs[keep], ys[keep]
        pairs = [f"{number(a)} {number(b)}" for a, b in zip(xs, ys, strict=True)]
        pieces.append("M" + "L".join(pairs))
    return "".join(pieces)
