"""camring's front of the wheel motor beside NSGA-II's, for the same processor time.

    python -m benchmarks.search.fronts [--motor FILE] [--of torque_ripple,efficiency]
        [--seeds 5] [--times 0.5 1] [--points 50]

NSGA-II (pymoo) evaluates its populations by `evaluate_many`, the fastest there is here, on
one thread, keeps the same limits drawn in by `SAFETY`, and gets so many times the
processor time of camring's search. As many designs of its front as camring's has, evenly
spread, are then looked at as camring's are: at finer resolution, where what breaks a limit
is left out. The hypervolume of each front
is its share of one box about all of them. Kept after every seed, in
benchmarks/results/search/fronts_POINTS.json with every design's values: stopped, it goes
on where it was. The picture is docs/pictures/search_fronts.
"""

import argparse
import json
import math
import time
from dataclasses import dataclass
from pathlib import Path

from camring.interfaces.compilation_cache import keep_compiled_programs

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "search" / "fronts.json"
PICTURE = ROOT / "docs" / "pictures" / "search_fronts"
POPULATION = 128
MARGIN = 0.1  # of the box beyond the worst corner of the best front known


@dataclass
class Found:
    """Losses (smaller is better) of the designs of one front, and what it took."""

    name: str
    seconds: float
    evaluations: int
    losses: list[list[float]]
    dropped: int = 0


def main() -> None:
    keep_compiled_programs()  # before JAX is imported
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motor", type=Path, default=ROOT / "examples" / "wheel_motor.toml")
    parser.add_argument("--of", default="torque_ripple,efficiency")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--times", type=float, nargs="+", default=[0.5, 1.0])
    parser.add_argument("--points", type=int, default=50)
    parser.add_argument("--out", type=Path, default=RESULTS)
    asked = parser.parse_args()

    from camring.interfaces.config import read_motor_file
    from camring.interfaces.trade_off import traded_results

    file, names = read_motor_file(asked.motor), traded_results(asked.of)
    kept = asked.out.with_name(f"{asked.out.stem}_{asked.points}.json")
    fronts = [Found(**each) for each in json.loads(kept.read_text())] if kept.exists() else []
    if not fronts:
        fronts = [ours(file, names, asked.points)]
        keep(fronts, kept)
    own = fronts[0]
    print(f"camring: {own.seconds:.1f} s of processor time, {len(own.losses)} designs", flush=True)
    for seed in range((len(fronts) - 1) // len(asked.times), asked.seeds):
        times = [each * own.seconds for each in asked.times]
        for found in evolved(file, names, seed, times, asked.points):
            fronts.append(found)
            print(f"{found.name}: {found.evaluations} designs judged", flush=True)
        keep(fronts, kept)
    shares = volumes([each.losses for each in fronts])
    print("\n| front | processor s | designs judged | in the front | left out | hypervolume |")
    print("|---" * 6 + "|")
    for each, share in zip(fronts, shares, strict=True):
        print(
            f"| {each.name} | {each.seconds:.1f} | {each.evaluations} | {len(each.losses)} "
            f"| {each.dropped} | {share:.4f} |"
        )
    try:
        draw(fronts, names, PICTURE)
    except ImportError:
        print('No picture without matplotlib: pip install "camring[plot]" brings it.')


def keep(fronts: list[Found], path: Path) -> None:
    """After every seed, so that a run that was stopped goes on where it was."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps([vars(each) for each in fronts]) + "\n")


def ours(file, names, points: int) -> Found:
    """`camring pareto`'s own search; its later looks are not counted."""
    import numpy as np

    from camring.interfaces.trade_off import SENSES, trade_off

    trade_off(file, names, points=3, sample=1)  # compiles
    marks: list[float] = []
    started = time.process_time()

    def say(sentence: str) -> None:
        if sentence.startswith("Looking again"):
            marks.append(time.process_time())

    found = trade_off(file, names, points=points, sample=1, say=say)
    senses = np.array([SENSES[name] for name in names])
    losses = (found.values * -senses).tolist()
    count = found.screened + found.evaluations
    return Found("camring", marks[0] - started, count, losses, len(found.dropped))


def evolved(file, names, seed: int, seconds: list[float], points: int):
    """NSGA-II's front whenever one of these processor times is over."""
    import numpy as np
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.problem import Problem
    from pymoo.problems.static import StaticProblem

    from camring.interfaces.many import evaluate_many
    from camring.interfaces.record import SAFETY
    from camring.interfaces.trade_off import SENSES, shares_of
    from camring.search.sampling import initial_point

    space = file.design_space
    limits = file.goal.constraints.names()

    def judged(points):
        found = evaluate_many(space, file.system, file.goal, points, threads=1, chunk=POPULATION)
        sound = np.all(np.asarray(found.faults) == 0, axis=0)
        columns = [np.array([getattr(m, n) for m in found.metrics]) for n in names]
        losses = [
            -SENSES[n] * np.array([shares_of(file.system, n, each) @ each for each in column.T])
            for n, column in zip(names, columns, strict=True)
        ]
        constraints = np.stack([np.asarray(found.constraints[n]) for n in limits], axis=1) + SAFETY
        losses = np.where(sound[:, None], np.stack(losses, axis=1), 1e3)
        constraints = np.where(sound[:, None] & np.isfinite(constraints), constraints, 1e3)
        return losses, constraints

    dimension = space.dimension
    first = (tuple(map(float, space.locate(file.system))),)
    design = np.array([initial_point(i, dimension, seed, first) for i in range(POPULATION)])
    judged(design)  # compiles
    problem = Problem(n_var=dimension, n_obj=len(names), n_ieq_constr=len(limits), xl=0.0, xu=1.0)
    algorithm = NSGA2(pop_size=POPULATION, sampling=design)
    algorithm.setup(problem, termination=("n_gen", 10**9), seed=seed, verbose=False)
    left, count, paused, started = sorted(seconds), 0, 0.0, time.process_time()
    while left:
        population = algorithm.ask()
        losses, constraints = judged(population.get("X"))
        Evaluator().eval(StaticProblem(problem, F=losses, G=constraints), population)
        algorithm.tell(infills=population)
        count += len(population)
        spent = time.process_time() - started - paused
        if spent >= left[0]:
            clock = time.process_time()
            kept, dropped = looked_again(file, names, algorithm.opt, points)
            paused += time.process_time() - clock
            yield Found(f"NSGA-II, seed {seed}, {spent:.0f} s", spent, count, kept, dropped)
            left.pop(0)


def looked_again(file, names, population, count: int) -> tuple[list[list[float]], int]:
    """Losses at finer resolution of so many designs, those that keep every limit there."""
    import numpy as np

    from camring.interfaces.compiled import assess
    from camring.interfaces.config import parse_motor_file
    from camring.interfaces.evaluator import outcome_of
    from camring.interfaces.trade_off import SENSES, shares_of
    from camring.physics.resolution import Resolution
    from camring.search.pareto import box_of, evenly_spread

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
                -SENSES[n] * float(shares_of(file.system, n, column) @ column)
                for n, column in zip(names, columns, strict=True)
            ]
        )
    return kept, dropped


