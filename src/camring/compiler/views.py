"""Steps that compute nothing: the same rows in another order, shape or company."""

from collections.abc import Callable
from typing import Any

import numpy as np

from camring.compiler.building import (
    TRACED_LANES,
    Builder,
    Flattened,
    Wanted,
    has_lanes,
    mapped,
)
from camring.compiler.graph import Constant, Joined, NotInLanes, Operand, Part, View


def broadcast(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    own = [axis for axis in wanted.params["broadcast_dimensions"] if axis < len(wanted.lead)]

    def change(rows: np.ndarray) -> np.ndarray:
        room = [1] * len(wanted.lead)
        for axis, size in zip(own, rows.shape, strict=True):
            room[axis] = size
        return np.broadcast_to(rows.reshape(room), wanted.lead)

    return mapped(given[0], change)


def reshaped(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    operand, sizes = given[0], wanted.params.get("new_sizes")
    if isinstance(operand, View) and operand.node.lanes and sizes and not has_lanes(sizes):
        return flattened(operand)
    return mapped(operand, lambda rows: rows.reshape(wanted.lead))


def sliced(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    operand, params = given[0], wanted.params
    strides = params["strides"] or (1,) * len(params["start_indices"])
    bounds = zip(params["start_indices"], params["limit_indices"], strides, strict=True)
    pieces = [slice(*each) for each in bounds]
    if isinstance(operand, View) and operand.node.lanes:
        if pieces[-1] != slice(0, TRACED_LANES, 1):
            return flattened(operand)
        pieces = pieces[:-1]
    return mapped(operand, lambda rows: rows[tuple(pieces[: rows.ndim])])


def sliced_from(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    """From places that are known: as JAX has it, never beyond an end."""
    operand, *starts = given
    sizes = wanted.params["slice_sizes"]
    if not all(isinstance(each, Constant) for each in starts):
        raise NotInLanes("a slice from a place that is computed")
    if isinstance(operand, View) and operand.node.lanes and sizes[-1] != TRACED_LANES:
        return flattened(operand)

    def change(rows: np.ndarray) -> np.ndarray:
        pieces = []
        for start, size, room in zip(starts, sizes, rows.shape, strict=False):
            assert isinstance(start, Constant)
            first = min(max(int(start.values), 0), room - size)
            pieces.append(slice(first, first + size))
        return rows[tuple(pieces)]

    return mapped(operand, change)


def transposed(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    order = wanted.params["permutation"]
    if order[-1] != len(order) - 1:
        raise NotInLanes("lanes that do not stay last")
    return mapped(given[0], lambda rows: rows.transpose(order[:-1]))


def reversed_(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    axes = wanted.params["dimensions"]
    if max(axes) >= len(wanted.lead):
        raise NotInLanes("lanes in another order")
    return mapped(given[0], lambda rows: np.flip(rows, axes))


def concatenated(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    return joined(build, given, wanted, wanted.params["dimension"])


def stacked(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    axis = wanted.params["axis"]
    apart = [mapped(each, lambda rows: np.expand_dims(rows, axis)) for each in given]
    return joined(build, apart, wanted, axis)


def padded(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    """Behind the first axis only: another part, of one number."""
    operand, filling = given
    (low, high, inner), *rest = wanted.params["padding_config"]
    known = isinstance(filling, Constant)
    if not known or low or inner or high < 0 or any(map(any, rest)) or not wanted.lead:
        raise NotInLanes("a padding that is not behind the first axis")
    if not high:
        return operand
    assert isinstance(filling, Constant)
    added = Constant(np.broadcast_to(filling.values, (high, *wanted.lead[1:])))
    return joined(build, [operand, added], wanted, 0)


def joined(build: Builder, given: list[Operand], wanted: Wanted, axis: int) -> Operand:
    """Rows of one node are another view of it; those of several are written behind each other."""
    if axis >= len(wanted.lead):
        raise NotInLanes("lanes one behind the other")
    given = [each for each in given if each.lead[axis]]
    views = [each for each in given if isinstance(each, View)]
    if len(views) == len(given) and all(each.node is views[0].node for each in views):
        return View(views[0].node, np.concatenate([each.rows for each in views], axis))
    if axis:
        raise NotInLanes("joining along another axis than the first")
    whole = Joined(wanted.lead, wanted.dtype)
    first = 0
    for each in given:
        part = Part(each.lead, wanted.dtype, given=each, whole_of=whole, first=first)
        whole.parts.append(part)
        first += part.rows
        build.add(part)
    return build.add(whole)


def flattened(operand: View) -> Flattened:
    return Flattened(operand.node, operand.rows.reshape(-1)[:1].reshape(()))


VIEWS: dict[str, Callable[[Builder, list[Any], Wanted], Operand]] = {
    "broadcast_in_dim": broadcast,
    "reshape": reshaped,
    "squeeze": reshaped,
    "expand_dims": reshaped,
    "slice": sliced,
    "dynamic_slice": sliced_from,
    "transpose": transposed,
    "rev": reversed_,
    "concatenate": concatenated,
    "stack": stacked,
    "pad": padded,
}
"""By the names of JAX's primitives."""
