"""Times of something done again and again, after one time that compiles."""

import time
from collections.abc import Callable

import jax


def wall_times(action: Callable[[], object], repeats: int) -> list[float]:
    """Seconds, shortest first; what JAX does behind our back is waited for."""
    return _times(action, repeats, time.perf_counter)


def processor_times(action: Callable[[], object], repeats: int) -> list[float]:
    """The same of all threads together, whoever else is at work on the machine."""
    return _times(action, repeats, time.process_time)


def _times(action: Callable[[], object], repeats: int, clock: Callable[[], float]) -> list[float]:
    jax.block_until_ready(action())
    times = []
    for _ in range(repeats):
        started = clock()
        jax.block_until_ready(action())
        times.append(clock() - started)
    return sorted(times)
