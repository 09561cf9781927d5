"""An evaluation and its gradients, completed by what the envelope says."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from camring.evaluation.envelope_batch import SEARCHED, AtPoints, SlopesAtPoints, at_points
from camring.evaluation.outcome import EnvelopeNumbers, Outcome, named_by_point
from camring.files.motor import MotorFile
from camring.numerics.verdict import Verdict
from camring.objective.envelope import (
    EFFICIENCY_LOSS,
    POINTWISE,
    RIPPLE_RATIO,
    Reference,
    against_given,
    loss_scale,
    names_against_given,
    names_in_envelope,
)
from camring.objective.objective import Goal
from camring.physics.envelope import Envelope, EnvelopeGrid

KEPT_RESULTS = (
    "torque_ripple",
    "efficiency",
    "min_pressure",
    "min_contact_force",
    "max_contact_stress",
)
"""What an evaluation keeps of every point of the envelope."""

ONE_WAY, BOTH_WAYS = (6, 4), (4, 3)
"""Speeds and pressures of the grid that a search sees: 24 points either way."""


def search_grid(envelope: Envelope) -> EnvelopeGrid:
    """The points at which a search sees every design."""
    return envelope.grid(*(BOTH_WAYS if envelope.both_directions else ONE_WAY))


class EnvelopeGoal:
    """What a file's envelope asks of a design, held against the file's own motor."""

    def __init__(self, file: MotorFile, grid: EnvelopeGrid | None = None) -> None:
        assert file.envelope is not None
        # A search's designs and the motor that they are held against are seen alike.
        self.resolution = SEARCHED if grid is None else None
        self.file = file
        self.envelope: Envelope = file.envelope
        self.goal: Goal = file.goal
        self.grid = search_grid(self.envelope) if grid is None else grid

    @cached_property
    def given(self) -> AtPoints:
        """The file's own motor at every point."""
        return at_points(self.file.system, self.goal, self.envelope, self.grid, self.resolution)

    @cached_property
    def reference(self) -> Reference:
        """Its ripple and efficiency."""
        metrics = self.given.metrics
        return Reference(np.asarray(metrics.torque_ripple), np.asarray(metrics.efficiency))

    @property
    def pointwise_names(self) -> tuple[str, ...]:
        """Limits that a descent sees at every point by itself."""
        from_file = [n for n in names_in_envelope(self.goal.constraints) if n in POINTWISE]
        return (*from_file, *names_against_given(self.envelope))

    @property
    def names(self) -> tuple[str, ...]:
        """Every limit of the file, those against the given motor last."""
        return (*self.goal.constraints.names(), *names_against_given(self.envelope))

    def limits(self, found: AtPoints) -> dict[str, Float[np.ndarray, " point"]]:
        """Every limit that holds in the envelope, at every point."""
        metrics = found.metrics
        if not names_against_given(self.envelope):
            return dict(found.limits)
        ripple, efficiency = np.asarray(metrics.torque_ripple), np.asarray(metrics.efficiency)
        return {
            **found.limits,
            **against_given(self.envelope, self.reference, ripple, efficiency),
        }

    def added(self, outcome: Outcome, found: AtPoints) -> Outcome:
        """The evaluation with the envelope in its limits and its objective."""
        if not outcome.results:
            return outcome
        limits = self.limits(found)
        worst = dict(outcome.constraints)
        for name, values in limits.items():
            # NumPy's maximum keeps what is not a number, Python's may lose it.
            worst[name] = float(np.maximum(worst.get(name, -np.inf), np.max(values)))
        share = self.ripple_term(found)
        physical = outcome.physical_objective + share
        penalty = sum(max(0.0, g) ** 2 for g in worst.values())
        failure = outcome.failure or _failure(found)
        return replace(
            outcome,
            objective=np.nan if failure else physical + self.goal.weights.penalty * penalty,
            physical_objective=np.nan if failure else physical,
            constraints={name: worst[name] for name in self.names},
            failure=failure,
            envelope=EnvelopeNumbers(
                limits={name: limits[name].tolist() for name in self.pointwise_names},
                results={
                    name: np.asarray(getattr(found.metrics, name)).tolist() for name in KEPT_RESULTS
                },
                share=share,
                operating={name: g for name, g in outcome.constraints.items() if name in POINTWISE},
            ),
        )

    def ripple_term(self, found: AtPoints) -> float:
        """What the ripple at all points adds to the objective."""
        ripple = np.asarray(found.metrics.torque_ripple)
        return self.goal.weights.envelope_ripple * float(np.mean(ripple**2))

    def ripple_term_slopes(
        self, found: AtPoints, slopes: SlopesAtPoints
    ) -> Float[np.ndarray, " coordinate"]:
        """The derivatives of `ripple_term`."""
        ripple = np.asarray(found.metrics.torque_ripple)
        factor = 2 * self.goal.weights.envelope_ripple / len(ripple)
        return factor * (ripple @ slopes.results["torque_ripple"])

    def gradients(
        self,
        found: AtPoints,
        slopes: SlopesAtPoints,
        objective: Float[np.ndarray, " coordinate"],
        constraints: Mapping[str, Float[np.ndarray, " coordinate"]],
        operating: Mapping[str, float],
        names: Sequence[str],
    ) -> tuple[Float[np.ndarray, " coordinate"], Float[np.ndarray, "constraint coordinate"]]:
        """Gradients of the objective and of the named limits.

        Parameters
        ----------
        objective, constraints
            Gradients at the operating points alone.
        operating
            The limits there.
        names
            Of limits: of the file, or one of them at a point (`pointwise` of a record).
        """
        of_limits = self.limit_slopes(slopes)
        pointwise = named_by_point(
            {name: list(of_limits[name]) for name in self.pointwise_names},
            {name: constraints[name] for name in constraints if name in POINTWISE},
        )
        values = self.limits(found)
        rows = []
        for name in names:
            if name in pointwise:
                rows.append(np.asarray(pointwise[name]))
                continue
            worst = int(np.argmax(values[name])) if name in values else 0
            inside = name in values and values[name][worst] > operating.get(name, -np.inf)
            rows.append(of_limits[name][worst] if inside else np.asarray(constraints[name]))
        return objective + self.ripple_term_slopes(found, slopes), np.stack(rows)

    def limit_slopes(
        self, slopes: SlopesAtPoints
    ) -> dict[str, Float[np.ndarray, "point coordinate"]]:
        found = dict(slopes.limits)
        envelope = self.envelope
        if envelope.ripple_ratio is not None:
            scale = envelope.ripple_ratio * self.reference.torque_ripple
            found[RIPPLE_RATIO] = slopes.results["torque_ripple"] / scale[:, None]
        if envelope.efficiency_loss is not None:
            found[EFFICIENCY_LOSS] = -slopes.results["efficiency"] / loss_scale(envelope)
        return found

    def names_by_point(self) -> tuple[str, ...]:
        """The names of all limits as a descent sees them: no maximum over points among them."""
        whole = [name for name in self.names if name not in self.pointwise_names]
        at_all = {name: range(self.grid.count) for name in self.pointwise_names}
        operating = {name: 0 for name in self.goal.constraints.names() if name in POINTWISE}
        return (*whole, *named_by_point(at_all, operating))


def _failure(found: AtPoints) -> str | None:
    wrong = np.flatnonzero(found.faults)
    if not len(wrong):
        return None
    place = int(wrong[0])
    grid = found.grid
    why = Verdict(jnp.asarray(found.faults[place])).explain()
    return f"in the envelope at {grid.text(place)}: {why}"
