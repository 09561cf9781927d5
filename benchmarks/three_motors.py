"""What `camring optimise` makes of the three example motors, from several seeds.

    python benchmarks/three_motors.py [--seeds 3] [--seeds-without-theory 2] [--motors mill]

Every study is the command itself in a process of its own, as a user runs it, with
the example's budget of 300 evaluations. It prints the table of the README, one row
a study, and saves all rows as JSON in `benchmarks/results`.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
BUDGET = 300


def study(motor: str, seed: int, theory: bool) -> dict:
    """One study: the ends of its table, and its wall time."""
    with tempfile.TemporaryDirectory() as scratch:
        command = [
            *(sys.executable, "-c", "from camring.interfaces.cli import main; main()"),
            *("optimise", str(ROOT / "examples" / f"{motor}_motor.toml")),
            *("--out", str(Path(scratch) / "study")),
            *("--budget", str(BUDGET), "--seed", str(seed), "--json"),
            *([] if theory else ["--no-theory"]),
        ]
        started = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True)
        seconds = time.perf_counter() - started
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    document = json.loads(done.stdout)
    row = {"motor": motor, "seed": seed, "theory": theory, "seconds": seconds}
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
    start = f"| {row['motor']} | {row['seed']} | {'yes' if row['theory'] else 'no'} "
    if not pairs:
        return start + f"| | | | | {row['seconds']:.0f} s | {row['sentence']} |"
    given, best = max(pairs, key=lambda pair: pair[1]["torque_ripple"] / pair[0]["torque_ripple"])
    gain = min(100 * (b["efficiency"] - g["efficiency"]) for g, b in pairs)
    return start + (
        f"| {100 * given['torque_ripple']:.2f} % | {100 * best['torque_ripple']:.2f} % "
        f"| 1/{given['torque_ripple'] / best['torque_ripple']:.1f} | {gain:+.2f} "
        f"| {row['seconds']:.0f} s | {'yes' if row['validated'] else row['sentence']} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--seeds-without-theory", type=int, default=2)
    parser.add_argument("--motors", nargs="+", default=["wheel", "winch", "mill"])
    asked = parser.parse_args()

    print(
        "| motor | seed | theory | ripple given | best | ratio | efficiency, points | time "
        "| validated |\n|---|---|---|---|---|---|---|---|---|"
    )
    rows = []
    for motor in asked.motors:
        for theory, seeds in ((True, asked.seeds), (False, asked.seeds_without_theory)):
            for seed in range(seeds):
                rows.append(study(motor, seed, theory))
                print(written(rows[-1]), flush=True)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "three_motors.json").write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
