"""Which files `camring export` writes, and the writing: each whole or not at all."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from camring.exchange.drawings.about import About, about
from camring.exchange.drawings.options import Wishes
from camring.exchange.drawings.plate import circle_from, plate_dxf, plate_ports, plate_table
from camring.exchange.drawings.ring import Ring, ring_of
from camring.exchange.drawings.ring_body import outer_diameter
from camring.exchange.drawings.ring_curves import RingCurves, micrometres, ring_curves
from camring.exchange.drawings.ring_dxf import ring_dxf
from camring.exchange.drawings.ring_points import ring_points, row_step
from camring.exchange.drawings.ring_step import ring_step
from camring.exchange.drawings.ring_svg import ring_svg
from camring.exchange.drawings.sheet import sheet_svg
from camring.files.errors import InputError, quote
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.files.ring_body import thin_wall
from camring.files.shapes.curve_file import curve_text
from camring.files.whole_file import make_folder, write_safely
from camring.geometry.port_shape import PlatePorts
from camring.studies.study_folder import unwritable

__all__ = ["DRAWN", "PRODUCTS", "Product", "chosen_products", "export"]


@dataclass(frozen=True)
class Product:
    """One file that was written, with a sentence on what it holds and figures about it.

    Attributes
    ----------
    notes
        What its user should know, a sentence each.
    """

    path: Path
    holds: str
    figures: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


class _Job:
    """A motor file on its way to files; what several of them need is made once."""

    def __init__(self, file: MotorFile, wishes: Wishes) -> None:
        self.file, self.wishes = file, wishes

    @cached_property
    def about(self) -> About:
        return about(self.file)

    @cached_property
    def ring(self) -> Ring:
        return ring_of(self.file)

    @cached_property
    def curves(self) -> RingCurves:
        """The ring's curves as the DXF holds them."""
        return ring_curves(self.ring, self.wishes.dxf)

    @cached_property
    def ports(self) -> PlatePorts:
        return plate_ports(self.file, self.wishes.port_circle)

    @property
    def circle_asked(self) -> bool:
        return self.wishes.port_circle is not None

    @cached_property
    def outer_radius(self) -> float:
        """Of the ring's body, m: half the diameter asked for, given in the file, or by rule."""
        return outer_diameter(self.file, self.ring, self.wishes.outer_diameter) / 2

    @property
    def body_notes(self) -> tuple[str, ...]:
        """What is to be known of the body that is drawn."""
        return tuple(thin_wall(self.file, 2 * self.outer_radius, self.ring.outer[0]))

    @property
    def ring_width(self) -> float:
        """Of the ring's body: as asked, or the roller's length."""
        return self.wishes.ring_width or self.ring.roller_length


class File(NamedTuple):
    """One file on its way to the folder; its name may begin with a folder of its own."""

    name: str
    content: bytes
    holds: str
    figures: dict[str, float]
    notes: tuple[str, ...] = ()


Made = Iterator[File]


def _ring(job: _Job) -> Made:
    ring, curves = job.ring, job.curves
    figures = {"normal_error": curves.error, **curves.counts}
    holds = f"pitch curve and working surface, each {curves.each}, within"
    yield File(
        "ring.dxf",
        ring_dxf(ring, curves, job.about),
        f"{holds} {micrometres(curves.error)}",
        figures,
    )
    error = max(ring.pitch.error, ring.surface.error)
    holds = f"both curves in true size, as splines within {micrometres(error)}"
    figures = {"normal_error": error, "pieces": float(ring.surface.pieces)}
    yield File("ring.svg", ring_svg(ring, job.about), holds, figures)


def _points(job: _Job) -> Made:
    content, step = ring_points(job.ring, job.about, job.wishes.chord, job.wishes.decimal)
    holds = f"points every {step:g} deg, chords within {1e6 * job.wishes.chord:g} um"
    yield File("ring_points.csv", content, holds, {"step_degrees": step})


def _curve(job: _Job) -> Made:
    ring = job.ring
    step, strays = row_step(ring, job.wishes.chord)
    parameter = ring.outline.parameter_at(np.radians(step) * np.arange(round(360 / step)))
    for name, distance in (("pitch_curve", 0.0), ("working_surface", ring.roller_radius)):
        content = curve_text(ring.outline.places(parameter, distance).point)
        holds = (
            f"{len(parameter) + 1} points of the {name.replace('_', ' ')}, x y z in mm, closed; "
            f"chords stray {1e6 * strays:.3g} um"
        )
        yield File(f"{name}.sldcrv", content.encode("ascii"), holds, {"step_degrees": step})


def _plate(job: _Job) -> Made:
    ports, asked = job.ports, job.circle_asked
    figures = {"port_circle": ports.circle, "port_height": ports.height}
    source, release_12 = circle_from(ports, asked), job.wishes.dxf.is_release_12
    holds = f"ports on a circle of {1e3 * ports.circle:.4g} mm radius, {source}"
    yield File("valve_plate.dxf", plate_dxf(ports, job.about, asked, release_12), holds, figures)
    table = plate_table(ports, job.about, asked, job.wishes.decimal)
    yield File("valve_plate.csv", table, "edges of all ports, degrees", figures)


