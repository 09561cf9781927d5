"""Putting a graph together: nodes one by one, each computation only once."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from camring.compiler.graph import (
    EXPENSIVE,
    Constant,
    Input,
    Lead,
    Node,
    NotInLanes,
    Operand,
    Pointwise,
    View,
)

TRACED_LANES = 97
"""A number of lanes that no other axis has, so that lanes are known by it."""


class Wanted(NamedTuple):
    """What a step has to give."""

    lead: Lead
    dtype: np.dtype
    params: dict[str, Any]
    """Of JAX's primitive."""


@dataclass(eq=False)
class Flattened(View):
    """Rows and lanes in one axis, some of the lanes, or what was made of that: no code for it.

    `computed_once` asks for it, and whether a modulus is below minus one; nothing else may.
    """

    modulus: bool = False


class Builder:
    """The nodes of one region; what is alike in all its rounds goes into the one around it."""

    def __init__(self, around: "Builder | None" = None) -> None:
        self.nodes: list[Node] = []
        self.around = around
        self._own: set[int] = set()
        self._known: dict[tuple, Node] = {}

    def input(self, place: int, aval: Any) -> Input:
        """A place of the function that is read, or of a body that repeats."""
        if not has_lanes(aval.shape) and aval.shape:
            raise NotInLanes(f"an input of shape {aval.shape} without lanes")
        dtype, lanes = np.dtype(aval.dtype), has_lanes(aval.shape)
        return self.own(Input(lead_of(aval.shape), dtype, lanes, place=place))

    def own(self, node: Input) -> Input:
        self._own.add(id(node))
        return node

    def add(self, node: Node) -> View:
        """A node, and all its rows."""
        self.nodes.append(node)
        self._own.add(id(node))
        return node.whole()

    def from_around(self, operand: Operand) -> bool:
        """Whether an operand is the same in every round."""
        return isinstance(operand, Constant) or id(operand.node) not in self._own

    def pointwise(
        self, name: str, inputs: list[Operand], lead: Lead, dtype: Any, **params: Any
    ) -> View:
        """One instruction on every row; the one there is already if it was asked for before."""
        if self.around is not None and all(map(self.from_around, inputs)):
            arrays = {id(e.node) for e in inputs if isinstance(e, View) and differs_by_row(e)}
            # Once for all rounds: what is expensive, and what takes no more memory than its parts.
            if len(arrays) <= 1 or name in EXPENSIVE or math.prod(lead) == 1:
                return self.around.pointwise(name, inputs, lead, dtype, **params)
        inputs = [spread(each, lead) for each in inputs]
        key = (name, lead, str(dtype), str(params), *(_identity(each) for each in inputs))
        node = self._known.get(key)
        if node is None:
            lanes = bool(lead) or any(isinstance(e, View) and e.node.lanes for e in inputs)
            node = Pointwise(lead, np.dtype(dtype), lanes, name=name, inputs=inputs, params=params)
            self._known[key] = node
            self.add(node)
        return node.whole()

    def following(self, operand: View) -> View:
        """The same rows, one behind the other in memory."""
        rows = operand.rows.ravel()
        if np.array_equal(rows, rows[0] + np.arange(len(rows))):
            return operand
        return self.pointwise("same", [operand], operand.lead, operand.dtype)


def _lane_axis(shape: tuple[int, ...]) -> int | None:
    """The last axis, or the last but one where a last of one holds a row's number."""
    if shape and shape[-1] == TRACED_LANES:
        return len(shape) - 1
    if shape[-2:] == (TRACED_LANES, 1):
        return len(shape) - 2
    return None


def lead_of(shape: tuple[int, ...]) -> Lead:
    """What lies before the lanes of an array of the traced function."""
    return shape[: _lane_axis(shape)]


def has_lanes(shape: tuple[int, ...]) -> bool:
    """Whether an array of the traced function has a number for each lane."""
    return _lane_axis(shape) is not None


def constant(value: Any) -> Constant:
    """Known numbers of the traced function; their lanes are not kept."""
    values = np.asarray(value)
    if has_lanes(values.shape):
        first = np.broadcast_to(values[..., :1], values.shape)
        if not np.array_equal(values, first, equal_nan=values.dtype.kind == "f"):
            raise NotInLanes("a constant that differs from lane to lane")
        values = values[..., 0]
    return Constant(values)


def mapped(operand: Operand, change: Callable[[np.ndarray], np.ndarray]) -> Operand:
    """An operand with its rows in another order or shape."""
    if isinstance(operand, Constant):
        return Constant(change(operand.values))
    return View(operand.node, change(operand.rows))


def spread(operand: Operand, lead: Lead) -> Operand:
    """Broadcast to the rows of a result; a constant may have a last axis of one for lanes."""
    if operand.lead == lead:
        return operand
    if isinstance(operand, Constant) and operand.values.ndim == len(lead) + 1:
        if operand.values.shape[-1] != 1:
            raise NotInLanes("a constant that differs from lane to lane")
        operand = Constant(operand.values[..., 0])
    return mapped(operand, lambda rows: np.broadcast_to(rows, lead))


def differs_by_row(operand: View) -> bool:
    """Whether it has more than one row of its node."""
    return bool(np.any(operand.rows != operand.rows.flat[0])) if operand.rows.size else False


def _identity(operand: Operand) -> tuple:
    if isinstance(operand, Constant):
        return operand.values.dtype.str, operand.values.shape, operand.values.tobytes()
    return id(operand.node), operand.rows.tobytes()
