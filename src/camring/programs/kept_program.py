"""Programs that the next run neither traces nor compiles again.

JAX keeps compiled programs under the text of the program, and to have that text it
traces and lowers every function anew in each process: most of what a short command takes.
Here a program is found by what it is made from: the source of this package, the versions
of what compiles it, and a description of its arguments. Where the description would have
to reach beyond the package (a law of a user's own), JAX does as it always does.

What is kept is machine code, in the folder of `compilation_cache`, which nobody else can write,
in files that are looked at before they are run (`kept_file`).
"""

import contextlib
import fcntl
import hashlib
import inspect
import os
import sys
import threading
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import Future
from functools import lru_cache
from pathlib import Path
from typing import Any, Generic, ParamSpec, Protocol, TypeVar
from weakref import WeakSet

import equinox as eqx
import jax
import numpy as np
from jax.experimental.serialize_executable import deserialize_and_load, serialize
from jaxlib import lapack

from camring.programs.between_arrays import Program, between_arrays, filled
from camring.programs.compilation_cache import MAKING_SUFFIX, programs_folder
from camring.programs.description import Indescribable, described
from camring.programs.jax_store import jax_store_unused
from camring.programs.kept_file import SUFFIX, content_of
from camring.programs.kept_file import write as keep
from camring.programs.leaves import split, whole_form

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

SPARING = {"xla_backend_optimization_level": 1, "xla_cpu_use_fusion_emitters": False}
"""Options of XLA under which one motor's programs compile in 75 % of the time and run as fast."""


class Forgetful(Protocol):
    """Who holds machine code that it can have again."""

    def forget(self) -> None: ...


alive: "WeakSet[Forgetful]" = WeakSet()


def forget_programs() -> None:
    """Those of all functions, as `jax.clear_caches` does with its own."""
    for each in list(alive):
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
        As `jax.jit` takes them; unless given `SPARING`, for what is kept.
    """

    def __init__(
        self,
        function: Callable[Arguments, Result],
        compiler_options: dict[str, Any] | None = None,
    ) -> None:
        self._function, self._options = function, compiler_options
        self._complete = completion(function)
        options: dict[str, Any] = {}
        if compiler_options is not None:
            options["compiler_options"] = compiler_options
        self._traced = eqx.filter_jit(function, **options)
        self._programs: dict[Hashable, Program] = {}
        self._others: set[Hashable] = set()
        self._busy: dict[Hashable, threading.Lock] = {}
        alive.add(self)

    def __call__(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        args, kwargs = self._complete(*args, **kwargs)
        wanted = _wanted(args, kwargs)
        if wanted is None:
            return self._traced(*args, **kwargs)
        key, arrays = wanted
        program = self._programs.get(key)
        if program is None:
            with self._lock_of(key):
                program = self._found(key, (args, kwargs), arrays)
        return self._traced(*args, **kwargs) if program is None else program(arrays)

    def begin(self, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Compiles what a call with such arguments will need, in a thread; that call waits for it.

        Arrays may be shapes alone (`jax.ShapeDtypeStruct`). What is wrong with them the call says.

        Returns
        -------
        The result with shapes for arrays, as soon as Python has read the function and the compiler
        goes on alone; cancelled where there is nothing to compile, or nothing that can be kept.
        """
        shapes: Future[Any] = Future()
        args, kwargs = self._complete(*args, **kwargs)
        wanted = _wanted(args, kwargs)
        if wanted is None or not self._lacks(wanted[0], (args, kwargs)):
            shapes.cancel()
            return shapes
        (key, arrays), lock = wanted, self._lock_of(wanted[0])
        lock.acquire()

        def made() -> None:
            try:
                with contextlib.suppress(Exception):
                    self._found(key, (args, kwargs), arrays, shapes.set_result)
            finally:
                shapes.cancel()
                lock.release()

        threading.Thread(target=made).start()
        return shapes

    def forget(self) -> None:
        """Gives back the machine code that this process holds; what is on disk stays."""
        self._programs.clear()

    def _lock_of(self, key: Hashable) -> threading.Lock:
        return self._busy.setdefault(key, threading.Lock())

    def _found(
        self,
        key: Hashable,
        given: Any,
        arrays: list[Any],
        read: Callable[[Any], None] = lambda shapes: None,
    ) -> Program | None:
        """From disk, or compiled and put there; None where the program is JAX's to keep.

        Its lock is held; `read` is given the shapes of a result that is to be compiled.
        """
        if key in self._others:
            return None
        if key not in self._programs:
            try:
                path = self._path(given)
            except Indescribable:
                self._others.add(key)
                return None
            self._programs[key] = kept_or_made(
                path,
                lambda content: _shown_to_run(content, arrays),
                lambda: self._compiled(path, given, arrays, read),
            )
        return self._programs[key]

    def _lacks(self, key: Hashable, given: Any) -> bool:
        """Whether a program must be compiled and can be kept."""
        try:
            return key not in self._programs and not self._path(given).exists()
        except Indescribable:
            return False

    def _path(self, given: Any) -> Path:
        name = program_name(self._function, given, (_xla_flags(), self._effort()))
        return Path(programs_folder()) / f"{self._function.__name__}-{name}{SUFFIX}"

    def _effort(self) -> dict[str, Any]:
        """Options for the compiler, but for those that `XLA_FLAGS` name: a user's own go first."""
        sparing = SPARING if jax.default_backend() == "cpu" else {}
        chosen = sparing if self._options is None else self._options
        return {name: value for name, value in chosen.items() if f"--{name}=" not in _xla_flags()}

    def _compiled(
        self,
        path: Path,
        given: Any,
        arrays: list[Any],
        read: Callable[[Any], None],
    ) -> Program:
        function, result = between_arrays(self._function, given)
        program = jax.jit(function).trace(arrays)
        lowered = program.lower()
        read(filled(*jax.tree.flatten(result.tree), program.out_info))
        with jax_store_unused():
            compiled = lowered.compile(compiler_options=self._effort())
        with contextlib.suppress(Exception):  # what cannot be kept is compiled once more
            keep(path, (*serialize(compiled), result.tree))
        return Program(compiled, result.tree)


