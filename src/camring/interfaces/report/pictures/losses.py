"""Where the hydraulic power goes that does not reach the shaft."""

from collections.abc import Sequence
from math import isfinite

from camring.interfaces.report.chart import picture
from camring.interfaces.report.data import Design
from camring.interfaces.report.figure import Figure
from camring.interfaces.report.marks import LETTER
from camring.interfaces.report.palette import INK, LOSSES
from camring.interfaces.report.pictures.bars import Bars
from camring.interfaces.report.quantities import QUANTITIES, significant
from camring.interfaces.report.scale import Axis
from camring.interfaces.report.svg import element, group, words

__all__ = ["balance_residual", "loss_figure"]

_DARK = ("line_loss", "throttling_loss", "compression_loss")


def balance_residual(metrics: dict[str, float]) -> float:
    """Input less output less all losses, as a share of the input."""
    rest = (
        metrics["input_power"] - metrics["output_power"] - sum(metrics.get(k, 0.0) for k in LOSSES)
    )
    return rest / metrics["input_power"]


def loss_figure(designs: Sequence[Design], duty: int) -> Figure | None:
    """The losses of every design stacked, negative terms to the left of zero.

    None when a simulation failed and there is no power to balance.
    """
    if not all(isfinite(balance_residual(dict(d.results[duty].metrics))) for d in designs):
        return None
    shares = []
    for design in designs:
        metrics = design.results[duty].metrics
        shares.append(
            {name: 100 * metrics.get(name, 0.0) / metrics["input_power"] for name in LOSSES}
        )
    high = max(sum(v for v in share.values() if v > 0) for share in shares)
    low = min(sum(v for v in share.values() if v < 0) for share in shares)
    room = 0.03 * (high - low) or 1.0
    bars = Bars(
        Axis(
            "Share of the hydraulic input",
            "%",
            low - (room if low < 0 else 0.0),
            high + room,
            tick_count=8,
        ),
        len(designs),
        58.0,
    )
    rows = [
        _stack(bars, design, duty, share, bars.y(k) + 8)
        for k, (design, share) in enumerate(zip(designs, shares, strict=True))
    ]
    name = f"losses-{duty}"
    svg = picture(
        name,
        "Where the power goes",
        "The losses of every design in per cent of the hydraulic input, stacked.",
        bars.size,
        bars.grid(),
        _keys(bars.left, [name for name in LOSSES if any(share[name] for share in shares)]),
        *rows,
        bars.wall(0.0),
    )
    return Figure(name, "Power balance", svg, _words(designs, duty), wide=True)


def _stack(bars: Bars, design: Design, duty: int, share: dict[str, float], y: float) -> str:
    metrics = design.results[duty].metrics
    power = (
        f"{significant(1e-3 * metrics['input_power'])} kW in, "
        f"{significant(1e-3 * metrics['output_power'])} kW out"
    )
    pieces = [bars.label(y + 19, design.label, power)]
    forward = backward = 0.0
    for name, colour in LOSSES.items():
        value = share[name]
        if not value:
            continue
        start = forward if value >= 0 else backward
        left, right = sorted((bars.x(start), bars.x(start + value)))
        pieces.append(
            element(
                "rect",
                x=left,
                y=y,
                width=max(right - left, 0.4),
                height=38.0,
                fill=colour,
                stroke="#ffffff",
                stroke_width=0.8,
            )
        )
        text = f"{significant(metrics[name], 3)} W"
        if right - left > LETTER * len(text) + 8:
            ink = "#ffffff" if name in _DARK else INK
            middle = (left + right) / 2
            pieces.append(
                words(middle, y + 23, text, class_="tick", text_anchor="middle", fill=ink)
            )
        if value >= 0:
            forward += value
        else:
            backward += value
    efficiency = f"efficiency {significant(100 * metrics['efficiency'], 4)} %"
    pieces.append(words(bars.x(forward) + 8, y + 23, efficiency, class_="label"))
    return group(*pieces)


def _keys(x: float, names: Sequence[str]) -> str:
    pieces = []
    for name in names:
        colour = LOSSES[name]
        label = QUANTITIES[name].label.lower()
        pieces += [
            element("rect", x=x, y=6.0, width=14.0, height=11.0, fill=colour),
            words(x + 20, 16.0, label, class_="legend"),
        ]
        x += 46 + LETTER * len(label)
    return "".join(pieces)


def _words(designs: Sequence[Design], duty: int) -> str:
    metrics = dict(designs[-1].results[duty].metrics)
    order = sorted(LOSSES, key=lambda name: -metrics.get(name, 0.0))
    residual = abs(balance_residual(metrics))
    closes = "to within a millionth" if residual < 1e-6 else f"to {1e6 * residual:.1g} millionths"
    text = (
        f"Most of what is lost is {QUANTITIES[order[0]].label.lower()}, then "
        f"{QUANTITIES[order[1]].label.lower()}; input, output and losses balance {closes}."
    )
    if metrics["compression_loss"] < 0:
        text += (
            " The compression term is negative because the model counts flow by volume, the same "
            "at port and at chamber pressure; it is bookkeeping, not power for free."
        )
    return text
