"""How far every result is from another solver's, and what the program itself says of it.

    python benchmarks/accuracy.py [--seeds 4] [--kinds references sound awkward hard manifold]

The motors are the references, and the random ones of the tests: sound ones of four
structures, those with one thing pushed to where solvers have trouble, with plain and detailed laws,
and the same behind a supply manifold; with `--kinds manifolds` some before a return manifold, and
between both. The other solver is SciPy's LSODA
(`reference`). A row gives the largest error of any result of docs/theory.md section
10, relative by the rules of `tests/both_solvers.py`, the result it is in, and the error
that the program estimated for the same result. `benchmarks/results/accuracy.json` has
every motor by itself. With `--ladder` three columns more: the largest error of what `simulate_to`
gives when asked for 1e-5, how many elements it took at most, and how many motors it says fell
short. With `--batch` the motors of a kind are solved side by side, with all three shares of the
elements in one call (`BatchResolution.ladder`); kinds that batches refuse are left out, and
`accuracy_batch.json` has the motors.
"""

import argparse
import dataclasses
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import jax
import numpy as np

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
sys.path.insert(0, str(ROOT / "tests"))

from both_solvers import relative_errors, run_all, scales, single
from detailed_motors import TROUBLES, detailed_case, hard_case
from motors import AWKWARD, STRUCTURES, Case, awkward_case, sound_case, with_drawn_manifold
from reference_files import DATA

from camring.evaluation.batch import measure_batch
from camring.evaluation.simulations import stacked
from camring.files.motor import read_motor_file
from camring.metrics.accuracy import Solution, climb
from camring.metrics.error_estimate import RESOLUTIONS, error_estimate, largest
from camring.numerics.quantity import real
from camring.numerics.verdict import Verdict
from camring.physics.batch_cycle import BatchResolution, fits
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.reference import OrbitError, independent_results

REFERENCES = ("mid", "wheel_motor", "winch_motor", "mill_motor", "mid_aerated")
OF_MANIFOLD = {
    "manifold": ("line_loss", "supply_pressure_swing"),
    "return_manifold": ("return_line_loss", "return_pressure_swing"),
}


class Kind(NamedTuple):
    """Motors of one structure that share a row."""

    name: str
    cases: list[Case]


def references(_: Iterable[int]) -> Iterator[Kind]:
    for name in REFERENCES:
        system = read_motor_file(DATA / f"{name}.toml").system
        motor = dataclasses.replace(system.motor, name="")  # a name would cost a compilation
        yield Kind(name, [Case(motor, system.fluid, point) for point in system.operating_points])


def sound(seeds: Iterable[int]) -> Iterator[Kind]:
    for each in STRUCTURES:
        name = f"sound, {each.kind}, {each.pistons} on {each.lobes}"
        yield Kind(name, [sound_case(seed, each) for seed in seeds])


def awkward(seeds: Iterable[int]) -> Iterator[Kind]:
    for trouble in AWKWARD:
        yield Kind(trouble, [awkward_case(seed, trouble) for seed in seeds])


def hard(seeds: Iterable[int]) -> Iterator[Kind]:
    yield Kind("sound, detailed laws", [detailed_case(seed) for seed in seeds])
    for trouble in TROUBLES:
        name = f"{trouble}, detailed laws"
        yield Kind(name, [hard_case(seed, trouble) for seed in seeds])


def manifold(seeds: Iterable[int]) -> Iterator[Kind]:
    radial = [Kind("sound", [sound_case(seed, STRUCTURES[0]) for seed in seeds])]
    for number, kind in enumerate([*radial, *awkward(seeds), *hard(seeds)]):
        random = np.random.default_rng([606, number])
        yield Kind(f"{kind.name}, manifold", [with_drawn_manifold(c, random) for c in kind.cases])


def manifolds(seeds: Iterable[int]) -> Iterator[Kind]:
    """Behind the return windows, alone and beside that of the supply."""
    further = (("radial", 0, sound_case), ("ring", 1, sound_case), ("detailed", 0, detailed_case))
    for number, (words, structure, drawn) in enumerate(further):
        random = np.random.default_rng([707, number])
        cases = [drawn(seed, STRUCTURES[structure]) for seed in seeds]
        emptied = [with_drawn_manifold(case, random, "return_manifold") for case in cases]
        yield Kind(f"{words}, return manifold", emptied)
        yield Kind(f"{words}, both manifolds", [with_drawn_manifold(c, random) for c in emptied])


SETS = {each.__name__: each for each in (references, sound, awkward, hard, manifold, manifolds)}


def row_of(case: Case, found, estimated, expected: dict) -> dict:
    """The worst result of one motor against the other solver."""
    values = {name: float(getattr(found, name)) for name in expected}
    scale = scales(expected, case)
    errors = relative_errors(values, expected, case)
    for side, names in OF_MANIFOLD.items():
        if getattr(case.motor, side) is not None:
            errors |= {name: abs(values[name] / expected[name] - 1) for name in names}
    worst = max(errors, key=lambda name: errors[name])
    claimed = float(getattr(estimated, worst)) / scale[worst]
    return {"error": errors[worst], "result": worst, "estimate": claimed}


