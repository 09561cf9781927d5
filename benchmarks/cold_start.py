"""How long a command takes before anything is compiled, and after.

    python benchmarks/cold_start.py [--json cold_start.json]

Each run is a process of its own with a cache folder of its own; the second kind finds there
what the first left. Without a cache every run is a first one.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MOTOR = Path(__file__).parents[1] / "examples" / "wheel_motor.toml"
ANOTHER = MOTOR.with_name("mill_motor.toml")
CAMRING = "from camring.cli.app import main; main()"


def seconds(*words: str, cache: str) -> float:
    """Wall time of one command; its standard output is thrown away."""
    started = time.perf_counter()
    subprocess.run(
        [sys.executable, "-c", CAMRING, *words],
        env={**os.environ, "CAMRING_CACHE": cache},
        stdout=subprocess.DEVNULL,
        check=True,
    )
    return time.perf_counter() - started


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--json", type=Path, help="where the figures go, too")
    asked = parser.parse_args()
    spent = {"camring --help": min(seconds("--help", cache="off") for _ in range(3))}
    simulate = ("simulate", str(MOTOR))
    with tempfile.TemporaryDirectory() as cache:
        spent["camring simulate, the first time"] = seconds(*simulate, cache=cache)
        again = [seconds(*simulate, cache=cache) for _ in range(5)]
        spent["camring simulate, once more"] = min(again)
        spent["a motor of other counts, the first time"] = seconds(
            "simulate", str(ANOTHER), cache=cache
        )
    spent["camring simulate without a cache"] = seconds(*simulate, cache="off")
    for name, each in spent.items():
        print(f"| {name} | {each:.2f} s |")
    if asked.json:
        asked.json.write_text(json.dumps(spent, indent=1) + "\n")


if __name__ == "__main__":
    main()
