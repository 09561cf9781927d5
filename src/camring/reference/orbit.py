"""The periodic chamber pressure in the second solver: SciPy's LSODA between kinks.

One orbit is a chain of elements, none containing a kink. On each, LSODA gives
the pressure at Chebyshev points and the element is halved until the Chebyshev
series has converged, so layers a thousandth of a degree wide are found wherever
they are. The unknown is the pressure *above the port that is open*, so that in
the quasi-steady stretches the small drop itself, not its difference of two large
pressures, is accurate.

The start pressure solves `P(theta0 + L; P0) = P0`, a scalar monotone map, by
Newton with the multiplier `exp(integral of df/dP)`.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import exp, inf, log, pi

import numpy as np
from scipy.integrate import ODEintWarning, odeint

from camring.reference.chamber import Chamber
from camring.reference.failure import OrbitError
from camring.reference.machine import Machine
from camring.reference.manifold import periodic_manifolds
from camring.reference.series import NODES, ORDER, series_of

FINEST = 1e-9  # shortest element, of the period
MOST_ELEMENTS = 5000  # between two kinks; a sound motor needs a few


@dataclass
class Element:
    """Chebyshev series of the unknown on [start, end]; pressure above `shift`."""

    start: float
    end: float
    shift: float
    series: np.ndarray
    final: float  # the unknown at the end
    exponent: float  # integral of df/dP


@dataclass
class Stretch:
    """Elements from one kink to the next, and the pressure they began with."""

    pressure: float
    elements: list[Element]


def march(
    chamber: Chamber,
    pressure: float,
    tolerance: float,
    before: Sequence[Stretch] = (),
    near: float = 0.0,
) -> tuple[list[Stretch], float]:
    """Follow the pressure over one period; stretches and the pressure at the end.

    Once the pressure comes as `near`, a share of its size, to that of the orbit
    followed `before` at a kink, the rest is the same and taken from there.
    """
    stretches: list[Stretch] = []
    edges = chamber.edges
    for index, (start, end) in enumerate(pairwise(edges)):
        if before and abs(pressure - before[index].pressure) <= near * chamber.size_of(pressure):
            stretches += before[index:]
            return stretches, _end_pressure(chamber, before[-1].elements[-1])
        elements = _follow(chamber, float(start), float(end), pressure, tolerance)
        stretches.append(Stretch(pressure, elements))
        pressure = _end_pressure(chamber, elements[-1])
    return stretches, pressure


def _end_pressure(chamber: Chamber, element: Element) -> float:
    return float(chamber.pressure(np.asarray(element.final), np.asarray(element.shift)))


def _follow(
    chamber: Chamber, start: float, end: float, pressure: float, tolerance: float
) -> list[Element]:
    """Integrate from one kink to the next in elements that the series resolves."""
    finest = FINEST * chamber.curve.period
    elements: list[Element] = []
    rtol = max(tolerance / 10, 1e-13)
    atol = rtol * 1e-4
    at, step = start, end - start
    shift = chamber.shift_at(start, end)
    slopes = chamber.slopes(start, end, shift)
    state = chamber.state(pressure, shift)

    def rhs(y: np.ndarray, angle: float) -> float:
        return slopes(float(y[0]), angle)[0]

    while at < end:
        to = end if at + 1.0001 * step >= end else at + step
        nodes = at + (to - at) / 2 * (NODES + 1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ODEintWarning)  # the message is read instead
            values, report = odeint(
                rhs, state, nodes, rtol=rtol, atol=atol, mxstep=20000, full_output=True
            )
        values = values[:, 0]
        good = report["message"] == "Integration successful." and bool(np.all(np.isfinite(values)))
        if not good and to - at < finest:
            raise OrbitError(f"LSODA failed at {at:.6g} rad: {report['message']}")
        series = series_of(values)
        tail = float(np.max(np.abs(series[-3:]))) if good else inf
        if tail > 3 * rtol * float(np.max(np.abs(values))) + 10 * atol and to - at >= finest:
            step = (to - at) / 2
            continue
        if len(elements) > MOST_ELEMENTS:
            raise OrbitError(f"more than {MOST_ELEMENTS} elements between two kinks")
        elements.append(
            Element(at, to, shift, series, float(values[-1]), _exponent(slopes, nodes, values))
        )
        state, at = float(values[-1]), to
        step *= 2
    return elements


_CLENSHAW_CURTIS = np.array(
    [
        sum(
            (0.5 if k in (0, ORDER) else 1.0)
            * 2
            / ORDER
            * np.cos(pi * j * k / ORDER)
            * (0.0 if k % 2 else 2 / (1 - k * k))
            for k in range(ORDER + 1)
        )
        * (0.5 if j in (0, ORDER) else 1.0)
        for j in range(ORDER + 1)
    ]
)


def _exponent(
    slopes: Callable[[float, float], tuple[float, float]], nodes: np.ndarray, values: np.ndarray
) -> float:
    """Integral of d(dy/dtheta)/dy along the orbit, central differences, Clenshaw-Curtis."""
    small = 1e-6
    rates = [
        (slopes(y + small, t)[0] - slopes(y - small, t)[0]) / (2 * small)
        for y, t in zip(values.tolist(), nodes.tolist(), strict=True)
    ]
    return float(_CLENSHAW_CURTIS @ np.asarray(rates)) * (nodes[-1] - nodes[0]) / 2


@dataclass
class Orbit:
    """A periodic pressure, readable at any angle."""

    chamber: Chamber
    elements: list[Element]
    residual: float  # pressure after a period minus before, Pa
    multiplier: float  # of a pressure disturbance over a period

    def __post_init__(self) -> None:
        self._starts = np.array([e.start for e in self.elements])
        self._ends = np.array([e.end for e in self.elements])
        self._shifts = np.array([e.shift for e in self.elements])
        self._series = np.stack([e.series for e in self.elements])

    @property
    def edges(self) -> np.ndarray:
        return np.append(self._starts, self._ends[-1])

    def state(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The unknown and its shift, at any angles."""
        first, period = self._starts[0], self.chamber.curve.period
        home = first + np.mod(np.asarray(angle, float) - first, period)
        index = np.clip(np.searchsorted(self._starts, home, side="right") - 1, 0, None)
        start, end = self._starts[index], self._ends[index]
        x = (2 * home - start - end) / (end - start)
        series = self._series[index]
        one, two = np.zeros_like(x), np.zeros_like(x)
        for k in range(ORDER, 0, -1):
            one, two = series[..., k] + 2 * x * one - two, one
        return series[..., 0] + x * one - two, self._shifts[index]

    def pressure(self, angle: np.ndarray) -> np.ndarray:
        return self.chamber.pressure(*self.state(angle))


