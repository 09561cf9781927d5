"""Shaft torque over a revolution, and the orders that it and the supply flow are made of."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.layers import Curve, Rule, Stems
from camring.drawing.scale import Axis, covering
from camring.files.quantities import significant
from camring.presentation.records import Design, Result
from camring.report.figure import Figure, around, degrees, design_styles, legend

__all__ = ["surviving", "torque_figures"]

FLOOR = 1e-3  # per cent of the mean torque; what lies lower is not drawn


def _percent(results: Sequence[Result]) -> str:
    return ", then ".join(significant(100 * r.metrics["torque_ripple"], 3) + " %" for r in results)


def _over_revolution(designs: Sequence[Design], index: int) -> Figure:
    name = f"torque-{index}"
    layers: list = []
    heights = []
    for design, style in zip(designs, design_styles(designs), strict=True):
        waves = design.results[index].waves
        angle, torque = around(waves.angle, waves.torque, 0.0, 2 * pi - 1e-9)
        heights.append(torque)
        layers.append(Curve(degrees(angle), torque, design.label, style))
    last = designs[-1].results[index]
    mean = last.metrics["mean_torque"]
    layers.insert(0, Rule(mean))
    svg = draw(
        Chart(
            name,
            "Shaft torque over one revolution",
            "Torque of the shaft, all pistons together, over one revolution. The axis does not "
            "start at zero.",
            Axis("Shaft angle", "deg", 0.0, 360.0, "angle", 12),
            covering("Shaft torque", "N·m", heights),
            layers,
            legend(designs),
            width=1064.0,
            height=310.0,
        )
    )
    results = [design.results[index] for design in designs]
    times = designs[-1].facts.surviving_order
    sentence = (
        f"All pistons together repeat {times} times a revolution about a mean of "
        f"{significant(mean)} N·m (the axis does not start at zero). One-sided torque ripple: "
        f"{_percent(results)}."
    )
    return Figure(name, "Shaft torque over a revolution", svg, sentence, wide=True)


@dataclass(frozen=True)
class _Wave:
    """What is taken apart into orders."""

    name: str
    words: str
    title: str
    mean: str  # metric that the amplitudes are shares of
    amplitudes: Callable[[Result], np.ndarray]


_TORQUE = _Wave(
    "orders",
    "torque",
    "Which orders survive",
    "mean_torque",
    lambda result: result.torque_amplitudes,
)
_FLOW = _Wave(
    "flow-orders",
    "supply flow",
    "The same orders of the supply flow",
    "supply_flow",
    lambda result: result.flow_amplitudes,
)


def surviving(
    result: Result, order: int, limit: int = 12, wave: _Wave = _TORQUE
) -> tuple[np.ndarray, np.ndarray]:
    """The multiples of the surviving order and their amplitudes in per cent of the wave's mean."""
    chosen = (result.orders > 0) & (result.orders % order == 0)
    orders = result.orders[chosen][:limit]
    amplitudes = wave.amplitudes(result)[chosen][:limit]
    return orders, 100 * amplitudes / abs(result.metrics[wave.mean])


def _spectrum(designs: Sequence[Design], index: int, wave: _Wave) -> Figure:
    name = f"{wave.name}-{index}"
    count = len(designs)
    layers: list = []
    tops, reach = [], 0.0
    for k, (design, style) in enumerate(zip(designs, design_styles(designs), strict=True)):
        orders, percent = surviving(design.results[index], design.facts.surviving_order, wave=wave)
        shown = np.where(percent > FLOOR, percent, np.nan)
        tops.append(shown)
        reach = max(reach, float(orders[-1]) if orders.size else 1.0)
        layers.append(Stems(orders, shown, style, 8.0 * (k - (count - 1) / 2)))
    base = designs[-1].facts.surviving_order
    high = covering("", "", tops, kind="log").high
    svg = draw(
        Chart(
            name,
            f"{wave.words.capitalize()} by shaft order",
            f"Peak amplitude of each surviving order of {wave.words}, in per cent of its mean, "
            "on a logarithmic scale.",
            Axis(
                "Shaft order", "per revolution", 0.0, reach + base / 2, marked=_marks(base, reach)
            ),
            Axis("Amplitude (peak)", f"% of mean {wave.words}", FLOOR, max(high, 1.0), "log"),
            layers,
            [(label, replace(style, key="mark")) for label, style in legend(designs)],
            width=1064.0,
            height=310.0,
            readable=False,
        )
    )
    return Figure(name, wave.title, svg, _order_sentence(designs, index, wave), wide=True)


def _marks(base: int, reach: float) -> tuple[float, ...]:
    return tuple(float(n) for n in range(base, int(reach) + 1, base))


def _order_sentence(designs: Sequence[Design], index: int, wave: _Wave) -> str:
    facts = designs[-1].facts
    base = facts.surviving_order
    orders, percent = surviving(designs[-1].results[index], base, wave=wave)
    why = (
        f"{facts.pistons} pistons on {facts.lobes} lobes cancel every order that is not a multiple "
        f"of {base}, so {wave.words} holds orders {base}, {2 * base}, {3 * base} and so on only."
    )
    if wave is _FLOW:
        why = "What the supply line hears: it makes pressure ripple in the pipes."
    if not orders.size or not np.isfinite(percent).any():
        return why
    strongest = int(np.argmax(percent))
    whose = "" if len(designs) == 1 else f" of the {designs[-1].label} design"
    return (
        f"{why} The strongest{whose} is order {int(orders[strongest])} with "
        f"{significant(float(percent[strongest]), 2)} % of mean {wave.words} (peak)."
    )


def torque_figures(designs: Sequence[Design], index: int) -> list[Figure]:
    """Torque in angle, torque and supply flow in orders, at one operating point."""
    spectra = [_spectrum(designs, index, wave) for wave in (_TORQUE, _FLOW)]
    return [_over_revolution(designs, index), *spectra]
