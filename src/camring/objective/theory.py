"""Designs that a page of theory gives: zero-ripple cams with matching port timing.

They need no evaluation to be written down, so a search may begin with them:
spline cams whose geometric torque ripple is zero (docs/theory.md section 11), and
windows that open and close where ideal commutation would, ahead by none, half
or all of the angle that pre-compression of the oil takes.
"""

from math import pi
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.optimize import lsq_linear

from camring.geometry.cam import AbstractCam
from camring.geometry.contour import pressure_angle, undercut_factor
from camring.geometry.profiles import zero_ripple_cams
from camring.numerics.compilation import one_program
from camring.numerics.selection import largest, smallest
from camring.objective.cam_modes import CamModes, control_values, unit_point_for
from camring.objective.design_space import DesignSpace, Variable
from camring.physics.contact import hertz_stress, normal_force
from camring.physics.system import System

HELD = 0.01  # of the range of control values: what a space may miss of a cam it "holds"
PRE_COMPRESSION = (1.0, 0.5, 0.0)  # shares of the full angle
_ANGLES = 2048
_FAITHFUL = 1e-3  # pull towards the given timing where edges leave a choice


class Limits(NamedTuple):
    """The limits that a cam alone can break; None where there is none."""

    min_undercut_factor: float | None = 0.0
    max_pressure_angle: float | None = None
    max_contact_stress: float | None = None


def theory_designs(
    system: System, space: DesignSpace, limits: Any = None, most: int = 12
) -> Float[np.ndarray, "design coordinate"]:
    """Points of the space that theory recommends, the most promising first.

    Parameters
    ----------
    limits
        Anything with the attributes of `Limits`, such as the `Constraints` of a
        goal: cams that break none of them come first.
    most
        Largest number of designs.

    Returns
    -------
    Unit points, possibly none: the space may hold no zero-ripple cam (too few
    modes, amplitudes too small), or the counts may allow none.
    """
    cams, within = _cam_points(system, space, limits or Limits())
    timings = _timing_points(system, space)
    # Cams within the limits first; then by the sum of ranks: the best cam with the best
    # timing, then its neighbours.
    pairs = sorted(
        (not within[i], i + j, i, j) for i in range(len(cams)) for j in range(len(timings))
    )
    designs: list[np.ndarray] = []
    for _, _, i, j in pairs:
        design = np.concatenate([timings[j], cams[i]])
        if all(np.max(np.abs(design - each), initial=0) > 1e-6 for each in designs):
            designs.append(design)
    return np.array(designs[:most]).reshape(-1, space.dimension)


def _cam_points(
    system: System, space: DesignSpace, limits: Any
) -> tuple[list[np.ndarray], list[bool]]:
    """Coordinates of the zero-ripple cams that the space holds, best first; within limits?"""
    if space.cam is None:
        return [np.zeros(0)], [True]
    motor, modes = system.motor, space.cam
    given = np.asarray(control_values(motor.cam))
    count = modes.count // modes.lobes
    if count * modes.lobes != modes.count:
        return [], []
    first = np.sum(given * np.exp(-2j * pi * modes.lobes * np.arange(len(given)) / len(given)))
    turned = round(np.angle(-first) / (-2 * pi) * count)  # control values to the dead centre
    points = []
    for cam in zero_ripple_cams(motor.pistons, motor.lobes, count, motor.cam.degree):
        lobe = np.roll(cam.control_values(count), turned) * np.ptp(given)
        point, missed = unit_point_for(modes, system, np.tile(lobe, modes.lobes))
        if missed < HELD and np.all((point >= 0) & (point <= 1)):
            points.append(point)
    if not points:
        return [], []
    undercut, angle, stress = map(np.asarray, _cams_facts(system, modes, np.array(points)))
    broken = (
        _excess(-undercut, limits.min_undercut_factor, -1)
        + _excess(angle, limits.max_pressure_angle)
        + _excess(stress, limits.max_contact_stress)
    )
    # Among cams within the limits the one with most undercut margin comes first.
    order = np.lexsort((-undercut, np.round(broken, 9)))
    return [points[place] for place in order], [bool(broken[place] < 1e-9) for place in order]


@one_program
def _cams_facts(
    system: System, modes: CamModes, points: Float[np.ndarray, "cam mode"]
) -> tuple[Array, Array, Array]:
    """`_cam_facts` of several designs."""
    return jax.vmap(lambda point: _cam_facts(system, modes.apply(system.motor.cam, point)))(points)


def _excess(value: np.ndarray, limit: float | None, sign: int = 1) -> np.ndarray:
    """What a value exceeds a limit by, as a share of it."""
    if limit is None:
        return np.zeros_like(value)
    return np.maximum(value - sign * float(limit), 0) / max(abs(float(limit)), 1e-9)


