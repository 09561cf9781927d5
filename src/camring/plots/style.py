"""One style for every figure, put on while it is drawn and taken off again."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from camring.drawing.palette import INK, QUIET, design_style
from camring.files.errors import InputError
from camring.files.motor.document import printable
from camring.files.whole_file import draft_beside, put_in_place

PICTURES = (".png", ".svg", ".pdf")
_ENOUGH_DOTS = 160  # an inch, of a raster picture

STYLE: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.titleweight": "normal",
    "axes.labelsize": 9.0,
    "axes.labelcolor": INK,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.facecolor": "white",
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "grid.color": "#d9dde1",
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "text.color": INK,
    "text.usetex": False,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "figure.facecolor": "white",
    "figure.dpi": 100.0,
    "hatch.linewidth": 0.6,
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "camring",  # the same picture is the same file
    "pdf.fonttype": 42,
}

Arguments = ParamSpec("Arguments")


class Sheet(Figure):
    """A figure of nobody's window, which a notebook shows when it is a cell's last value."""

    def _repr_png_(self) -> bytes:
        from io import BytesIO

        picture = BytesIO()
        with matplotlib.rc_context(STYLE):
            self.savefig(picture, format="png", dpi=_ENOUGH_DOTS)
        return picture.getvalue()


def styled(draw: Callable[Arguments, Figure]) -> Callable[Arguments, Figure]:
    """A drawing function that wears the style while it draws."""

    @wraps(draw)
    def drawn(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Figure:
        with matplotlib.rc_context(STYLE):
            return draw(*args, **kwargs)

    return drawn


def as_written(legend: Legend) -> None:
    """Names of motors and files in it as they are: a `$` begins no formula."""
    for text in legend.get_texts():
        text.set_parse_math(False)


def sheet(width: float = 6.3, height: float = 3.9) -> Figure:
    """An empty figure; inches. 6.3 is the text width of a page."""
    return Sheet(figsize=(width, height), layout="constrained")


def drawing_board(axes: Axes | None, width: float = 6.3, height: float = 3.9) -> tuple[Any, Axes]:
    """The axes given, or those of a new figure."""
    if axes is not None:
        return axes.figure, axes
    figure = sheet(width, height)
    return figure, figure.add_subplot()


def line(position: int, count: int) -> dict[str, Any]:
    """How the curve of one design among several is drawn: it differs in dash, not colour alone."""
    style = design_style(position, count)
    dash: Any = "-"
    if style.dash is not None:
        dash = (0, tuple(float(part) / style.width for part in style.dash.split()))
    return {"color": style.colour, "linestyle": dash, "linewidth": style.width}


def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure as PNG, SVG or PDF, by the ending of its name; whole or not at all.

    Raises
    ------
    InputError
        For another ending, or a place that cannot be written.
    """
    place = Path(path)
    require_picture(place)
    dated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}
    try:
        with draft_beside(place) as draft:
            with matplotlib.rc_context(STYLE):
                figure.savefig(
                    draft,
                    format=place.suffix.lower()[1:],
                    dpi=_ENOUGH_DOTS,
                    metadata=dated[place.suffix.lower()],
                )
            put_in_place(draft, place)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            printable(place), f"cannot be written ({reason})", "choose another place"
        ) from None
    return place


def require_picture(path: Path) -> None:
    """Refuse a name whose ending is no kind of picture, or whose folder is not there.

    Raises
    ------
    InputError
        With the endings that are known.
    """
    if path.suffix.lower() not in PICTURES:
        raise InputError(
            printable(path),
            f"ends in {path.suffix!r}" if path.suffix else "has no ending",
            "end it in .png, .svg or .pdf",
        )
    if path.is_dir():
        raise InputError(printable(path), "is a folder", "name a file in it, such as picture.svg")
    if not path.parent.is_dir():
        raise InputError(
            printable(path),
            f"lies in {printable(path.parent)}, which does not exist",
            "make the folder first",
        )
