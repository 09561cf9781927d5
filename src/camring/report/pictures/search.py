"""How the search went: the best so far by trial, and the designs nobody beats."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.frame import Frame
from camring.drawing.layers import Marks, Note, Region, Steps
from camring.drawing.palette import Style
from camring.drawing.scale import Axis, covering
from camring.drawing.svg import element
from camring.files.quantities import QUANTITIES, significant
from camring.presentation.records import ReportData, Search, Trial
from camring.report.figure import Figure

__all__ = ["convergence_figure", "pareto", "pareto_figure"]

_BEST = Style("#0b5cad", None, 2.2)
_TRIED = Style("#6e8db0", marker="circle", key="mark")
_BROKEN = Style("#a3262b", marker="cross", key="mark")
_SHADES = ("#f1f3f5", "#ffffff", "#e9eef4", "#ffffff")


def _phases(trials: Sequence[Trial]) -> list[tuple[str, float, float]]:
    """Stretches of one phase: name, first and last trial with half a trial of room."""
    stretches: list[tuple[str, float, float]] = []
    for trial in trials:
        if stretches and stretches[-1][0] == trial.phase:
            name, start, _ = stretches[-1]
            stretches[-1] = (name, start, trial.number + 0.5)
        else:
            stretches.append((trial.phase, trial.number - 0.5, trial.number + 0.5))
    return stretches


def convergence_figure(search: Search) -> Figure | None:
    """Objective of every trial and the best feasible one so far."""
    trials = [t for t in search.trials if np.isfinite(t.objective)]
    if not trials:
        return None
    number = np.array([t.number for t in trials], dtype=float)
    objective = np.array([t.objective for t in trials])
    good = np.array([t.feasible for t in trials])
    best = np.minimum.accumulate(np.where(good, objective, np.inf))
    best = np.where(np.isfinite(best), best, np.nan)
    log = bool((objective > 0).all())
    top = _top(objective, good)
    drawn = np.minimum(objective, top)
    layers: list = [
        Region(start, end, name, _SHADES[k % len(_SHADES)])
        for k, (name, start, end) in enumerate(_phases(search.trials))
    ]
    layers += [
        Marks(number[~good], drawn[~good], _BROKEN, 2.4),
        Marks(number[good], drawn[good], _TRIED, 2.2),
        Steps(number, best, "best so far", _BEST),
    ]
    if np.isfinite(best[-1]):
        where = float(number[int(np.nanargmin(best))])
        side = ("end", -6.0) if where > 0.6 * number[-1] else ("start", 6.0)
        layers.append(
            Note(where, float(best[-1]), f"best: trial {where:.0f}", *side[:1], -15.0, side[1])
        )
    end = max(float(search.trials[-1].number), 1.0)
    svg = draw(
        Chart(
            "convergence",
            "Objective by trial",
            "Objective of every evaluated design in the order of evaluation, and the best "
            "feasible objective so far.",
            Axis("Trial", "", -0.5, end + 0.5, tick_count=8),
            covering("Objective J", "", [drawn], margin=0.13, kind="log" if log else "linear"),
            layers,
            [
                ("all limits kept", _TRIED),
                ("a limit broken", _BROKEN),
                ("best so far that keeps all limits", _BEST),
            ],
            width=1064.0,
            height=330.0,
        )
    )
    return Figure(
        "convergence",
        "Convergence of the search",
        svg,
        _search_words(search, bool((objective > top).any())),
        wide=True,
    )


def _top(objective: np.ndarray, good: np.ndarray) -> float:
    """Where to cut the picture: penalties of hopeless designs must not flatten the others."""
    seen = objective[good] if good.any() else objective
    middle = float(np.quantile(seen, 0.5))
    return min(float(objective.max()), max(float(seen.max()), 3 * middle))


def _search_words(search: Search, cut: bool) -> str:
    total = len(search.trials)
    feasible = sum(t.feasible and not t.failed for t in search.trials)
    failed = sum(t.failed for t in search.trials)
    text = f"{total} designs were evaluated, {feasible} of them kept every limit"
    text += f", {failed} could not be evaluated." if failed else "."
    if cut:
        text += " Crosses at the upper edge lie above it: their penalty is large."
    if search.stopped:
        text += f" The search stopped: {search.stopped}."
    return text


def pareto(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Points that no other beats in both, less of each being better; shape (point,) of booleans."""
    order = np.lexsort((y, x))
    keep = np.zeros(len(x), dtype=bool)
    best = np.inf
    for index in order:
        if y[index] < best:
            keep[index], best = True, y[index]
    return keep


