"""Steps that are more than one instruction a row."""

import math
from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from jax import lax

from camring.compiler.building import Builder, Wanted, constant, spread
from camring.compiler.graph import (
    AcrossLanes,
    Constant,
    Counted,
    Folded,
    Input,
    NotInLanes,
    Operand,
    Product,
    Region,
    Result,
    Scan,
    Taken,
    View,
)

UNROLLED = 256
"""Rows folded into each of several results one after the other at most."""
OUTSIDE = -1  # no row has that number


def quotient(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    """By what is the same in every row, or every round: one division, and products."""
    above, below = given
    lead, dtype = wanted.lead, wanted.dtype
    plain = build.pointwise
    if dtype.kind != "f" or not isinstance(below, View):
        return plain("div", given, lead, dtype)
    if math.prod(lead) > 1 and np.all(below.rows == below.rows.flat[0]):
        below = View(below.node, below.rows.reshape(-1)[0])
    elif build.around is None or not build.from_around(below):
        return plain("div", given, lead, dtype)
    inverse = plain("div", [constant(np.ones((), dtype)), below], below.lead, dtype)
    return plain("mul", [above, inverse], lead, dtype)


def added(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    return build.pointwise("add", given, wanted.lead, wanted.dtype)


def squared(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    return build.pointwise("mul", [given[0], given[0]], wanted.lead, wanted.dtype)


def clamped(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    low, value, high = given
    raised = build.pointwise("max", [value, low], wanted.lead, wanted.dtype)
    return build.pointwise("min", [raised, high], wanted.lead, wanted.dtype)


def taken(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    """Rows by numbers: known ones are a view, others differ from lane to lane."""
    table, number = given
    how, lead = wanted.params["dimension_numbers"], wanted.lead
    apart = bool(how.operand_batching_dims)  # each lane has numbers of its own
    if isinstance(table, View) and isinstance(number, Constant) and not apart:
        if how.collapsed_slice_dims == (0,) and how.offset_dims == (len(lead),):
            return View(table.node, table.rows[number.values[..., 0]])
        return View(table.node, _gathered(table.rows, number.values, wanted))
    if not isinstance(table, View) or how.collapsed_slice_dims != (0,):
        raise NotInLanes("a gather that is no taking of rows")
    batched = how.operand_batching_dims == (1,) and not how.offset_dims
    if not batched or len(table.lead) != 1:
        raise NotInLanes("a gather that is no taking of rows in each lane")
    if table.rows.size == 1:
        return View(table.node, np.broadcast_to(table.rows.reshape(()), lead))
    return build.add(Taken(lead, wanted.dtype, table=build.following(table), number=number))


def _gathered(rows: np.ndarray, numbers: np.ndarray, wanted: Wanted) -> np.ndarray:
    """What a gather by known numbers does to lanes that it leaves whole, done to rows' numbers."""
    how, lanes = wanted.params["dimension_numbers"], rows.ndim
    sizes = (*wanted.params["slice_sizes"][:-1], 1)
    if lanes in (*how.collapsed_slice_dims, *how.start_index_map):
        raise NotInLanes("a gather along lanes")
    with jax.ensure_compile_time_eval():
        mode = wanted.params["mode"]
        taken = lax.gather(rows[..., None], numbers, how, sizes, mode=mode, fill_value=OUTSIDE)
    found = np.asarray(taken)
    if found.shape != (*wanted.lead, 1) or np.any(found == OUTSIDE):
        raise NotInLanes("a gather from outside")
    return found[..., 0]


def counted(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    before, number, added = given
    how = wanted.params["dimension_numbers"]
    batched = how.operand_batching_dims == (1,) and how.inserted_window_dims == (0,)
    if not batched or not _all_are(before, 0) or not _all_are(added, 1):
        raise NotInLanes("a scatter that is no counting of rows in each lane")
    return build.add(Counted(wanted.lead, wanted.dtype, given=number))


def _all_are(operand: Operand, value: int) -> bool:
    return isinstance(operand, Constant) and bool(np.all(operand.values == value))


def product(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    (left, right), batch = wanted.params["dimension_numbers"]
    matrix, operand = given
    if batch != ((), ()) or not isinstance(matrix, Constant) or not isinstance(operand, View):
        raise NotInLanes("a product that is none of a constant matrix with rows")
    values = matrix.values
    if tuple(left) != (values.ndim - 1,) or tuple(right) != (0,):
        raise NotInLanes("a product over other axes than the last and the first")
    if values.shape[-1] == 1:
        more = [1] * (operand.rows.ndim - 1)
        column = spread(Constant(values.reshape(*values.shape[:-1], *more)), wanted.lead)
        row = View(operand.node, operand.rows[0])
        return build.pointwise("mul", [column, row], wanted.lead, wanted.dtype)
    flat = values.reshape(-1, values.shape[-1])
    return build.add(
        Product(wanted.lead, wanted.dtype, matrix=flat, given=build.following(operand))
    )


def running_total(build: Builder, given: list[Operand], wanted: Wanted) -> Operand:
    lead, dtype = wanted.lead, wanted.dtype
    if wanted.params["axis"] or len(lead) != 1 or wanted.params["reverse"]:
        raise NotInLanes("a running total along another axis than the first")
    inner = Builder()
    so_far, here = (inner.own(Input((), dtype, place=place)) for place in range(2))
    total = inner.pointwise("add", [so_far.whole(), here.whole()], (), dtype)
    body = Region([so_far, here], inner.nodes, [total, total])
    scan = Scan(lead, dtype, body=body, begin=[constant(np.zeros((), dtype))], along=given)
    build.add(scan)
    return build.add(Result(lead, dtype, of=scan, number=1))


def fold(
    build: Builder, how: str, operand: Operand, axes: tuple[int, ...], dtype: np.dtype
) -> Operand:
    """Over some axes of an operand, its lanes being the axis behind its rows."""
    if not isinstance(operand, View):
        raise NotInLanes("a fold of a constant")
    if not operand.node.lanes and operand.lead == ():
        return operand
    rows = tuple(axis for axis in axes if axis < len(operand.lead))
    found = _fold_rows(build, how, operand, rows, dtype) if rows else operand
    if len(rows) == len(axes):
        return found
    if found.lead:
        raise NotInLanes("a fold over lanes but not over all rows")
    return build.add(AcrossLanes((), dtype, False, how=how, given=found))


def _fold_rows(
    build: Builder, how: str, operand: View, axes: tuple[int, ...], dtype: np.dtype
) -> View:
    if len(axes) == len(operand.lead) and operand.rows.size > 4:
        return build.add(Folded((), dtype, how=how, given=operand))
    rest = [axis for axis in range(len(operand.lead)) if axis not in axes]
    lead = tuple(operand.lead[axis] for axis in rest)
    rows = operand.rows.transpose([*axes, *rest]).reshape(-1, *lead)
    if len(rows) > UNROLLED:
        raise NotInLanes(f"a fold of {len(rows)} rows into each of several")
    found = View(operand.node, rows[0])
    for each in rows[1:]:
        found = build.pointwise(how, [found, View(operand.node, each)], lead, dtype)
    return found


STEPS: dict[str, Callable[[Builder, list[Any], Wanted], Operand]] = {
    "div": quotient,
    "add_any": added,
    "square": squared,
    "clamp": clamped,
    "gather": taken,
    "scatter-add": counted,
    "dot_general": product,
    "cumsum": running_total,
}
"""By the names of JAX's primitives."""

FOLDS = {
    "reduce_sum": "add",
    "reduce_max": "max",
    "reduce_min": "min",
    "reduce_and": "and",
    "reduce_or": "or",
}
"""The instruction that each of JAX's folds repeats."""
