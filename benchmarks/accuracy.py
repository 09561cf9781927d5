"""How far every result is from another solver's, and what the program itself says of it.

    python benchmarks/accuracy.py [--seeds 4] [--kinds references sound awkward hard manifold]

The motors are the references, and the random ones of the tests: sound ones of four
structures, those with one thing pushed to where solvers have trouble, on both rungs,
and the same behind a supply manifold. The other solver is SciPy's LSODA
(`metrics/independent`). A row gives the largest error of any result of model.md section
10, relative by the rules of `tests/both_roads.py`, the result it is in, and the error
that the program estimated for the same result. `benchmarks/results/accuracy.json` has
every motor by itself. With `--ladder` three columns more: the largest error of what
`simulate_to` gives when asked for 1e-5, how many elements it took at most, and how many
motors it says fell short.
"""

import argparse
import dataclasses
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
sys.path.insert(0, str(ROOT / "tests"))

from both_roads import relative_errors, run_all, scales, single
from motors import AWKWARD, STRUCTURES, Case, awkward_case, sound_case, with_manifold
from reference_files import DATA
from second_rung import TROUBLES, hard_case, second_rung_case

from camring.interfaces.config import read_motor_file
from camring.metrics.accuracy import Look, climb
from camring.metrics.error_estimate import error_estimate
from camring.metrics.independent import OrbitError, independent_results
from camring.physics.resolution import Resolution

REFERENCES = ("mid", "wheel_motor", "winch_motor", "mill_motor", "mid_aerated")
OF_MANIFOLD = ("line_loss", "supply_pressure_swing")


class Kind(NamedTuple):
    """Motors of one structure that share a row."""

    name: str
    cases: list[Case]


def references(_: int) -> Iterator[Kind]:
    for name in REFERENCES:
        system = read_motor_file(DATA / f"{name}.toml").system
        motor = dataclasses.replace(system.motor, name="")  # a name would cost a compilation
        yield Kind(name, [Case(motor, system.fluid, point) for point in system.operating_points])


def sound(seeds: int) -> Iterator[Kind]:
    for each in STRUCTURES:
        name = f"sound, {each.kind}, {each.pistons} on {each.lobes}"
        yield Kind(name, [sound_case(seed, each) for seed in range(seeds)])


def awkward(seeds: int) -> Iterator[Kind]:
    for trouble in AWKWARD:
        yield Kind(trouble, [awkward_case(seed, trouble) for seed in range(seeds)])


def hard(seeds: int) -> Iterator[Kind]:
    yield Kind("sound, second rung", [second_rung_case(seed) for seed in range(seeds)])
    for trouble in TROUBLES:
        name = f"{trouble}, second rung"
        yield Kind(name, [hard_case(seed, trouble) for seed in range(seeds)])


def manifold(seeds: int) -> Iterator[Kind]:
    radial = [Kind("sound", [sound_case(seed, STRUCTURES[0]) for seed in range(seeds)])]
    for number, kind in enumerate([*radial, *awkward(seeds), *hard(seeds)]):
        random = np.random.default_rng([606, number])
        # Lost in the line: 2 to 20 % of the difference; gallery: 0.04 to 30 times the strokes.
        fed = [
            with_manifold(case, 0.02 * 10 ** random.uniform(), 10 ** random.uniform(-1.4, 1.5))
            for case in kind.cases
        ]
        yield Kind(f"{kind.name}, manifold", fed)


SETS = {each.__name__: each for each in (references, sound, awkward, hard, manifold)}


def row_of(case: Case, found, estimated, expected: dict) -> dict:
    """The worst result of one motor against the other solver."""
    values = {name: float(getattr(found, name)) for name in expected}
    scale = scales(expected, case)
    errors = relative_errors(values, expected, case)
    if case.motor.manifold is not None:
        errors |= {name: abs(values[name] / expected[name] - 1) for name in OF_MANIFOLD}
    worst = max(errors, key=lambda name: errors[name])
    claimed = float(getattr(estimated, worst)) / scale[worst]
    return {"error": errors[worst], "result": worst, "estimate": claimed}


def measured(kind: Kind, ladder: bool) -> list[dict]:
    cycles, metrics = run_all(kind.cases)
    _, coarser = run_all(kind.cases, Resolution().second_look())
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
        estimated = error_estimate(found, single(coarser, place))
        rows.append(row_of(case, found, estimated, expected))
        if ladder:
            rows[-1]["ladder"] = climbed(kind, place, expected)
    return rows


def climbed(kind: Kind, place: int, expected: dict) -> dict:
    """The same after `simulate_to`; motors of a kind share their programs, as a batch."""
    case = kind.cases[place]

    def look(resolution: Resolution) -> Look:
        return Look(*(single(each, place) for each in seen_at(kind, resolution)))

    found = climb(look)
    row = row_of(case, found.metrics, found.error, expected)
    return row | {"elements": found.resolution.elements, "reached": found.reached}


_seen: dict = {}


def seen_at(kind: Kind, resolution: Resolution):
    if (kind.name, resolution) not in _seen:
        _seen[kind.name, resolution] = run_all(kind.cases, resolution)
    return _seen[kind.name, resolution]


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
    asked = parser.parse_args()
    more = " on the ladder | elements | short |" if asked.ladder else ""
    print(f"| motors | within 1e-5 | largest error | in | estimated |{more}")
    print("|" + "---|" * (5 + more.count("|")))
    found = {}
    for kind in (kind for name in asked.kinds for kind in SETS[name](asked.seeds)):
        found[kind.name] = measured(kind, asked.ladder)
        print(written(kind.name, found[kind.name]), flush=True)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "accuracy.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
