"""Where the hydraulic power goes that does not reach the shaft."""

from collections.abc import Mapping, Sequence
from math import isfinite

from camring.drawing.chart import picture
from camring.drawing.marks import LETTER
from camring.drawing.palette import INK, LOSSES
from camring.drawing.scale import Axis
from camring.drawing.svg import element, group, words
from camring.files.quantities import QUANTITIES, significant
from camring.presentation.records import Design
from camring.report.figure import Figure
from camring.report.pictures.bars import Bars

__all__ = ["balance_residual", "loss_figure"]

_DARK = ("line_loss", "return_line_loss", "throttling_loss", "compression_loss")


def balance_residual(metrics: dict[str, float]) -> float:
    """Input less output less all losses, as a share of the input."""
    rest = (
        metrics["input_power"] - metrics["output_power"] - sum(metrics.get(k, 0.0) for k in LOSSES)
    )
    return rest / metrics["input_power"]


def _counted(metrics: Mapping[str, float]) -> Mapping[str, float]:
    """With leakage down to the case where a brake's, down to the return, is none."""
    if metrics["leakage_loss"] >= 0 or "full_leakage_loss" not in metrics:
        return metrics
    whole, between = metrics["full_leakage_loss"], metrics["port_power"]
    return {**metrics, "leakage_loss": whole, "input_power": between}


def _put_in(metrics: Mapping[str, float]) -> float:
    """Power that goes in, W: that of the oil, or of the shaft where it drives a pump."""
    return metrics["input_power"] if metrics["input_power"] > 0 else -metrics["output_power"]


def loss_figure(designs: Sequence[Design], index: int) -> Figure | None:
    """The losses of every design stacked, negative terms to the left of zero.

    None when a simulation failed and there is no power to balance.
    """
    if not all(isfinite(balance_residual(dict(d.results[index].metrics))) for d in designs):
        return None
    shares = []
    for design in designs:
        metrics = _counted(design.results[index].metrics)
        shares.append({name: 100 * metrics.get(name, 0.0) / _put_in(metrics) for name in LOSSES})
    high = max(sum(v for v in share.values() if v > 0) for share in shares)
    low = min(sum(v for v in share.values() if v < 0) for share in shares)
    spare = 0.03 * (high - low) or 1.0
    bars = Bars(
        Axis(
            "Share of the hydraulic input",
            "%",
            low - (spare if low < 0 else 0.0),
            high + spare,
            tick_count=8,
        ),
        len(designs),
        58.0,
    )
    rows = [
        _stack(bars, design, index, share, bars.y(k) + 8)
        for k, (design, share) in enumerate(zip(designs, shares, strict=True))
    ]
    name = f"losses-{index}"
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
    return Figure(name, "Power balance", svg, _words(designs, index), wide=True)


def _stack(bars: Bars, design: Design, index: int, share: dict[str, float], y: float) -> str:
    metrics = _counted(design.results[index].metrics)
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
    pieces.append(words(bars.x(forward) + 8, y + 23, _rest(metrics), class_="label"))
    return group(*pieces)


def _rest(metrics: Mapping[str, float]) -> str:
    """What the losses leave, which a bench does not read where the oil's density changes."""
    if metrics["input_power"] < 0 and "port_efficiency" in metrics:
        return f"efficiency between the ports {significant(100 * metrics['port_efficiency'], 4)} %"
    read = significant(100 * metrics["efficiency"], 4)
    left = significant(100 * metrics.get("energy_efficiency", metrics["efficiency"]), 4)
    return f"efficiency {left} %" if left == read else f"energy efficiency {left} %"


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


def _words(designs: Sequence[Design], index: int) -> str:
    metrics = dict(_counted(designs[-1].results[index].metrics))
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
