"""Wall times of something done again and again, after one time that compiles."""

import time
from collections.abc import Callable

import jax


def wall_times(action: Callable[[], object], repeats: int) -> list[float]:
    """Seconds, shortest first; what JAX does behind our back is waited for."""
    jax.block_until_ready(action())
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        jax.block_until_ready(action())
        times.append(time.perf_counter() - started)
    return sorted(times)
