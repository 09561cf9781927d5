"""Programs that the next run neither traces nor compiles again.

JAX keeps compiled programs under the text of the program, and to have that text it
traces and lowers every function anew in each process: most of what a short command takes.
Here a program is found by what it is made from: the source of this package, the versions
of what compiles it, and a description of its arguments. Where the description would have
to reach beyond the package (a law of a user's own), JAX does as it always does.

What is kept is machine code, in the folder of `compilation_cache`, which nobody else can write.
"""

import contextlib
import hashlib
import os
import pickle
import sys
import threading
import time
import zlib
from collections.abc import Callable, Hashable
from functools import lru_cache
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar
from weakref import WeakSet

import equinox as eqx
import jax
import numpy as np
from jax.experimental.serialize_executable import deserialize_and_load, serialize

from camring.interfaces.compilation_cache import programs_folder
from camring.interfaces.description import Indescribable, described
from camring.interfaces.jax_store import jax_store_unused

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

SUFFIX = ".program"
DEBUGGING = ("jax_disable_jit", "jax_debug_nans", "jax_debug_infs")
UNUSED_SECONDS = 90 * 86_400.0
"""After these a file is thrown away; whoever needs it again compiles once more."""


class _Place:
    """Stands in a result for one of the program's arrays."""


class Program:
    """Machine code between lists of arrays, and the tree that its answers belong into."""

    def __init__(self, call: Callable[[list[Any]], list[Any]], result: Any) -> None:
        self._call = call
        self._leaves, self._structure = jax.tree.flatten(result)

    def __call__(self, arrays: list[Any]) -> Any:
        answers = iter(self._call(arrays))
        filled = [next(answers) if isinstance(leaf, _Place) else leaf for leaf in self._leaves]
        return jax.tree.unflatten(self._structure, filled)


_alive: "WeakSet[KeptProgram]" = WeakSet()


def forget_programs() -> None:
    """Those of all functions, as `jax.clear_caches` does with its own."""
    for each in list(_alive):
        each.forget()


