"""What may be said of a set of compromises: which are beaten, how much they cover, how evenly.

Every objective is to be made small.
"""

from typing import TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Int

Values: TypeAlias = Float[np.ndarray, "design objective"]


def non_dominated(values: Values) -> Bool[np.ndarray, " design"]:
    """True where no other design is at least as good in all objectives and better in one.

    Of equal designs all are kept. A design with a value that is no number is beaten.
    """
    values = np.asarray(values, dtype=float)
    kept = np.all(np.isfinite(values), axis=1)
    for place in np.flatnonzero(kept):
        others = values[kept]
        no_worse = np.all(others <= values[place], axis=1)
        better = np.any(others < values[place], axis=1)
        kept[place] = not np.any(no_worse & better)
    return kept


def hypervolume(values: Values, reference: Float[np.ndarray, " objective"]) -> float:
    """What the designs dominate of the box below a reference point, for 2 or 3 objectives.

    Parameters
    ----------
    reference
        A point worse than those that shall count; designs beyond it add nothing.

    Raises
    ------
    ValueError
        For another number of objectives.
    """
    values, reference = np.asarray(values, dtype=float), np.asarray(reference, dtype=float)
    values = values[np.all(values < reference, axis=1)]
    if len(reference) == 2:
        return _area(values, reference)
    if len(reference) != 3:
        raise ValueError(f"{len(reference)} objectives; the volume is for 2 or 3")
    layers = values[np.argsort(values[:, 2])]
    tops = np.append(layers[1:, 2], reference[2])
    return float(
        sum(
            _area(layers[: place + 1, :2], reference[:2]) * (top - layers[place, 2])
            for place, top in enumerate(tops[: len(layers)])
        )
    )


def _area(values: Values, reference: Float[np.ndarray, " 2"]) -> float:
    total, lowest = 0.0, reference[1]
    for first, second in values[np.lexsort(values.T[::-1])]:
        if second < lowest:
            total += (reference[0] - first) * (lowest - second)
            lowest = second
    return float(total)


def evenly_spread(values: Values, count: int) -> Int[np.ndarray, " chosen"]:
    """Places of designs that lie about equally far apart, the best of each objective among them.

    The most crowded design is left out until `count` are left: the one nearest to its
    nearest neighbour, and of that pair the one nearest to its second.
    """
    values = np.asarray(values, dtype=float)
    kept = list(range(len(values)))
    ends = {int(np.argmin(column)) for column in values.T} if len(values) else set()
    distance = np.linalg.norm(values[:, None] - values[None], axis=-1)
    np.fill_diagonal(distance, np.inf)
    while len(kept) > max(count, len(ends)):
        near = np.sort(distance[np.ix_(kept, kept)], axis=1)[:, :2]
        order = np.lexsort((near[:, -1], near[:, 0]))
        kept.remove(next(kept[place] for place in order if kept[place] not in ends))
    return np.array(kept, dtype=int)


def box_of(
    values: Values,
) -> tuple[Float[np.ndarray, " objective"], Float[np.ndarray, " objective"]]:
    """Lowest values of a front and how far the highest lie above; 1 where they do not."""
    lowest = np.min(values, axis=0)
    width = np.max(values, axis=0) - lowest
    return lowest, np.where(width > 0, width, 1.0)


__all__ = ["box_of", "evenly_spread", "hypervolume", "non_dominated"]
