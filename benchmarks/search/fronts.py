"""camring's front of a motor beside NSGA-II's, for the same processor time and the same time.

    python -m benchmarks.search.fronts [--motor FILE] [--of torque_ripple,efficiency]
        [--seeds 3] [--points 50]

NSGA-II (pymoo) evaluates its populations by `evaluate_many`, the fastest there is here, on
all cores and at search or at final resolution, begins with the given design among Sobol's,
and keeps the same limits drawn in by `SAFETY`, those of the operating points: of a file with
an `[envelope]` it would be asked for less than camring, so such a file is refused. Its front
is taken when it has had the processor time of camring's search, when it has had the time by
the clock, and, at search resolution from the first seed, at three times the processor time.
As many designs of it as camring's has, evenly spread, are then looked at as camring's are: at
finer resolution, where what breaks a limit is left out. The hypervolume of each front is its
share of one box about all of them. Kept after every run
in benchmarks/results/search/fronts.json with every design's values: stopped, it goes on
where it was. The picture of two results is docs/pictures/fronts_MOTOR.
"""

import argparse
import json
import math
import time
from dataclasses import dataclass
from pathlib import Path

from camring.programs.compilation_cache import keep_compiled_programs

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "search" / "fronts.json"
PICTURES = ROOT / "docs" / "pictures"
POPULATION = 128
LONGER = 3.0  # times camring's processor time, at the last resolution
RESOLUTIONS = ("search", "final")
TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50)  # per cent
MARGIN = 0.1  # of the box beyond the worst corner of the best front known


@dataclass
class Found:
    """Losses (smaller is better) of the designs of one front, and what it took."""

    name: str
    processor: float
    clock: float
    evaluations: int
    losses: list[list[float]]
    dropped: int = 0
    seed: int = 0


def main() -> None:
    keep_compiled_programs()  # before JAX is imported
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motor", type=Path, default=ROOT / "examples" / "derivation_motor.toml")
    parser.add_argument("--of", default="torque_ripple,efficiency")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--points", type=int, default=50)
    parser.add_argument("--resolutions", nargs="+", choices=RESOLUTIONS, default=RESOLUTIONS)
    parser.add_argument("--out", type=Path, default=RESULTS)
    asked = parser.parse_args()

    from camring.files.motor import read_motor_file
    from camring.studies.pareto import traded_results

    file, names = read_motor_file(asked.motor), traded_results(asked.of)
    if file.envelope is not None:
        parser.error(f"{asked.motor} has an [envelope], of which NSGA-II here knows nothing")
    study = f"{asked.motor.stem}: {', '.join(names)}; {asked.points}"
    fronts = kept(asked.out).get(study, [])
    if not fronts:
        fronts.append(ours(file, names, asked.points))
        keep(study, fronts, asked.out)
    own = fronts[0]
    print(f"camring: {own.processor:.1f} s of processor time, {own.clock:.1f} s", flush=True)
    for seed in range(asked.seeds):
        for resolution in asked.resolutions:
            if any(each.seed == seed and resolution in each.name for each in fronts[1:]):
                continue
            fronts.extend(evolved(file, names, seed, own, resolution))
            keep(study, fronts, asked.out)
    shares = volumes([each.losses for each in fronts])
    print(
        "\n| front | seed | processor s | clock s | designs evaluated | in the front | left out "
        "| widest gap over mean | hypervolume |"
    )
    print("|---" * 9 + "|")
    for each, share in zip(fronts, shares, strict=True):
        print(
            f"| {each.name} | {each.seed} | {each.processor:.1f} | {each.clock:.1f} "
            f"| {each.evaluations} | {len(each.losses)} | {each.dropped} "
            f"| {widest_gap(each.losses):.1f} | {share:.4f} |"
        )
    if len(names) == 2:
        draw(fronts, names, PICTURES / f"fronts_{asked.motor.stem}")


def kept(path: Path) -> dict[str, list[Found]]:
    """Every study's fronts."""
    if not path.exists():
        return {}
    studies = json.loads(path.read_text())
    return {study: [Found(**each) for each in fronts] for study, fronts in studies.items()}


