"""Every result a second time, by a solver that shares no formula with the first.

The product computes a cycle with JAX on a fixed mesh. This package reads the
same nouns into plain floats and computes docs/theory.md section 10 with SciPy: splines
from `scipy.interpolate`, the periodic pressure by LSODA between kinks, spectra by
Gauss quadrature, extremes by search. `camring optimise` validates with it, and
the tests compare the two.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from camring.reference.cooling import OPEN, found_rise
from camring.reference.failure import NoSecondSolver, OrbitError
from camring.reference.machine import Machine, machine_of
from camring.reference.orbit import Orbit, periodic_orbit
from camring.reference.parts import Manifold, Manifolds, Oil, Window
from camring.reference.results import results
from camring.reference.shape import NotStarShapedError
from camring.reference.user_laws import FRICTIONS, LEAKAGES, Friction, Rubbing

__all__ = [
    "FRICTIONS",
    "LEAKAGES",
    "Friction",
    "IndependentSolution",
    "Machine",
    "Manifold",
    "Manifolds",
    "NoSecondSolver",
    "NotStarShapedError",
    "Oil",
    "Orbit",
    "OrbitError",
    "Rubbing",
    "Window",
    "independent_results",
    "independent_solution",
    "machine_of",
    "results_of_machine",
    "solve_machine",
]


@dataclass(frozen=True)
class IndependentSolution:
    """An orbit, its results, and what a reader should know about them."""

    results: dict[str, float]
    notes: tuple[str, ...]
    orbit: Orbit


def solve_machine(
    machine: Machine, harmonics: int = 600, tolerance: float = 1e-10
) -> IndependentSolution:
    """Solve from plain numbers. Raises `OrbitError` or `NotStarShapedError`."""
    orbit = periodic_orbit(machine, tolerance)
    found = results(orbit, harmonics)
    return IndependentSolution(found, tuple(_notes(machine, orbit, found)), orbit)


def _notes(machine: Machine, orbit: Orbit, found: dict[str, float]) -> list[str]:
    notes = []
    if found["min_volume"] <= 0:
        notes.append("chamber volume falls to zero or below")
    if found["min_undercut_factor"] <= 0:
        notes.append("the working surface is undercut")
    if found["min_contact_force"] < 0:
        notes.append("the roller lifts off the ring")
    if found["min_pressure"] < machine.oil.vapour_pressure:
        notes.append("chamber pressure falls below the vapour pressure")
    if orbit.multiplier > 0.9:
        notes.append(
            f"nearly trapped oil: a pressure disturbance keeps {orbit.multiplier:.4f} of itself"
        )
    return notes


def independent_solution(
    motor: Any, fluid: Any, point: Any, harmonics: int = 600, tolerance: float = 1e-10
) -> IndependentSolution:
    """Solve one motor at one operating point; the nouns of `camring.physics`."""
    machine = machine_of(motor, fluid, point)
    if machine.cooling is None:
        return solve_machine(machine, harmonics, tolerance)

    def at(rise: float, highest: int) -> IndependentSolution:
        return solve_machine(machine_of(motor, fluid, point, rise), highest, tolerance)

    rise = found_rise(lambda rise: at(rise, 0).results[OPEN], machine.cooling)
    return at(rise, harmonics)


def independent_results(
    motor: Any, fluid: Any, point: Any, harmonics: int = 600, tolerance: float = 1e-10
) -> dict[str, float]:
    """Results of docs/theory.md section 10 under its names, SI.

    Parameters
    ----------
    harmonics
        Highest shaft order of the ripple sums.
    tolerance
        Of the pressure solver, relative to the pressure difference of the ports;
        1e-10 gives results good to about 1e-8, 1e-8 to about 1e-6 at half the time.
    """
    return results_of_machine(
        independent_solution(motor, fluid, point, harmonics, tolerance).results
    )


def results_of_machine(found: Mapping[str, float]) -> dict[str, float]:
    """Those of `solve_machine` that docs/theory.md names."""
    return {name: value for name, value in found.items() if name != OPEN}
