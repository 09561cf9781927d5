"""From a catalogue's data to motors: every sensible count, bore and ring, ranked.

The rules and their reasons stand in `sizing_rules`, the closed forms in
`metrics.estimate`.
"""

from dataclasses import dataclass
from math import gcd, isfinite, pi

import numpy as np
from jaxtyping import Float

from camring.files.starting import sizing_rules as rules
from camring.geometry.block import wall_between
from camring.geometry.ring_body import usual_outer_radius
from camring.metrics.estimate import (
    Conditions,
    Sketch,
    contact_stress,
    efficiency,
    greatest_pressure_angle,
    inertia_pressure,
    least_undercut_factor,
    port_drop,
    pre_compression,
    pressure_leaked_away,
    sine_torque_ripple,
)
from camring.numerics.quantity import Q

Share = Q[Float[np.ndarray, "*sketch"], "1"]

# Whole millimetres; above 60 only even ones, and no casting with larger bores is known to us.
_BORES = np.concatenate([np.arange(12, 60) * 1e-3, np.arange(60, 132, 2) * 1e-3])
_RING_STEPS = 80


@dataclass(frozen=True)
class Demand:
    """What a catalogue page says, SI: volume of a revolution, pressure, speed, outer diameter."""

    displacement: float
    pressure: float
    shaft_speed: float
    outer_diameter: float = float("inf")


@dataclass(frozen=True)
class Sketches:
    """Sketches with what closed forms say of them; arrays of one shape, best first.

    `score` is what they are ranked by, the smaller the better.
    """

    sketch: Sketch
    return_pressure: Q[Float[np.ndarray, "*sketch"], "Pa"]
    outer_radius: Q[Float[np.ndarray, "*sketch"], "m"]
    contact_stress: Q[Float[np.ndarray, "*sketch"], "Pa"]
    pressure_angle: Q[Float[np.ndarray, "*sketch"], "rad"]
    undercut_factor: Share
    port_drop: Q[Float[np.ndarray, "*sketch"], "Pa"]
    wall: Q[Float[np.ndarray, "*sketch"], "m"]
    efficiency: Share
    torque_ripple: Share
    score: Share

    def __len__(self) -> int:
        return len(self.score)

    def taken(self, places: np.ndarray) -> "Sketches":
        """Those at some places, in that order."""
        picked = {name: value[places] for name, value in vars(self).items() if name != "sketch"}
        return Sketches(sketch=Sketch(*(each[places] for each in self.sketch)), **picked)


def combinations() -> list[tuple[int, int]]:
    """Pistons and lobes worth a sketch, by the rules of the counts."""
    return [
        (pistons, lobes)
        for pistons in rules.PISTONS
        for lobes in rules.LOBES
        if lobes < pistons <= rules.MOST_PISTONS_A_LOBE * lobes
        and gcd(pistons, lobes) >= rules.LEAST_DIVISOR
        and pistons // gcd(pistons, lobes) >= rules.LEAST_PHASES
    ]


def displacements(counts: list[tuple[int, int]] | None = None) -> tuple[float, float]:
    """The least and the greatest displacement that the bores and strokes allow, m3."""
    cylinders = [p * n for p, n in (combinations() if counts is None else counts)]
    short, long = rules.STROKES
    cubed = pi / 4 * _BORES**3
    return min(cylinders) * short * float(cubed[0]), max(cylinders) * long * float(cubed[-1])


def conditions_of(demand: Demand, return_pressure: float | np.ndarray) -> Conditions:
    """The rated operating point."""
    return Conditions(
        demand.shaft_speed,
        demand.pressure,
        return_pressure,
        rules.CASE_PRESSURE,
        rules.DENSITY,
        rules.BULK_MODULUS,
    )


def candidates(demand: Demand, counts: list[tuple[int, int]] | None = None) -> Sketches:
    """Every count, bore, roller and ring that is looked at, good or not, unordered.

    Parameters
    ----------
    counts
        Pistons and lobes; all of `combinations` unless given.

    Returns
    -------
    Sketches of exactly the displacement. Empty when no bore gives a sensible stroke.
    """
    chosen = np.array(combinations() if counts is None else counts)
    ring = np.linspace(*rules.RADII, _RING_STEPS)
    which, bore, length, radius = (
        each.ravel()
        for each in np.meshgrid(
            np.arange(len(chosen)), _BORES, rules.ROLLER_LENGTHS, ring, indexing="ij"
        )
    )
    pistons, lobes = chosen[which].T
    area = pi * bore**2 / 4
    stroke = demand.displacement / (pistons * lobes * area)
    low, high = rules.STROKES
    sensible = (stroke >= low * bore) & (stroke <= high * bore) & (radius * bore > stroke)
    if isfinite(demand.outer_diameter):
        # The largest ring that may be built is a candidate too: the grid must not miss it.
        around = usual_outer_radius(stroke / 2, rules.ROLLER_RADIUS * bore, bore)
        largest = (demand.outer_diameter / 2 - around) / bore
        radius = np.where(
            (radius > largest) & (radius - (ring[1] - ring[0]) < largest), largest, radius
        )
    pistons, lobes, bore, stroke, length, radius = (
        each[sensible] for each in (pistons, lobes, bore, stroke, length, radius)
    )
    return _assessed(_sketch(demand, pistons, lobes, bore, stroke, length, radius * bore), demand)


