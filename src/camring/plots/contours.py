"""Where the numbers on contour lines stand: whole, apart from each other, read from one side."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.patheffects import withStroke
from matplotlib.text import Text

EDGE = 2.0  # heights of the letters between the middle of a number and the picture's edge
FRAME = 2.5  # of them between the middle of a number and the frame's sides
APART = 4.0  # heights of the letters between the middles of two numbers
SHORTEST = 6.0  # heights of the letters: a shorter line has no number
STEEPEST = 80.0  # deg downhill that a number is read; steeper ones are read upwards


Frame = tuple[tuple[float, float], ...]


def number_contours(
    axes: Axes,
    lines: ContourSet,
    size: float,
    frame: Frame | None = None,
    words: Sequence[Text] = (),
) -> None:
    """Write each line's level on it; a line on which there is no space for it stays without.

    Parameters
    ----------
    lines
        From `axes.contour`, drawn when both axes have their final limits.
    size
        Of the letters, points.
    frame
        Left and right, bottom and top of a frame that no number shall stand on, data coordinates.
    words
        Beside which no number shall stand, either.
    """
    places = label_places(axes, lines, size, frame, words)
    if not len(places):
        return
    said = axes.clabel(
        lines,
        fmt="%.4g",
        fontsize=size,
        inline_spacing=3,
        manual=[(float(x), float(y)) for x, y in places],
    )
    for text in said or ():
        text.set_path_effects([withStroke(linewidth=2.2, foreground="white")])
        downhill = 360 - text.get_rotation()
        if STEEPEST < downhill <= 90:
            text.set_rotation(180 - downhill)


def label_places(
    axes: Axes,
    lines: ContourSet,
    size: float,
    frame: Frame | None = None,
    words: Sequence[Text] = (),
) -> Float[np.ndarray, "label 2"]:
    """Points on the lines, data coordinates: as near the middle of each as the others allow.

    Long lines choose first.
    """
    letter = size * axes.figure.dpi / 72
    box = axes.bbox
    corners = np.array([box.p0, box.p1])
    covered = [
        np.array([said.p0, said.p1]) for said in (each.get_window_extent() for each in words)
    ]
    lines_of = [each for level in lines.allsegs for each in level if len(each) > 1]
    seen = [axes.transData.transform(each) for each in lines_of]
    along = [np.concatenate([[0], np.cumsum(np.hypot(*np.diff(each, axis=0).T))]) for each in seen]
    taken: list[Float[np.ndarray, " 2"]] = []
    for place in sorted(range(len(seen)), key=lambda i: -along[i][-1]):
        points, length = seen[place], along[place][-1]
        if length < SHORTEST * letter:
            continue
        free = within(points, corners, -EDGE * letter) & np.all(
            [np.hypot(*(points - each).T) >= APART * letter for each in taken], axis=0
        )
        if frame is not None:
            sides = axes.transData.transform(np.transpose(frame))
            free &= within(points, sides, -FRAME * letter) | ~within(points, sides, FRAME * letter)
        for each in covered:
            free &= ~within(points, each, EDGE * letter)
        if np.any(free):
            from_middle = np.where(free, np.abs(along[place] - length / 2), np.inf)
            taken.append(points[np.argmin(from_middle)])
    return axes.transData.inverted().transform(taken) if taken else np.empty((0, 2))


def within(
    points: Float[np.ndarray, "point 2"], corners: Float[np.ndarray, "2 2"], beyond: float
) -> Bool[np.ndarray, " point"]:
    """Which points lie in a box, lower left and upper right corner, made so much larger."""
    return np.all((points >= corners[0] - beyond) & (points <= corners[1] + beyond), axis=1)
