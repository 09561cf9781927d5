"""Torque at standstill by the second solver: each chamber's balance sought by Brent's method."""

from collections.abc import Callable
from dataclasses import replace
from math import lcm

import numpy as np
from scipy.optimize import brentq

from camring.reference.chamber import Chamber
from camring.reference.machine import Machine
from camring.reference.parts import Manifolds
from camring.reference.results import undercut_factor
from camring.reference.user_laws import Rubbing

__all__ = ["standing_torque"]


def standing_torque(machine: Machine, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torque of all pistons at rest at shaft angles: forwards, and backwards with ports exchanged.

    Both are positive where the shaft starts that way.
    """
    other = replace(machine, supply=machine.return_, return_=machine.supply)
    given, lost = _total(machine, angle)
    taken, lost_back = _total(other, angle)
    return given - lost, -taken - lost_back


def _total(machine: Machine, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    chamber = Chamber(replace(machine, manifolds=Manifolds()))
    distinct = lcm(machine.pistons, machine.repeats) // machine.repeats
    torque, lost = np.zeros_like(angle), np.zeros_like(angle)
    for k in range(distinct):
        at = angle + machine.period * k / distinct
        one, rubbed = _one(chamber, at)
        torque += one
        lost += rubbed
    return torque * (machine.pistons // distinct), lost * (machine.pistons // distinct)


def _one(chamber: Chamber, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    m = chamber.machine
    jet = chamber.curve.jet(angle, None)
    r, slope = jet[0], jet[1]
    pressure = np.array([_balance(chamber, float(at)) for at in angle])
    force = m.piston_area * (pressure - m.case_pressure)
    force = force + m.spring_preload - m.spring_rate * (r - chamber.lowest_radius)
    undercut = undercut_factor(m, jet)
    at = Rubbing(
        r, slope, force, force * np.hypot(1, slope / r), undercut * np.hypot(r, slope), 0.0
    )
    return force * slope, m.contact_loss(at)


def _balance(chamber: Chamber, angle: float) -> float:
    m, rho = chamber.machine, chamber.oil.density
    ports = (
        (
            m.supply,
            chamber.supply_opening,
            m.return_pressure if m.idles(m.supply, angle) else m.supply_pressure,
        ),
        (m.return_, chamber.return_opening, m.return_pressure),
    )
    areas = [
        m.port_of(w) * shape(angle - chamber.nearest_centre(w, angle)) for w, shape, _ in ports
    ]
    laws = (chamber.through_supply, chamber.through_return)

    def net(pressure: float) -> float:
        total = -m.leakage(pressure, m.case_pressure)
        total *= (rho(pressure) + rho(m.case_pressure)) / 2 if chamber.oil.aerated else 1.0
        for law, area, (_, _, port) in zip(laws, areas, ports, strict=True):
            density = (rho(pressure) + rho(port)) / 2
            flow = law(area, port - pressure, density) if area else 0.0
            total += flow * (density if chamber.oil.aerated else 1.0)
        return total

    around = (m.supply_pressure, m.return_pressure, m.case_pressure)
    low, high = min(around), max(around)
    return _root(net, low, high)


def _root(net: Callable[[float], float], low: float, high: float) -> float:
    at_low, at_high = net(low), net(high)
    if at_low <= 0:
        return low
    if at_high >= 0:
        return high
    return float(brentq(net, low, high, xtol=1e-9 * (high - low), rtol=1e-15))
