"""What `camring optimise` makes of the three example motors over their whole envelope.

    python benchmarks/envelope_motors.py [--seeds 15] [--motors wheel winch mill] [--add]

Every study is the command itself in a process of its own, as a user runs it. What counts
is read from its validation: both motors at every point of the fine grid, the second solver
at the corners and at the tightest point. It prints one row a motor, the worst of all seeds;
all studies are saved as JSON in `benchmarks/results` (`--first N` begins with another seed,
`--add` keeps the studies that are there).
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")


def study(motor: str, seed: int) -> dict:
    """One study: what its validation says of the envelope, and its time."""
    example = ROOT / "examples" / f"{motor}_motor.toml"
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "study"
        command = [
            *(sys.executable, "-c", "from camring.cli.app import main; main()"),
            *("optimise", str(example), "--out", str(folder), "--seed", str(seed), "--json"),
        ]
        started = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True)
        seconds = time.perf_counter() - started
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)
    document = json.loads(done.stdout)
    found = document["envelope"]["designs"]
    ripple, efficiency = (
        {name: np.array(found[name][key]) for name in ("given", "best")}
        for key in ("torque_ripple", "efficiency")
    )
    pairs = zip(document["given"]["results"], document["best"]["results"], strict=True)
    return {
        "motor": motor,
        "seed": seed,
        "seconds": seconds,
        "evaluations": document["evaluations"],
        "validated": document["validated"],
        "sentence": document["sentence"],
        "objective": document["best"]["objective"],
        "points": len(ripple["best"]),
        "broken given": int(np.sum(found["given"]["broken"])),
        "broken best": int(np.sum(found["best"]["broken"])),
        "operating ripple": [
            (given["torque_ripple"], best["torque_ripple"]) for given, best in pairs
        ],
        "mean ripple": [float(ripple[name].mean()) for name in ("given", "best")],
        "worst ripple ratio": float(np.max(ripple["best"] / ripple["given"])),
        "least efficiency gain": float(np.min(efficiency["best"] - efficiency["given"])),
        "mean efficiency gain": float(np.mean(efficiency["best"] - efficiency["given"])),
    }


def table(rows: list[dict]) -> None:
    """Prints one row a motor, the worst of all its studies."""
    print(
        "| motor | studies | validated | points broken | ripple at operating points "
        "| mean over the envelope | noisiest point | least efficient point | time |\n"
        "|---|---|---|---|---|---|---|---|---|"
    )
    for motor in dict.fromkeys(row["motor"] for row in rows):
        group = [row for row in rows if row["motor"] == motor]
        ratios = [before / after for row in group for before, after in row["operating ripple"]]
        means = [row["mean ripple"][0] / row["mean ripple"][1] for row in group]
        seconds = [row["seconds"] for row in group]
        print(
            f"| {motor} | {len(group)} | {sum(row['validated'] for row in group)} "
            f"| {max(row['broken best'] for row in group)} of {group[0]['points']} "
            f"| 1/{min(ratios):.1f} to 1/{max(ratios):.1f} | 1/{min(means):.1f} "
            f"| {max(row['worst ripple ratio'] for row in group):.2f} of given "
            f"| {100 * min(row['least efficiency gain'] for row in group):+.2f} points "
            f"| {np.median(seconds):.0f} s, longest {max(seconds):.0f} |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=15)
    parser.add_argument("--motors", nargs="+", default=["wheel", "winch", "mill"])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--add", action="store_true")
    asked = parser.parse_args()
    place = RESULTS / "envelope_motors.json"
    rows = json.loads(place.read_text()) if asked.add and place.exists() else []
    for seed in range(asked.first, asked.first + asked.seeds):
        for motor in asked.motors:
            rows.append(study(motor, seed))
            print(json.dumps(rows[-1]), file=sys.stderr, flush=True)
    table(rows)
    RESULTS.mkdir(exist_ok=True)
    place.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
