"""A chart: two axes, layers drawn between them, a legend, and words for those who cannot see it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from camring.drawing.frame import Frame, axes
from camring.drawing.marks import LETTER, keys_width, row_of_keys
from camring.drawing.palette import Style
from camring.drawing.scale import Axis
from camring.drawing.strips import HEIGHT, Strip, draw_strips
from camring.drawing.svg import element, escape, group, number

__all__ = ["Chart", "Layer", "draw", "picture"]

TOP, RIGHT, BOTTOM, LEFT = 40.0, 16.0, 46.0, 58.0


class Layer(Protocol):
    """Something drawn between the axes."""

    def draw(self, frame: Frame) -> str: ...


@dataclass(frozen=True)
class Chart:
    """What to draw; `draw` turns it into SVG text.

    `name` becomes part of element ids and must be unique on the page.
    `description` is read to those who cannot see the picture.
    """

    name: str
    title: str
    description: str
    x_axis: Axis
    y_axis: Axis
    layers: Sequence[Layer]
    legend: Sequence[tuple[str, Style]] = ()
    width: float = 520.0
    height: float = 310.0
    readable: bool = True
    left: float = LEFT
    strips: Sequence[Strip] = ()


def picture(
    name: str, title: str, description: str, size: tuple[float, float], *parts: str, **kw: object
) -> str:
    """The SVG element round some parts, with its title and description for screen readers."""
    head = element("title", escape(title), id=f"{name}-title") + element(
        "desc", escape(description), id=f"{name}-description"
    )
    attributes: dict[str, object] = {"class_": "chart", "role": "img"} | kw
    return element(
        "svg",
        head,
        *parts,
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {number(size[0])} {number(size[1])}",
        aria_labelledby=f"{name}-title {name}-description",
        **attributes,
    )


def draw(chart: Chart) -> str:
    """The chart as one SVG element, valid XML, fetching nothing."""
    # A long title and a long legend would meet, so they take a row each.
    wanted = LETTER * len(chart.y_axis.title) + keys_width(chart.legend) + 24
    crowded = bool(chart.legend) and wanted > chart.width
    base = chart.height - BOTTOM
    bottom = base - (HEIGHT * len(chart.strips) + 9 if chart.strips else 0.0)
    top = TOP + 16 if crowded else TOP
    frame = Frame(chart.x_axis, chart.y_axis, chart.left, top, chart.width - RIGHT, bottom, base)
    clip = element(
        "clipPath",
        element(
            "rect",
            x=frame.left,
            y=frame.top - 2,
            width=frame.right - frame.left,
            height=frame.bottom - frame.top + 4,
        ),
        id=f"{chart.name}-clip",
    )
    inside = group(
        *(layer.draw(frame) for layer in chart.layers), clip_path=f"url(#{chart.name}-clip)"
    )
    reading: dict[str, object] = {}
    if chart.readable:
        reading = {
            "class_": "chart readable",
            "tabindex": 0,
            "data_x": frame.ends(chart.x_axis),
            "data_y": frame.ends(chart.y_axis),
            "data_x_label": chart.x_axis.label,
            "data_x_unit": chart.x_axis.unit,
            "data_y_unit": chart.y_axis.unit,
        }
    return picture(
        chart.name,
        chart.title,
        chart.description,
        (chart.width, chart.height),
        element("defs", clip),
        axes(frame, 32.0 if crowded else 16.0),
        inside,
        draw_strips(frame, list(chart.strips)),
        row_of_keys(chart.legend, frame.right, 16.0),
        **reading,
    )
