"""The ring's two curves as DXF, in millimetres: splines, or polylines of release 12."""

from typing import Any

import numpy as np

from camring.exchange.drawings.about import About
from camring.exchange.drawings.dxf_drawing import (
    as_bytes,
    centre_lines,
    closed_polyline,
    new_drawing,
    notes,
)
from camring.exchange.drawings.ring import Ring
from camring.exchange.drawings.ring_curves import RingCurves, micrometres
from camring.geometry.closed_chain import ClosedChain
from camring.numerics.closed_spline import ClosedSpline

__all__ = ["ring_dxf"]

_CLOSED, _PLANAR = 1, 8


def ring_dxf(ring: Ring, curves: RingCurves, about: About) -> bytes:
    """The DXF file: layers PITCH_CURVE, WORKING_SURFACE, CENTRE and NOTES."""
    drawing = new_drawing(
        about,
        {
            "WORKING_SURFACE": (7, "CONTINUOUS", 50),
            "PITCH_CURVE": (4, "DASHDOT", 25),
            "CENTRE": (1, "CENTER", 18),
            "NOTES": (8, "CONTINUOUS", 18),
        },
        curves.style.is_release_12,
    )
    space = drawing.modelspace()
    _add(space, curves.pitch, "PITCH_CURVE")
    _add(space, curves.surface, "WORKING_SURFACE")
    reach = 1e3 * ring.surface_outer
    centre_lines(space, 1.05 * reach)
    said = [
        *about.lines(),
        "Lengths are in millimetres.",
        f"PITCH_CURVE: path of the roller centre, radius {1e3 * ring.inner[0]:.4f} to "
        f"{1e3 * ring.outer[0]:.4f} mm.",
        f"WORKING_SURFACE: inside of the ring, one roller radius "
        f"({1e3 * ring.roller_radius:.4f} mm) outside it along its normal.",
        f"Each is {curves.each}, normal error at most {micrometres(curves.error)}.",
    ]
    notes(space, (-reach, -1.15 * reach), reach / 40, said)
    return as_bytes(drawing, said)


def _add(space: Any, curve: ClosedSpline | ClosedChain, layer: str) -> None:
    if isinstance(curve, ClosedSpline):
        _add_spline(space, curve, layer)
        return
    corners = [
        (float(point.real), float(point.imag), float(bulge))
        for point, bulge in zip(1e3 * curve.points, curve.bulges, strict=True)
    ]
    closed_polyline(space, corners, layer)


def _add_spline(space: Any, curve: ClosedSpline, layer: str) -> None:
    clamped = curve.clamped()
    points = 1e3 * np.asarray(clamped.c)
    points[-1] = points[0]
    spline = space.add_spline(degree=3, dxfattribs={"layer": layer})
    spline.control_points = [(float(x), float(y), 0.0) for x, y in points]
    spline.knots = [float(knot) for knot in 1e3 * clamped.t]
    spline.dxf.flags = _CLOSED | _PLANAR
    spline.dxf.extrusion = (0, 0, 1)
