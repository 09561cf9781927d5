"""An empty DXF drawing in millimetres, what all of ours have in it, and its bytes.

Release 2010 holds splines and says its unit (`$INSUNITS`); release 12 holds straight
lines and arcs only and has no word for a unit, so its comments and notes say it.
"""

import io
import logging
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from camring.exchange.drawings.about import About

if TYPE_CHECKING:
    from ezdxf.document import Drawing

__all__ = ["as_bytes", "centre_lines", "closed_polyline", "new_drawing", "notes"]

MILLIMETRES = 4
_RELEASE_12 = "AC1009"
_MARGIN = 1.02  # of the height that a program shows at first


def new_drawing(
    about: About, layers: dict[str, tuple[int, str, int]], release_12: bool = False
) -> "Drawing":
    """An empty drawing in millimetres; layers have colour, line type and width in 0.01 mm."""
    # Imported, it lists the system's fonts, and would warn where it cannot keep the list.
    logging.getLogger("ezdxf").addHandler(logging.NullHandler())
    import ezdxf

    drawing = ezdxf.new("R12" if release_12 else "R2010", setup=["linetypes"], units=MILLIMETRES)
    drawing.header["$MEASUREMENT"] = 1
    drawing.header["$LUNITS"] = 2  # decimal
    drawing.header.custom_vars.append("Motor", about.motor)
    drawing.header.custom_vars.append("Program", about.program)
    drawing.header.custom_vars.append("Motor file", f"{about.file} sha256 {about.digest}")
    for name, (colour, linetype, width) in layers.items():
        drawing.layers.add(name, color=colour, linetype=linetype, lineweight=width)
    return drawing


def as_bytes(drawing: "Drawing", comments: Sequence[str]) -> bytes:
    """The file: comments first (group 999), then the drawing with its true extents.

    Programs that ask the header where a drawing lies, and show that part, find all of it.
    """
    from ezdxf.bbox import extents

    space = drawing.modelspace()
    found = extents(space)
    space.reset_extents(found.extmin, found.extmax)
    low, high = found.extmin.vec2, found.extmax.vec2
    space.reset_limits(low, high)
    drawing.set_modelspace_vport(_MARGIN * found.size.y, center=found.center.vec2)
    text = io.StringIO()
    for comment in comments:
        for row in textwrap.wrap(comment, 200):
            text.write(f"999\n{row}\n")
    drawing.write(text)
    return bytes(drawing.encode(text.getvalue()))


def centre_lines(space: Any, reach: float) -> None:
    """A cross through the shaft, mm."""
    for x, y in ((reach, 0.0), (0.0, reach)):
        space.add_line((-x, -y), (x, y), dxfattribs={"layer": "CENTRE"})


def closed_polyline(space: Any, corners: Sequence[tuple[float, float, float]], layer: str) -> None:
    """A closed line through corners of x, y (mm) and the bulge of the arc that begins there."""
    add = space.add_polyline2d if space.doc.dxfversion == _RELEASE_12 else space.add_lwpolyline
    add(corners, format="xyb", close=True, dxfattribs={"layer": layer})


def notes(space: Any, corner: tuple[float, float], height: float, lines: Sequence[str]) -> None:
    """Lines of text below each other, the long ones folded, mm."""
    rows = [row for line in lines for row in textwrap.wrap(line, 84)]
    for row, line in enumerate(rows):
        space.add_text(
            line,
            height=height,
            dxfattribs={"layer": "NOTES", "insert": (corner[0], corner[1] - 1.7 * height * row)},
        )
