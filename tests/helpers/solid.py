"""A STEP file as the Open CASCADE kernel reads it, for tests where it is installed."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Solid:
    """Lengths of all edges, areas of all faces (mm, mm2), and distances from the surface."""

    solids: int
    edges: list[float]
    faces: list[float]
    shell: Any

    def distance(self, x: float, y: float, z: float) -> float:
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
        from OCP.BRepExtrema import BRepExtrema_DistShapeShape
        from OCP.gp import gp_Pnt

        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(x, y, z)).Vertex()
        return BRepExtrema_DistShapeShape(vertex, self.shell).Value()


def read_solid(path: Path) -> Solid:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopExp import TopExp_Explorer

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    shape = reader.OneShape()

    def every(kind):
        explorer, found = TopExp_Explorer(shape, kind), []
        while explorer.More():
            here = explorer.Current()
            if not any(here.IsSame(other) for other in found):
                found.append(here)
            explorer.Next()
        return found

    def measured(part, measure):
        properties = GProp_GProps()
        measure(part, properties)
        return properties.Mass()

    return Solid(
        solids=len(every(Kind.TopAbs_SOLID)),
        edges=[measured(e, BRepGProp.LinearProperties_s) for e in every(Kind.TopAbs_EDGE)],
        faces=[
            measured(f, lambda part, into: BRepGProp.SurfaceProperties_s(part, into, 1e-9))
            for f in every(Kind.TopAbs_FACE)
        ],
        shell=every(Kind.TopAbs_SHELL)[0],
    )
