"""The curve of a ring in a DXF drawing: splines, arcs, lines and polylines round the shaft.

The shaft is the drawing's origin. A layer WORKING_SURFACE or PITCH_CURVE, as
`camring export` writes them, says what it holds; else one layer must hold the
curve and nothing else.
"""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from camring.files.errors import InputError
from camring.files.motor.document import printable
from camring.files.shapes.given_curve import MOST_POINTS, PITCH, SURFACE, GivenCurve

__all__ = ["read_drawing"]

_LAYERS = {"PITCH_CURVE": PITCH, "WORKING_SURFACE": SURFACE}
_UNITS = {0: 1e-3, 1: 25.4e-3, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0}  # $INSUNITS
_DRAWN = {"SPLINE", "ARC", "LINE", "CIRCLE", "LWPOLYLINE", "POLYLINE"}
_STEP = np.radians(0.25)  # of points on arcs and splines, seen from the shaft
LARGEST_FILE = 20_000_000  # bytes


def read_drawing(path: Path, on: str | None) -> GivenCurve:
    """The points of a ring's curve in a DXF file.

    Parameters
    ----------
    on
        Which curve to take where the drawing holds both, or what its one curve is.

    Raises
    ------
    InputError
        For a file that is no drawing, or holds no curve or several.
    """
    shown = printable(path)
    drawing = _opened(path, shown)
    unit = drawing.header.get("$INSUNITS", 0)
    if unit not in _UNITS:
        raise InputError(
            shown, f"is in a unit of number {str(unit)[:20]} ($INSUNITS)", "save it in mm"
        )
    layers: dict[str, list[Any]] = {}
    for entity in drawing.modelspace():
        if entity.dxftype() in _DRAWN:
            layers.setdefault(str(entity.dxf.layer).upper(), []).append(entity)
    layer, curve = _layer(layers, on, shown)
    points = _UNITS[unit] * _points(layers[layer], f"{shown} layer {layer}")
    notes = [] if unit else ["The drawing does not say its unit; millimetres are taken."]
    if curve is None:
        notes.append(
            f"The curve on layer {layer} is taken for the path of the roller centre; if it is the "
            'ring itself, write profile_curve = "surface".'
        )
    return GivenCurve(
        shown=f"{shown} layer {layer}",
        angles=np.angle(points),
        radii=np.abs(points),
        on=curve or PITCH,
        places=("",) * len(points),
        sorted_by_us=True,
        guessed=curve is None,
        notes=tuple(notes),
    )


def _opened(path: Path, shown: str) -> Any:
    import logging

    logging.getLogger("ezdxf").addHandler(logging.NullHandler())
    import ezdxf
    from ezdxf.lldxf.const import DXFError

    if not path.is_file():
        raise InputError(shown, "does not exist", "name a DXF drawing")
    if path.stat().st_size > LARGEST_FILE:
        raise InputError(shown, f"has more than {LARGEST_FILE:,} bytes", "export the ring alone")
    try:
        return ezdxf.readfile(path)
    except (DXFError, OSError, AttributeError, LookupError, TypeError, ValueError) as error:
        said = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(shown, f"is no DXF drawing ({said})"[:300], "save it as DXF") from None


def _layer(layers: dict[str, list[Any]], on: str | None, shown: str) -> tuple[str, str | None]:
    known = {curve: name for name, curve in _LAYERS.items() if name in layers}
    for wanted in (on,) if on else (PITCH, SURFACE):
        if wanted in known:
            return known[wanted], wanted
    others = [name for name in layers if name not in _LAYERS]
    if len(others) == 1 and not known:
        return others[0], on
    listed = ", ".join(sorted(layers)[:6]) or "none"
    raise InputError(
        shown,
        f"has curves on {len(layers)} layers ({listed}), and none says that it is the ring",
        "put the ring's curve alone on a layer PITCH_CURVE or WORKING_SURFACE",
    )


def _points(entities: list[Any], shown: str) -> np.ndarray:
    """All of a layer as complex numbers, in the drawing's unit."""
    from ezdxf.lldxf.const import DXFError

    try:
        points = np.concatenate([piece for each in entities for piece in _pieces(each)])
        sound = bool(np.all(np.isfinite(points)))
    except (DXFError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        sound = False  # whatever a damaged drawing makes of a curve that somebody else computes
    if not sound:
        raise InputError(
            shown, "holds a curve without points, or one that is none", "export the ring anew"
        )
    return points


def _pieces(entity: Any) -> list[np.ndarray]:
    """Points of an entity as complex numbers, in the drawing's unit; each end once or twice."""
    kind = entity.dxftype()
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return [piece for each in entity.virtual_entities() for piece in _pieces(each)]
    if kind == "LINE":
        ends = [complex(end.x, end.y) for end in (entity.dxf.start, entity.dxf.end)]
        return [np.array(ends)]
    if kind == "SPLINE":
        tool = entity.construction_tool()
        knots = np.unique(np.asarray(tool.knots()))
        each = max(2, int(np.ceil(2 * pi / _STEP / len(knots))))
        within = np.arange(each) / each
        places = (knots[:-1, None] + np.diff(knots)[:, None] * within).reshape(-1)
        return [np.array([complex(p.x, p.y) for p in tool.points([*places, knots[-1]])])]
    centre, radius = complex(entity.dxf.center.x, entity.dxf.center.y), entity.dxf.radius
    if kind == "CIRCLE":
        return [centre + radius * np.exp(1j * np.arange(0, 2 * pi, _STEP))]
    start, end = np.radians([entity.dxf.start_angle, entity.dxf.end_angle])
    turn = (end - start) % (2 * pi)
    # Ends of arcs are written with fewer digits than centres; points within serve as well.
    seen = radius * turn / max(abs(centre + radius * np.exp(1j * start)), 1e-12)
    count = min(max(2, int(np.ceil(seen / _STEP))), MOST_POINTS)
    return [centre + radius * np.exp(1j * (start + turn * (np.arange(count) + 0.5) / count))]
