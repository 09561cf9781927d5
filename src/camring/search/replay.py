"""An optimiser that keeps a loop of its own, made to be asked for one point at a time.

It is run again at every proposal, from its start through the evaluations in the
history, up to the first point that is not among them: that is the next one to evaluate.
So it keeps no state, and a study stopped at any trial goes on with the same bits.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

GRID = 2.0**-28  # box widths; nearer points share one evaluation, or vain steps would never end


class Unknown(Exception):
    """The optimiser has come to a point that nobody has evaluated, and knows some after it."""

    def __init__(
        self,
        point: Float[np.ndarray, " dimension"],
        ahead: Sequence[Float[np.ndarray, " dimension"]] = (),
    ) -> None:
        self.point, self.ahead = point, tuple(ahead)


def on_grid(point: Float[np.ndarray, " dimension"]) -> Float[np.ndarray, " dimension"]:
    """The nearest point of a fine grid in the box."""
    return np.round(np.clip(point, 0.0, 1.0) / GRID) * GRID + 0.0  # no negative zero
