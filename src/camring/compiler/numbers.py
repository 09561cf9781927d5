"""Numbers and rows of them in LLVM's words."""

import struct
from typing import Any

import numpy as np

from camring.compiler.graph import NotInLanes
from camring.compiler.machine import has_wide_registers

WIDTH = 8 if has_wide_registers() else 4
"""Lanes in one row: what a register holds where it holds eight or four numbers, else two registers.

More than a register's would help to hide how long a division takes, and cost twice the memory of a
block, which then leaves a core's own cache: measured in docs/notes/batch.md.
"""


def element(dtype: np.dtype) -> str:
    """One number."""
    if dtype == np.bool_:
        return "i1"
    if dtype.kind in "iu":
        return f"i{8 * dtype.itemsize}"
    if dtype == np.float64:
        return "double"
    if dtype == np.float32:
        return "float"
    raise NotInLanes(f"no code for numbers of type {dtype}")


def in_memory(dtype: np.dtype) -> str:
    """The same where it is stored."""
    return "i8" if dtype == np.bool_ else element(dtype)


def row(dtype: np.dtype, lanes: bool = True) -> str:
    """A number for each lane, or one for all of them."""
    return f"<{WIDTH} x {element(dtype)}>" if lanes else element(dtype)


def literal(value: Any, dtype: np.dtype, lanes: bool) -> str:
    """A known number, in every lane."""
    one = _literal(value, dtype)
    return f"splat ({element(dtype)} {one})" if lanes else one


def _literal(value: Any, dtype: np.dtype) -> str:
    if dtype == np.bool_:
        return "true" if value else "false"
    if dtype.kind in "iu":
        return str(int(value))
    return f"0x{struct.unpack('<Q', struct.pack('<d', float(value)))[0]:016X}"


def intrinsic(name: str, dtype: np.dtype, lanes: bool) -> str:
    """The full name of one of LLVM's own functions."""
    short = {"double": "f64", "float": "f32"}.get(element(dtype), element(dtype))
    return f"@llvm.{name}.v{WIDTH}{short}" if lanes else f"@llvm.{name}.{short}"
