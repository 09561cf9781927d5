"""When to stop: decided by the best so far over a window, never on consecutive trials.

Consecutive trials of a search that explores differ by design; the best so far is
what the user gets.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camring.search.problem import Evaluation, best_of


@dataclass(frozen=True)
class Convergence:
    """Stops when the last `window` trials gained or moved the best so far too little.

    Attributes
    ----------
    window
        Trials to look back over.
    gain
        Relative improvement of the best objective below which the search has
        converged; 0 switches the test off.
    movement
        Distance that the best point moved, root mean square over the axes in box
        widths, below which the search has converged; 0 switches the test off.
    """

    window: int = 50
    gain: float = 1e-4
    movement: float = 1e-5

    def reason(
        self, history: Sequence[Evaluation], first: int = 0, tolerance: float = 0.0
    ) -> str | None:
        """One sentence saying which test fired, or None when none did.

        Parameters
        ----------
        first
            The first trial that counts; an initial design is no sign of standstill.
        tolerance
            Violation up to which a constraint counts as satisfied.

        Notes
        -----
        While nothing feasible is known there is no objective to compare, and a
        search that has just become feasible has gained: neither has converged.
        """
        split = len(history) - self.window
        if split <= first:
            return None
        before = best_of(history[:split], tolerance)
        now = best_of(history, tolerance)
        if before is None or now is None or not before.feasible(tolerance):
            return None
        scale = max(abs(now.objective), abs(before.objective), np.finfo(float).tiny)
        gain = (before.objective - now.objective) / scale
        if gain < self.gain:
            return (
                f"Converged by objective: the best gained {gain:.2e} of itself over the last "
                f"{self.window} trials, less than {self.gain:.0e}."
            )
        movement = float(np.sqrt(np.mean((now.point - before.point) ** 2)))
        if movement < self.movement:
            return (
                f"Converged by design: the best point moved {movement:.2e} box widths over the "
                f"last {self.window} trials, less than {self.movement:.0e}."
            )
        return None
