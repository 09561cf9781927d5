"""The valve plate's ports as DXF, and their edges as a table."""

from itertools import pairwise
from math import cos, degrees, pi, radians, sin, tan
from typing import Any

from camring.exchange.drawings.about import About
from camring.exchange.drawings.dxf_drawing import (
    as_bytes,
    centre_lines,
    closed_polyline,
    new_drawing,
    notes,
)
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.geometry.port_shape import PlatePorts, PortError, Slot, ports_of

__all__ = ["EDGES", "assumptions", "circle_from", "plate_dxf", "plate_ports", "plate_table"]

# Column of the table of edges -> unit.
EDGES = {
    "port": "-",
    "number": "-",
    "opens": "deg",
    "full_from": "deg",
    "centre": "deg",
    "full_until": "deg",
    "closes": "deg",
    "slot_start": "deg",
    "slot_end": "deg",
    "notch_tip": "deg",
}
_LAYERS = {
    "SUPPLY_PORTS": (1, "CONTINUOUS", 50),
    "RETURN_PORTS": (5, "CONTINUOUS", 50),
    "NOTCHES": (3, "CONTINUOUS", 35),
    "CHAMBER_PORT": (8, "PHANTOM", 25),
    "PORT_CIRCLE": (8, "DASHDOT", 18),
    "CENTRE": (1, "CENTER", 18),
    "TIMING": (6, "CONTINUOUS", 13),
    "DIMENSIONS": (6, "CONTINUOUS", 13),
    "NOTES": (8, "CONTINUOUS", 18),
}


def plate_ports(file: MotorFile, circle: float | None) -> PlatePorts:
    """The ports of a motor file on a port circle (m); by default half the smallest pitch radius.

    Raises
    ------
    InputError
        When they cannot be cut.
    """
    from camring.geometry.outline import outline_of

    motor = file.system.motor
    usual = outline_of(motor.cam).extreme_radius(-1)[0] / 2
    try:
        return ports_of(motor.valve_plate, usual, circle)
    except PortError as error:
        least = error.least_radius
        way = (
            "narrow [motor.valve_plate] supply_width and return_width, or lessen shift's overlap"
            if least is None
            else f"give --port-circle of at least {1e3 * least:.4g} mm, a smaller port_area, or a "
            "larger ramp"
        )
        raise InputError(
            printable(file.path), error.problem, f"{way}; or leave out `plate` and `sheet`"
        ) from (error)


def circle_from(ports: PlatePorts, asked: bool) -> str:
    """Where the radius of the port circle comes from, in words."""
    if asked:
        return "as asked for"
    if ports.shape == "round":
        return "at which round ports of this area open as modelled"
    return "assumed"


def assumptions(ports: PlatePorts, asked: bool) -> list[str]:
    """What the drawing takes for granted because the motor file does not say it."""
    source = circle_from(ports, asked)
    remarks = [
        f"Port circle radius {1e3 * ports.circle:.4f} mm, {source}"
        + ("." if asked else "; choose one with --port-circle.")
    ]
    if ports.shape == "timing":
        return [
            *remarks,
            "A window given by a table, or areas that differ between supply and return, give no "
            "shape: the bands show only the angles at which the middle of a chamber's port finds "
            "the window open.",
        ]
    what = "diameter" if ports.shape == "round" else "radial height"
    remarks.append(
        f"Chamber port {degrees(ports.chamber_width):.4f} deg wide, {what} "
        f"{1e3 * ports.height:.4f} mm, from port area and ramp; a slot is narrower than its window "
        "by that width, so that the window opens and closes at the angles of the table."
    )
    if ports.ramp_error:
        share = 100 * abs(ports.ramp_error)
        words = "longer" if ports.ramp_error > 0 else "shorter"
        remarks.append(
            f"With these ports the ramp of the worse kind of window is {share:.2g} % {words} than "
            "the model says; all edges are exact."
        )
    return remarks


def plate_table(
    ports: PlatePorts, about: About, asked: bool, decimal: Decimal = Decimal.POINT
) -> bytes:
    """The table of edges as CSV, one row for each port, degrees in [0, 360)."""
    remarks = [
        *about.lines(),
        "opens to closes: where the middle of a chamber's port stands while the port is open to "
        "it; slot_start and slot_end: the edges of the slot in the plate.",
        *assumptions(ports, asked),
    ]
    rows = [[slot.kind, str(slot.number), *_edges(ports, slot)] for slot in ports.slots]
    names = [named(name, unit) for name, unit in EDGES.items()]
    return csv_table(names, rows, remarks=remarks, decimal=decimal).encode("utf-8")


def _edges(ports: PlatePorts, slot: Slot) -> list[str]:
    shape_known = ports.shape != "timing"
    angles = (
        slot.opens,
        slot.full_from if shape_known else None,
        slot.centre,
        slot.full_until if shape_known else None,
        slot.closes,
        slot.start if shape_known else None,
        slot.end if shape_known else None,
        slot.notch_tip if shape_known else None,
    )
    return ["NaN" if angle is None else f"{degrees(angle) % 360:.6f}" for angle in angles]