def _sketch(
    demand: Demand,
    pistons: np.ndarray,
    lobes: np.ndarray,
    bore: np.ndarray,
    stroke: np.ndarray,
    length: np.ndarray,
    radius: np.ndarray,
) -> Sketch:
    area = pi * bore**2 / 4
    swept = area * stroke
    slow_flow = demand.displacement * rules.SLOW * demand.shaft_speed / (2 * pi)
    tight = rules.LEAK_SHARE * slow_flow / (pistons * demand.pressure / 2)
    gap = rules.gap_leakage(bore)
    valve = np.clip(
        tight - gap,
        rules.LEAST_VALVE_LEAKAGE_PER_AREA * area,
        rules.VALVE_LEAKAGE_PER_AREA * area,
    )
    least, most = rules.PORT_SHARE
    bare = Sketch(
        pistons=pistons,
        lobes=lobes,
        bore=bore,
        stroke=stroke,
        mean_radius=radius,
        roller_radius=rules.ROLLER_RADIUS * bore,
        roller_length=length * bore,
        port_area=area,
        dead_volume=rules.DEAD_SHARE * swept,
        piston_mass=rules.MASS_PER_CUBED_BORE * bore**3,
        viscous_damping=rules.film_damping(bore),
        leakage_coefficient=valve + gap,
        roller_friction=np.full_like(bore, rules.ROLLER_FRICTION),
        side_friction=np.full_like(bore, rules.SIDE_FRICTION),
    )
    # The drop falls with the square of the port's share of the piston area.
    whole = port_drop(bare, conditions_of(demand, 0.0))
    needed = np.sqrt(whole / (rules.PORT_DROP_WANTED * demand.pressure))
    return bare._replace(port_area=np.clip(needed, least, most) * area)


def _assessed(sketch: Sketch, demand: Demand) -> Sketches:
    pressed = inertia_pressure(sketch, conditions_of(demand, 0.0)) + rules.CASE_PRESSURE
    least, _ = rules.RETURN_PRESSURES
    back = np.maximum(np.ceil((pressed + rules.RETURN_SPARE) / 1e5) * 1e5, least)
    # Beyond what any motor may have the other numbers mean nothing; they stay finite.
    conditions = conditions_of(demand, np.minimum(back, demand.pressure / 2))
    stress = contact_stress(sketch, conditions, rules.STEEL)
    angle = greatest_pressure_angle(sketch)
    useful = efficiency(sketch, conditions)
    ripple = sine_torque_ripple(sketch.phases)
    outer = np.asarray(
        usual_outer_radius(sketch.greatest_radius, sketch.roller_radius, sketch.bore)
    )
    inner = sketch.least_radius - rules.PISTON_LENGTH * sketch.bore
    size = outer / (rules.ORDINARY_SIZE * demand.displacement ** (1 / 3))
    score = (
        (np.maximum(stress, rules.STRESS_EASY) / rules.STRESS_EASY) ** 2
        + (np.maximum(angle, rules.ANGLE_EASY) / rules.ANGLE_EASY) ** 2
        + ((1 - useful) / rules.ORDINARY_LOSS) ** 2
        + ripple / rules.ORDINARY_RIPPLE
        + size**2
        + sketch.pistons / rules.ORDINARY_PISTONS
        + sketch.roller_length / sketch.bore
    )
    return Sketches(
        sketch=sketch,
        return_pressure=back,
        outer_radius=outer,
        contact_stress=stress,
        pressure_angle=angle,
        undercut_factor=least_undercut_factor(sketch),
        port_drop=port_drop(sketch, conditions),
        wall=np.asarray(wall_between(sketch.pistons, sketch.bore, inner)),
        efficiency=useful,
        torque_ripple=ripple,
        score=score,
    )


def shut_angle(sketch: Sketch, conditions: Conditions) -> float:
    """Angle about a dead centre over which both windows are shut, rad, of one sketch.

    Three fifths of full pre-compression, or the most after which leakage at the slowest speed
    leaves the chamber above the case.
    """
    shares = np.linspace(0.02, rules.SHUT_SHARE, 200)
    angles = shares * pre_compression(sketch, conditions)
    slow = conditions._replace(shaft_speed=rules.SLOWEST * conditions.shaft_speed)
    spare = conditions.return_pressure - conditions.case_pressure - rules.LEAK_SPARE
    kept = pressure_leaked_away(sketch, slow, angles) <= spare
    return float(angles[max(int(np.sum(kept)) - 1, 0)])


def shortfalls(found: Sketches, demand: Demand) -> dict[str, np.ndarray]:
    """By what share each sketch misses each rule; zero or less where it is kept."""
    bore = found.sketch.bore
    return {
        "contact_stress": found.contact_stress / rules.STRESS_WANTED - 1,
        "pressure_angle": found.pressure_angle / rules.ANGLE_WANTED - 1,
        "undercut_factor": 1 - found.undercut_factor / rules.UNDERCUT_WANTED,
        "block": rules.LEAST_WALL - found.wall / bore,
        "ports": found.port_drop
        / (rules.PORT_DROP_LIMIT * np.maximum(demand.pressure - found.return_pressure, 1e5))
        - 1,
        "contact": found.return_pressure / rules.RETURN_PRESSURES[1] - 1,
        "outer_diameter": 2 * found.outer_radius / demand.outer_diameter - 1,
    }


def sized(demand: Demand, counts: list[tuple[int, int]] | None = None) -> Sketches:
    """The best motor of every count that keeps all rules, the best first; possibly none."""
    found = candidates(demand, counts)
    if not len(found):
        return found
    missed = np.max(np.stack(list(shortfalls(found, demand).values())), axis=0)
    kept = found.taken(np.flatnonzero(missed <= 1e-9))
    order = np.argsort(kept.score, kind="stable")
    pairs = np.stack([kept.sketch.pistons[order], kept.sketch.lobes[order]], axis=-1)
    _, first = np.unique(pairs, axis=0, return_index=True)
    return kept.taken(order[np.sort(first)])
