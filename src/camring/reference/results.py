"""Every number of docs/theory.md section 10 from a periodic orbit, in the second solver."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import lcm, pi, sqrt

import numpy as np

from camring.reference.cooling import warmth
from camring.reference.displacement import rises_on_fed_lobes
from camring.reference.efficiency import efficiencies
from camring.reference.life import rating_life
from camring.reference.lines import at_windows
from camring.reference.machine import Machine
from camring.reference.orbit import Orbit
from camring.reference.past_plate import past_plate
from camring.reference.shape import Jet
from camring.reference.user_laws import Rubbing

GAUSS = np.polynomial.legendre.leggauss(20)


@dataclass(frozen=True)
class Motion:
    """What the cam and the oil press a piston to, at some angles."""

    jet: Jet
    lift: np.ndarray
    pressure: np.ndarray
    force: np.ndarray
    normal_force: np.ndarray
    undercut: np.ndarray
    contact_torque: np.ndarray  # lost in roller and side friction
    torque: np.ndarray


def undercut_factor(machine: Machine, jet: Jet) -> np.ndarray:
    r, r1, r2, _ = jet
    curvature = (r**2 + 2 * r1**2 - r * r2) / (r**2 + r1**2) ** 1.5
    return 1 + curvature * machine.roller_radius


def motion(orbit: Orbit, angle: np.ndarray, inside: np.ndarray | None = None) -> Motion:
    m, w = orbit.chamber.machine, orbit.chamber.machine.shaft_speed
    jet = orbit.chamber.curve.jet(angle, inside)
    r, r1, r2, _ = jet
    pressure = orbit.pressure(angle)
    force = (
        m.piston_area * (pressure - m.case_pressure)
        - m.piston_mass * w**2 * r2
        - m.viscous_damping * w * r1
    )
    if m.spring_rate or m.spring_preload:
        force = force + m.spring_preload - m.spring_rate * (r - orbit.chamber.lowest_radius)
    normal = force * np.hypot(1, r1 / r)
    undercut = undercut_factor(m, jet)
    lost = m.contact_loss(Rubbing(r, r1, force, normal, undercut * np.hypot(r, r1), w))
    lift = r - orbit.chamber.reference
    return Motion(jet, lift, pressure, force, normal, undercut, lost, force * r1 - lost)


def contact_stress(machine: Machine, state: Motion) -> np.ndarray:
    m = machine
    compliance = (1 - m.ring_poisson**2) / m.ring_modulus
    compliance += (1 - m.roller_poisson**2) / m.roller_modulus
    radius = m.roller_radius * state.undercut
    load = np.maximum(state.normal_force, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.sqrt(load / (compliance * pi * m.roller_length * radius))


def flows(orbit: Orbit, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Supply and return into a chamber, leakage out: volumes a second, or masses if aerated."""
    chamber, m = orbit.chamber, orbit.chamber.machine
    states, shifts = orbit.state(angle)
    rho, aerated = chamber.oil.density, chamber.oil.aerated
    found = np.zeros((3, len(angle)))
    before, behind = chamber.supply_at(angle).tolist(), chamber.return_at(angle).tolist()
    for k, (at, y, shift) in enumerate(
        zip(angle.tolist(), states.tolist(), shifts.tolist(), strict=True)
    ):
        above = shift * float(np.expm1(y)) if chamber.oil.logarithmic else chamber.scale * y
        pressure = shift + above
        ports = (
            (0, m.supply, chamber.supply_opening, before[k], chamber.through_supply),
            (1, m.return_, chamber.return_opening, behind[k], chamber.through_return),
        )
        for kind, window, shape, port, law in ports:
            row = kind
            if m.idles(window, at):
                row, port = 1, m.return_pressure
            share = shape(at - chamber.nearest_centre(window, at))
            density = (rho(pressure) + rho(port)) / 2
            flow = law(m.port_of(window) * share, port - shift - above, density)
            found[row, k] += flow * density if aerated else flow
        leak = m.leakage(pressure, m.case_pressure)
        found[2, k] = leak * ((rho(pressure) + rho(m.case_pressure)) / 2 if aerated else 1.0)
    return found[0], found[1], found[2]


