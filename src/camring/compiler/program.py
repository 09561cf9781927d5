"""A function of arrays in lanes as machine code for this processor.

Its arrays have lanes along their last axis and any number of rows before it. Every
block of lanes, a register's, goes through the whole function by itself, so results of one lane
never depend on how many others there are; a repetition ends when its block has done.
"""

import ctypes
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from math import prod
from typing import Any, NamedTuple

import jax
import numpy as np

from camring.compiler.building import has_lanes
from camring.compiler.graph import NotInLanes
from camring.compiler.machine import loaded, machine_code
from camring.compiler.memory import CACHE_LINE
from camring.compiler.numbers import WIDTH
from camring.compiler.reading import read, trace
from camring.compiler.writing import ENTRY, write


class Shape(NamedTuple):
    """What one result looks like."""

    lead: tuple[int, ...]
    dtype: np.dtype
    lanes: bool


class Code(NamedTuple):
    """Everything that another process needs to run a function; nothing in it but plain data."""

    machine_code: bytes
    working_memory: int
    """Bytes, for one block at a time."""
    arguments: tuple[Shape, ...]
    results: tuple[Shape, ...]


class NativeProgram:
    """Arrays to arrays, compiled once for any number of lanes.

    Parameters
    ----------
    function
        Traceable by JAX; of a tree of arrays with lanes, and single numbers.
    arguments
        An example of that tree; shapes and types count, lanes and numbers do not.

    Raises
    ------
    NotInLanes
        For a step of the function that there is no code for.
    """

    def __init__(self, function: Callable[[Any], Any], arguments: Any) -> None:
        traced, result = trace(function, arguments)
        region = read(traced)
        text, memory = write(region)
        leaves, self._structure = jax.tree.flatten(result)
        shapes = [
            Shape(operand.lead, operand.dtype, has_lanes(leaf.shape))
            for operand, leaf in zip(region.outputs, leaves, strict=True)
        ]
        arguments = [
            Shape(each.shape[:-1], np.dtype(each.dtype), bool(each.shape))
            for each in traced.in_avals
        ]
        self._begin(Code(machine_code(text), memory, tuple(arguments), tuple(shapes)))

    @classmethod
    def restored(cls, code: Code) -> "NativeProgram":
        """What another process compiled, results as a list."""
        program = cls.__new__(cls)
        program._structure = jax.tree.structure([0] * len(code.results))
        program._begin(code)
        return program

    def _begin(self, code: Code) -> None:
        self.code = code
        self._engine = loaded(code.machine_code)
        pointer, number = ctypes.c_void_p, ctypes.c_int64
        signature = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, number, number, number)
        self._call = signature(self._engine.get_function_address(ENTRY))
        self._memory = threading.local()

    def __call__(self, arguments: Any) -> Any:
        """Results for all lanes; of what is one number for all of them, the largest.

        Raises
        ------
        TypeError, ValueError
            For arrays of other types, or other shapes, than the program was made for.
        """
        given = [np.asarray(each) for each in jax.tree.leaves(arguments)]
        lanes = _lanes(given, self.code.arguments)
        whole = -(-lanes // WIDTH) * WIDTH
        given = _as_expected(given, self.code.arguments, lanes, whole)
        found = _aligned(self.code.results, whole)
        inputs, outputs = _addresses(given), _addresses(found)
        self._run(inputs, outputs, whole)
        shaped = [
            each[..., :lanes] if shape.lanes else each[..., :lanes].max()
            for each, shape in zip(found, self.code.results, strict=True)
        ]
        return jax.tree.unflatten(self._structure, shaped)

    def _run(self, inputs: ctypes.Array, outputs: ctypes.Array, whole: int) -> None:
        """All blocks of lanes: a few of them are shared out among the processor's cores.

        Whoever has many calls the program from threads of its own.
        """
        blocks = whole // WIDTH

        def some(first: int, last: int) -> None:
            self._call(inputs, outputs, self._working_memory(), whole, first, last)

        if not 1 < blocks <= FEW_BLOCKS or cores() == 1:
            some(0, blocks)
            return
        parts = min(cores(), blocks)
        ends = [blocks * part // parts for part in range(parts + 1)]
        others = [_helpers().submit(some, *pair) for pair in pairwise(ends[1:])]
        some(0, ends[1])
        for each in others:
            each.result()

    def _working_memory(self) -> int:
        """Where this thread's own begins, on a boundary of a cache line."""
        if not hasattr(self._memory, "bytes"):
            self._memory.bytes = np.zeros(self.code.working_memory + CACHE_LINE, np.uint8)
        return -(-_address(self._memory.bytes) // CACHE_LINE) * CACHE_LINE


FEW_BLOCKS = 256 // WIDTH
"""Up to so many a call is shared out; a caller with threads of its own is not the slower for it."""


def cores() -> int:
    """Processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@cache
def _helpers() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max(cores() - 1, 1), "camring-blocks")


def _lanes(given: list[np.ndarray], wanted: tuple[Shape, ...]) -> int:
    """How many there are: whatever is not as the code expects it would be read wrongly."""
    if len(given) != len(wanted):
        raise ValueError(f"{len(given)} arrays where the program takes {len(wanted)}")
    lanes = next(each.shape[-1] for each in given if each.ndim)
    for array, shape in zip(given, wanted, strict=True):
        if array.dtype != shape.dtype:
            raise TypeError(f"numbers of type {array.dtype} where the program takes {shape.dtype}")
        if array.shape != ((*shape.lead, lanes) if shape.lanes else ()):
            expected = (*shape.lead, "lanes") if shape.lanes else ()
            raise ValueError(f"shape {array.shape} where the program takes {expected}")
    return lanes


def _as_expected(
    given: list[np.ndarray], shapes: tuple[Shape, ...], lanes: int, whole: int
) -> list[np.ndarray]:
    """The same in memory as the code expects it, the last lane repeated to whole blocks."""
    if lanes == whole:
        return [np.ascontiguousarray(each) for each in given]
    arrays = _aligned(shapes, whole)
    for array, target in zip(given, arrays, strict=True):
        target[..., :lanes] = array
        target[..., lanes:] = array[..., -1:] if array.ndim else array
    return arrays


def _aligned(shapes: tuple[Shape, ...], lanes: int) -> list[np.ndarray]:
    """Arrays side by side in one piece of memory, each from a cache line on.

    JAX takes such an array without copying it.
    """
    sizes = [prod(each.lead) * lanes * each.dtype.itemsize for each in shapes]
    places = np.cumsum([0, *(-(-size // CACHE_LINE) * CACHE_LINE for size in sizes)]).tolist()
    memory = np.empty(places[-1] + CACHE_LINE, np.uint8)
    first = -_address(memory) % CACHE_LINE
    return [
        np.ndarray((*each.lead, lanes), each.dtype, memory, first + place)
        for each, place in zip(shapes, places, strict=False)
    ]


def _address(array: np.ndarray) -> int:
    return array.__array_interface__["data"][0]  # `array.ctypes` takes ten times as long


def _addresses(arrays: list[np.ndarray]) -> ctypes.Array:
    return (ctypes.c_void_p * len(arrays))(*map(_address, arrays))


__all__ = ["Code", "NativeProgram", "NotInLanes"]