def _cam_facts(system: System, cam: AbstractCam) -> tuple[Array, Array, Array]:
    """Least undercut factor, greatest pressure angle and contact stress at supply pressure."""
    motor = system.motor
    angles = cam.period * jnp.arange(16 * cam.control_count) / (16 * cam.control_count)
    radius = cam.pitch_radius(angles)
    pressed = largest(
        jnp.stack([p.supply_pressure - p.case_pressure for p in system.operating_points])
    )
    force = jnp.where(radius.first >= 0, motor.piston.area * pressed, 0.0)
    stress = hertz_stress(normal_force(force, radius), radius, motor.roller, motor.ring_material)
    return (
        smallest(undercut_factor(radius, motor.roller.radius)),
        largest(jnp.abs(pressure_angle(radius))),
        largest(stress),
    )


def _window_edges(system: System) -> Array:
    """Opening and closing of supply and return within the first lobe pitch, rad."""
    plate = system.motor.valve_plate
    edges = [
        port.centre + plate.shift + side * port.width / 2
        for port in (plate.supply, plate.return_)
        for side in (-1, 1)
    ]
    return jnp.stack(edges)


def _timing_points(system: System, space: DesignSpace) -> list[np.ndarray]:
    """Coordinates of all variables but the cam's: wanted timings first, the given one last."""
    count = len(space.variables)
    given = space.locate(system)[:count]
    if count == 0:
        return [given]

    now, slope = map(np.asarray, _edges_and_slopes(system, space.variables, given))
    movable = np.any(np.abs(slope) > 0, axis=0)
    points = []
    if np.any(movable):
        for share in PRE_COMPRESSION:
            wanted = ideal_edges(system, share)
            # The nearest turn of the same windows.
            pitch = system.motor.valve_plate.pitch
            wanted = wanted + pitch * np.round(np.mean(now - wanted) / pitch)
            faithful = _FAITHFUL * np.linalg.norm(slope) * np.eye(count)
            found = lsq_linear(
                np.vstack([slope, faithful]),
                np.concatenate([wanted - now, np.zeros(count)]),
                bounds=(-given - 1e-12, 1 - given + 1e-12),
            )
            points.append(np.where(movable, np.clip(given + found.x, 0, 1), given))
    return [*points, given]


@one_program
def _edges_and_slopes(
    system: System, variables: tuple[Variable, ...], point: Float[np.ndarray, " variable"]
) -> tuple[Array, Array]:
    """Of the windows at a point, and by each coordinate."""

    def edges(point: Array) -> Array:
        moved = system
        for place, variable in enumerate(variables):
            moved = variable.apply(moved, point[place])
        return _window_edges(moved)

    at = jnp.asarray(point)
    return edges(at), jax.jacfwd(edges)(at)


@one_program
def _commutation(system: System) -> tuple[Array, Array, Array, Array]:
    """Pitch radius over a pitch, every drop, the oil's modulus at mean pressure, piston area."""
    motor, points = system.motor, system.operating_points
    angles = motor.valve_plate.pitch * jnp.arange(_ANGLES) / _ANGLES
    drops = jnp.stack([each.pressure_drop for each in points])
    mean = jnp.mean(jnp.stack([each.supply_pressure for each in points]))
    radius = motor.cam.pitch_radius(angles).value
    return radius, drops, system.fluid.bulk_modulus_at(mean), motor.piston.area


def ideal_edges(system: System, share: float) -> Float[np.ndarray, " edge"]:
    """Opening and closing of supply and return for ideal commutation, rad.

    Supply opens at the inner dead centre and return at the outer. Each closes
    ahead of the next dead centre by a share of the angle in which the piston
    alone would bring the oil to the other pressure.

    Notes
    -----
    The lift near a dead centre is that of the given cam; `V dp/beta` of oil has
    to be pressed together or let expand, at the mean pressure drop of the
    operating points.
    """
    pitch, dead = system.motor.valve_plate.pitch, float(system.motor.dead_volume)
    angles = pitch * np.arange(_ANGLES) / _ANGLES
    radius, drops, *numbers = map(np.asarray, _commutation(system))
    modulus, area = map(float, numbers)
    # Where it brakes, the high pressure comes from the return: nothing is gained by closing early.
    drop = float(np.mean([max(float(each), 0.0) for each in drops]))
    inner, outer = angles[np.argmin(radius)], angles[np.argmax(radius)]
    stroke = float(np.ptp(radius))

    def ahead(centre: float, volume: float) -> float:
        needed = min(volume * drop / modulus / area, stroke / 4)
        back = np.arange(512) / 512 * pitch / 2
        at = np.interp((centre - back) % pitch, angles, radius, period=pitch)
        moved = np.abs(at - at[0])
        return float(back[int(np.argmax(moved >= needed))])

    outer = outer if outer > inner else outer + pitch
    return np.array(
        [
            inner,
            outer - share * ahead(outer, dead + area * stroke),
            outer,
            inner + pitch - share * ahead(inner, dead),
        ]
    )
