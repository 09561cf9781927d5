"""How far every result stays from its limit."""

from collections.abc import Sequence

import numpy as np

from camring.drawing.chart import picture
from camring.drawing.marks import row_of_keys
from camring.drawing.palette import INK, LIMIT, Style
from camring.drawing.scale import Axis
from camring.drawing.svg import element, words
from camring.files.quantities import QUANTITIES, significant
from camring.presentation.records import Constraint, Design
from camring.report.figure import Figure, design_styles, legend
from camring.report.pictures.bars import TOP, WIDTH, Bars

__all__ = ["margin_figure", "plain_name"]

WIDEST = 1.0  # margins beyond the whole limit are cut there and say so
DEEPEST = 0.5

_NAMES = {
    "min_pressure": "Lowest pressure (cavitation)",
    "max_pressure": "Highest pressure",
    "min_contact_force": "Lowest contact force (lift-off)",
    "max_ripple_ratio": "Torque ripple against the given motor",
    "max_efficiency_loss": "Efficiency lost against the given motor",
    "chamber_volume": "Smallest chamber volume",
    "lift": "Lift",
}


def margin_figure(constraints: Sequence[Constraint], designs: Sequence[Design]) -> Figure | None:
    """Margins to every limit in every design; a bar to the left of zero breaks the limit."""
    if not constraints:
        return None
    margins = np.array([c.margins for c in constraints], dtype=float)
    finite = margins[np.isfinite(margins)]
    least = float(finite.min()) if finite.size else 0.0
    low = -0.02 if least >= 0 else max(1.15 * least, -DEEPEST)
    bars = Bars(
        Axis(
            "Margin, % of the limit's own scale (right of the red line: kept)",
            "",
            100 * low,
            100 * WIDEST,
            tick_count=8,
        ),
        len(constraints),
        max(14.0 * len(designs) + 14.0, 34.0),
        right=190.0,
    )
    rows = []
    for row, constraint in enumerate(constraints):
        y = bars.y(row) + (bars.pitch - 14 * len(designs)) / 2
        middle = y + 7 * len(designs) - 2
        rows.append(bars.label(middle, plain_name(constraint.name), constraint.limit))
        pairs = zip(constraint.margins, constraint.values, design_styles(designs), strict=True)
        for k, (margin, value, style) in enumerate(pairs):
            rows.append(_bar(bars, y + 14 * k, float(margin), value, style, low))
    zero = bars.x(0.0)
    wall = element(
        "line", x1=zero, x2=zero, y1=TOP - 4, y2=bars.bottom, stroke=LIMIT, stroke_width=1.6
    ) + words(zero, TOP - 10, "limit", class_="note", text_anchor="middle", fill=LIMIT)
    svg = picture(
        "margins",
        "Constraint margins",
        "How far each result stays from its limit, in per cent of the limit's scale.",
        bars.size,
        bars.grid(),
        *rows,
        wall,
        row_of_keys(legend(designs), WIDTH - 16, 16.0),
    )
    return Figure("margins", "Margins to the limits", svg, _words(constraints, designs), True)


def _bar(bars: Bars, y: float, margin: float, value: str, style: Style, low: float) -> str:
    if not np.isfinite(margin):
        return words(bars.x(0.0) + 7, y + 9, f"{value} · no margin known", class_="tick")
    zero, end = bars.x(0.0), bars.x(100 * float(np.clip(margin, low, WIDEST)))
    broken = margin < 0
    bar = element(
        "rect",
        x=min(zero, end),
        y=y,
        width=max(abs(end - zero), 1.0),
        height=10.0,
        fill="#ffffff" if broken else style.colour,
        stroke=LIMIT if broken else style.colour,
        stroke_width=1.4 if broken else 0.8,
        fill_opacity=0.5 if style.dash and not broken else None,
    )
    share = f"{significant(100 * abs(margin), 2)} %"
    text = f"{value} · broken by {share}" if broken else f"{value} · {share}"
    text = f"▸ {text}" if margin > WIDEST else text
    return bar + words(
        max(end, zero) + 7, y + 9, text, class_="tick", fill=LIMIT if broken else INK
    )


def plain_name(name: str) -> str:
    """A constraint's key as words: "max_contact_stress" becomes "Highest contact stress"."""
    if name in _NAMES:
        return _NAMES[name]
    if name in QUANTITIES:
        return QUANTITIES[name].label
    for end, end_name in (("_low", "lower end"), ("_high", "upper end")):
        if name.endswith(end):
            return f"{plain_name(name.removesuffix(end))}, {end_name}"
    sense, _, rest = name.partition("_")
    heads = {"min": "Lowest", "max": "Highest"}
    if sense in heads:
        return f"{heads[sense]} {rest.replace('_', ' ')}"
    return name.replace("_", " ").capitalize()


def _words(constraints: Sequence[Constraint], designs: Sequence[Design]) -> str:
    margins = np.array([c.margins[-1] for c in constraints], dtype=float)
    if not np.isfinite(margins).any():
        return "No margin could be computed."
    tightest = int(np.nanargmin(margins))
    name = plain_name(constraints[tightest].name)
    percent = significant(100 * abs(float(margins[tightest])), 2)
    broken = int((margins < 0).sum())
    whose = "" if len(designs) == 1 else f" of the {designs[-1].label} design"
    if broken:
        limits = "One limit is" if broken == 1 else f"{broken} limits are"
        return f"{limits} broken; the worst{whose} is “{name}”, by {percent} %."
    return (
        f"All limits are kept at the operating points; the tightest{whose} is “{name}” with "
        f"{percent} % to spare."
    )
