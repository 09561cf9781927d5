"""Where a front has gaps, and where it may be reached from.

Seen along the diagonal, towards better in all objectives alike, a front of two objectives
is a row of points and one of three a sheet. Neighbours are those next to one another in
the row, or joined in the sheet's triangulation.
"""

from collections.abc import Iterator
from itertools import pairwise, product
from typing import TypeAlias

import numpy as np
from jaxtyping import Float
from scipy.spatial import Delaunay, QhullError

Values: TypeAlias = Float[np.ndarray, "design objective"]


def sideways(values: Values) -> Float[np.ndarray, "design across"]:
    """Places in the row or sheet: coordinates at right angles to the diagonal, to scale."""
    count = values.shape[1]
    across = np.linalg.svd(np.ones((1, count)))[2][1:]
    return values @ across.T


def neighbours(values: Values) -> list[tuple[int, int]]:
    """Pairs of neighbours, each with the smaller place first; for 2 or 3 objectives."""
    seen = sideways(values)
    if values.shape[1] == 2:
        order = np.argsort(seen[:, 0], kind="stable").tolist()
        return [(min(pair), max(pair)) for pair in pairwise(order)]
    try:
        triangles = Delaunay(seen).simplices
    except (QhullError, ValueError):  # fewer than three, or all on one line
        return [(a, b) for b in range(len(seen)) for a in range(b)]
    sides = np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [0, 2])]))
    return [(int(a), int(b)) for a, b in np.unique(sides, axis=0)]


def spacing(values: Values, count: int) -> float:
    """How far neighbours would be apart if `count` designs were spread evenly."""
    seen = sideways(values)
    if values.shape[1] == 2:
        row = values[np.argsort(seen[:, 0], kind="stable")]
        return float(np.sum(np.linalg.norm(np.diff(row, axis=0), axis=1))) / max(count - 1, 1)
    try:
        corners = values[Delaunay(seen).simplices]
    except (QhullError, ValueError):
        return 0.0
    sides = corners[:, 1:] - corners[:, :1]
    area = np.sum(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)) / 2
    # A sheet of equilateral triangles has two of them for each corner.
    return float(np.sqrt(2 / np.sqrt(3) * area / count))


def between_ends(ends: Values, count: int) -> Iterator[Float[np.ndarray, " objective"]]:
    """At least `count` places spread evenly between the best designs of each objective.

    Parameters
    ----------
    ends
        The best design of each objective, in their order.
    """
    objectives = len(ends)
    steps = 1
    while _lattice_size(steps, objectives) < count:
        steps += 1
    for share in product(range(steps + 1), repeat=objectives):
        if sum(share) == steps:
            yield np.array(share) @ ends / steps


def _lattice_size(steps: int, objectives: int) -> int:
    return steps + 1 if objectives == 2 else (steps + 1) * (steps + 2) // 2


__all__ = ["between_ends", "neighbours", "sideways", "spacing"]