def keep(study: str, fronts: list[Found], path: Path) -> None:
    """After every run, so that what was stopped goes on where it was."""
    path.parent.mkdir(parents=True, exist_ok=True)
    everything = kept(path) | {study: fronts}
    plain = {name: [vars(each) for each in found] for name, found in everything.items()}
    path.write_text(json.dumps(plain, indent=None) + "\n")


def ours(file, names, points: int) -> Found:
    """`camring pareto`'s own search; its later resolutions are not counted."""
    import numpy as np

    from camring.studies.objectives import SENSES
    from camring.studies.pareto import trade_off

    trade_off(file, names, points=3, sample=1)  # compiles
    marks: list[tuple[float, float]] = []

    def say(sentence: str) -> None:
        if sentence.startswith(("Screening", "Looking again")):
            marks.append((time.process_time(), time.monotonic()))

    found = trade_off(file, names, points=points, sample=1, say=say)
    processor, clock = np.subtract(marks[1], marks[0])
    losses = (found.values * [-SENSES[name] for name in names]).tolist()
    count = found.screened + found.evaluations
    return Found("camring", processor, clock, count, losses, len(found.dropped))


def evolved(file, names, seed: int, own: Found, resolution_name: str):
    """NSGA-II's front at camring's processor time, at its time by the clock, and later."""
    import numpy as np
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.problem import Problem
    from pymoo.problems.static import StaticProblem

    from camring.evaluation.batch import cores, evaluate_many
    from camring.evaluation.outcome import SAFETY
    from camring.objective.point_shares import point_shares
    from camring.physics.batch_cycle import BatchResolution
    from camring.search.sampling import initial_point
    from camring.studies.objectives import SENSES

    space = file.design_space
    limits = file.goal.constraints.names()
    resolution = BatchResolution() if resolution_name == "final" else BatchResolution.search()

    def evaluated(points):
        chunk = POPULATION // cores()
        found = evaluate_many(space, file.system, file.goal, points, resolution, chunk=chunk)
        sound = np.all(np.asarray(found.faults) == 0, axis=0)
        columns = [np.array([getattr(m, n) for m in found.metrics]) for n in names]
        losses = [
            -SENSES[n] * np.array([point_shares(file.system, n, each) @ each for each in column.T])
            for n, column in zip(names, columns, strict=True)
        ]
        constraints = np.stack([np.asarray(found.constraints[n]) for n in limits], axis=1) + SAFETY
        losses = np.where(sound[:, None], np.stack(losses, axis=1), 1e3)
        constraints = np.where(sound[:, None] & np.isfinite(constraints), constraints, 1e3)
        return losses, constraints

    dimension = space.dimension
    first = (tuple(map(float, space.locate(file.system))),)
    design = np.array([initial_point(i, dimension, seed, first) for i in range(POPULATION)])
    evaluated(design)  # compiles
    problem = Problem(n_var=dimension, n_obj=len(names), n_ieq_constr=len(limits), xl=0.0, xu=1.0)
    algorithm = NSGA2(pop_size=POPULATION, sampling=design)
    algorithm.setup(problem, termination=("n_gen", 10**9), seed=seed, verbose=False)
    goals = [
        ("same processor time", own.processor, 0),
        ("same time", own.clock, 1),
        (f"{LONGER:g} times the processor time", LONGER * own.processor, 0),
    ][: 3 if seed == 0 and resolution_name == "search" else 2]
    count, looking = 0, np.zeros(2)
    started = np.array([time.process_time(), time.monotonic()])
    fronts = []
    while goals:
        population = algorithm.ask()
        losses, constraints = evaluated(population.get("X"))
        Evaluator().eval(StaticProblem(problem, F=losses, G=constraints), population)
        algorithm.tell(infills=population)
        count += len(population)
        spent = np.array([time.process_time(), time.monotonic()]) - started - looking
        for goal in [each for each in goals if spent[each[2]] >= each[1]]:
            before = np.array([time.process_time(), time.monotonic()])
            losses, dropped = looked_again(file, names, algorithm.opt, len(own.losses))
            looking += np.array([time.process_time(), time.monotonic()]) - before
            name = f"NSGA-II, {resolution_name} resolution, {goal[0]}"
            fronts.append(Found(name, *spent, count, losses, dropped, seed))
            print(f"{name}, seed {seed}: {count} designs evaluated", flush=True)
            goals.remove(goal)
    return fronts


