"""One loop over rows, in which all its members are computed."""

import numpy as np

from camring.compiler.folds import RunningFold
from camring.compiler.gates import Gate, gates
from camring.compiler.graph import (
    Folded,
    Node,
    NotInLanes,
    Part,
    Pointwise,
    Result,
    Scan,
    Taken,
)
from camring.compiler.memory import Buffer
from camring.compiler.numbers import WIDTH, element, in_memory, intrinsic, literal, row
from camring.compiler.primitives import pointwise
from camring.compiler.rows import (
    TRUTH,
    Here,
    LoopOver,
    Rows,
    Variable,
    flat_rows,
    key_of,
)
from camring.compiler.schedule import Loop


def write_loop(rows: Rows, loop: Loop, stored: set[int]) -> None:
    """The loop's code; nodes in `stored` have a buffer, into which each row goes at its end."""
    code = rows.code
    folds = {id(n): RunningFold(code, n) for n in loop.members if isinstance(n, Folded)}
    scans = {id(n): _begun(rows, n) for n in loop.members if isinstance(n, Scan)}
    gated = {id(node): gate for gate in gates(loop.members, stored) for node in gate.members}
    with LoopOver(code, loop.rows) as here:
        assert here.index is not None
        writes: list[tuple[str, np.dtype, Buffer]] = []
        for node in loop.members:
            if isinstance(node, Folded):
                folds[id(node)].take(rows.read(flat_rows(node.given), here))
            elif isinstance(node, Scan):
                _advance(rows, node, scans[id(node)], here)
            elif isinstance(node, Part):
                target = rows.shifted(rows.located(node.whole_of), node.first)
                writes.append((rows.read(flat_rows(node.given), here), node.dtype, target))
            elif id(node) in gated:
                if key_of(node) not in here.local and node in gated[id(node)].products:
                    _through(rows, gated[id(node)], here)
            elif not isinstance(node, Result):
                here.local[key_of(node)] = member(rows, node, here)
            if id(node) in stored and not isinstance(node, Folded | Scan | Part):
                writes.append((rows.read(node.whole(), here), node.dtype, rows.located(node)))
        for value, dtype, buffer in writes:
            rows.store(value, dtype, buffer, here.index)
    for node in loop.members:
        if isinstance(node, Folded):
            rows.single[key_of(node)] = folds[id(node)].end()
        if isinstance(node, Scan):
            for number, carried in enumerate(scans[id(node)]):
                rows.single[id(node), number] = carried.get()


def member(rows: Rows, node: Node, here: Here) -> str:
    """One row of a node."""
    if isinstance(node, Pointwise):
        given = [rows.read(flat_rows(each), here, node.lanes) for each in node.inputs]
        kinds = [each.dtype for each in node.inputs]
        return pointwise(rows.code, node.name, node.params, given, kinds, node.dtype, node.lanes)
    if isinstance(node, Taken):
        return _taken(rows, node, here)
    raise NotInLanes(f"no code for {type(node).__name__} here")


def _begun(rows: Rows, node: Scan) -> list[Variable]:
    """What a scan carries, before the first row."""
    carried = []
    for each in node.begin:
        variable = Variable(rows.code, each.dtype)
        variable.set(rows.read(each, Here()))
        carried.append(variable)
    return carried


def _advance(rows: Rows, node: Scan, carried: list[Variable], here: Here) -> None:
    within, inputs = here.within(), node.body.inputs
    for variable, given in zip(carried, inputs, strict=False):
        within.local[key_of(given)] = variable.get()
    for operand, given in zip(node.along, inputs[len(carried) :], strict=True):
        within.local[key_of(given)] = rows.read(operand, here)
    for each in node.body.nodes:
        within.local[key_of(each)] = member(rows, each, within)
    found = [rows.read(each, within) for each in node.body.outputs]
    for variable, value in zip(carried, found, strict=False):
        variable.set(value)
    for number, value in enumerate(found[len(carried) :], len(carried)):
        here.local[id(node), number] = value


def _through(rows: Rows, gate: Gate, here: Here) -> None:
    """What lies behind a gate, or zeros where its factor is zero in all lanes."""
    code, typed = rows.code, row(gate.factor.dtype)
    factor, zero = rows.read(flat_rows(gate.factor), here), literal(0, gate.factor.dtype, True)
    flowing = code.new(f"fcmp une {typed} {factor}, {zero}")
    some = code.call(intrinsic("vector.reduce.or", TRUTH, True), "i1", (row(TRUTH), flowing))
    opened, shut, after = code.name("open"), code.name("shut"), code.name("after")
    code.do(f"br i1 {some}, label %{opened}, label %{shut}")
    code.label(opened)
    within = here.within()  # what is loaded there is not known on the other way
    for node in gate.members:
        within.local[key_of(node)] = member(rows, node, within)
    code.do(f"br label %{after}")
    code.label(shut)
    code.do(f"br label %{after}")
    code.label(after)
    for each in gate.products:
        here.local[key_of(each)] = code.new(
            f"phi {row(each.dtype)} [ {within.local[key_of(each)]}, %{opened} ], "
            f"[ {literal(0, each.dtype, True)}, %{shut} ]"
        )


def _taken(rows: Rows, node: Taken, here: Here) -> str:
    code, wide, size = rows.code, f"<{WIDTH} x i64>", node.dtype.itemsize
    if node.dtype == TRUTH:
        raise NotInLanes("taking truths")
    table = rows.shifted(rows.located(node.table.node), int(node.table.rows.flat[0]))
    number = rows.read(flat_rows(node.number), here)
    if node.number.dtype.itemsize < 8:
        number = code.new(f"sext {row(node.number.dtype)} {number} to {wide}")
    offset = code.new(f"mul {wide} {number}, {rows.splat(table.stride, 'i64')}")
    lanes = ", ".join(f"i64 {size * lane}" for lane in range(WIDTH))
    offset = code.new(f"add {wide} {offset}, <{lanes}>")
    pointers = code.new(f"getelementptr i8, ptr {table.pointer}, {wide} {offset}")
    short = {"double": "f64", "float": "f32"}.get(element(node.dtype), in_memory(node.dtype))
    return code.call(
        f"@llvm.masked.gather.v{WIDTH}{short}.v{WIDTH}p0",
        row(node.dtype),
        (f"<{WIDTH} x ptr>", pointers),
        ("i32", str(size)),
        (row(TRUTH), "splat (i1 true)"),
        (row(node.dtype), "poison"),
    )
