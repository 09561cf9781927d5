"""The ring as a solid in a STEP file, through the Open CASCADE kernel (extra `step`)."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from camring.exchange.drawings.about import About
from camring.exchange.drawings.ring import Ring
from camring.files.errors import InputError
from camring.numerics.closed_spline import ClosedSpline

__all__ = ["ring_step"]

_AP242 = 5


def ring_step(ring: Ring, about: About, outer_radius: float, width: float) -> bytes:
    """A STEP file (AP242) of the ring: the working surface as a hole in a round disc.

    The hole has one face and one closed cubic edge at either end. The ring stands
    with its axis along z, from z = 0 to its width; millimetres.

    Parameters
    ----------
    outer_radius, width
        Of the ring's body, m.

    Raises
    ------
    InputError
        When the extra is missing.
    """
    kernel = _kernel()
    solid = _solid(kernel, ring.surface, 1e3 * outer_radius, 1e3 * width)
    # Settings exist only once a writer does.
    writer = kernel.writer()
    kernel.static.SetCVal_s("write.step.unit", "MM")
    kernel.static.SetCVal_s("write.step.product.name", f"Cam ring, {_ascii(about.motor)}")
    kernel.static.SetIVal_s("write.step.schema", _AP242)
    writer.Transfer(solid, kernel.as_is)
    _head(kernel, writer, about)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ring.step"
        done = writer.Write(str(path))
        if done != kernel.done:
            raise InputError("ring.step", f"cannot be written ({done})", "leave out `step`")
        return path.read_bytes()


class _Kernel:
    """The few names of the kernel that are used here."""

    def __init__(self) -> None:
        from OCP import BRepBuilderAPI, BRepPrimAPI, Geom, STEPControl, collections, gp
        from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
        from OCP.IFSelect import IFSelect_ReturnStatus
        from OCP.Interface import Interface_Static
        from OCP.Message import Message
        from OCP.TCollection import TCollection_HAsciiString

        self.builder, self.solids, self.curves = BRepBuilderAPI, BRepPrimAPI, Geom
        self.arrays, self.space = collections, gp
        self.static = Interface_Static
        self.writer = STEPControl.STEPControl_Writer
        self.as_is = STEPControl.STEPControl_StepModelType.STEPControl_AsIs
        self.header, self.text = APIHeaderSection_MakeHeader, TCollection_HAsciiString
        # The kernel would tell of its progress on stdout.
        for printer in list(Message.DefaultMessenger_s().Printers()):
            Message.DefaultMessenger_s().RemovePrinter(printer)
        self.done = IFSelect_ReturnStatus.IFSelect_RetDone


def _head(kernel: _Kernel, writer: Any, about: About) -> None:
    """The file's header: motor, program and the sense of angles."""
    head = kernel.header(writer.Model())
    head.SetName(kernel.text(_ascii(f"Cam ring, {about.motor}")))
    head.SetOriginatingSystem(kernel.text(about.program))
    head.SetAuthorValue(1, kernel.text(about.program))
    head.SetOrganizationValue(1, kernel.text(""))
    head.SetDescriptionValue(1, kernel.text(_ascii(" ".join(about.lines()))))


def _ascii(text: str) -> str:
    return text.encode("ascii", "replace").decode()


def _kernel() -> _Kernel:
    try:
        return _Kernel()
    except ImportError as error:
        raise InputError(
            "--only step",
            f"needs the Open CASCADE kernel, which is not installed ({error})",
            'install it with `pip install "camring[step]"`, or leave out `step`',
        ) from error


def _solid(kernel: _Kernel, surface: ClosedSpline, outer: float, width: float) -> Any:
    """The face between circle and spline, pushed along the axis."""
    gp, build = kernel.space, kernel.builder
    up = gp.gp_Ax2(gp.gp_Pnt(0, 0, 0), gp.gp_Dir(0, 0, 1))
    circle = build.BRepBuilderAPI_MakeEdge(gp.gp_Circ(up, outer)).Edge()
    rim = build.BRepBuilderAPI_MakeWire(circle).Wire()
    hole = build.BRepBuilderAPI_MakeWire(
        build.BRepBuilderAPI_MakeEdge(_curve(kernel, surface)).Edge()
    ).Wire()
    face = build.BRepBuilderAPI_MakeFace(rim, True)
    hole.Reverse()
    face.Add(hole)
    along = gp.gp_Vec(0, 0, width)
    return kernel.solids.BRepPrimAPI_MakePrism(face.Face(), along).Shape()


def _curve(kernel: _Kernel, surface: ClosedSpline) -> Any:
    clamped = surface.clamped()
    points = 1e3 * np.asarray(clamped.c)
    points[-1] = points[0]
    knots, counts = np.unique(1e3 * clamped.t, return_counts=True)
    poles = kernel.arrays.Array1_gp_Pnt(1, len(points))
    for place, (x, y) in enumerate(points, 1):
        poles.SetValue(place, kernel.space.gp_Pnt(float(x), float(y), 0.0))
    values = kernel.arrays.Array1_double(1, len(knots))
    repeats = kernel.arrays.Array1_int(1, len(knots))
    for place, (knot, count) in enumerate(zip(knots, counts, strict=True), 1):
        values.SetValue(place, float(knot))
        repeats.SetValue(place, int(count))
    return kernel.curves.Geom_BSplineCurve(poles, values, repeats, 3)
