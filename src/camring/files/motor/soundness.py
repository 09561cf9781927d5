"""What each value may be on its own but not together: refused before anything is simulated."""

from math import degrees, pi
from typing import Any

import numpy as np

from camring.files.errors import InputError, quote
from camring.files.modes import idle_lobes_of, modes_of
from camring.files.motor.sound_laws import notched, require_sound_laws
from camring.files.motor.tables import (
    CamTable,
    ConstraintsTable,
    FileTables,
    MotorTable,
    ObjectiveTable,
    PlanarCamTable,
    RadialCamTable,
)
from camring.geometry.sampling import Samples, from_first, sample_spline, turning

LEAST_STROKE = 1e-7  # m; below it lies a circle with rounding errors


def require_sound(tables: FileTables, document: dict[str, Any]) -> None:
    """Refuse a motor that cannot exist or an operating point at which nothing drives it.

    Raises
    ------
    InputError
        With the numbers that clash.
    """
    motor, given = tables.motor, document["motor"]
    _require_windows_fit(motor, given["valve_plate"])
    require_sound_laws(tables, document)
    radius = _pitch_radius(motor, given["cam"])
    _require_volume(motor, given, radius)
    _require_body(motor, given["cam"], radius)
    _require_pressing_spring(motor, given, radius)
    _require_modes(tables)
    _require_drop(tables, document["operating_points"])
    _require_no_notch_backwards(tables)
    _require_an_aim(tables.objective)
    _require_gap_between(tables.constraints)


def period_of(motor: MotorTable) -> float:
    """Angle after which the cam repeats, rad."""
    return 2 * pi / (motor.lobes if motor.cam.symmetry == "lobes" else 1)


def _require_windows_fit(motor: MotorTable, given: dict[str, Any]) -> None:
    pitch = 2 * pi / motor.lobes
    for key in ("supply_width", "return_width"):
        width = getattr(motor.valve_plate, key)
        if width > pitch * (1 + 1e-12):
            raise InputError(
                f"motor.valve_plate.{key}",
                f"is {quote(given[key])}, wider than the pitch of {degrees(pitch):.4g} deg "
                f"that {motor.lobes} lobes leave",
                f"give at most {degrees(pitch):.4g} deg; a window as wide as half the pitch, "
                f"{degrees(pitch) / 2:.4g} deg, just touches its neighbours",
            )


def _pitch_radius(motor: MotorTable, given: dict[str, Any]) -> Samples:
    cam = motor.cam
    if isinstance(cam, PlanarCamTable):
        _require_enough("control_points", len(cam.control_points), cam)
        return _star_shaped(cam, motor)
    assert isinstance(cam, RadialCamTable)
    _require_enough("control_radii", len(cam.control_radii), cam)
    return sample_spline(np.array(cam.control_radii), period_of(motor), cam.degree)


def _require_enough(key: str, count: int, cam: CamTable) -> None:
    if count <= cam.degree:
        raise InputError(
            f"motor.cam.{key}",
            f"has {count} values but a spline of degree {cam.degree} needs at least "
            f"{cam.degree + 1} in a period",
            "give more, 12 to 24 for a smooth lobe",
        )


def _star_shaped(cam: PlanarCamTable, motor: MotorTable) -> Samples:
    repeats = motor.lobes if cam.symmetry == "lobes" else 1
    points = from_first(np.array(cam.control_points), repeats)
    found = turning(points, repeats, cam.degree)
    field = "motor.cam.control_points"
    if found.winding == -1:
        raise InputError(field, "run clockwise round the shaft", "reverse their order")
    if found.winding != 1:
        covered = "ring" if repeats == 1 else f"lobe pitch of {360 / repeats:.4g} deg"
        raise InputError(
            field,
            f"lead {found.winding} times round the shaft where the curve must go round once",
            f"give the points of one {covered}, anticlockwise round the origin",
        )
    if found.least <= 0 or found.lag > 0.95 * pi:
        raise InputError(
            field,
            "make a curve that is not star-shaped about the shaft: near the polar angle "
            f"{degrees(found.angle):.4g} deg it turns back or crosses itself",
            "move the points there so that each lies further round than the one before",
        )
    return found.radius


def _require_volume(motor: MotorTable, given: dict[str, Any], radius: Samples) -> None:
    low, high = float(np.min(radius.value)), float(np.max(radius.value))
    if high - low < LEAST_STROKE:
        raise InputError(
            "motor.cam",
            f"is a circle of radius {low * 1e3:.6g} mm: the stroke is zero",
            "let the control values rise and fall with the lobes",
        )
    reference = motor.cam.reference_radius
    if reference == "minimum":
        return
    zero = float(np.mean(radius.value)) if reference == "mean" else float(reference)
    area = pi * motor.bore**2 / 4
    volume = motor.dead_volume + area * (low - zero)
    if volume <= 0:
        place = degrees(float(radius.angle[int(np.argmin(radius.value))]))
        raise InputError(
            "motor.dead_volume",
            f"is {quote(given['dead_volume'])}, so the chamber volume falls to "
            f"{volume * 1e6:.4g} cm^3 at {place:.4g} deg",
            f"give more than {area * (zero - low) * 1e6:.4g} cm^3 for this stroke, "
            'or set motor.cam.reference_radius = "minimum"',
        )