def pareto_figure(data: ReportData) -> Figure | None:
    """Torque ripple against lost efficiency, every feasible design, each to be clicked."""
    search = data.search
    if search is None:
        return None
    wanted = ("torque_ripple", "efficiency")
    trials = [t for t in search.trials if t.feasible and all(k in t.results for k in wanted)]
    if len(trials) < 3:
        return None
    ripple = np.array([100 * t.results["torque_ripple"] for t in trials])
    loss = np.array([100 * (1 - t.results["efficiency"]) for t in trials])
    front = pareto(ripple, loss)
    order = np.argsort(ripple[front], kind="stable")
    layers: list = [
        Steps(ripple[front][order], loss[front][order], "front", Style("#0b5cad", None, 1.4)),
        _Designs(tuple(trials), ripple, loss, front),
    ]
    # Below and left of the front there is room; the given motor lies above it.
    places = {"given": ("middle", 9.0, 0.0), "best": ("end", -14.0, -6.0)}
    for number, text in ((search.given, "given"), (search.best, "best")):
        layers += [
            Note(float(x), float(y), text, *places[text])
            for t, x, y in zip(trials, ripple, loss, strict=True)
            if t.number == number
        ]
    svg = draw(
        Chart(
            "pareto",
            "Torque ripple against lost efficiency",
            "Every design that keeps all limits; those on the line are beaten by none in both. "
            "Designs can be chosen with a click, or with Tab and Enter.",
            covering("Torque ripple, one-sided (weighted mean)", "%", [ripple], kind="log"),
            covering("1 − efficiency", "%", [loss]),
            layers,
            width=1064.0,
            height=360.0,
            readable=False,
        )
    )
    count = int(front.sum())
    return Figure(
        "pareto",
        "Ripple against efficiency",
        svg + '<div class="chosen" id="pareto-chosen" aria-live="polite"></div>',
        f"The {count} design{'s' if count > 1 else ''} on the line cannot be improved in one of "
        "the two without losing in the other, among all that were tried. Choose a point to see "
        "its numbers.",
        wide=True,
    )


@dataclass(frozen=True)
class _Designs:
    """Points that carry their design's numbers for the page's script."""

    trials: tuple[Trial, ...]
    x: np.ndarray
    y: np.ndarray
    front: np.ndarray

    def draw(self, frame: Frame) -> str:
        pieces = []
        # The front is drawn last, so that it lies on top.
        order = np.argsort(self.front, kind="stable")
        x, y = frame.x(self.x)[order], frame.y(self.y)[order]
        chosen = [self.trials[k] for k in order]
        spots = zip(chosen, x, y, self.front[order], strict=True)
        for trial, x, y, front in spots:
            rows = [["Trial", f"{trial.number} ({trial.phase})"]]
            for name, value in trial.results.items():
                known = QUANTITIES.get(name)
                rows.append(
                    [known.label, f"{known.written(value)} {known.unit}".strip()]
                    if known
                    else [name.replace("_", " "), significant(value)]
                )
            if front:  # the others would only swell the file
                rows += [[name, significant(value)] for name, value in trial.variables.items()]
            pieces.append(
                element(
                    "circle",
                    cx=float(x),
                    cy=float(y),
                    r=5.0 if front else 3.0,
                    class_="design front" if front else "design",
                    tabindex=0 if front else None,
                    role="button" if front else None,
                    aria_label=f"Trial {trial.number}" if front else None,
                    data_rows=json.dumps(rows, ensure_ascii=False, separators=(",", ":")),
                )
            )
        return "".join(pieces)