def periodic_orbit(machine: Machine, tolerance: float = 1e-10) -> Orbit:
    """Solve for the periodic pressure, docs/theory.md section 3.

    With manifolds, that of a chamber between them.
    """
    chamber = Chamber(machine)
    if machine.manifolds:
        chamber = Chamber(machine, *periodic_manifolds(chamber, tolerance))
    pressure = machine.supply_pressure
    best: Orbit | None = None
    stretches: list[Stretch] = []
    slack, least, allowed = 0.0, inf, 3 * tolerance
    for _ in range(12):
        near = 0.01 * slack * tolerance
        stretches, after = march(chamber, pressure, tolerance, stretches, near)
        elements = [element for stretch in stretches for element in stretch.elements]
        multiplier = exp(sum(e.exponent for e in elements))
        orbit = Orbit(chamber, elements, after - pressure, multiplier)
        missed = abs(orbit.residual) / chamber.size_of(pressure)
        if missed < least:
            best, least = orbit, missed
        slack = max(1 - multiplier, 1e-300)
        if missed <= allowed * min(1.0, slack):
            return orbit
        if slack < 1e-12:
            raise OrbitError(
                "the chamber neither leaks nor meets an open port: any pressure is periodic"
            )
        if chamber.oil.logarithmic:
            pressure *= exp(min(max(log(after / pressure) / slack, -3.0), 3.0))
        else:
            pressure += orbit.residual / slack
    if best is None or least > 1e3 * allowed:
        raise OrbitError("Newton on the period map did not converge")
    return best