def _sheet(job: _Job) -> Made:
    content = sheet_svg(
        job.ring, job.curves, job.ports, job.about, job.outer_radius, job.ring_width
    )
    holds = (
        f"drawing sheet A3 of a ring of {2e3 * job.outer_radius:.5g} mm; print it from a browser"
    )
    figures = {"outer_diameter": 2 * job.outer_radius, "ring_width": job.ring_width}
    yield File("sheet.svg", content, holds, figures, job.body_notes)


def _step(job: _Job) -> Made:
    content = ring_step(job.ring, job.about, job.outer_radius, job.ring_width)
    figures = {"outer_diameter": 2 * job.outer_radius, "ring_width": job.ring_width}
    holds = f"the ring as a solid of {2e3 * job.outer_radius:.5g} x {1e3 * job.ring_width:.4g} mm"
    yield File("ring.step", content, holds, figures, job.body_notes)


def _fmu(job: _Job) -> Made:
    # Simulates, which no other product does.
    from camring.exchange.fmu.axes import axes_of
    from camring.exchange.fmu.description import starts
    from camring.exchange.fmu.filling import filled_table
    from camring.exchange.fmu.modelica import modelica_files
    from camring.exchange.fmu.package import fmu_of, statements

    filled = filled_table(job.file, axes_of(job.file, job.wishes.table))
    fmu, said = fmu_of(job.file, filled), statements(job.file, filled)
    holds = f"FMU for co-simulation, FMI 2.0: {fmu.parts}"
    yield File(f"{fmu.name}.fmu", fmu.content, holds, filled.errors.figures(), tuple(said[1:]))
    start = starts(job.file.system.operating_points[0])
    table = filled.table
    files = modelica_files(fmu.name, said, table.content(), start, table.periods)
    for name, content in files.items():
        holds = "Modelica package" if name.endswith(".mo") else "belongs to it"
        yield File(name, content, holds, {})


PRODUCTS: dict[str, Callable[[_Job], Made]] = {
    "ring": _ring,
    "points": _points,
    "curve": _curve,
    "plate": _plate,
    "sheet": _sheet,
    "step": _step,
    "fmu": _fmu,
}
DRAWN = ("ring", "plate", "sheet")
"""Those that hold a DXF or speak of one."""
_ONLY_IF_NAMED = ("curve", "step", "fmu")


def chosen_products(only: str | None) -> tuple[str, ...]:
    """The products named in a list with commas; without one all that come unasked.

    Raises
    ------
    InputError
        For a name that is none, with its nearest neighbour.
    """
    if only is None:
        return tuple(name for name in PRODUCTS if name not in _ONLY_IF_NAMED)
    names = [name.strip() for name in only.split(",") if name.strip()]
    if names == ["all"]:
        return tuple(PRODUCTS)
    for name in names:
        if name not in PRODUCTS:
            close = get_close_matches(name, PRODUCTS, n=1, cutoff=0.5)
            hint = f" (did you mean {close[0]!r}?)" if close else ""
            raise InputError(
                "--only", f"has {quote(name)}{hint}", f"name some of {', '.join(PRODUCTS)}, or all"
            )
    if not names:
        raise InputError("--only", "names nothing", f"name some of {', '.join(PRODUCTS)}, or all")
    return tuple(name for name in PRODUCTS if name in names)


def export(
    file: MotorFile,
    folder: str | Path,
    *,
    only: Sequence[str] | None = None,
    wishes: Wishes | None = None,
    replace: bool = False,
) -> list[Product]:
    """Write the files of a motor for CAD, grinding machine, workshop and system simulation.

    Parameters
    ----------
    only
        Names of `PRODUCTS`; all but the solid and the FMU when left out.
    replace
        Whether files of the same names may be replaced.

    Returns
    -------
    list of Product
        What was written; nothing is written unless all of it could be made.

    Raises
    ------
    InputError
        When the ring has no working surface, the ports do not fit, an extra is
        missing, or the place cannot be written.
    """
    place, job = Path(folder), _Job(file, wishes or Wishes())
    names = chosen_products(None) if only is None else chosen_products(",".join(only))
    made = [each for name in names for each in PRODUCTS[name](job)]
    _require_free_names(place, [each.name for each in made], replace)
    written = []
    try:
        for each in made:
            path = place / each.name
            make_folder(path.parent)
            write_safely(path, each.content)
            written.append(Product(path, each.holds, each.figures, each.notes))
    except OSError as error:
        raise unwritable(place, error) from error
    return written


def _require_free_names(place: Path, names: Sequence[str], replace: bool) -> None:
    if place.exists() and not place.is_dir():
        raise InputError(printable(place), "is a file", "give a folder as --out")
    standing = [name for name in names if (place / name).exists()]
    if standing and not replace:
        raise InputError(
            printable(place / standing[0]), "exists", "give another --out, or replace with --force"
        )


def figures_of(written: Sequence[Product]) -> list[dict[str, Any]]:
    """What was written, as a document for programs; lengths in SI."""
    return [
        {"path": printable(each.path), "holds": each.holds, **each.figures}
        | ({"notes": list(each.notes)} if each.notes else {})
        for each in written
    ]