def looked_again(file, names, population, count: int) -> tuple[list[list[float]], int]:
    """Losses at finer resolution of so many designs, those that keep every limit there."""
    import numpy as np

    from camring.evaluation.assessed import outcome_of
    from camring.files.motor import parse_motor_file
    from camring.objective.point_shares import point_shares
    from camring.physics.resolution import Resolution
    from camring.programs.compiled import assess
    from camring.search.pareto.dominance import box_of, evenly_spread
    from camring.studies.objectives import SENSES

    feasible = np.all(population.get("FEAS").reshape(len(population), -1), axis=1)
    points, losses = population.get("X")[feasible], population.get("F")[feasible]
    if not len(points):
        return [], len(population)
    lowest, width = box_of(losses)
    kept, dropped = [], 0
    for point in points[evenly_spread((losses - lowest) / width, count)]:
        motor = parse_motor_file(file.with_design(point.tolist()), file.path)
        outcome = outcome_of(assess(motor.system, motor.goal, Resolution.fine()))
        broken = any(value > 0 for value in outcome.constraints.values())
        if outcome.failure or broken:
            dropped += 1
            continue
        columns = [np.array([each[n] for each in outcome.results]) for n in names]
        kept.append(
            [
                -SENSES[n] * float(point_shares(file.system, n, column) @ column)
                for n, column in zip(names, columns, strict=True)
            ]
        )
    return kept, dropped


def volumes(fronts: list[list[list[float]]]) -> list[float]:
    """Share of one box that each front dominates: from the best of all to a tenth beyond."""
    import numpy as np

    from camring.search.pareto.dominance import box_of, hypervolume, non_dominated

    together = np.array([each for front in fronts for each in front])
    lowest, width = box_of(together[np.flatnonzero(non_dominated(together))])
    reference = np.full(together.shape[1], 1 + MARGIN)
    return [
        hypervolume((np.array(front) - lowest) / width, reference) / math.prod(reference)
        if front
        else 0.0
        for front in fronts
    ]


def widest_gap(losses: list[list[float]]) -> float:
    """Over the mean gap, along a front of two results in widths of itself; else no number."""
    import numpy as np

    from camring.search.pareto.dominance import box_of, non_dominated

    values = np.array(losses)
    if len(values) < 3 or values.shape[1] != 2:
        return math.nan
    values = values[non_dominated(values)]
    lowest, width = box_of(values)
    along = ((values - lowest) / width)[np.argsort(values[:, 0])]
    gaps = np.linalg.norm(np.diff(along, axis=0), axis=1)
    return float(np.max(gaps) / np.mean(gaps))


def _reach(values) -> tuple[float, float]:
    """A little beyond all of them, in steps of a factor."""
    return float(min(values)) / 1.15, float(max(values)) * 1.15


def draw(fronts: list[Found], names, path: Path) -> None:
    """Writes the picture of two results as PNG: same processor time, first seed."""
    import numpy as np
    from matplotlib.figure import Figure

    from camring.studies.objectives import SENSES

    shown = [each for each in fronts if each.seed == 0 and "same time" not in each.name]
    figure = Figure(figsize=(7.5, 5))
    axes = figure.subplots()
    colours = ("#D55E00", "#56B4E9", "#0072B2", "#CC79A7", "#009E73")
    for place, (front, colour) in enumerate(zip(shown, colours, strict=False)):
        values = np.array(front.losses).reshape(-1, 2) * [-SENSES[name] for name in names]
        axes.plot(
            *(100 * values[np.argsort(values[:, 0])].T),
            color=colour,
            marker="os^Dv"[place],
            markersize=4,
            linestyle="-" if place == 0 else "none",
            linewidth=1,
            zorder=len(shown) - place,
            label=front.name,
        )
    axes.set_xscale("log")
    axes.set_xticks(TICKS, labels=[f"{each:g}" for each in TICKS])
    axes.set_xlim(*_reach(100 * np.abs(np.concatenate([each.losses for each in shown])[:, 0])))
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.set(
        xlabel=f"{names[0].replace('_', ' ')}, %",
        ylabel=f"{names[1].replace('_', ' ')}, %",
    )
    axes.legend(fontsize=7, frameon=False)
    figure.tight_layout()
    figure.savefig(path.with_suffix(".png"), dpi=90)


if __name__ == "__main__":
    main()
