"""Sums and extremes over the rows of a loop."""

import numpy as np

from camring.compiler.graph import Folded
from camring.compiler.instructions import Instructions
from camring.compiler.numbers import literal, row
from camring.compiler.primitives import pointwise
from camring.compiler.rows import TRUTH, Variable


def neutral(how: str, dtype: np.dtype) -> float | int | bool:
    """What changes nothing in a fold."""
    if how == "add":
        return 0
    if how in ("and", "or"):
        return how == "and"
    if dtype == TRUTH:
        return how == "min"
    if dtype.kind == "f":
        return -np.inf if how == "max" else np.inf
    return int(np.iinfo(dtype).min if how == "max" else np.iinfo(dtype).max)


class RunningFold:
    """What is folded so far, from row to row.

    An extreme takes one instruction a row; that there was no number in some row is
    remembered beside it and said at the end.
    """

    def __init__(self, code: Instructions, node: Folded) -> None:
        self._code, self._how, self._dtype = code, node.how, node.dtype
        self._extreme = node.how in ("max", "min") and node.dtype.kind == "f"
        self._total = Variable(code, node.dtype)
        self._total.set(literal(neutral(node.how, node.dtype), node.dtype, True))
        self._undefined = Variable(code, TRUTH)
        self._undefined.set(literal(False, TRUTH, True))

    def take(self, value: str) -> None:
        code, dtype = self._code, self._dtype
        so_far = self._total.get()
        if not self._extreme:
            found = pointwise(code, self._how, {}, [so_far, value], [dtype, dtype], dtype, True)
            self._total.set(found)
            return
        typed, truth = row(dtype), row(TRUTH)
        further = "ogt" if self._how == "max" else "olt"
        better = code.new(f"fcmp {further} {typed} {value}, {so_far}")
        self._total.set(code.new(f"select {truth} {better}, {typed} {value}, {typed} {so_far}"))
        none = code.new(f"fcmp uno {typed} {value}, {value}")
        self._undefined.set(code.new(f"or {truth} {none}, {self._undefined.get()}"))

    def end(self) -> str:
        found, typed = self._total.get(), row(self._dtype)
        if not self._extreme:
            return found
        nan = literal(np.nan, self._dtype, True)
        none = self._undefined.get()
        return self._code.new(f"select {row(TRUTH)} {none}, {typed} {nan}, {typed} {found}")
