"""Manifolds at the windows in the second solver: all chambers marched together.

At one instant the pistons stand at `copies` different places of the cam's
period, equally far apart. So one part of the period, followed by LSODA with
a state for each place and one for each manifold, holds everything: at its end each
place is where the next one was, and a manifold must be where it began. That
map's fixed point is found by Newton with a Jacobian from differences.
"""

import warnings
from collections.abc import Callable
from itertools import pairwise
from math import exp, expm1, inf, lcm, log

import numpy as np
from scipy.integrate import ODEintWarning, odeint

from camring.reference.chamber import Chamber
from camring.reference.failure import OrbitError
from camring.reference.series import NODES, PeriodicSeries, series_of

FINEST = 1e-9  # shortest element, of the part of the period
ROUGH = 1e-6  # tolerance of the first marches and of the Jacobian
NUDGE = 1e-3  # step of the Jacobian's differences


class _Together:
    """Chambers at all places and, last, the manifolds, over one part of the cam's period.

    States are numbers of the size of one: pressure above the return's over the
    pressure difference, or the logarithm of their ratio for oil with air in it.
    """

    def __init__(self, chamber: Chamber) -> None:
        m = chamber.machine
        self.chamber = chamber
        self.supply, self.return_ = m.manifolds.supply, m.manifolds.return_
        self.set_pressures = [
            pressure
            for manifold, pressure in (
                (self.supply, m.supply_pressure),
                (self.return_, m.return_pressure),
            )
            if manifold is not None
        ]
        self.copies = lcm(m.pistons, m.repeats) // m.repeats
        self.alike = m.pistons // self.copies
        self.part = chamber.curve.period / self.copies
        folded = np.sort((chamber.edges[:-1] - chamber.start) % self.part)
        edges = np.concatenate([[0.0], folded, [self.part]])
        keep = np.concatenate([[True], np.diff(edges) > 1e-13 * chamber.curve.period])
        edges = edges[keep]
        edges[-1] = self.part
        self.edges = chamber.start + edges

    def state(self, pressure: float) -> float:
        base = self.chamber.machine.return_pressure
        if self.chamber.oil.logarithmic:
            return log(pressure / base)
        return (pressure - base) / self.chamber.scale

    def pressure(self, state: np.ndarray) -> np.ndarray:
        base = self.chamber.machine.return_pressure
        if self.chamber.oil.logarithmic:
            return base * np.exp(state)
        return base + self.chamber.scale * state

    def first_guess(self) -> np.ndarray:
        """Every place at the pressure of its open window, the manifolds at their set pressures."""
        m, chamber = self.chamber.machine, self.chamber
        found = []
        for k in range(self.copies):
            at = chamber.start + self.part * k
            near = chamber.nearest_centre(m.supply, at)
            open_ = chamber.supply_opening(at - near) > 0
            found.append(self.state(m.supply_pressure if open_ else m.return_pressure))
        return np.array([*found, *map(self.state, self.set_pressures)])

    def shifted(self, state: np.ndarray) -> np.ndarray:
        """States at the end of the part, each under the name of the place it has come to."""
        return np.concatenate([np.roll(state[: self.copies], 1), state[self.copies :]])

    def rates(self, start: float, end: float) -> Callable[[np.ndarray, float], list[float]]:
        """(states, theta) -> their slopes, on a stretch where no place has a kink."""
        chamber, m, oil = self.chamber, self.chamber.machine, self.chamber.oil
        in_, back = chamber.through_supply, chamber.through_return
        supply_port, return_port = m.port_of(m.supply), m.port_of(m.return_)
        rho, rho_slope = oil.density, oil.density_slope
        places = []
        for k in range(self.copies):
            offset = self.part * k
            middle = (start + end) / 2 + offset
            supply_at = chamber.nearest_centre(m.supply, middle) - offset
            return_at = chamber.nearest_centre(m.return_, middle) - offset
            places.append((offset, chamber.motion(middle), supply_at, return_at))
        base, unit, speed = m.return_pressure, chamber.scale, m.shaft_speed
        leak, case, beta = m.leakage, m.case_pressure, m.oil.bulk_modulus
        copies, feeding, emptying = self.copies, self.supply, self.return_
        set_supply, set_return = self.state(m.supply_pressure), self.state(base)
        set_pressure, density, alike = m.supply_pressure, m.oil.density, self.alike
        supply_open, return_open = chamber.supply_opening, chamber.return_opening
        rho_set, rho_return, rho_case = (rho(p) for p in (set_pressure, base, case))

        def split(states: np.ndarray) -> tuple[list[float], float, float]:
            """Chambers, and what stands before the supply and behind the return windows."""
            values = states.tolist()
            before = values[copies] if feeding is not None else set_supply
            behind = values[-1] if emptying is not None else set_return
            return values[:copies], before, behind

        def stiff(states: np.ndarray, angle: float) -> list[float]:
            chambers, before, behind = split(states)
            drawn, given, slopes = 0.0, 0.0, []
            for y, (offset, motion, supply_at, return_at) in zip(chambers, places, strict=True):
                volume, swept = motion(angle + offset)
                net = -leak(base + unit * y, case)
                share = supply_open(angle - supply_at)
                if share > 0:
                    through = in_(supply_port * share, unit * (before - y), density)
                    drawn += through
                    net += through
                share = return_open(angle - return_at)
                if share > 0:
                    through = back(return_port * share, unit * (behind - y), density)
                    given -= through
                    net += through
                slopes.append(beta * (net / speed - swept) / (volume * unit))
            if feeding is not None:
                fed = feeding.line_conductance * (set_pressure - base - unit * before)
                slopes.append(beta * (fed - alike * drawn) / (speed * feeding.volume * unit))
            if emptying is not None:
                left = emptying.line_conductance * unit * behind
                slopes.append(beta * (alike * given - left) / (speed * emptying.volume * unit))
            return slopes

        logarithmic = oil.logarithmic

        def aerated(states: np.ndarray, angle: float) -> list[float]:
            chambers, last_before, last_behind = split(states)
            before = base * exp(last_before) if logarithmic else base + unit * last_before
            above_return = base * expm1(last_behind) if logarithmic else unit * last_behind
            behind = base + above_return
            rho_before, rho_behind = rho(before), rho(behind)
            drawn, given, slopes = 0.0, 0.0, []
            for y, (offset, motion, supply_at, return_at) in zip(chambers, places, strict=True):
                volume, swept = motion(angle + offset)
                above = base * expm1(y) if logarithmic else unit * y
                pressure = base + above
                here = rho(pressure)
                net = -(here + rho_case) / 2 * leak(pressure, case)
                share = supply_open(angle - supply_at)
                if share > 0:
                    mean = (here + rho_before) / 2
                    through = mean * in_(supply_port * share, before - pressure, mean)
                    drawn += through
                    net += through
                share = return_open(angle - return_at)
                if share > 0:
                    mean = (here + rho_behind) / 2
                    through = mean * back(return_port * share, above_return - above, mean)
                    given -= through
                    net += through
                size = pressure if logarithmic else unit
                slopes.append((net / speed - here * swept) / (volume * rho_slope(pressure) * size))
            if feeding is not None:
                fed = (rho_set + rho_before) / 2 * feeding.line_conductance
                fed *= set_pressure - before
                size = before if logarithmic else unit
                capacity = speed * feeding.volume * rho_slope(before) * size
                slopes.append((fed - alike * drawn) / capacity)
            if emptying is not None:
                left = (rho_return + rho_behind) / 2 * emptying.line_conductance * above_return
                size = behind if logarithmic else unit
                capacity = speed * emptying.volume * rho_slope(behind) * size
                slopes.append((alike * given - left) / capacity)
            return slopes

        return aerated if oil.aerated else stiff

    def march(self, state: np.ndarray, tolerance: float) -> np.ndarray:
        """States at the end of the part, each under its new name."""
        for start, end in pairwise(self.edges.tolist()):
            values, good = _integrate(self.rates(start, end), state, [start, end], tolerance)
            if not good:
                raise OrbitError(f"LSODA failed with the manifold at {start:.6g} rad")
            state = values[-1]
        return self.shifted(state)

    def follow(
        self, state: np.ndarray, tolerance: float
    ) -> tuple[list[PeriodicSeries], np.ndarray]:
        """The same, with the manifolds' pressures as series."""
        finest = FINEST * self.part
        edges: list[float] = [float(self.edges[0])]
        rows: list[list[np.ndarray]] = []
        for start, end in pairwise(self.edges.tolist()):
            rates = self.rates(start, end)
            at, step = start, end - start
            while at < end:
                to = end if at + 1.0001 * step >= end else at + step
                nodes = at + (to - at) / 2 * (NODES + 1)
                values, good = _integrate(rates, state, nodes, tolerance)
                shared = values[:, self.copies :].T if good else ()
                row = [series_of(self.pressure(each)) for each in shared]
                tail = max(float(np.max(np.abs(each[-3:]))) for each in row) if good else inf
                if tail > 3 * tolerance * self.chamber.scale and to - at >= finest:
                    step = (to - at) / 2
                    continue
                if not good:
                    raise OrbitError(f"LSODA failed with the manifold at {at:.6g} rad")
                edges.append(to)
                rows.append(row)
                state, at, step = values[-1], to, 2 * step
        found = [PeriodicSeries(edges, each) for each in zip(*rows, strict=True)]
        return found, self.shifted(state)