def extremes(
    function: Callable[[np.ndarray, np.ndarray], np.ndarray], edges: np.ndarray
) -> tuple[float, float]:
    """Smallest and largest value over intervals on which the function is smooth.

    `function(angle, inside)`: `inside` is an angle of the same interval, for
    functions that jump at an edge. Sampled, then the best brackets are zoomed in.
    """
    low, high = edges[:-1], edges[1:]
    keep = high > low
    low, high = low[keep], high[keep]
    middle = (low + high) / 2
    grid = np.linspace(0, 1, 13)
    at = low[:, None] + (high - low)[:, None] * grid
    value = function(at.ravel(), np.repeat(middle, len(grid))).reshape(at.shape)
    found = []
    for sign in (-1.0, 1.0):
        height = sign * value
        chosen = np.argsort(np.max(height, axis=1))[::-1][:12]
        rows, best = np.arange(len(chosen)), np.argmax(height[chosen], axis=1)
        a = at[chosen, np.maximum(best - 1, 0)]
        b = at[chosen, np.minimum(best + 1, len(grid) - 1)]
        within = np.repeat(middle[chosen], 17)
        top = float(np.max(height))
        for _ in range(6):
            fine = np.linspace(a, b, 17, axis=1)
            here = sign * function(fine.ravel(), within).reshape(fine.shape)
            peak = np.argmax(here, axis=1)
            top = max(top, float(np.max(here)))
            a, b = fine[rows, np.maximum(peak - 1, 0)], fine[rows, np.minimum(peak + 1, 16)]
        found.append(sign * top)
    return found[0], found[1]


def _split(edges: np.ndarray, longest: float) -> np.ndarray:
    """Edges with long intervals divided."""
    parts = [
        np.linspace(a, b, int(np.ceil((b - a) / longest)) + 1)[:-1] for a, b in pairwise(edges)
    ]
    return np.append(np.concatenate(parts), edges[-1])


def _sign_changes(function: Callable[[np.ndarray], np.ndarray], edges: np.ndarray) -> np.ndarray:
    """Zeros of a continuous function, bracketed on a sampled mesh and bisected."""
    at = np.unique(
        np.concatenate(
            [a + (edges[1:] - edges[:-1]) * a_ for a, a_ in ((edges[:-1], k / 8) for k in range(9))]
        )
    )
    sign = np.signbit(function(at))
    here = np.flatnonzero(sign[1:] != sign[:-1])
    low, high, left = at[here], at[here + 1], sign[here]
    for _ in range(50):
        middle = (low + high) / 2
        same = np.signbit(function(middle)) == left
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2