class KeptProgram(Generic[Arguments, Result]):
    """A function compiled once for a user, where `equinox.filter_jit` compiles it for a process.

    Called in the same way: arrays are traced, everything else is part of the program. It
    is just that inside another traced function, where nothing can be kept, and under JAX's
    settings for looking for mistakes.

    Parameters
    ----------
    function
        Pure, and reached by its name in a module of this package.
    compiler_options
        As `jax.jit` takes them.
    """

    def __init__(
        self,
        function: Callable[Arguments, Result],
        compiler_options: dict[str, Any] | None = None,
    ) -> None:
        self._function, self._options = function, compiler_options
        options: dict[str, Any] = {}
        if compiler_options is not None:
            options["compiler_options"] = compiler_options
        self._traced = eqx.filter_jit(function, **options)
        self._programs: dict[Hashable, Program] = {}
        self._others: set[Hashable] = set()
        self._busy: dict[Hashable, threading.Lock] = {}
        _alive.add(self)

    def __call__(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        folder = programs_folder()
        leaves, structure = jax.tree.flatten((args, kwargs))
        if not folder or no_tracing(leaves):
            return self._traced(*args, **kwargs)
        key = structure, *(seen(leaf) for leaf in leaves)
        program = self._programs.get(key)
        arrays = [leaf for leaf in leaves if is_array(leaf)]
        if program is None:
            program = self._found(key, Path(folder), (args, kwargs), arrays)
        return self._traced(*args, **kwargs) if program is None else program(arrays)

    def forget(self) -> None:
        """Gives back the machine code that this process holds; what is on disk stays."""
        self._programs.clear()

    def _found(self, key: Hashable, folder: Path, given: Any, arrays: list[Any]) -> Program | None:
        """From disk, or compiled and put there; None where the program is JAX's to keep."""
        with self._busy.setdefault(key, threading.Lock()):
            if key in self._others:
                return None
            if key not in self._programs:
                try:
                    name = program_name(self._function, given, self._options)
                    path = folder / f"{self._function.__name__}-{name}{SUFFIX}"
                except Indescribable:
                    self._others.add(key)
                    return None
                known = from_disk(path, lambda content: _shown_to_run(content, arrays))
                self._programs[key] = known or self._compiled(path, given, arrays)
            return self._programs[key]

    def _compiled(self, path: Path, given: Any, arrays: list[Any]) -> Program:
        function, result = between_arrays(self._function, given)
        lowered = jax.jit(function).lower(arrays)
        with jax_store_unused():
            compiled = lowered.compile(compiler_options=self._options)
        with contextlib.suppress(Exception):  # what cannot be kept is compiled once more
            keep(path, (*serialize(compiled), result.tree))
        return Program(compiled, result.tree)


class Outcome:
    """The tree of a function's result, known once the function has been traced."""

    tree: Any = None


def between_arrays(function: Callable, given: Any) -> tuple[Callable[[list], list], Outcome]:
    """A function of the arrays in some arguments alone, all else being part of it.

    What comes back besides it is filled in when the function is traced.
    """
    leaves, structure = jax.tree.flatten(given)
    outcome = Outcome()

    def called(chosen: list[Any]) -> list[Any]:
        places = iter(chosen)
        filled = [next(places) if is_array(leaf) else leaf for leaf in leaves]
        args, kwargs = jax.tree.unflatten(structure, filled)
        answer = function(*args, **kwargs)
        outcome.tree = jax.tree.map(lambda leaf: _Place() if is_array(leaf) else leaf, answer)
        return [leaf for leaf in jax.tree.leaves(answer) if is_array(leaf)]

    called.__name__ = function.__name__  # in JAX's logs and profiles
    return called, outcome


def program_name(function: Callable, given: Any, options: object) -> str:
    """A name for the program that some arguments need.

    Raises
    ------
    Indescribable
        Where the program depends on something that has no lasting name.
    """
    words = f"{made_with()}{described(function)}{options}{described(given)}"
    return hashlib.sha256(words.encode()).hexdigest()[:40]


def no_tracing(leaves: list[Any]) -> bool:
    """Whether a function must run as it stands: within another, or to look for a mistake."""
    within = any(isinstance(leaf, jax.core.Tracer) for leaf in leaves)
    return within or any(map(_setting, DEBUGGING))


def is_array(leaf: Any) -> bool:
    """Whether a leaf is traced; all others are part of the program."""
    return isinstance(leaf, jax.Array | np.ndarray | np.generic)


def seen(leaf: Any) -> Hashable:
    """What of a leaf makes another program."""
    if is_array(leaf):
        return leaf.shape, leaf.dtype, getattr(leaf, "weak_type", False)
    return type(leaf), leaf


def keep(path: Path, content: Any) -> None:
    """Writes a program under its name at once or not at all; a full disk is no error."""
    with contextlib.suppress(Exception):  # whatever could not be kept is compiled once more
        draft = path.with_suffix(f".{os.getpid()}{threading.get_ident()}")
        draft.write_bytes(zlib.compress(pickle.dumps(content), 1))
        draft.replace(path)
        for each in path.parent.glob(f"*{SUFFIX}"):
            if time.time() - each.stat().st_mtime > UNUSED_SECONDS:
                each.unlink(missing_ok=True)


def from_disk(path: Path, restored: Callable[[Any], Program]) -> Program | None:
    """A program that was kept, by what makes it of its content; None where there is none such."""
    if not path.exists():
        return None
    try:
        program = restored(pickle.loads(zlib.decompress(path.read_bytes())))
        os.utime(path)
    except Exception:  # whatever is wrong with a file, compiling makes a new one
        return None
    return program


def _shown_to_run(content: Any, arrays: list[Any]) -> Program:
    code, inner, outer, result = content
    program = Program(deserialize_and_load(code, inner, outer), result)
    jax.block_until_ready(program(arrays))
    return program


def _setting(name: str) -> Any:
    return getattr(jax.config, name)


@lru_cache(maxsize=1)
def made_with() -> str:
    """Everything besides its function and its arguments that a program depends on."""
    versions = (sys.version, jax.__version__, jax.lib.__version__, eqx.__version__, np.__version__)
    device = jax.devices()[0]
    settings = (
        os.environ.get("XLA_FLAGS"),
        _setting("jax_enable_x64"),
        _setting("jax_default_matmul_precision"),
        (device.platform, device.device_kind, jax.device_count()),
    )
    return f"{versions}{settings}"