def measured(kind: Kind, ladder: bool) -> list[dict]:
    cycles, metrics = run_all(kind.cases)
    solutions = [
        (run_all(kind.cases, Resolution().second_solution(s))[1], f) for s, f in RESOLUTIONS
    ]
    rows = []
    for place, case in enumerate(kind.cases):
        refused = int(cycles.verdict.code[place])
        if refused:
            rows.append({"refused": f"verdict {refused}"})
            continue
        try:
            expected = independent_results(*case, tolerance=1e-9)
        except OrbitError as error:
            rows.append({"refused": f"the other solver: {error}"})
            continue
        found = single(metrics, place)
        estimated = largest(*(error_estimate(found, single(m, place), f) for m, f in solutions))
        rows.append(row_of(case, found, estimated, expected))
        if ladder:
            rows[-1]["ladder"] = climbed(kind, place, expected)
    return rows


def climbed(kind: Kind, place: int, expected: dict) -> dict:
    """The same after `simulate_to`; motors of a kind share their programs, as a batch."""
    case = kind.cases[place]

    def solution_at(resolution: Resolution) -> Solution:
        return Solution(*(single(each, place) for each in seen_at(kind, resolution)))

    found = climb(solution_at)
    row = row_of(case, found.metrics, found.error, expected)
    return row | {"elements": found.resolution.elements, "reached": found.reached}


_seen: dict = {}


def seen_at(kind: Kind, resolution: Resolution):
    if (kind.name, resolution) not in _seen:
        _seen[kind.name, resolution] = run_all(kind.cases, resolution)
    return _seen[kind.name, resolution]


def measured_in_batch(kind: Kind, ladder: bool) -> list[dict]:
    """The same of motors side by side."""
    rows = []
    for place, case in enumerate(kind.cases):
        try:
            expected = independent_results(*case, tolerance=1e-9)
        except OrbitError as error:
            rows.append({"refused": f"the other solver: {error}"})
            continue

        def solution_at(resolution: Resolution, place: int = place) -> Solution:
            found, faults = in_batch(kind, resolution.elements)
            which = SHARES.index(resolution.filled) * len(kind.cases) + place
            metrics = jax.tree.map(lambda leaf: leaf[which], found)
            return Solution(Solved(Verdict(faults[which])), metrics)

        first, *_ = Resolution.ladder()
        found = climb(solution_at, ladder=(first,))
        refused = int(found.cycle.verdict.code)
        if refused:
            rows.append({"refused": f"verdict {refused}"})
            continue
        rows.append(row_of(case, found.metrics, found.error, expected))
        if ladder:
            found = climb(solution_at)
            row = row_of(case, found.metrics, found.error, expected)
            more = {"elements": found.resolution.elements, "reached": found.reached}
            rows[-1]["ladder"] = row | more
    return rows


class Solved(NamedTuple):
    """What `climb` reads of a cycle."""

    verdict: Verdict


SHARES = [1.0, *(share for share, _ in RESOLUTIONS)]
"""Of its elements with which each motor is solved."""


def in_batch(kind: Kind, elements: int):
    """Metrics and faults of all motors of a kind at every share of the elements."""
    if (kind.name, elements) not in _seen:
        places = [System(each.motor, each.fluid, (each.point,)) for each in kind.cases]
        filled = real(np.repeat(SHARES, len(places)))
        resolution = next(e for e in BatchResolution.ladder() if e.elements == elements)
        many = stacked(places * len(SHARES))
        (metrics,), faults = jax.device_get(measure_batch(many, 600, resolution, filled))
        _seen[kind.name, elements] = metrics, faults[0]
    return _seen[kind.name, elements]


def written(name: str, rows: list[dict]) -> str:
    looked = [row for row in rows if "error" in row]
    if not looked:
        return f"| {name} | {len(rows)} | {rows[0]['refused']} | | |"
    worst = max(looked, key=lambda row: row["error"])
    within = sum(row["error"] < 1e-5 for row in looked)
    what = worst["result"].replace("_", " ")
    number = f"{within} of {len(rows)}"
    line = f"| {name} | {number} | {worst['error']:.1e} | {what} | {worst['estimate']:.1e} |"
    ladders = [row["ladder"] for row in looked if "ladder" in row]
    if not ladders:
        return line
    most = max(row["elements"] for row in ladders)
    short = sum(not row["reached"] for row in ladders)
    return f"{line} {max(row['error'] for row in ladders):.1e} | {most} | {short} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--kinds", nargs="+", choices=SETS, default=list(SETS))
    parser.add_argument("--ladder", action="store_true")
    parser.add_argument("--batch", action="store_true")
    asked = parser.parse_args()
    run = measured_in_batch if asked.batch else measured
    more = " on the ladder | elements | short |" if asked.ladder else ""
    print(f"| motors | within 1e-5 | largest error | in | estimated |{more}")
    print("|" + "---|" * (5 + more.count("|")))
    found = {}
    for kind in (kind for name in asked.kinds for kind in SETS[name](range(asked.seeds))):
        if asked.batch and not fits(kind.cases[0].motor):
            continue
        found[kind.name] = run(kind, asked.ladder)
        print(written(kind.name, found[kind.name]), flush=True)
    RESULTS.mkdir(exist_ok=True)
    name = "accuracy_batch.json" if asked.batch else "accuracy.json"
    path = RESULTS / name  # kinds that were not asked for stay as they are
    kept = json.loads(path.read_text()) if path.exists() else {}
    path.write_text(json.dumps({**kept, **found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
