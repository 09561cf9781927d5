"""What slopes cost beside an evaluation, processor time, on the three motors.

python -m benchmarks.search.slope_cost
"""

import statistics
import time

import numpy as np

from camring.programs.compilation_cache import keep_compiled_programs

POINTS = 40


def main() -> None:
    keep_compiled_programs()  # before JAX is imported

    from benchmarks.search.motors import MOTORS

    print("| motor | evaluation, ms | its slopes, ms | ratio |\n|---|---|---|---|")
    for name, maker in MOTORS.items():
        problem = maker()
        middle = np.array(problem.given[0])
        random = np.random.default_rng(0)
        times: list[tuple[float, float]] = []
        for _ in range(POINTS + 1):
            point = middle + 0.1 * (random.random(len(middle)) - 0.5)
            started = time.process_time()
            problem.evaluate(point)
            between = time.process_time()
            problem.slopes(point)
            times.append((between - started, time.process_time() - between))
        plain, slopes = (1e3 * statistics.median(each) for each in zip(*times[1:], strict=True))
        print(f"| {name} | {plain:.2f} | {slopes:.2f} | {slopes / plain:.2f} |", flush=True)


if __name__ == "__main__":
    main()
