"""The lines between the ports and their manifolds in the second solver: flows and losses."""

from dataclasses import dataclass

import numpy as np

from camring.reference.chamber import Chamber
from camring.reference.parts import Manifold

__all__ = ["AtWindows", "at_windows"]


@dataclass(frozen=True)
class AtWindows:
    """At some angles; levels are powers for each unit of flow: pressures, or enthalpies."""

    before: np.ndarray  # pressure at the supply windows
    behind: np.ndarray  # pressure at the return windows
    level_before: np.ndarray
    level_behind: np.ndarray
    supply_loss: np.ndarray  # power that the line to the supply manifold takes
    return_loss: np.ndarray  # power that the line from the return manifold takes


def at_windows(chamber: Chamber, angle: np.ndarray) -> AtWindows:
    """What oil is worth at both kinds of windows, and what it has lost or has yet to lose."""
    m = chamber.machine
    before, behind = chamber.supply_at(angle), chamber.return_at(angle)
    if chamber.oil.aerated:
        ports = chamber.oil.enthalpy(np.array([m.supply_pressure, m.return_pressure]))
        at_supply, at_return = (float(each) for each in ports)
    else:
        at_supply, at_return = m.supply_pressure, m.return_pressure
    level_before = _levels(chamber, before, m.manifolds.supply, at_supply)
    level_behind = _levels(chamber, behind, m.manifolds.return_, at_return)
    fed = _through(chamber, m.manifolds.supply, m.supply_pressure, before)
    emptied = _through(chamber, m.manifolds.return_, behind, m.return_pressure)
    return AtWindows(
        before,
        behind,
        level_before,
        level_behind,
        fed * (at_supply - level_before),
        emptied * (level_behind - at_return),
    )


def _levels(
    chamber: Chamber, pressure: np.ndarray, manifold: Manifold | None, at_port: float
) -> np.ndarray:
    if manifold is None:
        return np.full(len(pressure), at_port)
    return chamber.oil.enthalpy(pressure) if chamber.oil.aerated else pressure


def _through(
    chamber: Chamber,
    manifold: Manifold | None,
    start: "float | np.ndarray",
    end: "float | np.ndarray",
) -> np.ndarray:
    """Down a line: volumes a second, or masses if aerated."""
    here, there = np.atleast_1d(start), np.atleast_1d(end)
    if manifold is None:
        return np.zeros(max(len(here), len(there)))
    flow = manifold.line_conductance * (here - there)
    if chamber.oil.aerated:
        rho = np.vectorize(chamber.oil.density, otypes=[float])
        flow = flow * (rho(here) + rho(there)) / 2
    return flow
