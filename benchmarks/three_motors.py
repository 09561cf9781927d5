"""What `camring optimise` makes of the three example motors, from several seeds.

    python benchmarks/three_motors.py [--seeds 3] [--seeds-without-theory 2] [--motors mill]
        [--seeds-of-bayesian 1]

Every study is the command itself in a process of its own, as a user runs it, with
the example's budget of 300 evaluations. It prints the tables of the README, one row
a study, then how far each study's best objective is above the best that any study of
that motor found, and after how many evaluations it was within a hundredth and a
thousandth of that. All rows are saved as JSON in `benchmarks/results`.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

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
            *(sys.executable, "-c", "from camring.interfaces.cli import main; main()"),
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
    """A row of the table, for the operating point where least was won."""
    pairs = list(zip(row["given"], row["best"], strict=False))
    start = f"| {row['motor']} | {row['method']} | {row['seed']} "
    start += f"| {'yes' if row['theory'] else 'no'} "
    if not pairs:
        return start + f"| | | | | {row['seconds']:.0f} s | {row['sentence']} |"
    given, best = max(pairs, key=lambda pair: pair[1]["torque_ripple"] / pair[0]["torque_ripple"])
    gain = min(100 * (b["efficiency"] - g["efficiency"]) for g, b in pairs)
    return start + (
        f"| {100 * given['torque_ripple']:.2f} % | {100 * best['torque_ripple']:.2f} % "
        f"| 1/{given['torque_ripple'] / best['torque_ripple']:.1f} | {gain:+.2f} "
        f"| {row['seconds']:.0f} s | {'yes' if row['validated'] else row['sentence']} |"
    )


def convergence(rows: list[dict]) -> None:
    """Prints how good the objectives are beside the best of all studies of the same motor."""
    print(
        "\n| motor | method | seed | theory | above the best J | evaluations to 1 % | to 0.1 % |"
        "\n|---|---|---|---|---|---|---|"
    )
    for row in rows:
        alike = [each["objectives"] for each in rows if each["motor"] == row["motor"]]
        best = min(value for values in alike for value in values if value is not None)
        excess = [math.inf if value is None else value / best - 1 for value in row["objectives"]]
        reached = [
            str(next((k + 1 for k, value in enumerate(excess) if value <= limit), "never"))
            for limit in (0.01, 0.001)
        ]
        print(
            f"| {row['motor']} | {row['method']} | {row['seed']} "
            f"| {'yes' if row['theory'] else 'no'} | {100 * min(excess):.3f} % "
            f"| {reached[0]} | {reached[1]} |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--seeds-without-theory", type=int, default=2)
    parser.add_argument("--motors", nargs="+", default=["wheel", "winch", "mill"])
    parser.add_argument("--seeds-of-bayesian", type=int, default=1)
    asked = parser.parse_args()

    print(
        "| motor | method | seed | theory | ripple given | best | ratio | efficiency, points "
        "| time | validated |\n|---|---|---|---|---|---|---|---|---|---|"
    )
    rows = []
    for motor in asked.motors:
        few = asked.seeds_of_bayesian
        for method, theory, seeds in (
            ("gradient", True, asked.seeds),
            ("gradient", False, asked.seeds_without_theory),
            ("bayesian", True, few),
            ("bayesian", False, few),
        ):
            for seed in range(seeds):
                rows.append(study(motor, seed, theory, method))
                print(written(rows[-1]), flush=True)
    convergence(rows)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "three_motors.json").write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