def plate_dxf(ports: PlatePorts, about: About, asked: bool, release_12: bool = False) -> bytes:
    """The DXF file: slots, a chamber's port at angle 0, timing angles, dimensions."""
    drawing = new_drawing(about, _LAYERS, release_12)
    space = drawing.modelspace()
    inner, outer = 1e3 * ports.inner, 1e3 * ports.outer
    height = outer / 45
    space.add_circle((0, 0), 1e3 * ports.circle, dxfattribs={"layer": "PORT_CIRCLE"})
    centre_lines(space, 1.25 * outer)
    for slot in ports.slots:
        _outline(space, ports, slot.start, slot.end, f"{slot.kind.upper()}_PORTS")
        if slot.notch_tip is not None and ports.shape != "timing":
            _notch(space, ports, slot)
    _timing(space, ports, height)
    if ports.chamber_width:
        half = ports.chamber_width / 2
        _outline(space, ports, -half, half, "CHAMBER_PORT")
    for slot in (_first(ports, "supply"), _first(ports, "return")):
        _dimension(drawing, slot.start, slot.end, inner, inner - 4 * height, height)
    said = [
        *about.lines(),
        "Lengths are in millimetres.",
        *assumptions(ports, asked),
        "CHAMBER_PORT is drawn where a piston at angle 0 stands. Angles written at the edges: "
        "where the middle of a chamber's port stands when the port opens to it and closes.",
    ]
    notes(space, (-1.3 * outer, -1.4 * outer), height, said)
    return as_bytes(drawing, said)


def _first(ports: PlatePorts, kind: str) -> Slot:
    return next(slot for slot in ports.slots if slot.kind == kind)


def _at(radius: float, angle: float) -> tuple[float, float]:
    return radius * cos(angle), radius * sin(angle)


def _outline(space: Any, ports: PlatePorts, start: float, end: float, layer: str) -> None:
    """A closed line of true arcs round a slot or port, mm."""
    inner, outer, circle = 1e3 * ports.inner, 1e3 * ports.outer, 1e3 * ports.circle
    if ports.shape == "round":
        half = ports.chamber_width / 2
        start, end = start + half, end - half
        if end - start < 1e-9:
            space.add_circle(
                _at(circle, start), 1e3 * ports.height / 2, dxfattribs={"layer": layer}
            )
            return
    bend = tan((end - start) / 4)
    cap = 1.0 if ports.shape == "round" else 0.0
    corners = [
        (*_at(outer, start), bend),
        (*_at(outer, end), cap),
        (*_at(inner, end), -bend),
        (*_at(inner, start), cap),
    ]
    closed_polyline(space, corners, layer)


def _notch(space: Any, ports: PlatePorts, slot: Slot) -> None:
    """The groove in plan: a triangle from its tip to the slot's edge."""
    assert slot.notch_tip is not None
    middle, reach = 1e3 * ports.circle, 1e3 * ports.height / 8
    corners = [
        (*_at(middle, slot.notch_tip), 0.0),
        (*_at(middle + reach, slot.start), 0.0),
        (*_at(middle - reach, slot.start), 0.0),
    ]
    closed_polyline(space, corners, "NOTCHES")


def _timing(space: Any, ports: PlatePorts, height: float) -> None:
    """A tick and its angle in degrees where a window opens and where it closes.

    Ticks whose words would lie on each other bend apart.
    """
    from ezdxf.enums import TextEntityAlignment

    inner, outer = 1e3 * ports.inner, 1e3 * ports.outer
    edges = sorted(each % (2 * pi) for slot in ports.slots for each in (slot.opens, slot.closes))
    for angle, shown in zip(edges, _apart(edges, 1.5 * height / (outer + 5 * height)), strict=True):
        corners = (
            _at(inner, angle),
            _at(outer + height, angle),
            _at(outer + 4 * height, shown),
        )
        for start, end in pairwise(corners):
            space.add_line(start, end, dxfattribs={"layer": "TIMING"})
        turned = degrees(angle) % 360
        flipped = 90 < turned < 270
        text = space.add_text(
            f"{turned:.3f}%%d",
            height=height,
            rotation=degrees(shown) + 180 if flipped else degrees(shown),
            dxfattribs={"layer": "TIMING"},
        )
        place = TextEntityAlignment.MIDDLE_RIGHT if flipped else TextEntityAlignment.MIDDLE_LEFT
        text.set_placement(_at(outer + 4.5 * height, shown), align=place)


def _apart(angles: list[float], least: float) -> list[float]:
    """Ascending angles of a turn, each pair that is nearer than `least` moved apart alike."""
    shown = list(angles)
    for place in range(-1, len(angles) - 1):
        short = least - (angles[place + 1] - angles[place]) % (2 * pi)
        if short > 0:
            shown[place] -= short / 2
            shown[place + 1] += short / 2
    return shown


def _dimension(
    drawing: Any, start: float, end: float, edge: float, radius: float, height: float
) -> None:
    """An angular dimension of a slot, inside the ports."""
    if radius <= 0 or not radians(0.01) < end - start < pi:
        return
    found = drawing.modelspace().add_angular_dim_cra(
        center=(0, 0),
        radius=edge,
        start_angle=degrees(start),
        end_angle=degrees(end),
        distance=radius - edge,
        override={"dimtxt": height, "dimasz": height, "dimexe": height / 2, "dimadec": 3},
        dxfattribs={"layer": "DIMENSIONS"},
    )
    found.render()
