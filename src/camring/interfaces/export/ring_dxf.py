"""The ring's two curves as DXF: one closed cubic spline each, in millimetres."""

import io
import logging
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from camring.interfaces.export.about import About
from camring.interfaces.export.ring import Ring
from camring.numerics.closed_spline import ClosedSpline

if TYPE_CHECKING:
    from ezdxf.document import Drawing

__all__ = ["as_bytes", "centre_lines", "new_drawing", "notes", "ring_dxf"]

MILLIMETRES = 4
_CLOSED, _PLANAR = 1, 8


def ring_dxf(ring: Ring, about: About) -> bytes:
    """The DXF file: layers PITCH_CURVE, WORKING_SURFACE, CENTRE and NOTES."""
    drawing = new_drawing(
        about,
        {
            "WORKING_SURFACE": (7, "CONTINUOUS", 50),
            "PITCH_CURVE": (4, "DASHDOT", 25),
            "CENTRE": (1, "CENTER", 18),
            "NOTES": (8, "CONTINUOUS", 18),
        },
    )
    space = drawing.modelspace()
    _add_spline(space, ring.pitch, "PITCH_CURVE")
    _add_spline(space, ring.surface, "WORKING_SURFACE")
    reach = 1e3 * ring.surface_outer
    centre_lines(space, 1.05 * reach)
    notes(
        space,
        (-reach, -1.15 * reach),
        reach / 40,
        [
            *about.lines(),
            f"PITCH_CURVE: path of the roller centre, radius {1e3 * ring.inner[0]:.4f} to "
            f"{1e3 * ring.outer[0]:.4f} mm.",
            f"WORKING_SURFACE: inside of the ring, one roller radius "
            f"({1e3 * ring.roller_radius:.4f} mm) outside it along its normal.",
            f"Each is one closed cubic spline, normal error at most "
            f"{1e6 * max(ring.pitch.error, ring.surface.error):.2g} um.",
        ],
    )
    return as_bytes(drawing)


def new_drawing(about: About, layers: dict[str, tuple[int, str, int]]) -> "Drawing":
    """An empty drawing in millimetres; layers have colour, line type and width in 0.01 mm."""
    # Imported, it lists the system's fonts, and would warn where it cannot keep the list.
    logging.getLogger("ezdxf").addHandler(logging.NullHandler())
    import ezdxf

    drawing = ezdxf.new("R2010", setup=["linetypes"], units=MILLIMETRES)
    drawing.header["$MEASUREMENT"] = 1
    drawing.header.custom_vars.append("Motor", about.motor)
    drawing.header.custom_vars.append("Program", about.program)
    drawing.header.custom_vars.append("Motor file", f"{about.file} sha256 {about.digest}")
    for name, (colour, linetype, width) in layers.items():
        drawing.layers.add(name, color=colour, linetype=linetype, lineweight=width)
    return drawing


def as_bytes(drawing: "Drawing") -> bytes:
    text = io.StringIO()
    drawing.write(text)
    return text.getvalue().encode("utf-8")


def centre_lines(space: Any, reach: float) -> None:
    """A cross through the shaft, mm."""
    for x, y in ((reach, 0.0), (0.0, reach)):
        space.add_line((-x, -y), (x, y), dxfattribs={"layer": "CENTRE"})


def notes(space: Any, corner: tuple[float, float], height: float, lines: list[str]) -> None:
    """Lines of text below each other, the long ones folded, mm."""
    rows = [row for line in lines for row in textwrap.wrap(line, 84)]
    for row, line in enumerate(rows):
        space.add_text(
            line,
            height=height,
            dxfattribs={"layer": "NOTES", "insert": (corner[0], corner[1] - 1.7 * height * row)},
        )


def _add_spline(space: Any, curve: ClosedSpline, layer: str) -> None:
    clamped = curve.clamped()
    points = 1e3 * np.asarray(clamped.c)
    points[-1] = points[0]
    spline = space.add_spline(degree=3, dxfattribs={"layer": layer})
    spline.control_points = [(float(x), float(y), 0.0) for x, y in points]
    spline.knots = [float(knot) for knot in 1e3 * clamped.t]
    spline.dxf.flags = _CLOSED | _PLANAR
    spline.dxf.extrusion = (0, 0, 1)
