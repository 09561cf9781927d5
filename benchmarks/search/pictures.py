"""Pictures of the runs: best value against evaluations, and data profiles."""

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from benchmarks.search.campaign import Campaign, Entry
from benchmarks.search.measures import TARGETS, profile, quartiles

# Okabe and Ito's colours; ours drawn thick, rivals thin, each library one colour.
STYLES = {
    "gradient": ("#D55E00", "-"),
    "bayesian": ("#E69F00", "-"),
    "bayesian + model": ("#E69F00", "--"),
    "scbo": ("#CC79A7", "-"),
    "scbo + model": ("#CC79A7", "--"),
    "differences": ("#009E73", "-."),
    "cma-es": ("#8C564B", "-"),
    "nelder-mead": ("#8C564B", "--"),
    "SLSQP, differences": ("#000000", "-"),
    "COBYQA": ("#0072B2", "-"),
    "SciPy DE": ("#7F7F7F", "-"),
    "pycma": ("#7F7F7F", "--"),
    "pymoo GA": ("#7F7F7F", ":"),
    "pymoo ISRES": ("#7F7F7F", "-."),
    "Optuna TPE": ("#56B4E9", "-"),
    "Optuna GP": ("#56B4E9", "--"),
    "SMT EGO": ("#009E73", "-"),
    "BoTorch SCBO": ("#009E73", "--"),
}
LOWEST, HIGHEST = 1e-4, 10.0
BAND = ("gradient", "scbo", "scbo + model", "differences", "SLSQP, differences", "COBYQA")
LONG = 300  # evaluations; a panel of longer runs has a logarithmic axis
"""Methods whose quartiles are drawn as well; more would hide one another."""


def _style(entry: Entry) -> dict:
    colour, dashes = STYLES[entry.method]
    width = 2.2 if entry.is_ours else 1.2
    return {"color": colour, "linestyle": dashes, "linewidth": width}


def convergence(campaign: Campaign, path: Path) -> None:
    """Median of the best feasible excess over the best known value, a panel a problem."""
    columns = 3
    rows = math.ceil(len(campaign.problems) / columns)
    figure = Figure(figsize=(12, 3.1 * rows))
    panels = figure.subplots(rows, columns, squeeze=False)
    for axes in panels.flat[len(campaign.problems) :]:
        axes.set_visible(False)
    entries = [each for each in campaign.entries if not each.slopes_cost]
    for axes, problem in zip(panels.flat, campaign.problems, strict=False):
        for entry in entries:
            traces = campaign.runs(entry, problem)
            if not traces:
                continue
            length = max(each.budget for each in traces)
            lower, median, upper = np.clip(
                quartiles(traces, campaign.best_known[problem], length), LOWEST, None
            )
            # Only where something changes: else the file would be ten times as large.
            levels = np.minimum(np.stack([lower, median, upper]), 100 * HIGHEST)
            changed = np.any(np.diff(levels, prepend=np.nan) != 0, axis=0)
            changed[-1] = True
            counted = 1 + np.flatnonzero(changed)
            lower, median, upper = levels[:, changed]
            axes.plot(counted, median, drawstyle="steps-post", **_style(entry))
            if entry.method in BAND:
                colour = STYLES[entry.method][0]
                shade = {"color": colour, "alpha": 0.12, "linewidth": 0, "step": "post"}
                axes.fill_between(counted, lower, upper, **shade)
        for target in TARGETS:
            axes.axhline(target, color="#BBBBBB", linewidth=0.6, zorder=0)
        axes.set(yscale="log", ylim=(0.9 * LOWEST, HIGHEST), title=problem)
        budgets = [t.budget for entry in entries for t in campaign.runs(entry, problem)]
        if max(budgets) > LONG:
            axes.set(xscale="log", xlim=(1, max(budgets)))
        else:
            axes.set(xlim=(0, None))
    for axes in panels[:, 0]:
        axes.set_ylabel("above the best known, relative")
    for axes in panels[-1]:
        axes.set_xlabel("evaluations")
    _finish(figure, entries, path)


def profiles(campaign: Campaign, path: Path) -> None:
    """Share of runs within each target against evaluations over variables and one."""
    figure = Figure(figsize=(12, 4.2))
    panels = figure.subplots(1, len(TARGETS), sharey=True)
    budgets = np.geomspace(0.5, 50, 120)
    for axes, target in zip(panels, TARGETS, strict=True):
        for entry in campaign.entries:
            groups = [
                (traces, campaign.best_known[problem], campaign.dimension[problem])
                for problem in campaign.problems
                if (traces := campaign.runs(entry, problem))
            ]
            style = _style(entry)
            if entry.slopes_cost:
                style["linestyle"] = ":"
            axes.plot(budgets, profile(groups, target, budgets, entry.slopes_cost), **style)
        axes.set(xscale="log", ylim=(0, 1), title=f"within {100 * target:g} %")
        axes.set_xlabel("evaluations / (variables + 1)")
    panels[0].set_ylabel("share of runs, problems alike")
    _finish(figure, campaign.entries, path)


def _finish(figure: Figure, entries: list[Entry], path: Path) -> None:
    handles = []
    for entry in entries:
        style = _style(entry)
        if entry.slopes_cost:
            style["linestyle"] = ":"
        handles.append(Line2D([], [], label=entry.name, **style))
    figure.legend(handles=handles, ncols=6, loc="lower center", frameon=False, fontsize=8)
    height = figure.get_size_inches()[1]
    figure.tight_layout(rect=(0, 0.75 / height, 1, 1))
    figure.savefig(path.with_suffix(".png"), dpi=80)
