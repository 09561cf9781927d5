"""Results of a motor file as objectives to make small, for many designs at a time."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from camring.files.motor import MotorFile, missing_design_space
from camring.objective.design_space import DesignSpace
from camring.objective.point_shares import point_shares
from camring.studies.design_gradients import Limits, LimitSlopes, Points, sloped_designs
from camring.studies.envelope_gradients import EnvelopedDesigns

Losses: TypeAlias = Float[np.ndarray, "point result"]
LossSlopes: TypeAlias = Float[np.ndarray, "point result dimension"]

SENSES = {
    "torque_ripple": -1,
    "flow_ripple": -1,
    "pressure_ripple": -1,
    "efficiency": 1,
    "volumetric_efficiency": 1,
    "hydromechanical_efficiency": 1,
    "displacement": 1,
    "mean_torque": 1,
    "max_contact_stress": -1,
    "max_pressure": -1,
    "max_pressure_angle": -1,
    "max_jerk": -1,
    "jerk_objective": -1,
}
"""What may be traded, and whether more (+1) or less (-1) of it is better."""


class Traded:
    """A motor file as objectives to make small.

    Side by side where the motor can be simulated in batches, else one by one; at final
    resolution either way, so that a limit that holds here holds in the end.

    Raises
    ------
    InputError
        When the file has no design space.
    """

    def __init__(self, file: MotorFile, names: Sequence[str]) -> None:
        if file.design_space is None:
            raise missing_design_space(file.path)
        self.file, self.names = file, tuple(names)
        self.space: DesignSpace = file.design_space
        self.senses = np.array([SENSES[name] for name in names], dtype=float)
        designs = sloped_designs(file.system, file.goal, self.space, self.names)
        self._designs = designs if file.envelope is None else EnvelopedDesigns(designs, file)

    def summed(self, results: Sequence[Mapping]) -> Float[np.ndarray, " result"]:
        """One number for each result from those of all operating points, SI."""
        return self._sum(np.array([[each[name] for name in self.names] for each in results]))

    def _sum(self, results: Float[np.ndarray, "operating result"]) -> Float[np.ndarray, " result"]:
        return np.sum(self._shares(results) * results, axis=0)

    def _shares(
        self, results: Float[np.ndarray, "operating result"]
    ) -> Float[np.ndarray, "operating result"]:
        pairs = zip(self.names, np.asarray(results, dtype=float).T, strict=True)
        return np.stack([point_shares(self.file.system, *each) for each in pairs], axis=1)

    def values(self, points: Points) -> tuple[Losses, Limits]:
        """Losses and constraints; no numbers where the simulation failed."""
        results, limits = self._designs.values(points)
        return -self.senses * np.array([self._sum(each) for each in results]), limits

    def slopes(self, points: Points) -> tuple[LossSlopes, LimitSlopes]:
        """Derivatives of both by the coordinates; quick where `values` has just been asked."""
        results, of_results, of_limits = self._designs.slopes(points)
        shares = np.stack([self._shares(each) for each in results])
        summed = np.einsum("por,pord->prd", shares, of_results)
        return -self.senses[:, None] * summed, of_limits


__all__ = ["SENSES", "Traded"]
