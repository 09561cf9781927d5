"""The rows of a measured table, simulated: values of a motor's results and their slopes."""

from concurrent.futures import ThreadPoolExecutor

import jax
import numpy as np
from jaxtyping import Bool, Float

from camring.interfaces.compiled import simulate_compiled
from camring.interfaces.config import MotorFile
from camring.interfaces.config.document import printable
from camring.interfaces.errors import CamringError
from camring.interfaces.evaluator import applied
from camring.interfaces.fitted_numbers import FittedNumber, space_of
from camring.interfaces.many import cores
from camring.interfaces.measured_duties import duties_of
from camring.interfaces.measured_table import MeasuredTable
from camring.interfaces.motor_program import motor_program
from camring.numerics.verdict import Verdict
from camring.objective.measurable import measurable_slopes
from camring.objective.slopes import Operated, directions
from camring.physics.system import System

Point = Float[np.ndarray, " number"]
Seen = tuple[Float[np.ndarray, " value"], Float[np.ndarray, "value number"]]

TOGETHER = 8
"""Directions in one call: the same compiled program for any number of numbers up to it."""

_directions = motor_program(directions)
_slopes = motor_program(measurable_slopes)


class Bench:
    """Rows of a table as a model that gives values and slopes.

    Attributes
    ----------
    rows, group, results
        Of each measured value: its row, the place and the name of its result.
    measured, given_deviation
        SI; NaN where no standard deviation is given.
    """

    def __init__(
        self, file: MotorFile, table: MeasuredTable, numbers: tuple[FittedNumber, ...]
    ) -> None:
        self.file, self.table, self.numbers = file, table, numbers
        self.space = space_of(numbers)
        self.duties = duties_of(file, table)
        self.names = tuple(table.values)
        cells = [
            (row, place)
            for place, name in enumerate(self.names)
            for row in np.flatnonzero(np.isfinite(table.values[name]))
        ]
        self.rows = np.array([row for row, _ in cells])
        self.group = np.array([place for _, place in cells])
        self.results = tuple(self.names[place] for place in self.group)
        self.measured = np.array([table.values[self.names[p]][row] for row, p in cells])
        self.given_deviation = np.array([table.deviations[self.names[p]][row] for row, p in cells])
        self.start = np.array([each.start for each in numbers])
        self.faults: dict[int, str] = {}

    @property
    def name(self) -> str:
        """Of the table, for messages."""
        return printable(self.table.path)

    def at(self, some: Point, chosen: Bool[np.ndarray, " number"]) -> Seen:
        """Values and slopes with some numbers moved, the others as given."""
        point = np.array([each.as_given for each in self.numbers])
        point[chosen] = some
        values, slopes = self(point)
        return values, slopes[:, chosen]

    def as_given(self) -> Float[np.ndarray, " value"]:
        """Values of the motor file as it stands."""
        return self(np.array([each.as_given for each in self.numbers]))[0]

    def __call__(self, point: Point) -> Seen:
        """Values, NaN where a row cannot be simulated, and slopes by the coordinates."""
        numbers = self.numbers
        scaled = np.array([n.value(x) / n.scale for n, x in zip(numbers, point, strict=True)])
        steps = np.where([n.by_logarithm for n in numbers], scaled, 1.0)
        motor, goal = self.file.system.motor, self.file.goal
        along = _directions(self.space, System(motor, self.file.system.fluid, ()), scaled)
        spare = -len(point) % TOGETHER

        def padded(leaf: np.ndarray) -> np.ndarray:
            return np.concatenate([leaf, np.zeros((spare, *leaf.shape[1:]))])

        still = jax.tree.map(lambda each: np.zeros((len(point), *each.shape)), self.duties[0][0])
        moved = jax.tree.map(padded, jax.device_get(Operated(along.motor, along.fluid, still)))

        def row(number: int) -> tuple:
            duty, fluid = self.duties[number]
            here = applied(self.space, System(motor, fluid, ()), scaled)
            cycle = simulate_compiled(here.motor, here.fluid, duty, None)
            fault = int(cycle.verdict.code)
            if fault:
                self.faults[number] = Verdict(cycle.verdict.code).explain()
            return fault, *jax.device_get(_slopes(cycle, moved, self.names, goal.harmonics))

        with ThreadPoolExecutor(cores()) as pool:
            rows = list(pool.map(row, range(len(self.duties))))
        places = list(zip(self.rows, self.results, strict=True))
        values = np.array([np.nan if rows[r][0] else rows[r][1][name] for r, name in places])
        slopes = np.array([rows[r][2][name][: len(point)] for r, name in places])
        return values, steps * slopes

    def require_sound(self, values: np.ndarray) -> None:
        """Raises where the fit would begin with rows that cannot be simulated."""
        if np.all(np.isfinite(values)):
            return
        row = int(self.rows[np.flatnonzero(~np.isfinite(values))[0]])
        reason = self.faults.get(row, "a result is not a finite number")
        raise CamringError(
            f"{self.table.where(row)} cannot be simulated with the numbers of "
            f"{self.file.path.name}: {reason}."
        )