class Quadrature:
    """Gauss points over one orbit, fine enough for the highest order asked."""

    def __init__(self, edges: np.ndarray, highest_order: int) -> None:
        edges = _split(edges, 8.0 / max(highest_order, 1))
        nodes, weights = GAUSS
        half = np.diff(edges) / 2
        self.angle = ((edges[:-1] + half)[:, None] + half[:, None] * nodes).ravel()
        self.weight = (half[:, None] * weights).ravel()
        self.length = edges[-1] - edges[0]

    def mean(self, values: np.ndarray) -> float:
        return float(self.weight @ values) / self.length

    def harmonics(self, values: np.ndarray, every: int, highest: int) -> np.ndarray:
        """Complex Fourier coefficients of the orders `every, 2 every, ...` up to the highest."""
        turn = np.exp(-1j * every * self.angle)
        term = self.weight * values / self.length
        found = []
        for _ in range(highest // every):
            term = term * turn
            found.append(term.sum())
        return np.asarray(found)


def total_torque(orbit: Orbit, angle: np.ndarray) -> np.ndarray:
    """Torque of the shaft: the sum over all pistons."""
    m = orbit.chamber.machine
    total = np.zeros_like(np.asarray(angle, float))
    distinct = lcm(m.pistons, m.repeats) // m.repeats
    for k in range(distinct):
        total += motion(orbit, angle + m.period * k / distinct).torque
    return total * (m.pistons // distinct)


def geometry_results(orbit: Orbit) -> dict[str, float]:
    chamber, m, w = orbit.chamber, orbit.chamber.machine, orbit.chamber.machine.shaft_speed
    curve = chamber.curve
    smallest, largest = chamber.extreme_radii()
    rises = m.repeats * rises_on_fed_lobes(chamber)
    knots = np.array([p.start for p in chamber.pieces] + [chamber.pieces[-1].end])

    def of(change: Callable[[Jet], np.ndarray]) -> tuple[float, float]:
        return extremes(lambda at, inside: change(curve.jet(at, inside)), knots)

    quadrature = Quadrature(knots, 1)
    jerk = curve.jet(quadrature.angle)[3]
    mean_volume = m.dead_volume + m.piston_area * (
        quadrature.mean(curve.jet(quadrature.angle)[0]) - chamber.reference
    )
    stiffness = m.oil.bulk_modulus * m.piston_area**2 / mean_volume
    stroke = largest - smallest
    largest_of = lambda change: max(abs(x) for x in of(change))  # noqa: E731
    return {
        "displacement": m.pistons * rises * m.piston_area,
        "stroke": stroke,
        "min_undercut_factor": of(lambda jet: undercut_factor(m, jet))[0],
        "max_pressure_angle": float(np.arctan(largest_of(lambda jet: jet[1] / jet[0]))),
        "max_velocity": w * largest_of(lambda jet: jet[1]),
        "max_acceleration": w**2 * largest_of(lambda jet: jet[2]),
        "max_jerk": w**3 * largest_of(lambda jet: jet[3]),
        "min_volume": m.dead_volume + m.piston_area * (smallest - chamber.reference),
        "natural_frequency": sqrt(stiffness / m.piston_mass),
        "damping_ratio": m.viscous_damping / (2 * sqrt(m.piston_mass * stiffness)),
        "jerk_objective": quadrature.mean((jerk / (stroke * m.lobes**3)) ** 2),
    }


def results(orbit: Orbit, harmonics: int) -> dict[str, float]:
    """All results of docs/theory.md section 10, SI."""
    chamber, m, w = orbit.chamber, orbit.chamber.machine, orbit.chamber.machine.shaft_speed
    found = geometry_results(orbit)
    edges = orbit.edges
    if m.rubs:
        force = _sign_changes(lambda at: motion(orbit, at).force, edges)
        slope = _sign_changes(lambda at: chamber.curve.jet(at)[1], edges)
        edges = np.sort(np.concatenate([edges, force, slope]))
    quad = Quadrature(edges, harmonics)
    state = motion(orbit, quad.angle)
    supply, back, leak = flows(orbit, quad.angle)
    ports = at_windows(chamber, quad.angle)
    drop = m.supply_pressure - m.return_pressure
    surviving = lcm(m.pistons, m.repeats)
    speed = w * state.jet[1]
    contact = w * state.contact_torque
    if chamber.oil.aerated:
        level = chamber.oil.enthalpy(state.pressure)
        at_supply, at_return = chamber.oil.enthalpy(
            np.array([m.supply_pressure, m.return_pressure])
        )
        through = supply * (ports.level_before - level) + back * (ports.level_behind - level)
        leaking, compressing = leak * (level - at_return), np.zeros_like(leak)
        at_case = float(chamber.oil.enthalpy(np.array(m.case_pressure)))
        warming, below_return = leak * (level - at_case), float(at_return) - at_case
        drained, drained_amount = leak, leak
        input_power = m.pistons * quad.mean(supply) * float(at_supply - at_return)
        supply = supply / chamber.oil.density(m.supply_pressure)
        back = back / chamber.oil.density(m.return_pressure)
        leak = leak / chamber.oil.density(m.case_pressure)
    else:
        above = state.pressure - m.return_pressure
        through = supply * ((ports.before - m.return_pressure) - above)
        through = through + back * ((ports.behind - m.return_pressure) - above)
        leaking = leak * above
        warming, below_return = leak * (state.pressure - m.case_pressure), -m.case_pressure
        below_return += m.return_pressure
        drained, drained_amount = leak * m.oil.density, leak
        # Integral of (P-Pt) V/beta dP by parts: the balance of power is then a true check.
        compressing = -m.piston_area * speed * above**2 / (2 * m.oil.bulk_modulus)
        input_power = m.pistons * quad.mean(supply) * drop
    torque = m.pistons * quad.mean(state.torque)
    supply_flow = m.pistons * quad.mean(supply)
    outside = past_plate(m, chamber.oil)
    supply_flow += outside.supply
    input_power += outside.power
    ideal = drop * found["displacement"] / (2 * pi)
    torque_orders = m.pistons * quad.harmonics(state.torque, surviving, harmonics)
    flow_orders = m.pistons * quad.harmonics(supply, surviving, harmonics)
    back_orders = m.pistons * quad.harmonics(back, surviving, harmonics)
    gauge = state.pressure - m.return_pressure
    pressure_orders = quad.harmonics(gauge, m.repeats, harmonics)
    size = lambda orders: float(np.sum(np.abs(orders) ** 2))  # noqa: E731
    low_pressure, high_pressure = extremes(lambda at, _: orbit.pressure(at), orbit.edges)
    low_torque, high_torque = torque_extremes(orbit)
    low_supply, high_supply = extremes(lambda at, _: chamber.supply_at(at), orbit.edges)
    low_return, high_return = extremes(lambda at, _: chamber.return_at(at), orbit.edges)
    output = torque * w
    friction = m.pistons * quad.mean(m.viscous_damping * speed**2 + contact)
    heat = m.pistons * quad.mean(warming) + friction + outside.heat
    drain_mass = m.pistons * quad.mean(drained) + outside.drain_mass
    amount_past_plate = outside.drain_mass if chamber.oil.aerated else outside.drain
    drain_amount = m.pistons * quad.mean(drained_amount) + amount_past_plate
    found |= {
        "mean_torque": torque,
        "torque_ripple": sqrt(size(torque_orders)) / abs(torque),
        "torque_ripple_peak_to_peak": (high_torque - low_torque) / abs(torque),
        "pressure_ripple": sqrt(size(pressure_orders)) / abs(quad.mean(gauge)),
        "flow_ripple": sqrt(size(flow_orders)) / abs(supply_flow),
        "return_flow_ripple": sqrt(size(back_orders))
        / abs(m.pistons * quad.mean(back) - outside.back),
        "ideal_torque": ideal,
        "supply_flow": supply_flow,
        "return_flow": outside.back - m.pistons * quad.mean(back),
        "case_drain": m.pistons * quad.mean(leak) + outside.drain,
        "input_power": input_power,
        "output_power": output,
        "line_loss": quad.mean(ports.supply_loss),
        "return_line_loss": quad.mean(ports.return_loss),
        "throttling_loss": m.pistons * quad.mean(through),
        "leakage_loss": m.pistons * quad.mean(leaking) + outside.power,
        "friction_loss": friction,
        "port_power": input_power + drain_amount * below_return,
        "full_leakage_loss": m.pistons * quad.mean(warming) + outside.heat + outside.across,
        "case_heat": heat,
        **warmth(m.cooling, heat, drain_mass),
        "compression_loss": m.pistons * quad.mean(compressing),
        "min_pressure": low_pressure,
        "max_pressure": high_pressure,
        "supply_pressure_swing": high_supply - low_supply,
        "return_pressure_swing": high_return - low_return,
        "min_contact_force": extremes(lambda at, i: motion(orbit, at, i).force, orbit.edges)[0],
        "max_contact_stress": extremes(
            lambda at, i: contact_stress(m, motion(orbit, at, i)), orbit.edges
        )[1],
        "l10_life": rating_life(m, state.jet, state.undercut, state.normal_force, quad.weight),
        "spectral_pressure": size(pressure_orders) / drop**2,
        "spectral_torque": size(torque_orders) / ideal**2,
    }
    return found | efficiencies(found, drop * supply_flow)


def torque_extremes(orbit: Orbit) -> tuple[float, float]:
    """Smallest and largest torque of the shaft, over its own short period."""
    m = orbit.chamber.machine
    short = 2 * pi / lcm(m.pistons, m.repeats)
    first = orbit.edges[0]
    folded = first + np.sort(np.mod(orbit.edges[:-1] - first, short))
    folded = np.append(folded, first + short)
    return extremes(lambda at, _: total_torque(orbit, at), np.unique(folded))
