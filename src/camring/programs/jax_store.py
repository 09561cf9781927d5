"""JAX's own store of compiled programs, out of use while somebody compiles."""

import contextlib
import threading
from collections.abc import Iterator

import jax
from jax.experimental.compilation_cache import compilation_cache

SWITCH = "jax_enable_compilation_cache"

_gate = threading.Lock()
_users: list[object] = []


@contextlib.contextmanager
def jax_store_unused() -> Iterator[None]:
    """What is compiled meanwhile, by any thread, is compiled and neither found nor put there.

    The machine code of a program that came out of that store is not whole, and cannot be
    stored anywhere else.
    """
    me = object()
    with _gate:
        was_in_use = bool(_users) or getattr(jax.config, SWITCH)
        if was_in_use:
            _users.append(me)
            _switch(on=False)
    try:
        yield
    finally:
        with _gate:
            if was_in_use:
                _users.remove(me)
                _switch(on=not _users)


def _switch(*, on: bool) -> None:
    if getattr(jax.config, SWITCH) != on:
        jax.config.update(SWITCH, on)
        compilation_cache.reset_cache()  # it looks at the switch once only
