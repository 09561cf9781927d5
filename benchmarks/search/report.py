"""Tables and pictures from the runs kept.

    python -m benchmarks.search.report [--traces benchmarks/results/search] [--pictures FOLDER]

Prints Markdown: expected running times to 10, 1 and 0.1 % above the best known value with
the runs that got there, how ours compare with the best rival, every case lost, what each
method's own thinking costs. Draws docs/pictures/search_convergence.png and search_profiles.png.
"""

import argparse
import math
import statistics
from pathlib import Path

from benchmarks.search.campaign import Campaign, Duel
from benchmarks.search.measures import TARGETS, RunningTime
from benchmarks.search.traces import RESULTS, kept

PICTURES = Path(__file__).parents[2] / "docs" / "pictures"
HALF, TENTH = 0.5, 0.1  # what ours should need of the best rival's evaluations


def said(time: RunningTime | None) -> str:
    """Expected evaluations, and of how many runs how many got there where not all did."""
    if time is None:
        return ""
    number = f"{time.expected:.0f}" if math.isfinite(time.expected) else "–"
    return f"{number} ({time.successes}/{time.runs})"


def percent(target: float) -> str:
    return f"{100 * target:g} %"


def running_times(campaign: Campaign, target: float) -> str:
    lines = ["| method | " + " | ".join(campaign.problems) + " |"]
    lines.append("|---" * (1 + len(campaign.problems)) + "|")
    for entry in campaign.entries:
        cells = [said(campaign.time(entry, problem, target)) for problem in campaign.problems]
        lines.append(f"| {entry.name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def faced(duel: Duel) -> str:
    """One ratio with the rival and both expectations behind it."""
    if math.isnan(duel.ratio):
        return f"neither ({duel.our_time.runs} seeds)"
    if not duel.rival_time.successes:
        longest = f"no rival in {duel.rival_time.longest:.0f}"
        return f"under {duel.ratio:.2f}: {said(duel.our_time)} : {longest}"
    number = f"{duel.ratio:.2f}" if math.isfinite(duel.ratio) else "never"
    behind = f"{said(duel.our_time)} : {said(duel.rival_time)} {duel.rival.name}"
    return f"{number}: {behind}"


def aims(campaign: Campaign, target: float) -> str:
    """Each of ours beside the rival that is hardest for it on the seeds that both have."""
    shown = [each for each in campaign.ours if each.method not in ("cma-es", "nelder-mead")]
    lines = ["| problem | " + " | ".join(each.name for each in shown) + " |"]
    lines.append("|---" * (1 + len(shown)) + "|")
    for problem in campaign.problems:
        duels = [campaign.duels(each, problem, target) for each in shown]
        cells = [faced(each[0]) if each else "" for each in duels]
        lines.append(f"| {problem} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def counts(campaign: Campaign, target: float) -> str:
    """On how many problems each of ours stands how to its hardest rival."""
    lines = [
        "| ours | problems | at most a tenth | at most half | fewer | more, or never |",
        "|---" * 6 + "|",
    ]
    for entry in campaign.ours:
        hardest = [
            duels[0].ratio for p in campaign.problems if (duels := campaign.duels(entry, p, target))
        ]
        if not hardest:
            continue
        below = [sum(ratio <= limit for ratio in hardest) for limit in (TENTH, HALF)]
        fewer, more = sum(r < 1 for r in hardest), sum(r > 1 for r in hardest)
        lines.append(
            f"| {entry.name} | {len(hardest)} | {below[0]} | {below[1]} | {fewer} | {more} |"
        )
    return "\n".join(lines)


def lost(campaign: Campaign) -> str:
    """Every problem and target at which a rival needs fewer evaluations than one of ours."""
    lines = ["| problem | target | ours | ahead of it |", "|---" * 4 + "|"]
    for problem in campaign.problems:
        for entry in campaign.ours:
            if entry.method in ("cma-es", "nelder-mead"):
                continue
            for target in TARGETS:
                ahead = [d for d in campaign.duels(entry, problem, target) if d.ratio > 1]
                names = ", ".join(f"{d.rival.name} {said(d.rival_time)}" for d in ahead)
                own = said(campaign.time(entry, problem, target))
                if ahead:
                    lines.append(
                        f"| {problem} | {percent(target)} | {entry.name} {own} | {names} |"
                    )
    return "\n".join(lines)


def thinking(campaign: Campaign) -> str:
    """Processor milliseconds of the method itself for each evaluation, median over runs."""
    kinds = {
        "2 variables": lambda problem: campaign.dimension[problem] == 2,
        "4 to 10": lambda problem: campaign.dimension[problem] > 2 and problem not in MOTORS,
        "motors": lambda problem: problem in MOTORS,
    }
    lines = [
        "| method | " + " | ".join(kinds) + " | evaluations of a run, most |",
        "|---" * 5 + "|",
    ]
    for entry in campaign.entries:
        if entry.slopes_cost:
            continue
        cells = []
        for belongs in kinds.values():
            each = [
                1e3 * trace.thinking / len(trace.objective)
                for problem in campaign.problems
                if belongs(problem)
                for trace in campaign.runs(entry, problem)
                if trace.thinking is not None
            ]
            cells.append(f"{statistics.median(each):.2g}" if each else "")
        most = max(len(t.objective) for p in campaign.problems for t in campaign.runs(entry, p))
        lines.append(f"| {entry.method} | " + " | ".join(cells) + f" | {most} |")
    return "\n".join(lines)


MOTORS = ("wheel", "winch", "mill")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--traces", type=Path, default=RESULTS)
    parser.add_argument("--pictures", type=Path, default=PICTURES)
    asked = parser.parse_args()
    campaign = Campaign.of(kept(asked.traces).values())
    if not campaign.problems:
        raise SystemExit(f"no runs in {asked.traces}: python -m benchmarks.search makes them")
    print(
        "## Best known values\n\n| problem | variables | constraints | best known | lowest found |"
    )
    print("|---|---|---|---|---|")
    for problem in campaign.problems:
        print(
            f"| {problem} | {campaign.dimension[problem]} | {campaign.constraint_count[problem]} "
            f"| {campaign.best_known[problem]:.8g} | {campaign.lowest(problem):.8g} |"
        )
    for target in TARGETS:
        name = percent(target)
        print(f"\n## Expected evaluations to {name}\n\n{running_times(campaign, target)}")
        print(f"\n## Aims, {name}\n\n{aims(campaign, target)}\n\n{counts(campaign, target)}")
    print(f"\n## Lost\n\n{lost(campaign)}")
    print(f"\n## Own processor time, ms an evaluation\n\n{thinking(campaign)}")
    try:
        from benchmarks.search.pictures import convergence, profiles
    except ImportError:
        print('\nNo pictures without matplotlib: pip install "camring[plot]" brings it.')
        return
    asked.pictures.mkdir(parents=True, exist_ok=True)
    convergence(campaign, asked.pictures / "search_convergence")
    profiles(campaign, asked.pictures / "search_profiles")


if __name__ == "__main__":
    main()