def volumes(fronts: list[list[list[float]]]) -> list[float]:
    """Share of one box that each front dominates: from the best of all to a tenth beyond."""
    import numpy as np

    from camring.search.pareto import box_of, hypervolume, non_dominated

    together = np.array([each for front in fronts for each in front])
    lowest, width = box_of(together[np.flatnonzero(non_dominated(together))])
    reference = np.full(together.shape[1], 1 + MARGIN)
    return [
        hypervolume((np.array(front) - lowest) / width, reference) / math.prod(reference)
        if front
        else 0.0
        for front in fronts
    ]


def draw(fronts: list[Found], names, path: Path) -> None:
    """Writes the picture of two results as SVG and PNG."""
    import matplotlib
    import numpy as np
    from matplotlib.figure import Figure

    from camring.interfaces.trade_off import SENSES

    figure = Figure(figsize=(7.5, 5))
    axes = figure.subplots()
    for front in fronts:
        values = np.array(front.losses).reshape(-1, 2) * [-SENSES[name] for name in names]
        own = front.name == "camring"
        axes.plot(
            *(100 * values[np.argsort(values[:, 0])].T),
            color="#D55E00" if own else "#0072B2",
            marker="o" if own else ".",
            markersize=5 if own else 3,
            linestyle="-" if own else "none",
            linewidth=1.5,
            zorder=2 if own else 1,
            label=front.name,
        )
    axes.set(xlabel=f"{names[0].replace('_', ' ')}, %", ylabel=f"{names[1].replace('_', ' ')}, %")
    axes.legend(fontsize=7, frameon=False)
    figure.tight_layout()
    with matplotlib.rc_context({"svg.hashsalt": "camring"}):
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
    figure.savefig(path.with_suffix(".png"), dpi=90)


if __name__ == "__main__":
    main()