def _require_body(motor: MotorTable, given: dict[str, Any], radius: Samples) -> None:
    """A body smaller than all of its inside is a slip: a radius where a diameter is asked for.

    One that only the cam's deepest places pierce is a warning of `check`, and refused where it is
    drawn: a search may come there.
    """
    outer = motor.cam.outer_diameter
    inside = 2 * (float(np.min(radius.value)) + motor.roller.radius)
    if outer is None or outer > inside:
        return
    raise InputError(
        "motor.cam.outer_diameter",
        f"is {quote(given['outer_diameter'])}, within the working surface, whose diameter begins "
        f"at {1e3 * inside:.5g} mm",
        f'give a diameter; if that is the radius, write "{2e3 * outer:.6g} mm"',
    )


def _require_pressing_spring(motor: MotorTable, given: dict[str, Any], radius: Samples) -> None:
    """A spring that comes loose on the way out would pull in the model."""
    if motor.piston is None:
        return
    stroke = float(np.max(radius.value) - np.min(radius.value))
    needed = motor.piston.spring_rate * stroke
    if motor.piston.spring_preload < needed:
        raise InputError(
            "motor.piston.spring_preload",
            f"is {quote(given['piston']['spring_preload'])}, less than the {needed:.4g} N by which "
            f"the spring gives way over the stroke of {1e3 * stroke:.4g} mm, so that it is loose "
            "at the outer dead centre",
            f"give at least {needed:.4g} N, or a smaller spring_rate",
        )


def _require_modes(tables: FileTables) -> None:
    modes = modes_of(tables.motor.modes or {}, tables.motor.lobes)
    before = tables.motor.manifolds()
    if modes and before:
        raise InputError(
            "[motor.modes]",
            f"needs windows at the set pressure, and {before[0]} puts a volume before them",
            "leave one of the two out",
        )
    for place, point in enumerate(tables.operating_points):
        idle_lobes_of(modes, point.mode, place)


def _require_drop(tables: FileTables, given: list[dict[str, Any]]) -> None:
    for place, point in enumerate(tables.operating_points):
        if point.supply_pressure == point.return_pressure:
            raise InputError(
                f"[[operating_points]] {place + 1}, supply_pressure",
                f"is {quote(given[place]['supply_pressure'])}, the return pressure itself",
                "raise it for a motor, or lower it for one that brakes; both are absolute",
            )
    if not any(point.weight > 0 for point in tables.operating_points):
        raise InputError(
            "[[operating_points]] 1, weight",
            "is zero, like that of every operating point",
            "give one a weight above zero",
        )


def _require_no_notch_backwards(tables: FileTables) -> None:
    if not notched(tables.motor.valve_plate):
        return
    for place, point in enumerate(tables.operating_points):
        if point.rotation == "reverse":
            raise InputError(
                f"[[operating_points]] {place + 1}, rotation",
                'is "reverse", but a relief notch lies at the opening edge of its window, and '
                "backwards that edge closes, which the model does not have",
                "leave motor.valve_plate.notch_angle and notch_area out, those of one side as "
                "well, or let the motor turn forwards only",
            )


def _require_an_aim(objective: ObjectiveTable) -> None:
    terms = ("torque_ripple", "pressure_ripple", "efficiency", "spectrum", "jerk")
    if not any(getattr(objective, term) > 0 for term in terms):
        raise InputError(
            "[objective]",
            "gives no term a weight above zero",
            "give at least one of " + ", ".join(terms),
        )
    for key in ("spectral_pressure", "spectral_torque"):
        given = key in objective.model_fields_set and getattr(objective, key) > 0
        if given and objective.spectrum == 0:
            raise InputError(
                f"objective.{key}",
                "has no effect with objective.spectrum = 0",
                "leave it out, or give objective.spectrum a weight",
            )


def _require_gap_between(constraints: ConstraintsTable) -> None:
    low, high = constraints.min_pressure, constraints.max_pressure
    if low is not None and high is not None and low >= high:
        raise InputError(
            "constraints.min_pressure",
            f"of {low / 1e5:.4g} bar is not below max_pressure of {high / 1e5:.4g} bar",
            "lower it or raise constraints.max_pressure",
        )
