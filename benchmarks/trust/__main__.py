"""One measurement of trust, by name, count and seed.

    python -m benchmarks.trust files --count 100000
    python -m benchmarks.trust simulations --count 5000
    python -m benchmarks.trust study-kills --count 1000
    python -m benchmarks.trust kills --count 20 --of optimise map
    python -m benchmarks.trust interrupts --count 20
    python -m benchmarks.trust power-cuts --count 1000
    python -m benchmarks.trust archives
    python -m benchmarks.trust errors --count 70

Each prints what it counted and ends with exit code 1 when anything is not as docs/trust.md says.
Everything is drawn from the seed; a case that failed is named by the seed that gives it again.
`--first` goes on where an earlier run ended.
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from camring.programs.compilation_cache import keep_compiled_programs

TESTS = Path(__file__).parents[2] / "tests"
sys.path[:0] = [str(TESTS / "helpers"), str(TESTS)]


def main() -> None:
    keep_compiled_programs()  # before JAX is imported

    from benchmarks.trust import accepted, archives, errors, kills, power_cuts, study_kills

    measurements: dict[str, Callable[[argparse.Namespace], int]] = {
        "files": accepted.files,
        "simulations": accepted.simulations,
        "study-kills": study_kills.study_kills,
        "kills": kills.kills,
        "interrupts": kills.interrupts,
        "power-cuts": power_cuts.power_cuts,
        "archives": archives.archives,
        "errors": errors.errors,
    }
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trust", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("name", choices=list(measurements))
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="leave out what comes before")
    parser.add_argument("--of", nargs="+", choices=list(kills.COMMANDS), default=None)
    asked = parser.parse_args()
    sys.exit(1 if measurements[asked.name](asked) else 0)


if __name__ == "__main__":
    main()
