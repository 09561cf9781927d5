"""The pressure equation of one chamber in the second solver, cut where it has kinks."""

from collections.abc import Callable
from functools import cached_property
from math import expm1, log, pi

import numpy as np

from camring.reference.laws import OilLaw, opening, opening_kinks, orifice
from camring.reference.machine import Machine
from camring.reference.parts import Window
from camring.reference.series import PeriodicSeries
from camring.reference.shape import Piece, PitchCurve


class Chamber:
    """Right-hand side dP/dtheta, cut into stretches without kinks.

    `before` is the pressure in the manifold before the supply windows, `behind` that in the
    one behind the return windows; None where the set pressure stands there.
    """

    def __init__(
        self,
        machine: Machine,
        before: PeriodicSeries | None = None,
        behind: PeriodicSeries | None = None,
    ) -> None:
        self.machine = machine
        self.before, self.behind = before, behind
        self.curve = PitchCurve(machine)
        self.oil = OilLaw(machine.oil)
        self.through_supply = orifice(machine, machine.supply)
        self.through_return = orifice(machine, machine.return_)
        self.supply_opening = opening(machine.supply)
        self.return_opening = opening(machine.return_)
        self.pitch = 2 * pi / machine.lobes
        self.scale = abs(machine.supply_pressure - machine.return_pressure)
        self.pieces = self.curve.pieces()
        self.reference = self._reference()
        self.start = machine.supply.centre % machine.period
        self.edges = self._edges()

    def _reference(self) -> float:
        given = self.machine.reference_radius
        if not isinstance(given, str):
            return float(given)
        if given == "minimum":
            return self.extreme_radii()[0]
        nodes, weights = np.polynomial.legendre.leggauss(12)
        total = 0.0
        for piece in self.pieces:
            half = (piece.end - piece.start) / 2
            total += half * float(weights @ self.curve.jet(piece.start + half * (1 + nodes))[0])
        return total / self.curve.period

    def extreme_radii(self) -> tuple[float, float]:
        at = np.concatenate([self.curve.turning_points(), [p.start for p in self.pieces]])
        radii = self.curve.jet(at)[0]
        return float(radii.min()), float(radii.max())

    @cached_property
    def lowest_radius(self) -> float:
        """From which a return spring's travel counts."""
        return self.extreme_radii()[0]

    def _edges(self) -> np.ndarray:
        """Kinks of one orbit from its start, both ends included."""
        period = self.curve.period
        around = [p.start for p in self.pieces]
        for window in (self.machine.supply, self.machine.return_):
            for kink in opening_kinks(window):
                around += [
                    window.centre + kink + self.pitch * k
                    for k in range(self.machine.lobes // self.machine.repeats)
                ]
        for pressure in (self.before, self.behind):
            if pressure is not None:
                part = pressure.period
                copies = round(period / part)
                around += [e + part * k for e in pressure.edges[:-1] for k in range(copies)]
        inside = np.sort((np.asarray(around) - self.start) % period)
        all_edges = np.concatenate([[0.0], inside, [period]])
        keep = np.concatenate([[True], np.diff(all_edges) > 1e-13 * period])
        all_edges = all_edges[keep]
        all_edges[-1] = period
        return self.start + all_edges

    def nearest_centre(self, window: Window, angle: float) -> float:
        return window.centre + self.pitch * round((angle - window.centre) / self.pitch)

    def piece_at(self, angle: float) -> tuple[Piece, float]:
        """The cam's polynomial at an angle and the turns to take off it."""
        turns = np.floor((angle - self.pieces[0].start) / self.curve.period) * self.curve.period
        home = angle - turns
        starts = [p.start for p in self.pieces]
        return self.pieces[max(int(np.searchsorted(starts, home, side="right")) - 1, 0)], turns

    def motion(self, middle: float) -> Callable[[float], tuple[float, float]]:
        """theta -> (volume, its slope) on the stretch without kinks around an angle."""
        piece, turns = self.piece_at(middle)
        origin, scale, powers = piece.origin + turns, piece.scale, piece.coefficients[::-1]
        area = self.machine.piston_area
        fixed = self.machine.dead_volume - area * self.reference

        def of(angle: float) -> tuple[float, float]:
            x = (angle - origin) * scale
            value = slope = 0.0
            for power in powers:
                slope = slope * x + value
                value = value * x + power
            return fixed + area * value, area * slope * scale

        return of

    def supply_law(self) -> Callable[[float], float]:
        """Pressure before the supply windows at an angle."""
        return _one_by_one(self.before, self.machine.supply_pressure)

    def return_law(self) -> Callable[[float], float]:
        """Pressure behind the return windows at an angle."""
        return _one_by_one(self.behind, self.machine.return_pressure)

    def supply_at(self, angle: np.ndarray) -> np.ndarray:
        """Pressure before the supply windows at many angles."""
        return _many(self.before, self.machine.supply_pressure, angle)

    def return_at(self, angle: np.ndarray) -> np.ndarray:
        """Pressure behind the return windows at many angles."""
        return _many(self.behind, self.machine.return_pressure, angle)

    def slopes(
        self, start: float, end: float, shift: float
    ) -> Callable[[float, float], tuple[float, float]]:
        """(y, theta) -> (dy/dtheta, P) on a stretch without kinks.

        `P = shift + scale y`, or `P = shift e^y` for oil with air in it.
        """
        m, middle = self.machine, (start + end) / 2
        motion = self.motion(middle)
        supply_at = self.nearest_centre(m.supply, middle)
        return_at = self.nearest_centre(m.return_, middle)
        supply_open, return_open = self.supply_opening, self.return_opening
        in_, back, speed, leak = self.through_supply, self.through_return, m.shaft_speed, m.leakage
        supply_port, return_port = m.port_of(m.supply), m.port_of(m.return_)
        supply_pressure, return_pressure = self.supply_law(), self.return_law()
        if m.idles(m.supply, middle):
            supply_pressure = lambda _: m.return_pressure  # noqa: E731
        density, modulus, unit, case = (
            m.oil.density,
            m.oil.bulk_modulus,
            self.scale,
            m.case_pressure,
        )

        def stiff(y: float, angle: float) -> tuple[float, float]:
            volume, swept = motion(angle)
            above = unit * y
            pressure = shift + above
            net = -leak(pressure, case) / speed - swept
            share = supply_open(angle - supply_at)
            if share > 0:
                to_supply = supply_pressure(angle) - shift
                net += in_(supply_port * share, to_supply - above, density) / speed
            share = return_open(angle - return_at)
            if share > 0:
                to_return = return_pressure(angle) - shift
                net += back(return_port * share, to_return - above, density) / speed
            return modulus * net / (volume * unit), pressure

        rho, rho_slope = self.oil.density, self.oil.density_slope
        rho_supply, rho_return, rho_case = (
            rho(at) for at in (m.supply_pressure, m.return_pressure, case)
        )
        rho_before = (lambda _: rho_supply) if self.before is None else rho
        rho_behind = (lambda _: rho_return) if self.behind is None else rho
        if m.idles(m.supply, middle):
            rho_before = lambda _: rho_return  # noqa: E731

        logarithmic = self.oil.logarithmic

        def aerated(y: float, angle: float) -> tuple[float, float]:
            volume, swept = motion(angle)
            above = shift * expm1(y) if logarithmic else unit * y
            pressure = shift + above
            here = rho(pressure)
            net = -(here + rho_case) / 2 * leak(pressure, case) / speed - here * swept
            share = supply_open(angle - supply_at)
            if share > 0:
                before = supply_pressure(angle)
                mean = (here + rho_before(before)) / 2
                net += mean * in_(supply_port * share, (before - shift) - above, mean) / speed
            share = return_open(angle - return_at)
            if share > 0:
                behind = return_pressure(angle)
                mean = (here + rho_behind(behind)) / 2
                net += mean * back(return_port * share, (behind - shift) - above, mean) / speed
            size = pressure if logarithmic else unit
            return net / (volume * rho_slope(pressure) * size), pressure

        return aerated if self.oil.aerated else stiff

    def state(self, pressure: float, shift: float) -> float:
        return log(pressure / shift) if self.oil.logarithmic else (pressure - shift) / self.scale

    def pressure(self, state: np.ndarray, shift: np.ndarray) -> np.ndarray:
        return shift * np.exp(state) if self.oil.logarithmic else shift + self.scale * state

    def size_of(self, pressure: float) -> float:
        """What errors of a pressure are measured against: its own where the oil is thin."""
        return min(self.scale, pressure) if self.oil.logarithmic else self.scale

    def shift_at(self, start: float, end: float) -> float:
        """Pressure of the wider open port on a stretch."""
        m, middle = self.machine, (start + end) / 2
        share = [
            max(shape(at - self.nearest_centre(w, middle)) for at in (start, end))
            for w, shape in ((m.supply, self.supply_opening), (m.return_, self.return_opening))
        ]
        fed = share[0] > share[1] and not m.idles(m.supply, middle)
        return self.supply_law()(middle) if fed else self.return_law()(middle)


def _one_by_one(pressure: PeriodicSeries | None, constant: float) -> Callable[[float], float]:
    return (lambda _: constant) if pressure is None else pressure.scalar


def _many(pressure: PeriodicSeries | None, constant: float, angle: np.ndarray) -> np.ndarray:
    return np.full(np.shape(angle), constant) if pressure is None else pressure(angle)
