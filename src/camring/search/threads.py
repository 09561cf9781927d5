"""One thread for small matrices.

A linear-algebra library starts as many threads as there are cores and lets them
spin. For matrices of a few hundred rows they win nothing, and where another
program wants the cores they wait for one another: with two searches at a time on
two cores, each ran seven times slower than alone. Held to one thread, neither does.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController


@cache
def _libraries() -> ThreadpoolController:
    import scipy.linalg  # noqa: F401  brings the library that JAX calls, too

    return ThreadpoolController()


@contextmanager
def one_linear_algebra_thread() -> Iterator[None]:
    """Within it, BLAS works in the calling thread alone."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield
