"""Tables and pictures from the runs kept.

    python -m benchmarks.search.report [--traces benchmarks/results/search] [--pictures FOLDER]

Prints Markdown: expected running times to 10, 1 and 0.1 % above the best known value with
the runs that got there, how ours compare with the best rival, every case lost, what each
method's own thinking costs. Draws docs/pictures/search_convergence and search_profiles.
"""

import argparse
import math
import statistics
from pathlib import Path

from benchmarks.search.campaign import Campaign
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


def ratio(ours: RunningTime | None, theirs: RunningTime) -> str:
    """Our expected evaluations over theirs; nothing where ours has not been run."""
    if ours is None or not ours.runs:
        return ""
    if not theirs.successes:
        return "they never" if ours.successes else "neither"
    return f"{ours.expected / theirs.expected:.2f}" if ours.successes else "we never"


def aims(campaign: Campaign, target: float) -> str:
    """Ours beside the best rival of each problem, chosen afterwards in the rival's favour."""
    lines = [
        "| problem | best rival | bayesian | of the rival | best of ours without slopes "
        "| of the rival | gradient, slopes 0 / 2 | of the rival |",
        "|---" * 8 + "|",
    ]
    for problem in campaign.problems:
        rival, theirs = campaign.best(problem, target, campaign.rivals)
        usual = campaign.time(campaign.named("bayesian"), problem, target)
        own, best = campaign.best(problem, target, campaign.ours_without_slopes)
        slopes = [campaign.time(each, problem, target) for each in campaign.ours_with_slopes]
        against = " / ".join(ratio(each, theirs) for each in slopes)
        lines.append(
            f"| {problem} | {rival} {said(theirs)} "
            f"| {said(usual)} | {ratio(usual, theirs)} "
            f"| {own} {said(best)} | {ratio(best, theirs)} "
            f"| {' / '.join(said(each) for each in slopes)} | {against} |"
        )
    return "\n".join(lines)


def counts(campaign: Campaign, target: float) -> str:
    """How often the aims are met, and how often ours are behind."""
    tally = {"half": 0, "ahead": 0, "tenth": 0, "tenth, slopes counted": 0}
    usual = {"half": 0, "ahead": 0}
    for problem in campaign.problems:
        _, theirs = campaign.best(problem, target, campaign.rivals)
        _, best = campaign.best(problem, target, campaign.ours_without_slopes)
        learned = campaign.time(campaign.named("bayesian"), problem, target)
        plain, full = (campaign.time(each, problem, target) for each in campaign.ours_with_slopes)
        for time, into in ((best, tally), (learned, usual)):
            if time is not None and math.isfinite(time.expected):
                into["half"] += time.expected <= HALF * theirs.expected
                into["ahead"] += time.expected < theirs.expected
        for time, name in ((plain, "tenth"), (full, "tenth, slopes counted")):
            if time is not None and math.isfinite(time.expected):
                tally[name] += time.expected <= TENTH * theirs.expected
    total = len(campaign.problems)
    return (
        f"To {percent(target)}, of {total} problems: bayesian at most half of the best rival's "
        f"evaluations on {usual['half']}, fewer on {usual['ahead']}; the best of ours without "
        f"slopes at most half on {tally['half']}, fewer on {tally['ahead']}; gradient at most a "
        f"tenth on {tally['tenth']} with slopes free, on {tally['tenth, slopes counted']} with "
        "slopes at two evaluations."
    )


def lost(campaign: Campaign) -> str:
    """Every problem and target at which some rival needs fewer evaluations than ours."""
    lines = []
    for problem in campaign.problems:
        for target in TARGETS:
            own, best = campaign.best(problem, target, campaign.ours_without_slopes)
            ahead = [
                (time.expected, f"{entry.name} {said(time)}")
                for entry in campaign.rivals
                if (time := campaign.time(entry, problem, target)) is not None
                and time.expected < best.expected
            ]
            if ahead:
                names = ", ".join(name for _, name in sorted(ahead))
                lines.append(f"| {problem} | {percent(target)} | {own} {said(best)} | {names} |")
    head = "| problem | target | best of ours without slopes | ahead of it |\n|---|---|---|---|\n"
    return head + "\n".join(lines)


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
    convergence(campaign, asked.pictures / "search_convergence")
    profiles(campaign, asked.pictures / "search_profiles")


if __name__ == "__main__":
    main()
