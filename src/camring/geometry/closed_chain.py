"""A closed plane curve as a chain of straight lines, or of circular arcs without corners.

Points of the plane are complex numbers. Many machine controls read lines and arcs
and no spline. Every link begins and ends on the curve. Arcs come in pairs
(biarcs): the two of a pair share a tangent where they meet, and both ends of a pair
have the curve's own tangent, so the chain turns nowhere abruptly.

Of the biarcs between two places that one is taken whose arcs have tangents of equal
length to the corner of their control polygon (Bolton, Biarc curves, Computer-Aided
Design 7, 1975).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, pi
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float

__all__ = ["ChainError", "ClosedChain", "Kind", "along_links", "fit_chain"]

Kind = Literal["lines", "arcs"]

_PARTS = np.arange(1, 16) / 16  # where a link is measured, as fractions of it
_GRID = 4096  # places a period at which the density of links is computed
_LEAST_DENSITY = 0.15  # of the greatest: where curvature stands still links are still short
_SPARE = 0.98  # of the tolerance, for what lies between the measured places
_ROUNDS = 16
_LEAST_LINKS, _MOST_LINKS = 12, 200_000  # of a turn


class ChainError(ValueError):
    """A tolerance that no chain of a sensible number of links keeps; `strays` is what one does."""

    def __init__(self, strays: float, links: int) -> None:
        self.strays, self.links = strays, links
        super().__init__(f"strays {strays:.3g} with {links} links")


@dataclass(frozen=True, eq=False)
class ClosedChain:
    """Links from each point to the next, the last back to the first.

    Attributes
    ----------
    points
        Ends of the links, anticlockwise.
    bulges
        Tangent of a quarter of the angle of each link's arc, positive where it turns left, as
        drawing programs have it; zero for a straight line.
    error
        Largest distance from the curve, along the curve's normal, in fifteen places of each link.
    """

    points: Complex[np.ndarray, " link"]
    bulges: Float[np.ndarray, " link"]
    error: float

    @property
    def links(self) -> int:
        return len(self.points)


def fit_chain(
    follow: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    stray: Callable[[np.ndarray, np.ndarray], np.ndarray],
    repeats: int,
    tolerance: float,
    kind: Kind,
) -> ClosedChain:
    """A chain that stays within a tolerance of a closed curve, each of its periods alike.

    Parameters
    ----------
    follow
        Point, outward normal (both complex) and curvature of the curve at parameters; the
        curve runs anticlockwise once round as its parameter grows by 2 pi.
    stray
        Signed distance of points from the curve along its normal, given parameters near by.
    repeats
        Periods in one turn, by which the curve is turned into itself.

    Raises
    ------
    ChainError
        When 200,000 links do not suffice.
    """
    parameter, grown = _density(follow, 2 * pi / repeats, tolerance, kind)
    most = ceil(_MOST_LINKS / (repeats * (1 if kind == "lines" else 2)))
    count = min(max(ceil(_LEAST_LINKS / repeats), ceil(grown[-1])), most)
    for _ in range(_ROUNDS):
        places = np.interp(np.linspace(0, grown[-1], count + 1), grown, parameter)
        points, bulges, near = _links(follow, places, kind)
        error = _error(stray, points, bulges, near)
        if error <= _SPARE * tolerance:
            return _all_round(points[:-1], bulges, error, repeats)
        # A line strays with the square of its length, a biarc with the cube.
        order = 2 if kind == "lines" else 3
        share = (error / (_SPARE * tolerance)) ** (1 / order)
        if count >= most:
            break
        count = min(max(count + 1, ceil(count * min(share, 4.0))), most)
    raise ChainError(error, len(bulges) * repeats)


def _density(
    follow: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    period: float,
    tolerance: float,
    kind: Kind,
) -> tuple[np.ndarray, np.ndarray]:
    """Parameters of one period, and the number of links that lead up to each of them."""
    parameter = np.linspace(0, period, _GRID + 1)
    point, _, curvature = follow(parameter)
    step = np.abs(np.diff(point))
    if kind == "lines":
        bend = np.abs(curvature[1:] + curvature[:-1]) / 2
        density = np.sqrt(bend / (8 * tolerance))
    else:
        # Of two curves with like ends whose curvatures part by a slope over half a length.
        slope = np.abs(np.diff(curvature)) / step
        density = np.cbrt(slope / (324 * tolerance / 2))
    density = np.maximum(density, _LEAST_DENSITY * density.max())
    links = np.concatenate([[0.0], np.cumsum(density * step)])
    if links[-1] <= 0:  # a circle is an arc, whatever the tolerance
        links = np.linspace(0, 2, _GRID + 1)
    return parameter, links


def _links(
    follow: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    places: np.ndarray,
    kind: Kind,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends of the links of one period with the last, their bulges, and parameters of the ends."""
    point, normal, _ = follow(places)
    if kind == "lines":
        return point, np.zeros(len(point) - 1), places
    before, after = 1j * normal[:-1], 1j * normal[1:]
    start, end = point[:-1], point[1:]
    chord = end - start
    # |end - start - d (before + after)| = 2 d, the root that is positive.
    along = np.real(np.conj(chord) * (before + after))
    bend = 2 * (1 - np.real(np.conj(before) * after))
    square = np.abs(chord) ** 2
    reach = square / (along + np.sqrt(along**2 + bend * square))
    joint = (start + end + reach * (before - after)) / 2
    first = np.tan(np.angle((joint - start) * np.conj(before)) / 2)
    second = np.tan(np.angle(after * np.conj(end - joint)) / 2)
    points = np.append(np.stack([start, joint], axis=1).reshape(-1), end[-1])
    middle = (places[:-1] + places[1:]) / 2
    near = np.append(np.stack([places[:-1], middle], axis=1).reshape(-1), places[-1])
    return points, np.stack([first, second], axis=1).reshape(-1), near


def _error(
    stray: Callable[[np.ndarray, np.ndarray], np.ndarray],
    points: np.ndarray,
    bulges: np.ndarray,
    near: np.ndarray,
) -> float:
    measured = along_links(points[:-1], points[1:], bulges, _PARTS)
    parameters = near[:-1, None] + np.diff(near)[:, None] * _PARTS
    joints = stray(points[:-1], near[:-1])
    return float(max(np.abs(stray(measured, parameters)).max(), np.abs(joints).max()))


def along_links(
    start: Complex[np.ndarray, " link"],
    end: Complex[np.ndarray, " link"],
    bulges: Float[np.ndarray, " link"],
    part: Float[np.ndarray, " place"],
) -> Complex[np.ndarray, "link place"]:
    """Points at parts (0 to 1) of the angle of each link's arc, or of a straight link's length.

    An arc of bulge b that turns by 4 atan(b) is seen from its start at an angle of half what is
    left of it: exact for any bulge, zero among them.
    """
    turn = 4 * np.arctan(bulges)[:, None]
    half = turn / 2
    # sin(part half) / sin(half), which tends to the part itself where the arc is straight.
    share = np.where(
        np.abs(half) > 1e-9, np.sin(part * half) / np.where(half == 0, 1, np.sin(half)), part
    )
    return start[:, None] + (end - start)[:, None] * share * np.exp(-1j * (1 - part) * half)


def _all_round(points: np.ndarray, bulges: np.ndarray, error: float, repeats: int) -> ClosedChain:
    turned = np.exp(2j * pi * np.arange(repeats) / repeats)
    return ClosedChain((turned[:, None] * points).reshape(-1), np.tile(bulges, repeats), error)
