"""The rows of a measured table, simulated: values of a motor's results and their slopes."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from camring.files.errors import CamringError
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.fitting.batch_rows import BenchRows
from camring.fitting.fitted_numbers import FittedNumber, numbers_named, space_of
from camring.fitting.measurements.operating_points import operating_points_of
from camring.fitting.measurements.table import MeasuredTable
from camring.numerics.verdict import Verdict

Point = Float[np.ndarray, " number"]
Seen = tuple[Float[np.ndarray, " value"], Float[np.ndarray, "value number"]]


class Bench:
    """Rows of a table as a model that gives values and slopes.

    Attributes
    ----------
    rows, group, results
        Of each measured value: its row, the place and the name of its result.
    measured, given_deviation
        SI; NaN where no standard deviation is given.
    distinct, of_row
        Rows whose operating point and oil no row above has, each simulated once; and of
        every row its place among them.
    """

    def __init__(
        self, file: MotorFile, table: MeasuredTable, numbers: tuple[FittedNumber, ...]
    ) -> None:
        self.file, self.table, self.numbers = file, table, numbers
        # The usual numbers have slopes in any case: fits of any of them are one program.
        self._moved = tuple({n.key: n for n in (*numbers_named(file, None), *numbers)}.values())
        moved = [each.key for each in self._moved]
        self._chosen = [moved.index(each.key) for each in numbers]
        self.operating_points = operating_points_of(file, table)
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
        self.distinct, self.of_row = _distinct(self.operating_points)
        self._simulated = BenchRows(
            space_of(self._moved),
            file.system.motor,
            [self.operating_points[row] for row in self.distinct],
            self.names,
            file.goal.harmonics,
        )

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
        whole = np.array([each.given / each.scale for each in self._moved])
        whole[self._chosen] = scaled
        found = self._simulated(whole)
        for row, fault in zip(self.distinct, found.faults.tolist(), strict=True):
            if fault:
                self.faults[row] = Verdict(jnp.asarray(fault)).explain()
        places = [self.of_row[row] for row in self.rows]
        cells = list(zip(places, self.results, strict=True))
        sound = found.faults[places] == 0
        values = np.where(sound, [found.values[name][place] for place, name in cells], np.nan)
        slopes = np.array([found.slopes[name][self._chosen, place] for place, name in cells])
        return values, steps * slopes

    def require_sound(self, values: np.ndarray) -> None:
        """Raises where the fit would begin with rows that cannot be simulated."""
        if np.all(np.isfinite(values)):
            return
        row = int(self.rows[np.flatnonzero(~np.isfinite(values))[0]])
        first = self.distinct[self.of_row[row]]
        reason = self.faults.get(first, "a result is not a finite number")
        raise CamringError(
            f"{self.table.where(row)} cannot be simulated with the numbers of "
            f"{self.file.path.name}: {reason}."
        )


def _distinct(operating_points: list) -> tuple[list[int], list[int]]:
    """First rows of each operating point and oil, and which of them every row repeats."""
    seen: dict[tuple, int] = {}
    first: list[int] = []
    places: list[int] = []
    for row, entry in enumerate(operating_points):
        key = tuple(np.asarray(leaf).tobytes() for leaf in jax.tree.leaves(entry))
        if key not in seen:
            seen[key] = len(first)
            first.append(row)
        places.append(seen[key])
    return first, places
