"""What `camring optimise` makes of the three example motors, from several seeds.

    python benchmarks/three_motors.py [--seeds 3] [--seeds-without-theory 2] [--motors mill]
        [--seeds-of-scbo 1]

Every study is the command itself in a process of its own, as a user runs it, with
the example's budget of 300 evaluations. It prints the tables of docs/notes/search.md: what was
won, how far the worst study's best objective is above the best that any study of that
motor found, and after how many evaluations they were within a hundredth and a thousandth
of that. All studies are saved as compressed JSON in
`benchmarks/results/three_motors.json.gz` (`gzip -dc` shows it).
"""

import argparse
import gzip
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import camring

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
BUDGET = 300


def study(motor: str, seed: int, theory: bool, method: str) -> dict:
    """One study: the ends of its table, its wall time, and its best objective as it fell."""
    text = (ROOT / "examples" / f"{motor}_motor.toml").read_text()
    with tempfile.TemporaryDirectory() as scratch:
        folder, motor_file = Path(scratch) / "study", Path(scratch) / f"{motor}_motor.toml"
        motor_file.write_text(text.replace("[search]", f'[search]\nmethod = "{method}"'))
        command = [
            *(sys.executable, "-c", "from camring.cli.app import main; main()"),
            *("optimise", str(motor_file), "--out", str(folder)),
            *("--budget", str(BUDGET), "--seed", str(seed), "--json"),
            *([] if theory else ["--no-theory"]),
        ]
        started = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True)
        seconds = time.perf_counter() - started
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)
        records = camring.open_study(folder).records
    document = json.loads(done.stdout)
    row = {"motor": motor, "seed": seed, "theory": theory, "method": method, "seconds": seconds}
    row["objectives"] = [r.outcome.objective if r.feasible else None for r in records]
    row["evaluations"] = document["evaluations"]
    row["validated"] = document["validated"]
    row["sentence"] = document["sentence"]
    for which in ("given", "best"):
        results = (document[which] or {}).get("results", [])
        row[which] = [
            {name: each[name] for name in ("torque_ripple", "efficiency")} for each in results
        ]
    return row


def written(row: dict) -> str:
    """One study, for whoever waits."""
    return (
        f"{row['motor']}, {row['method']}, seed {row['seed']}, "
        f"{'with' if row['theory'] else 'without'} theory: {row['seconds']:.0f} s, "
        f"{row['evaluations']} evaluations; {row['sentence']}"
    )


def tables(rows: list[dict]) -> None:
    """Prints what was won, and how surely and quickly: one row for all seeds of a kind."""
    kinds = list(dict.fromkeys((r["motor"], r["method"], r["theory"]) for r in rows))
    groups = [[r for r in rows if (r["motor"], r["method"], r["theory"]) == kind] for kind in kinds]
    print(
        "| motor | method | theory | studies | ripple given | best | ratio | efficiency, points "
        "| time | validated |\n|---|---|---|---|---|---|---|---|---|---|"
    )
    for group in groups:
        given, best = zip(*[worst_point(row) for row in group], strict=True)
        before, after = given[0]["torque_ripple"], [each["torque_ripple"] for each in best]
        times = [row["seconds"] for row in group]
        gains = [gain(row) for row in group]
        print(
            f"{head(group)} | {100 * before:.2f} % | {_range(after, 100, '.2f')} % "
            f"| 1/{before / max(after):.1f} | {_range(gains, 1, '+.2f')} "
            f"| {np.median(times):.0f} s, longest {max(times):.0f} "
            f"| {sum(row['validated'] for row in group)} |"
        )
    print(
        "\n| motor | method | theory | studies | above the best J, worst "
        "| evaluations to 1 %, median and most | to 0.1 % |\n|---|---|---|---|---|---|---|"
    )
    for group in groups:
        alike = [row["objectives"] for row in rows if row["motor"] == group[0]["motor"]]
        best = min(value for values in alike for value in values if value is not None)
        excess = [
            [math.inf if value is None else value / best - 1 for value in row["objectives"]]
            for row in group
        ]
        print(
            f"{head(group)} | {100 * max(map(min, excess)):.3f} % "
            f"| {_reached(excess, 0.01)} | {_reached(excess, 0.001)} |"
        )


def head(group: list[dict]) -> str:
    first = group[0]
    theory = "yes" if first["theory"] else "no"
    return f"| {first['motor']} | {first['method']} | {theory} | {len(group)}"


def worst_point(row: dict) -> tuple[dict, dict]:
    """Results given and found at the operating point where least was won."""
    pairs = list(zip(row["given"], row["best"], strict=True))
    return max(pairs, key=lambda pair: pair[1]["torque_ripple"] / pair[0]["torque_ripple"])


def gain(row: dict) -> float:
    """The smallest gain of efficiency of any operating point, in points."""
    pairs = zip(row["given"], row["best"], strict=True)
    return min(100 * (best["efficiency"] - given["efficiency"]) for given, best in pairs)


def _range(values: list[float], factor: float, form: str) -> str:
    low, high = (format(factor * each, form) for each in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _reached(excess: list[list[float]], limit: float) -> str:
    counts = [
        next((k + 1 for k, value in enumerate(each) if value <= limit), math.inf) for each in excess
    ]
    never = sum(map(math.isinf, counts))
    if never == len(counts):
        return "never"
    most = f"never in {never}" if never else f"{max(counts)}"
    return f"{np.median(counts):.0f}, {most}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--seeds-without-theory", type=int, default=2)
    parser.add_argument("--motors", nargs="+", default=["wheel", "winch", "mill"])
    parser.add_argument("--seeds-of-scbo", type=int, default=1)
    asked = parser.parse_args()

    rows = []
    for motor in asked.motors:
        few = asked.seeds_of_scbo
        for method, theory, seeds in (
            ("gradient", True, asked.seeds),
            ("gradient", False, asked.seeds_without_theory),
            ("scbo", True, few),
            ("scbo", False, few),
        ):
            for seed in range(seeds):
                rows.append(study(motor, seed, theory, method))
                print(written(rows[-1]), file=sys.stderr, flush=True)
    tables(rows)
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps(rows, indent=1) + "\n"
    # Without the hour, so that the same studies are the same file.
    (RESULTS / "three_motors.json.gz").write_bytes(gzip.compress(text.encode(), mtime=0))


if __name__ == "__main__":
    main()
