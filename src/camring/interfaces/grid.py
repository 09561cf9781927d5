"""Results over one or two numbers of the motor file: what a map and a sweep come to."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any, get_args, get_type_hints

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from camring.interfaces.report.quantities import QUANTITIES, Quantity
from camring.metrics.summary import Metrics
from camring.numerics.verdict import EXPLANATIONS, Verdict

_ASCII = str.maketrans({"·": ".", "²": "^2", "³": "^3"})


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
        said = {"speed": "shaft speed"}.get(said, said)
        unit = self.unit or "–"
        return f"{said[:1].upper()}{said[1:]}, {unit}"

    def text(self, place: int) -> str:
        """One value with its unit."""
        return f"{self.shown[place]:.4g} {self.unit}".rstrip()


@dataclass(frozen=True, eq=False)
class Grid:
    """Every result at every combination of the axes' values.

    Attributes
    ----------
    results
        By its name of model.md section 10, SI, one dimension for each axis; NaN where the
        simulation is not to be trusted.
    faults
        Sums of `Fault` bits of the same shape; zero is sound.
    limits
        Largest results that the motor file allows, SI, where it sets any.
    title
        The motor's name and what is held still.
    """

    axes: tuple[Axis, ...]
    results: dict[str, Float[np.ndarray, "*grid"]]
    faults: Int[np.ndarray, "*grid"]
    limits: dict[str, float]
    title: str = ""

    @classmethod
    def of(
        cls,
        axes: tuple[Axis, ...],
        metrics: Metrics,
        faults: Int[np.ndarray, " many"],
        limits: dict[str, float],
        title: str,
    ) -> "Grid":
        """From a batch in the order of `numpy.meshgrid(..., indexing="ij")`."""
        shape = tuple(len(axis.shown) for axis in axes)
        sound = faults == 0
        results = {
            name: np.where(sound, values, np.nan).reshape(shape)
            for name, values in vars(metrics).items()
        }
        return cls(axes, results, faults.reshape(shape), limits, title)

    @property
    def sound(self) -> Bool[np.ndarray, "*grid"]:
        """Where the simulation can be trusted."""
        return self.faults == 0

    def shown(self, name: str) -> Float[np.ndarray, "*grid"]:
        """A result in the unit it is shown in."""
        return self.results[name] * quantity(name).factor

    def warnings(self) -> list[str]:
        """How many points have no results, and why; where the roller lifts or the oil cavitates."""
        said = []
        total = self.faults.size
        for fault, sentence in EXPLANATIONS.items():
            count = int(np.count_nonzero(self.faults & fault))
            if count:
                said.append(f"{count} of {total} points have no results: {sentence}.")
        for name, words in LIMITS.items():
            count = int(np.count_nonzero(self.results[name] < 0))
            if count:
                said.append(f"{count} of {total} points: {words}.")
        return said

    def why(self, place: tuple[int, ...]) -> str:
        """The faults at one point in words; empty when sound."""
        return Verdict(jnp.asarray(self.faults[place])).explain()


# Results that must not fall below zero, with what happens there.
LIMITS = {
    "min_contact_force": "the roller lifts off the ring",
    "vapour_margin": "the chamber pressure falls below the vapour pressure (cavitation)",
}


@cache
def si_units() -> dict[str, str]:
    """SI units of the results by name, as their annotations have them."""
    hints: dict[str, Any] = get_type_hints(Metrics, include_extras=True)
    return {name: str(get_args(hint)[1]) for name, hint in hints.items()}


@cache
def quantity(name: str) -> Quantity:
    """How a result is shown: as in every report, or in SI where no report shows it."""
    known = QUANTITIES.get(name)
    if known is not None:
        return known
    plain = QUANTITIES.get(name.removesuffix("_true_rms"))
    if plain is not None:
        label = f"{plain.label.removesuffix(', one-sided')}, true rms"
        return replace(plain, name=name, label=label)
    words = name.replace("_", " ")
    unit = si_units()[name]
    if unit == "Pa":
        return Quantity(name, f"{words[:1].upper()}{words[1:]}", "bar", 1e-5)
    if unit == "m":
        return Quantity(name, f"{words[:1].upper()}{words[1:]}", "mm", 1e3)
    return Quantity(name, f"{words[:1].upper()}{words[1:]}", "" if unit == "1" else unit, 1.0)


def result_names() -> tuple[str, ...]:
    """Every result there is, by its name of model.md section 10."""
    return tuple(si_units())


def plain_unit(unit: str) -> str:
    """A unit in letters that every spreadsheet reads: `cm^3/rev`, `N.m`; `1` for none."""
    return unit.translate(_ASCII) or "1"


__all__ = [
    "LIMITS",
    "Axis",
    "Grid",
    "plain_unit",
    "quantity",
    "result_names",
]
