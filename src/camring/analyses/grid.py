"""Results over one or two numbers of the motor file: what a map and a sweep come to."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from camring.files.result_names import quantity
from camring.files.units import to_si
from camring.metrics.efficiency import BRAKE, PUMP, working_as
from camring.metrics.summary import Metrics
from camring.numerics.verdict import EXPLANATIONS, Verdict


@dataclass(frozen=True)
class Axis:
    """One number of the motor file and the values it takes.

    Attributes
    ----------
    key
        Its path in the motor file, `motor.valve_plate.shift`.
    unit
        The unit it is shown in; empty for a plain number in SI.
    shown
        Its values in that unit.
    """

    key: str
    unit: str
    shown: Float[np.ndarray, " place"]

    @property
    def label(self) -> str:
        """For an axis of a picture: what it is and its unit."""
        name = self.key.rsplit(".", 1)[-1].replace("_", " ")
        where = self.key.split(".")[-2].replace("_", " ") if self.key.count(".") > 1 else ""
        if self.key.startswith("operating_points"):
            where = ""
        said = f"{where} {name}".strip() if where else name
        said = {"speed": "shaft speed", "temperature": "oil temperature"}.get(said, said)
        unit = self.unit or "–"
        return f"{said[:1].upper()}{said[1:]}, {unit}"

    def si(self, unit: str) -> Float[np.ndarray, " place"]:
        """Its values in SI, whose unit of this kind is given."""
        return np.array([to_si(f"{float(v)!r} {self.unit}".rstrip(), unit) for v in self.shown])

    def text(self, place: int) -> str:
        """One value with its unit."""
        return f"{self.shown[place]:.4g} {self.unit}".rstrip()


@dataclass(frozen=True, eq=False)
class Grid:
    """Every result at every combination of the axes' values.

    Attributes
    ----------
    results
        By its name of docs/theory.md section 10, SI, one dimension for each axis; NaN where the
        simulation is not to be trusted.
    faults
        Sums of `Fault` bits of the same shape; zero is sound.
    limits
        Largest results that the motor file allows, SI, where it sets any.
    title
        The motor's name and what is held still.
    notes
        What is to be known of the whole grid, a sentence each.
    envelope
        The range in which the motor must run, two ends for each axis in the axis' unit; None
        where the file has none, or other numbers vary.
    quadrants
        Whether the axes are signed speed and pressure difference: `analyses.quadrants`.
    """

    axes: tuple[Axis, ...]
    results: dict[str, Float[np.ndarray, "*grid"]]
    faults: Int[np.ndarray, "*grid"]
    limits: dict[str, float]
    title: str = ""
    notes: tuple[str, ...] = ()
    envelope: tuple[tuple[float, float], ...] | None = None
    quadrants: bool = False

    @classmethod
    def of(
        cls,
        axes: tuple[Axis, ...],
        metrics: Metrics,
        faults: Int[np.ndarray, " many"],
        limits: dict[str, float],
        title: str,
        notes: Sequence[str] = (),
    ) -> "Grid":
        """From a batch in the order of `numpy.meshgrid(..., indexing="ij")`."""
        shape = tuple(len(axis.shown) for axis in axes)
        sound = faults == 0
        results = {
            name: np.where(sound, values, np.nan).reshape(shape)
            for name, values in vars(metrics).items()
        }
        return cls(axes, results, faults.reshape(shape), limits, title, tuple(notes))

    @property
    def sound(self) -> Bool[np.ndarray, "*grid"]:
        """Where the simulation can be trusted."""
        return self.faults == 0

    @property
    def mode(self) -> np.ndarray:
        """What the machine works as: `motor`, `pump` or `brake`; empty where unsound."""
        words = working_as(self.results["input_power"], self.results["output_power"])
        return np.where(self.sound, words, "")

    def shown(self, name: str) -> Float[np.ndarray, "*grid"]:
        """A result in the unit it is shown in."""
        return self.results[name] * quantity(name).factor

    def warnings(self) -> list[str]:
        """How many points have no results, and why; where the roller lifts or the oil cavitates.

        Each sentence names the values of the axes between which its points lie, and how many
        of them are in the envelope.
        """
        found = [
            (f"points have no results: {sentence}", (self.faults & fault) != 0)
            for fault, sentence in EXPLANATIONS.items()
        ]
        found += [(f"points: {words}", self.results[name] < 0) for name, words in LIMITS.items()]
        said = BRAKES if self.quadrants else MODES
        found += [(f"points: {words}", self.mode == each) for each, words in said.items()]
        return [
            *(
                f"{np.count_nonzero(places)} of {places.size} {words} ({self._where(places)})."
                for words, places in found
                if places.any()
            ),
            *self.notes,
        ]

    def _where(self, found: Bool[np.ndarray, "*grid"]) -> str:
        """Between which values of the axes some points lie, and how many in the envelope."""
        said = []
        for axis, places in zip(self.axes, np.nonzero(found), strict=True):
            ends = sorted({float(f"{axis.shown[k]:.4g}") for k in (places.min(), places.max())})
            said.append(f"{' to '.join(f'{end:g}' for end in ends)} {axis.unit}".rstrip())
        text = ", ".join(said)
        if self.envelope is None:
            return text
        inside = np.count_nonzero(found & self.in_envelope)
        return f"{text}; {inside or 'none'} of them in the envelope"

    @property
    def in_envelope(self) -> Bool[np.ndarray, "*grid"]:
        """Which points the envelope holds, its ends included; all of them without one."""
        inside = np.ones(self.faults.shape, dtype=bool)
        for place, (axis, ends) in enumerate(zip(self.axes, self.envelope or (), strict=False)):
            slack = 1e-9 * max(map(abs, ends))
            held = (axis.shown >= ends[0] - slack) & (axis.shown <= ends[1] + slack)
            along = [1] * len(self.axes)
            along[place] = -1
            inside &= held.reshape(along)
        return inside

    def why(self, place: tuple[int, ...]) -> str:
        """The faults at one point in words; empty when sound."""
        return Verdict(jnp.asarray(self.faults[place])).explain()


# Results that must not fall below zero, with what happens there.
LIMITS = {
    "min_contact_force": "the roller lifts off the ring",
    "vapour_margin": "the chamber pressure falls below the vapour pressure (cavitation)",
}

MODES = {
    PUMP: "the shaft is driven and oil delivered (pump); efficiencies there are a pump's",
    BRAKE: "the shaft is driven and oil is taken, too (brake); efficiencies there mean nothing",
}

BRAKES = {BRAKE: "shaft and oil both give power, and all of it is lost; no efficiency there"}


__all__ = [
    "LIMITS",
    "Axis",
    "Grid",
]
