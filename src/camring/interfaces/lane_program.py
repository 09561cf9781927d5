"""A function of many designs side by side, as fast as this machine runs it.

On a processor it becomes machine code of our own making (`numerics/native`), kept for
the next process like every other program. What there is no such code for (a law of a
user's own with a sort in it, a graphics card) goes through JAX's compiler, slower, with
the same results. `CAMRING_NATIVE=off` lets everything go that way.
"""

import os
import threading
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar

import jax

from camring.interfaces.compilation_cache import programs_folder
from camring.interfaces.description import Indescribable
from camring.interfaces.kept_program import (
    SUFFIX,
    Program,
    between_arrays,
    from_disk,
    is_array,
    keep,
    no_tracing,
    program_name,
    seen,
)
from camring.interfaces.motor_program import motor_program, named
from camring.numerics.native.machine import made_by
from camring.numerics.native.program import Code, NativeProgram, NotInLanes

SWITCH = "CAMRING_NATIVE"

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class LaneProgram(Generic[Arguments, Result]):
    """A function whose arrays all have lanes along their last axis, compiled for any number.

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
        self._otherwise = motor_program(function, compiler_options)
        self._programs: dict[Hashable, Program | None] = {}
        self._busy = threading.Lock()
        self.hindrances: list[str] = []
        """Why JAX had to compile what it did."""

    def __call__(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not native():
            return self._otherwise(*args, **kwargs)
        given = named((args, kwargs), "")
        leaves, structure = jax.tree.flatten(given)
        if no_tracing(leaves):
            return self._otherwise(*args, **kwargs)
        key = structure, *(_seen_in_lanes(leaf) for leaf in leaves)
        if key not in self._programs:
            with self._busy:
                if key not in self._programs:
                    self._programs[key] = self._found(given)
        program = self._programs[key]
        if program is None:
            return self._otherwise(*args, **kwargs)
        return program([leaf for leaf in leaves if is_array(leaf)])

    def _found(self, given: Any) -> Program | None:
        """From disk, or compiled and put there; None where JAX has to do it."""
        path = self._path(given)
        known = from_disk(path, _restored) if path else None
        if known:
            return known
        leaves = jax.tree.leaves(given)
        arrays = [leaf for leaf in leaves if is_array(leaf)]
        function, result = between_arrays(self._function, given)
        try:
            native = NativeProgram(function, arrays)
        except NotInLanes as reason:
            self.hindrances.append(str(reason))
            return None
        if path:
            keep(path, (native.code, result.tree))
        return Program(native, result.tree)

    def _path(self, given: Any) -> Path | None:
        folder = programs_folder()
        if not folder:
            return None
        one_lane = jax.tree.map(_one_lane, given)
        try:
            name = program_name(self._function, one_lane, made_by())
        except Indescribable:
            return None
        return Path(folder) / f"{self._function.__name__}-lanes-{name}{SUFFIX}"


def native() -> bool:
    """Whether machine code of our own is wanted, and for a processor."""
    return os.environ.get(SWITCH, "").lower() != "off" and jax.default_backend() == "cpu"


def _seen_in_lanes(leaf: Any) -> Hashable:
    return (leaf.ndim, leaf.shape[:-1], leaf.dtype) if is_array(leaf) else seen(leaf)


def _one_lane(leaf: Any) -> Any:
    return leaf[..., :1] if is_array(leaf) and leaf.ndim else leaf


def _restored(content: Any) -> Program:
    code, result = content
    return Program(NativeProgram.restored(Code(*code)), result)
