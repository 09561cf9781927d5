"""A design under the hand: the numbers of a file with some of them moved.

A file is read anew when the hand lets go. While it moves, only leaves of the system change,
which takes a thousandth of the time and compiles nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import numpy as np

from camring.files.motor import MotorFile
from camring.files.motor.entries import Number
from camring.files.motor.keys import key_map
from camring.physics.system import System
from camring.programs.motor_program import named

_OF_A_POINT = {
    "speed": "shaft_speed",
    "supply_pressure": "supply_pressure",
    "return_pressure": "return_pressure",
    "case_pressure": "case_pressure",
    "weight": "weight",
}


@dataclass(frozen=True, eq=False)
class Movable:
    """The system of a file as a list of numbers, and where each key of the file is among them."""

    file: MotorFile

    @cached_property
    def _flat(self) -> tuple[list[np.ndarray], Any, dict[str, int]]:
        # A name is no number; without one all motors of a kind are one program.
        system = named(self.file.system, "")
        found, structure = jax.tree_util.tree_flatten_with_path(system)
        places = {_name(path): at for at, (path, _) in enumerate(found)}
        return [np.asarray(leaf) for _, leaf in found], structure, places

    @cached_property
    def places(self) -> dict[str, tuple[int, ...]]:
        """Of every number of motor, oil and operating points that can be moved."""
        leaves = self._flat[2]
        found: dict[str, tuple[int, ...]] = {}
        for path, entry in key_map(self.file.choices).items():
            if path.startswith("operating_points."):
                key = path.rpartition(".")[2]
                for k in range(len(self.file.system.operating_points)):
                    at = leaves.get(f"operating_points.{k}.{_OF_A_POINT.get(key, '')}")
                    if at is not None:
                        found[f"operating_points[{k}].{key}"] = (at,)
            elif isinstance(entry, Number) and entry.leaves and entry.leaves[0] in leaves:
                found[path] = tuple(leaves[each] for each in entry.leaves)
        if isinstance(self.file.document["motor"]["cam"].get("reference_radius", ""), str):
            found.pop("motor.cam.reference_radius", None)
        return found

    @property
    def control_place(self) -> int:
        """Of the cam's control values."""
        leaves = self._flat[2]
        for name in ("control_radii", "control_points"):
            if f"motor.cam.{name}" in leaves:
                return leaves[f"motor.cam.{name}"]
        raise KeyError("control values")

    @property
    def system(self) -> System:
        """As the file has it; its motor has no name."""
        leaves, structure, _ = self._flat
        return jax.tree.unflatten(structure, leaves)

    def values(self) -> dict[str, float]:
        """SI numbers by path, as the system has them."""
        leaves = self._flat[0]
        return {path: float(leaves[at[0]]) for path, at in self.places.items()}

    def moved(
        self, values: Mapping[str, float], controls: np.ndarray | None = None
    ) -> System | None:
        """The system with other numbers; None where one of them needs the file to be read anew.

        The case pressure follows the return pressure where the file gives it none.
        """
        leaves, structure, names = self._flat
        leaves = list(leaves)
        for path, value in values.items():
            if path not in self.places:
                return None
            for at in self.places[path]:
                leaves[at] = np.asarray(value, leaves[at].dtype)
            if path.endswith("].return_pressure"):
                k = int(path.split("[")[1].split("]")[0])
                if "case_pressure" not in self.file.document["operating_points"][k]:
                    at = names[f"operating_points.{k}.case_pressure"]
                    leaves[at] = np.asarray(value, leaves[at].dtype)
        if controls is not None:
            leaves[self.control_place] = np.asarray(controls, leaves[self.control_place].dtype)
        return jax.tree.unflatten(structure, leaves)


def _name(path: tuple[Any, ...]) -> str:
    parts = [getattr(each, "name", getattr(each, "idx", getattr(each, "key", ""))) for each in path]
    return ".".join(str(part) for part in parts)
