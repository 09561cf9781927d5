"""A cube around the best point that grows with success and shrinks with failure.

In ten dimensions most of the box is far from every evaluation, and a surrogate
is worth little there. Close to the best point it soon becomes exact.
"""

from dataclasses import asdict, dataclass, replace

import numpy as np
from jaxtyping import Float

from camring.search.problem import Memory
from camring.search.surrogate.acquisition import Region

LARGEST = 1.6  # box widths: the whole box from any point near its middle
SMALLEST = 1e-3
AT_FIRST = 0.8
AFTER_A_DISCOVERY = 0.2
WINS_TO_GROW = 2
LOSSES_TO_SHRINK = 3
MOST_CAUTION = 3.0


@dataclass(frozen=True)
class TrustRegion:
    """Its size, and what the last steps taken in it were worth.

    Attributes
    ----------
    length
        Edge of the cube, in box widths.
    wins, losses
        Steps in a row that did, or did not, give a new best point.
    caution
        Deviations by which the next step stays inside each constraint: raised
        by a step that came out infeasible, lowered by one that did not.
    collapses
        How often the cube became too small to matter and began anew.
    """

    length: float = AT_FIRST
    wins: int = 0
    losses: int = 0
    caution: float = 0.0
    collapses: int = 0

    def after_step(
        self,
        improved: bool,
        feasible: bool,
        patience: int = LOSSES_TO_SHRINK,
        smallest: float = SMALLEST,
    ) -> "TrustRegion":
        """The region after a step, or a batch, in it. Eriksson et al. (2019), TuRBO, section 2.

        Parameters
        ----------
        patience
            Losses in a row that halve it.
        smallest
            Edge below which it begins anew.
        """
        caution = max(self.caution - 1.0, 0.0) if feasible else self.caution + 1.0
        wins, losses = (self.wins + 1, 0) if improved else (0, self.losses + 1)
        length, collapses = self.length, self.collapses
        if wins == WINS_TO_GROW:
            length, wins = min(2 * length, LARGEST), 0
        if losses >= patience:
            length, losses = length / 2, 0
        if length < smallest:
            length, collapses = AT_FIRST, collapses + 1
        return TrustRegion(length, wins, losses, min(caution, MOST_CAUTION), collapses)

    def after_discovery(self) -> "TrustRegion":
        """The region after a search of the whole box found a better point elsewhere."""
        return replace(self, length=max(self.length, AFTER_A_DISCOVERY), wins=0, losses=0)

    def around(
        self,
        centre: Float[np.ndarray, " dimension"],
        shape: Float[np.ndarray, " dimension"] | float = 1.0,
    ) -> Region:
        """The part of the cube, or of a brick of that shape, that lies in the unit box."""
        half = np.broadcast_to(self.length / 2 * np.asarray(shape), centre.shape)
        return Region(np.clip(centre - half, 0.0, 1.0), np.clip(centre + half, 0.0, 1.0))

    def to_memory(self) -> Memory:
        """As JSON-able values."""
        return asdict(self)
