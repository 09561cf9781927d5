"""Which files `camring export` writes, and the writing: each whole or not at all."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from camring.geometry.port_shape import PlatePorts
from camring.interfaces.config import MotorFile
from camring.interfaces.config.document import printable
from camring.interfaces.errors import InputError, quote
from camring.interfaces.export.about import About, about
from camring.interfaces.export.plate import circle_from, plate_dxf, plate_ports, plate_table
from camring.interfaces.export.ring import Ring, ring_of
from camring.interfaces.export.ring_dxf import ring_dxf
from camring.interfaces.export.ring_points import ring_points
from camring.interfaces.export.ring_step import ring_step
from camring.interfaces.export.ring_svg import ring_svg
from camring.interfaces.export.sheet import sheet_svg
from camring.interfaces.fmu.axes import Ranges
from camring.interfaces.study_folder import unwritable, write_safely
from camring.interfaces.units import UnitError, to_si

__all__ = ["PRODUCTS", "Product", "Wishes", "chosen_products", "export"]

DEFAULT_CHORD = 1e-6  # m


@dataclass(frozen=True)
class Wishes:
    """What may be asked for beside the motor file; lengths in m, None for the default."""

    chord: float = DEFAULT_CHORD
    port_circle: float | None = None
    outer_radius: float | None = None
    ring_width: float | None = None
    table: Ranges = field(default_factory=Ranges)
    """Speeds and pressures of the FMU's table, as typed."""

    @classmethod
    def read(
        cls,
        chord: str | None = None,
        port_circle: str | None = None,
        outer_radius: str | None = None,
        ring_width: str | None = None,
        table: Ranges | None = None,
    ) -> "Wishes":
        """Wishes from what stands on the command line, such as "42 mm".

        Raises
        ------
        InputError
            For what is no length above zero.
        """
        return cls(
            _length("--chord", chord, "2 um") or DEFAULT_CHORD,
            _length("--port-circle", port_circle, "42 mm"),
            _length("--outer-radius", outer_radius, "140 mm"),
            _length("--ring-width", ring_width, "30 mm"),
            table or Ranges(),
        )


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
    def ports(self) -> PlatePorts:
        return plate_ports(self.file, self.wishes.port_circle)

    @property
    def circle_asked(self) -> bool:
        return self.wishes.port_circle is not None

    @property
    def outer_radius(self) -> float:
        """Of the ring's body: as asked, or two roller radii beyond the working surface."""
        least = self.ring.surface_outer
        asked = self.wishes.outer_radius
        if asked is not None and asked <= least:
            raise InputError(
                "--outer-radius",
                f"is {1e3 * asked:.6g} mm, within the working surface of {1e3 * least:.6g} mm",
                f"give more, such as {1e3 * (least + 2 * self.ring.roller_radius):.4g} mm",
            )
        return asked or least + 2 * self.ring.roller_radius

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
    ring = job.ring
    error = max(ring.pitch.error, ring.surface.error)
    figures = {"normal_error": error, "pieces": float(ring.surface.pieces)}
    holds = f"pitch curve and working surface, within {1e6 * error:.2g} um"
    yield File("ring.dxf", ring_dxf(ring, job.about), holds, figures)
    yield File("ring.svg", ring_svg(ring, job.about), "the same curves in true size", figures)


def _points(job: _Job) -> Made:
    content, step = ring_points(job.ring, job.about, job.wishes.chord)
    holds = f"points every {step:g} deg, chords within {1e6 * job.wishes.chord:g} um"
    yield File("ring_points.csv", content, holds, {"step_degrees": step})


def _plate(job: _Job) -> Made:
    ports, asked = job.ports, job.circle_asked
    figures = {"port_circle": ports.circle, "port_height": ports.height}
    source = circle_from(ports, asked)
    holds = f"ports on a circle of {1e3 * ports.circle:.4g} mm radius, {source}"
    yield File("valve_plate.dxf", plate_dxf(ports, job.about, asked), holds, figures)
    table = plate_table(ports, job.about, asked)
    yield File("valve_plate.csv", table, "edges of all ports, degrees", figures)


def _sheet(job: _Job) -> Made:
    content = sheet_svg(job.ring, job.ports, job.about, job.outer_radius, job.ring_width)
    yield File("sheet.svg", content, "drawing sheet A3; print it from any browser", {})


def _step(job: _Job) -> Made:
    content = ring_step(job.ring, job.about, job.outer_radius, job.ring_width)
    figures = {"outer_radius": job.outer_radius, "ring_width": job.ring_width}
    holds = f"the ring as a solid of {2e3 * job.outer_radius:.4g} x {1e3 * job.ring_width:.4g} mm"
    yield File("ring.step", content, holds, figures)


def _fmu(job: _Job) -> Made:
    # Simulates, which no other product does.
    from camring.interfaces.fmu.axes import axes_of
    from camring.interfaces.fmu.description import starts
    from camring.interfaces.fmu.filling import filled_table
    from camring.interfaces.fmu.modelica import modelica_files
    from camring.interfaces.fmu.package import fmu_of, statements

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
    "plate": _plate,
    "sheet": _sheet,
    "step": _step,
    "fmu": _fmu,
}
_ONLY_IF_NAMED = ("step", "fmu")


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
    _require_room(place, [each.name for each in made], replace)
    written = []
    try:
        for each in made:
            path = place / each.name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_safely(path, each.content)
            written.append(Product(path, each.holds, each.figures, each.notes))
    except OSError as error:
        raise unwritable(place, error) from error
    return written


def _require_room(place: Path, names: Sequence[str], replace: bool) -> None:
    if place.exists() and not place.is_dir():
        raise InputError(printable(place), "is a file", "give a folder as --out")
    standing = [name for name in names if (place / name).exists()]
    if standing and not replace:
        raise InputError(
            printable(place / standing[0]), "exists", "give another --out, or replace with --force"
        )


def _length(option: str, text: str | None, example: str) -> float | None:
    if text is None:
        return None
    try:
        value = to_si(text, "m")
    except UnitError as error:
        raise InputError(option, str(error), f'give a length such as "{example}"') from None
    if not (isfinite(value) and 0 < value < 100):
        raise InputError(
            option,
            f"is {quote(text)} but must be above zero and below 100 m",
            f'give a length such as "{example}"',
        )
    return value


def figures_of(written: Sequence[Product]) -> list[dict[str, Any]]:
    """What was written, as a document for programs; lengths in SI."""
    return [
        {"path": printable(each.path), "holds": each.holds, **each.figures}
        | ({"notes": list(each.notes)} if each.notes else {})
        for each in written
    ]
