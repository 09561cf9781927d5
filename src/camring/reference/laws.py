"""Openings, orifices and oil in the second solver: one scalar at a time, from docs/theory.md alone.

# notation: p0 atmospheric pressure, pc dissolution pressure, rho density
"""

from collections.abc import Callable
from math import acos, cos, exp, pi, sqrt, tanh

import numpy as np
from scipy.optimize import brentq

from camring.reference.machine import Machine
from camring.reference.parts import Oil, Window

Scalar = Callable[[float], float]


def opening(window: Window) -> Scalar:
    """Open share of a port's area at a signed distance from its centre."""
    half = window.width / 2
    ramp = window.ramp * half
    knots, shares = window.table

    def linear(distance: float) -> float:
        share = (half - abs(distance)) / ramp
        return 0.0 if share < 0 else min(share, 1.0)

    def lens(distance: float) -> float:
        share = linear(distance)
        return 2 / pi * (acos(1 - share) - (1 - share) * sqrt(share * (2 - share)))

    def tabulated(distance: float) -> float:
        return float(np.interp(distance, knots, shares, left=0.0, right=0.0))

    plain = {"linear": linear, "round": lens, "table": tabulated}[window.shape]
    if window.notch_angle == 0 or window.notch_area == 0:
        return plain

    def notched(distance: float) -> float:
        if distance >= 0:
            return plain(distance)
        along = (distance + half + window.notch_angle) / window.notch_angle
        groove = window.notch_area * min(max(along, 0.0), 1.0) ** 2
        return min(plain(distance) + groove, 1.0)

    return notched


def opening_kinks(window: Window) -> list[float]:
    """Signed distances from the centre where the opening is not smooth."""
    if window.shape == "table":
        kinks = list(window.table[0])
    else:
        shoulder = window.width / 2 * (1 - window.ramp)
        kinks = [-window.width / 2, -shoulder, shoulder, window.width / 2]
    if window.notch_angle and window.notch_area:
        edge = -window.width / 2
        kinks.append(edge - window.notch_angle)
        bare = opening(Window(**{**window.__dict__, "notch_area": 0.0}))
        # The groove and the port together are fully open before the port alone is.
        excess = lambda d: bare(d) + window.notch_area - 1  # noqa: E731
        if excess(edge) < 0 < excess(0.0):
            kinks.append(float(brentq(excess, edge, 0.0, xtol=1e-16)))
    return kinks


class OilLaw:
    """Density, stiffness and energy of the oil at a pressure."""

    def __init__(self, oil: Oil) -> None:
        self.oil = oil
        self.aerated = oil.law == "aerated"
        # Air keeps the pressure above zero, so its logarithm is a fit unknown; without
        # air the liquid can be pulled.
        self.logarithmic = self.aerated and oil.air_fraction > 0
        self._air = oil.air_fraction / (1 - oil.air_fraction)
        self._mass = oil.density + self._air * oil.air_density

    def _volume(self, pressure: float) -> tuple[float, float]:
        """Volume of oil and undissolved air for a unit volume of liquid, and its derivative."""
        oil, p0 = self.oil, self.oil.atmospheric_pressure
        x = min(max((pressure - p0) / (oil.dissolution_pressure - p0), 0.0), 1.0)
        share = 1 - x * x * (3 - 2 * x)
        share_slope = -6 * x * (1 - x) / (oil.dissolution_pressure - p0)
        gas = self._air * (p0 / pressure) ** (1 / oil.polytropic_index) if self._air else 0.0
        strain = (pressure - p0) / oil.bulk_modulus
        gain = oil.modulus_gain
        liquid = (1 + gain * strain) ** (-1 / gain) if gain > 0 else exp(-strain)
        softness = 1 / (1 + gain * strain) if gain > 0 else 1.0
        slope = (
            gas * (share_slope - share / (oil.polytropic_index * pressure))
            - liquid * softness / oil.bulk_modulus
        )
        return gas * share + liquid, slope

    def _volumes(self, pressure: np.ndarray) -> np.ndarray:
        """As `_volume`, of many pressures; scalars march faster in Python, arrays in numpy."""
        oil, p0 = self.oil, self.oil.atmospheric_pressure
        x = np.clip((pressure - p0) / (oil.dissolution_pressure - p0), 0.0, 1.0)
        gas = self._air * (p0 / pressure) ** (1 / oil.polytropic_index) if self._air else 0.0
        strain, gain = (pressure - p0) / oil.bulk_modulus, oil.modulus_gain
        liquid = (1 + gain * strain) ** (-1 / gain) if gain > 0 else np.exp(-strain)
        return gas * (1 - x * x * (3 - 2 * x)) + liquid

    def density(self, pressure: float) -> float:
        if not self.aerated:
            return self.oil.density
        return self._mass / self._volume(pressure)[0]

    def density_slope(self, pressure: float) -> float:
        """d rho / dP of the aerated oil."""
        volume, slope = self._volume(pressure)
        return -self._mass * slope / volume**2

    def enthalpy(self, pressure: np.ndarray) -> np.ndarray:
        """Integral of dP/rho from atmospheric pressure, J/kg, by Gauss quadrature.

        In the logarithm of pressure where there is air, in pressure where there is none.
        """
        p0, pc = self.oil.atmospheric_pressure, self.oil.dissolution_pressure
        nodes, weights = np.polynomial.legendre.leggauss(40)

        def between(low: np.ndarray, high: np.ndarray) -> np.ndarray:
            a, b = low[..., None], high[..., None]
            if self.logarithmic:
                a, b = np.log(a), np.log(b)
            at = (a + b) / 2 + (b - a) / 2 * nodes
            at = np.exp(at) if self.logarithmic else at
            inverse = self._volumes(at) * (at if self.logarithmic else 1.0)
            return np.sum(weights * inverse, axis=-1) * ((b - a) / 2)[..., 0] / self._mass

        pressure = np.asarray(pressure, float)
        rising = between(np.full_like(pressure, p0), np.minimum(pressure, pc))
        beyond = between(np.full_like(pressure, pc), np.maximum(pressure, pc))
        return rising + beyond


def orifice(machine: Machine, window: Window) -> Callable[[float, float, float], float]:
    """Volume flow into the chamber for an area, a pressure drop and the oil's density."""
    own, soft = window.discharge_coefficient, machine.oil.transition_pressure**2
    coefficient = machine.discharge_coefficient if own is None else own
    viscosity, critical = machine.oil.viscosity, machine.critical_flow_number

    def turbulent(area: float, drop: float, density: float) -> float:
        return coefficient * area * sqrt(2 / density) * drop / sqrt(sqrt(drop * drop + soft))

    def laminar_turbulent(area: float, drop: float, density: float) -> float:
        speed = sqrt(2 * abs(drop) / density)
        flow_number = sqrt(4 * area / pi) / viscosity * speed
        flow = coefficient * tanh(2 * flow_number / critical) * area * speed
        return flow if drop >= 0 else -flow

    return turbulent if machine.orifice == "turbulent" else laminar_turbulent


def lens_area(share: float) -> float:
    """Overlap of two equal circles over a circle's area, for tests of the round window.

    `share` is the overlapping length over the diameter; circular-segment formula.
    """
    half_angle = acos(1 - share)
    return (2 * half_angle - 2 * (1 - share) * sqrt(1 - cos(half_angle) ** 2)) / pi
