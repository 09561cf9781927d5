"""A function of many designs side by side, as fast as this machine runs it.

On a processor it becomes machine code of our own making (`compiler`), kept for
the next process like every other program. What there is no such code for (a law of a
user's own with a sort in it, a version of JAX that puts a step in words unknown here)
goes through JAX's compiler, slower, with the same results, and the first time a warning
says so. On a graphics card, and with `CAMRING_NATIVE=off`, everything goes that way.
"""

import os
import threading
import warnings
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar

import jax

from camring.compiler.machine import made_by
from camring.compiler.numbers import WIDTH
from camring.compiler.program import Code, NativeProgram, NotInLanes
from camring.programs.between_arrays import Program, between_arrays
from camring.programs.compilation_cache import programs_folder
from camring.programs.description import Indescribable
from camring.programs.kept_program import (
    SUFFIX,
    alive,
    completion,
    keep,
    kept_or_made,
    program_name,
)
from camring.programs.leaves import is_array, split
from camring.programs.motor_program import bare, motor_program

SWITCH = "CAMRING_NATIVE"

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class BatchProgram(Generic[Arguments, Result]):
    """A function whose arrays all have the batch along their last axis, compiled for any number.

    Motors in its result have no name (`motor_program`).

    Parameters
    ----------
    function
        Pure, and reached by its name in a module of this package.
    compiler_options
        As `jax.jit` takes them, for where JAX compiles it.
    """

    def __init__(
        self,
        function: Callable[Arguments, Result],
        compiler_options: dict[str, Any] | None = None,
    ) -> None:
        self._function = function
        self._complete = completion(function)
        self._otherwise = motor_program(function, compiler_options)
        self._programs: dict[Hashable, Program | None] = {}
        self._busy = threading.Lock()
        self.hindrances: list[str] = []
        """Why JAX had to compile what it did."""
        alive.add(self)

    def __call__(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not native():
            return self._otherwise(*args, **kwargs)
        given = bare(*self._complete(*args, **kwargs))
        leaves, structure = jax.tree.flatten(given)
        found = split(leaves, _form_in_batch)
        if found is None:
            return self._otherwise(*args, **kwargs)
        arrays, forms = found
        key = structure, forms
        if key not in self._programs:
            with self._busy:
                if key not in self._programs:
                    self._programs[key] = self._found(given)
        program = self._programs[key]
        if program is None:
            return self._otherwise(*args, **kwargs)
        return program(arrays)

    def forget(self) -> None:
        """Gives back the machine code that this process holds; what is on disk stays."""
        self._programs.clear()

    def _found(self, given: Any) -> Program | None:
        """From disk, or compiled and put there; None where JAX has to do it."""
        path = self._path(given)
        try:
            if path is None:
                return self._made(given, None)
            return kept_or_made(path, _restored, lambda: self._made(given, path))
        except Exception as reason:  # whatever it is, JAX can do it
            self.hindrances.append(_words(reason))
            _warn_once(self.hindrances[-1])
            return None

    def _made(self, given: Any, path: Path | None) -> Program:
        arrays = [leaf for leaf in jax.tree.leaves(given) if is_array(leaf)]
        function, result = between_arrays(self._function, given)
        native = NativeProgram(function, arrays)
        if path:
            keep(path, (native.code, result.tree))
        return Program(native, result.tree)

    def _path(self, given: Any) -> Path | None:
        folder = programs_folder()
        if not folder:
            return None
        one_design = jax.tree.map(_one_design, given)
        try:
            name = program_name(self._function, one_design, made_by())
        except Indescribable:
            return None
        return Path(folder) / f"{self._function.__name__}-batch-{name}{SUFFIX}"


_warned = threading.Event()


def _words(reason: Exception) -> str:
    """What stood in the way, in one line; a fault of ours with its kind."""
    said = " ".join(str(reason).split())
    return said if isinstance(reason, NotInLanes) else f"{type(reason).__name__}: {said}"


def _warn_once(reason: str) -> None:
    if _warned.is_set():
        return
    _warned.set()
    warnings.warn(
        f"Batches of designs run three to eight times slower than they could, with the same "
        f"results: machine code of our own could not be made ({reason}), so JAX compiles them. "
        f"{SWITCH}=off does so without this warning.",
        RuntimeWarning,
        stacklevel=4,
    )


def row_width() -> int:
    """Members that machine code treats in one step, so that fewer cost as much as all of them."""
    return WIDTH if native() else 1


def native() -> bool:
    """Whether machine code of our own is wanted, and for a processor."""
    return os.environ.get(SWITCH, "").lower() != "off" and jax.default_backend() == "cpu"


def _form_in_batch(array: Any) -> Hashable:
    """All but the number of designs, which a program takes as they come."""
    form = getattr(array, "aval", array)
    return form.ndim, form.shape[:-1], form.dtype


def _one_design(leaf: Any) -> Any:
    if not (is_array(leaf) and leaf.ndim):
        return leaf
    form = getattr(leaf, "aval", leaf)
    weak = getattr(form, "weak_type", False)
    return jax.ShapeDtypeStruct((*form.shape[:-1], 1), form.dtype, weak_type=weak)


def _restored(content: Any) -> Program:
    code, result = content
    return Program(NativeProgram.restored(Code(*code)), result)
