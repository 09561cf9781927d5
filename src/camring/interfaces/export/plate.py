"""The valve plate's ports as DXF, and their edges as a table."""

from math import cos, degrees, pi, radians, sin, tan
from typing import Any

from camring.geometry.port_shape import PlatePorts, PortError, Slot, ports_of
from camring.interfaces.config import MotorFile
from camring.interfaces.config.document import printable
from camring.interfaces.errors import InputError
from camring.interfaces.export.about import About
from camring.interfaces.export.ring_dxf import as_bytes, centre_lines, new_drawing, notes
from camring.interfaces.export.ring_points import table_csv

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
    told = [
        f"Port circle radius {1e3 * ports.circle:.4f} mm, {source}"
        + ("." if asked else "; choose one with --port-circle.")
    ]
    if ports.shape == "timing":
        return [
            *told,
            "The window is a table, which gives no shape: the bands show only the angles at which "
            "the middle of a chamber's port finds the window open.",
        ]
    what = "diameter" if ports.shape == "round" else "radial height"
    told.append(
        f"Chamber port {degrees(ports.chamber_width):.4f} deg wide, {what} "
        f"{1e3 * ports.height:.4f} mm, from port area and ramp; a slot is narrower than its window "
        "by that width, so that the window opens and closes at the angles of the table."
    )
    if ports.ramp_error:
        told.append(
            f"With these ports the worse kind of window takes {100 * ports.ramp_error:+.2g} % of "
            "its ramp longer to open fully than the model says; all edges are exact."
        )
    return told


def plate_table(ports: PlatePorts, about: About, asked: bool) -> bytes:
    """The table of edges as CSV, one row for each port, degrees in [0, 360)."""
    told = [
        *about.lines(),
        "opens to closes: where the middle of a chamber's port stands while the port is open to "
        "it; slot_start and slot_end: the edges of the slot in the plate.",
        *assumptions(ports, asked),
    ]
    rows = [[slot.kind, str(slot.number), *_edges(ports, slot)] for slot in ports.slots]
    return table_csv(told, EDGES, rows)


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
    return ["" if angle is None else f"{degrees(angle) % 360:.6f}" for angle in angles]


def plate_dxf(ports: PlatePorts, about: About, asked: bool) -> bytes:
    """The DXF file: slots, a chamber's port at angle 0, timing angles, dimensions."""
    drawing = new_drawing(about, _LAYERS)
    space = drawing.modelspace()
    inner, outer = 1e3 * ports.inner, 1e3 * ports.outer
    height = outer / 45
    space.add_circle((0, 0), 1e3 * ports.circle, dxfattribs={"layer": "PORT_CIRCLE"})
    centre_lines(space, 1.3 * outer)
    for slot in ports.slots:
        _outline(space, ports, slot.start, slot.end, f"{slot.kind.upper()}_PORTS")
        if slot.notch_tip is not None and ports.shape != "timing":
            _notch(space, ports, slot)
        _timing(space, ports, slot, height)
    if ports.chamber_width:
        half = ports.chamber_width / 2
        _outline(space, ports, -half, half, "CHAMBER_PORT")
    for slot in (_first(ports, "supply"), _first(ports, "return")):
        _dimension(drawing, slot.start, slot.end, inner, inner - 4 * height, height)
    notes(
        space,
        (-1.3 * outer, -1.4 * outer),
        height,
        [
            *about.lines(),
            *assumptions(ports, asked),
            "CHAMBER_PORT is drawn where a piston at angle 0 stands. Angles written at the edges: "
            "where the middle of a chamber's port stands when the port opens to it and closes.",
        ],
    )
    return as_bytes(drawing)


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
    space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs={"layer": layer})


def _notch(space: Any, ports: PlatePorts, slot: Slot) -> None:
    """The groove in plan: a triangle from its tip to the slot's edge."""
    assert slot.notch_tip is not None
    middle, reach = 1e3 * ports.circle, 1e3 * ports.height / 8
    corners = [
        _at(middle, slot.notch_tip),
        _at(middle + reach, slot.start),
        _at(middle - reach, slot.start),
    ]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "NOTCHES"})


def _timing(space: Any, ports: PlatePorts, slot: Slot, height: float) -> None:
    """A tick and its angle in degrees where a window opens and where it closes."""
    from ezdxf.enums import TextEntityAlignment

    outer = 1e3 * ports.outer
    for angle in (slot.opens, slot.closes):
        inside, outside = _at(1e3 * ports.inner, angle), _at(outer + 2 * height, angle)
        space.add_line(inside, outside, dxfattribs={"layer": "TIMING"})
        turned = degrees(angle) % 360
        flipped = 90 < turned < 270
        text = space.add_text(
            f"{turned:.3f}%%d",
            height=height,
            rotation=turned + 180 if flipped else turned,
            dxfattribs={"layer": "TIMING"},
        )
        place = TextEntityAlignment.MIDDLE_RIGHT if flipped else TextEntityAlignment.MIDDLE_LEFT
        text.set_placement(_at(outer + 2.5 * height, angle), align=place)


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
