"""A design over its envelope, some points at a time so that the hand never waits for it."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from typing import Any

import jax
import numpy as np

from camring.evaluation.batch import batch_faults, solve_batch
from camring.evaluation.envelope_batch import SEARCHED, prepared
from camring.evaluation.envelope_outcome import search_grid
from camring.evaluation.simulations import part_of
from camring.files.motor import MotorFile
from camring.metrics.shown import METRICS
from camring.objective.constraints import at_point
from camring.objective.envelope import conditions_of, names_in_envelope
from camring.physics.batch_cycle import fits
from camring.physics.envelope import Envelope, EnvelopeGrid
from camring.physics.system import System
from camring.programs.compiled import simulate, summarise
from camring.studies.envelope_grid import BOTH_WAYS as FINE_BOTH_WAYS
from camring.studies.envelope_grid import ONE_WAY as FINE_ONE_WAY
from camring.studies.envelope_grid import usual_envelope
from camring.studio.evaluation import named

SHOWN = ("torque_ripple", "efficiency", "max_contact_stress", "min_pressure")
"""Results that the map can show beside the limits."""


@dataclass(frozen=True, eq=False)
class Range:
    """Where a file's motor must run, and whether the file says so itself."""

    envelope: Envelope
    asked: bool
    coarse: EnvelopeGrid
    fine: EnvelopeGrid

    @classmethod
    def of(cls, file: MotorFile) -> "Range | None":
        """None for a motor without a pressure drop to drive it."""
        if file.envelope is None:
            drops = [float(each.pressure_drop) for each in file.system.operating_points]
            if max(drops) <= 0:
                return None
        envelope = file.envelope or usual_envelope(file.system)
        fine = FINE_BOTH_WAYS if envelope.both_directions else FINE_ONE_WAY
        return cls(envelope, file.envelope is not None, search_grid(envelope), envelope.grid(*fine))


@dataclass(frozen=True, eq=False)
class Over:
    """A design at the points of a grid: limits (limit, point) and results (result, point)."""

    names: tuple[str, ...]
    limits: np.ndarray
    results: np.ndarray


AT_ONCE = 8
"""Points in one step: as many as a processor takes side by side."""


def steps(grid: EnvelopeGrid) -> int:
    """How many steps `mapped` takes."""
    return ceil(grid.count / AT_ONCE)


def mapped(
    file: MotorFile, system: System, where: Range, grid: EnvelopeGrid
) -> Iterator[Over | None]:
    """None after every step but the last, then the whole."""
    constraints = file.goal.constraints
    names = names_in_envelope(constraints)
    limits = np.full((len(names), grid.count), np.nan)
    results = np.full((len(METRICS), grid.count), np.nan)
    side_by_side = fits(system.motor)
    designs = None
    if side_by_side:
        conditions = conditions_of(where.envelope, grid)
        designs = jax.device_get(prepared(system, conditions))
    for start in range(0, grid.count, AT_ONCE):
        stop = min(start + AT_ONCE, grid.count)
        if designs is not None:
            found, faults = _batch(designs, start, file.goal.harmonics)
        else:
            found, faults = _one_by_one(system, where, grid, range(start, stop), file)
        results[:, start:stop] = np.where(faults, np.nan, found)[:, : stop - start]
        drop: Any = grid.pressure_drop[start:stop]
        said = at_point(constraints, system, drop, named(results[:, start:stop]))
        for row, name in enumerate(names):
            limits[row, start:stop] = np.broadcast_to(np.asarray(said[name]), drop.shape)
        if stop < grid.count:
            yield None
    yield Over(names, limits, np.stack([results[METRICS.index(name)] for name in SHOWN]))


def _batch(designs: System, start: int, harmonics: int) -> tuple[np.ndarray, np.ndarray]:
    cycles, metrics = solve_batch(part_of(designs, start, AT_ONCE), harmonics, SEARCHED)
    found, faults = jax.device_get((metrics[0], batch_faults(cycles)))
    return np.stack([getattr(found, name) for name in METRICS]), faults[0] != 0


def _one_by_one(
    system: System, where: Range, grid: EnvelopeGrid, places: range, file: MotorFile
) -> tuple[np.ndarray, np.ndarray]:
    """For motors that cannot be simulated side by side."""
    rows, faults = [], []
    for place in places:
        fluids = where.envelope.fluids
        fluid = fluids[grid.fluid[place]] if fluids else system.fluid
        cycle = simulate(system.motor, fluid, grid.operating_point(place))
        found = jax.device_get((summarise(cycle, file.goal.harmonics), cycle.verdict.code))
        rows.append([float(getattr(found[0], name)) for name in METRICS])
        faults.append(bool(found[1]))
    return np.array(rows).T, np.array(faults)
