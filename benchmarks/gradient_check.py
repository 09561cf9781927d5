"""Exact slopes beside central differences, at hundreds of random designs of the example motors.

    python benchmarks/gradient_check.py [--designs 100] [--json gradient_check.json]

Each design is drawn from the whole design space; its slopes along one random direction are
compared with differences over two steps, freed of their third-order term. Where the two
differences disagree by more than a ten-thousandth of the slope a kink lies between the
designs that they look at, and they mean nothing: such places are counted, not compared.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from camring.programs.compilation_cache import keep_compiled_programs

EXAMPLES = Path(__file__).parents[1] / "examples"
STEPS = (2e-3, 1e-3)
"""Of the unit box, along the direction."""

DOUBT = 1e-4
LEAST_SCALE = 0.1
"""Constraints are counted in their limits; a slope of nil is compared with this."""


def compared(name: str, designs: int, seed: int = 0) -> dict[str, dict[str, float]]:
    """Errors of the slopes of objective and constraints of a motor, as shares of the slope."""
    import camring
    from camring.evaluation.evaluator import applied
    from camring.programs.compiled import assess, slopes, solve

    file = camring.read_motor_file(EXAMPLES / f"{name}_motor.toml")
    space, system, goal = file.design_space, file.system, file.goal
    limits = goal.constraints.names()

    def values(point: np.ndarray) -> np.ndarray:
        found = assess(applied(space, system, point), goal)
        numbers = [found.physical_objective, *(found.constraints[each] for each in limits)]
        return np.where(np.any(found.faults), np.nan, np.array(numbers, float))

    random = np.random.default_rng(seed)
    errors, doubts = [], []
    for point in random.uniform(STEPS[0], 1 - STEPS[0], (designs, space.dimension)):
        way = random.normal(size=space.dimension)
        way /= np.linalg.norm(way)
        design = solve(applied(space, system, point), goal)
        found = slopes(space, system, point, design, goal)
        exact = np.array([found.objective, *(found.constraints[each] for each in limits)])
        with np.errstate(invalid="ignore"):  # an undercut ring's stress is infinite
            wide, narrow = (
                (values(point + step * way) - values(point - step * way)) / (2 * step)
                for step in STEPS
            )
        scale = np.linalg.norm(exact, axis=1) + LEAST_SCALE
        errors.append(np.abs(exact @ way - (4 * narrow - wide) / 3) / scale)
        doubts.append(np.abs(narrow - wide) / scale)
    rows = {}
    for place, each in enumerate(("objective", *limits)):
        error, doubt = np.array(errors)[:, place], np.array(doubts)[:, place]
        smooth = error[doubt < DOUBT]
        rows[each] = {
            "designs": len(error),
            "not a number": int(np.sum(np.isnan(error))),
            "kinks": int(np.sum(doubt >= DOUBT)),
            "median": float(np.median(smooth)),
            "95 %": float(np.quantile(smooth, 0.95)),
            "worst": float(smooth.max()),
        }
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--designs", type=int, default=100, help="of each motor")
    parser.add_argument("--json", type=Path, help="where the table goes, too")
    asked = parser.parse_args()
    keep_compiled_programs()  # before JAX is imported

    table = {name: compared(name, asked.designs) for name in ("wheel", "winch", "mill")}
    columns = ("designs", "not a number", "kinks", "median", "95 %", "worst")
    print("| motor | slope of |", " | ".join(columns), "|")
    print("|---|---|" + "---|" * len(columns))
    for motor, rows in table.items():
        for each, row in rows.items():
            numbers = (f"{row[name]:.1e}" if name in columns[3:] else row[name] for name in columns)
            print(f"| {motor} | {each.replace('_', ' ')} |", " | ".join(map(str, numbers)), "|")
    if asked.json:
        asked.json.write_text(json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    main()
