"""What may change: a box of variables, and the system at each of its points.

`Variable` moves numbers of the system between bounds, `CamModes` shapes the
cam. Points are coordinates in [0, 1]; the given system lies inside the box.
"""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.cam import AbstractCam
from camring.numerics.compilation import one_program
from camring.numerics.quantity import ArrayLike, real
from camring.objective.cam_modes import CamModes, control_values
from camring.physics.system import System

DocumentValue = float | list[float] | list[list[float]]


def leaf(path: str) -> Callable[[System], Array]:
    """The function that takes the leaf at a path, `motor.piston.bore`, out of a system.

    A whole number in it is a place: `operating_points.0.shaft_speed`. The function raises
    AttributeError for a system that does not have it.
    """
    parts = path.split(".")

    def take(system: System) -> Array:
        here: Any = system
        for part in parts:
            here = here[int(part)] if part.isdigit() else getattr(here, part)
        if here is None:
            raise AttributeError(f"this system has no {path}")
        return here

    return take


def with_leaves(system: System, paths: Iterable[str], new: Callable[[Array], Array]) -> System:
    """The system with the leaves at some paths replaced by a function of what was there."""
    for path in paths:
        given = leaf(path)(system)
        system = eqx.tree_at(leaf(path), system, jnp.asarray(new(given), given.dtype))
    return system


class Variable(eqx.Module):
    """One coordinate: a number of the system, or several that move together.

    Attributes
    ----------
    keys
        Their paths in the motor file; the first names the variable.
    leaves
        For each key the leaves that hold it.
    low, high
        Bounds in SI; of the change as a share of the given value if `relative`.
    """

    keys: tuple[str, ...] = eqx.field(static=True)
    leaves: tuple[tuple[str, ...], ...] = eqx.field(static=True)
    low: Float[Array, ""] = eqx.field(converter=real)
    high: Float[Array, ""] = eqx.field(converter=real)
    relative: bool = eqx.field(static=True, default=False)

    @property
    def name(self) -> str:
        return self.keys[0]

    def apply(self, system: System, unit: ArrayLike) -> System:
        """The system with this coordinate at `unit`."""
        reached = self.low + unit * (self.high - self.low)
        paths = (path for paths in self.leaves for path in paths)
        return with_leaves(
            system, paths, lambda given: given * (1 + reached) if self.relative else reached
        )

    def locate(self, system: System) -> Float[np.ndarray, ""]:
        """The coordinate of the given system."""
        given = 0.0 if self.relative else np.asarray(leaf(self.leaves[0][0])(system))
        low, high = np.asarray(self.low), np.asarray(self.high)
        return (given - low) / (high - low)


class AbstractSpace(eqx.Module):
    """Coordinates, and the system at each of their points."""

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """A name for each coordinate."""

    @property
    def dimension(self) -> int:
        """How many coordinates there are."""
        return len(self.names)

    @abstractmethod
    def apply(self, system: System, unit_point: ArrayLike) -> System:
        """The system of one point; traceable, differentiable, batched with `vmap`."""


class DesignSpace(AbstractSpace):
    """A box of designs around a given system.

    Every method takes that system, so a space is only the statement of what
    may change and by how much.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> file.design_space.names, file.design_space.locate(file.system).round(6).tolist()
    (('motor.valve_plate.shift', 'motor.dead_volume'), [0.5, 0.5])
    >>> larger = file.design_space.apply(file.system, [0.5, 1.0])
    >>> round(float(larger.motor.dead_volume) * 1e6, 3)  # cm3
    6.0
    """

    variables: tuple[Variable, ...] = ()
    cam: CamModes | None = None
    cam_key: str = eqx.field(static=True, default="motor.cam.control_radii")

    @property
    def names(self) -> tuple[str, ...]:
        """A name for each coordinate."""
        names = tuple(variable.name for variable in self.variables)
        return names + (self.cam.names if self.cam is not None else ())

    def apply(self, system: System, unit_point: ArrayLike) -> System:
        """The system of one design; traceable, differentiable, batched with `vmap`.

        Parameters
        ----------
        system
            The given one.
        unit_point
            Coordinates in [0, 1]; outside, the variables simply go on.
        """
        point = real(unit_point)
        system = self._moved(system, point)
        if self.cam is None:
            return system
        cam = self.cam.apply(system.motor.cam, point[len(self.variables) :])
        return eqx.tree_at(lambda each: each.motor.cam, system, cam)

    def locate(self, system: System) -> Float[np.ndarray, " coordinate"]:
        """The given system's own point."""
        point = [float(variable.locate(system)) for variable in self.variables]
        modes = self.cam.dimension if self.cam is not None else 0
        return np.clip(np.array(point + [0.5] * modes), 0.0, 1.0)

    def document_values(
        self, system: System, unit_point: Sequence[float] | Float[np.ndarray, " coordinate"]
    ) -> dict[str, DocumentValue]:
        """What a motor file of this design says: key -> SI number or list of them."""
        point = np.asarray(unit_point, dtype=float)
        design = self._moved(system, point)
        values: dict[str, DocumentValue] = {
            key: float(leaf(paths[0])(design))
            for variable in self.variables
            for key, paths in zip(variable.keys, variable.leaves, strict=True)
        }
        if self.cam is not None:
            cam = _cam_of(self.cam, design.motor.cam, point[len(self.variables) :])
            design = eqx.tree_at(lambda each: each.motor.cam, design, cam)
            values[self.cam_key] = np.asarray(leaf(self.cam_key)(design)).tolist()
        return values

    def _moved(self, system: System, point: Float[Array, " coordinate"] | np.ndarray) -> System:
        """With all coordinates but the cam's; of plain numbers without a program."""
        for place, variable in enumerate(self.variables):
            system = variable.apply(system, point[place])
        return system

    def describe(
        self, system: System, unit_point: Sequence[float] | Float[np.ndarray, " coordinate"]
    ) -> dict[str, float]:
        """The value of each coordinate in SI: numbers as they are, mode amplitudes in m."""
        design = self._moved(system, np.asarray(unit_point, dtype=float))
        values = {v.name: float(leaf(v.leaves[0][0])(design)) for v in self.variables}
        if self.cam is not None:
            modes = np.asarray(unit_point, dtype=float)[len(self.variables) :]
            amplitudes = (2 * modes - 1) * np.asarray(self.cam.bounds())
            values.update(zip(self.cam.names, amplitudes.tolist(), strict=True))
        return values


@one_program
def _cam_of(
    modes: CamModes, cam: AbstractCam, unit_point: Float[np.ndarray, " coordinate"]
) -> AbstractCam:
    return modes.apply(cam, unit_point)


__all__ = [
    "AbstractSpace",
    "CamModes",
    "DesignSpace",
    "Variable",
    "control_values",
    "leaf",
    "with_leaves",
]