def _integrate(
    rates: Callable, state: np.ndarray, at: "list[float] | np.ndarray", tolerance: float
) -> tuple[np.ndarray, bool]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ODEintWarning)  # the message is read instead
        values, report = odeint(
            rates, state, at, rtol=tolerance, atol=tolerance / 10, mxstep=20000, full_output=True
        )
    good = report["message"] == "Integration successful." and bool(np.all(np.isfinite(values)))
    return values, good


def periodic_manifolds(
    chamber: Chamber, tolerance: float
) -> tuple[PeriodicSeries | None, PeriodicSeries | None]:
    """Pressures of supply and return manifold over one part of the cam's period.

    Parameters
    ----------
    chamber
        One that sees the set pressures, of a machine with one manifold or both.
    tolerance
        Of the pressure, relative to the difference of the set ones.
    """
    together = _Together(chamber)
    fine = max(tolerance / 10, 1e-12)
    state = together.first_guess()
    for _ in range(together.copies + 2):  # every chamber forgets the guess
        state = together.march(state, ROUGH)
    inverse, state = _newton_matrix(together, state)
    before = inf
    for _ in range(20):
        series, after = together.follow(state, fine)
        error = float(np.max(np.abs(after - state)))
        if error <= 10 * fine or (error <= 1e3 * fine and error > before / 2):
            there = chamber.machine.manifolds
            return (
                series[0] if there.supply is not None else None,
                series[-1] if there.return_ is not None else None,
            )
        if error > before / 2:
            inverse, state = _newton_matrix(together, state)
            before = inf
            continue
        before = error
        state = state + inverse @ (after - state)
    raise OrbitError("Newton on the period map of chambers and manifold did not converge")


def _newton_matrix(together: _Together, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inverse of one minus the map's Jacobian at the state that a step of Newton's leads to."""
    count = len(state)
    inverse = np.eye(count)
    for _ in range(2):
        after = together.march(state, ROUGH)
        columns = []
        for k in range(count):
            nudged = state + NUDGE * (np.arange(count) == k)
            columns.append((together.march(nudged, ROUGH) - after) / NUDGE)
        inverse = np.linalg.inv(np.eye(count) - np.stack(columns, axis=1))
        state = state + inverse @ (after - state)
    return inverse, state