def _wanted(args: Any, kwargs: Any) -> tuple[Hashable, list[Any]] | None:
    """What tells a program from others, and its arrays; None where a function runs as it stands."""
    leaves, structure = jax.tree.flatten((args, kwargs))
    found = split(leaves, whole_form) if programs_folder() else None
    return None if found is None else ((structure, found[1]), found[0])


def _xla_flags() -> str:
    return os.environ.get("XLA_FLAGS", "")


def completion(function: Callable[Arguments, Any]) -> Callable[Arguments, Any]:
    """Of a function's arguments: what is left out has its default, so that both are one program.

    Raises
    ------
    TypeError
        For arguments that the function does not take, like the function.
    """
    signature = inspect.signature(function)
    parameters = list(signature.parameters.values())
    plain = all(each.kind is inspect.Parameter.POSITIONAL_OR_KEYWORD for each in parameters)

    def complete(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Any:
        if plain and not kwargs and len(args) == len(parameters):
            return args, kwargs
        bound = signature.bind(*args, **kwargs)
        bound.apply_defaults()
        return bound.args, bound.kwargs

    return complete


def program_name(function: Callable, given: Any, options: object) -> str:
    """A name for the program that some arguments need.

    Raises
    ------
    Indescribable
        Where the program depends on something that has no lasting name.
    """
    words = f"{made_with()}{described(function)}{options}{described(given)}"
    return hashlib.sha256(words.encode()).hexdigest()[:40]


def kept_or_made(
    path: Path, restored: Callable[[Any], Program], made: Callable[[], Program]
) -> Program:
    """A program from disk or, by the first of the processes that want it, made; others wait."""
    known = from_disk(path, restored)
    if known:
        return known
    with _one_process_at_a_time(path):
        return from_disk(path, restored) or made()


@contextlib.contextmanager
def _one_process_at_a_time(path: Path) -> Iterator[None]:
    """Where files cannot be locked everyone goes ahead; the lock of who dies is free."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            file = stack.enter_context(path.with_suffix(MAKING_SUFFIX).open("ab"))
            fcntl.flock(file, fcntl.LOCK_EX)
            stack.callback(path.with_suffix(MAKING_SUFFIX).unlink, missing_ok=True)
        yield


def from_disk(path: Path, restored: Callable[[Any], Program]) -> Program | None:
    """A program that was kept, by what makes it of its content; None where there is none such."""
    try:
        return restored(content_of(path))
    except Exception:  # whatever is wrong with a file, compiling makes a new one
        return None


def _shown_to_run(content: Any, arrays: list[Any]) -> Program:
    code, inner, outer, result = content
    if b"lapack" in code:
        _connect_lapack()
    program = Program(deserialize_and_load(code, inner, outer), result)
    jax.block_until_ready(program(arrays))
    return program


@lru_cache(maxsize=1)
def _connect_lapack() -> None:
    """JAX does so when it compiles; machine code from disk would call into nothing and crash."""
    lapack._lapack.initialize()


@lru_cache(maxsize=1)
def made_with() -> str:
    """Everything besides function, arguments and compiler's options that a program depends on."""
    versions = (sys.version, jax.__version__, jax.lib.__version__, eqx.__version__, np.__version__)
    device = jax.devices()[0]
    settings = (
        _setting("jax_enable_x64"),
        _setting("jax_default_matmul_precision"),
        (device.platform, device.device_kind, jax.device_count()),
    )
    return f"{versions}{settings}"


def _setting(name: str) -> Any:
    return getattr(jax.config, name)
