"""Reading and writing rows of a graph's nodes, in loops and outside of any."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from camring.compiler.graph import Constant, Node, NotInLanes, Operand, Result, View
from camring.compiler.instructions import Instructions
from camring.compiler.memory import Buffer, Memory, Span
from camring.compiler.numbers import WIDTH, element, in_memory, literal, row

Key: TypeAlias = tuple[int, int]

TRUTH = np.dtype(bool)


def key_of(node: Node) -> Key:
    """What a node's rows are found by; a `Result` is one of several things of its node."""
    return (id(node.of), node.number) if isinstance(node, Result) else (id(node), 0)


@dataclass
class Here:
    """Where code is being written: within a loop at row `index`, or outside of any."""

    index: str | None = None
    local: dict[Key, str] = field(default_factory=dict)
    """Rows that this pass of the loop has computed."""
    loaded: dict[tuple, str] = field(default_factory=dict)
    places: dict[bytes, str] = field(default_factory=dict)

    def within(self) -> "Here":
        """What is known here, but not what will be known there."""
        return Here(self.index, dict(self.local), dict(self.loaded), dict(self.places))


class Rows:
    """Knows where the rows of every node are, and writes code that reads and writes them."""

    def __init__(self) -> None:
        self.code = Instructions()
        self.memory = Memory()
        self.buffers: dict[Key, Buffer] = {}
        self.single: dict[Key, str] = {}
        """Single rows, and single numbers, that are in registers."""
        self._tables: dict[bytes, str] = {}
        self.tables: list[str] = []
        """Known numbers that the code looks up, as LLVM's text."""

    def buffer(self, rows: int, dtype: np.dtype) -> tuple[Span, Buffer]:
        """Working memory for some rows."""
        stride = WIDTH * np.dtype(dtype).itemsize
        span = self.memory.take(rows * stride)
        pointer = self.code.new(f"getelementptr i8, ptr %work, i64 {span.first}")
        return span, Buffer(pointer, str(stride), min(stride, 64))

    def read(self, operand: Operand, here: Here, lanes: bool = True) -> str:
        """An operand's numbers at the present row; its rows in the order of the loop's."""
        if isinstance(operand, Constant):
            return self._read_constant(operand.values.ravel(), here, lanes)
        node, rows = operand.node, operand.rows.ravel()
        key = key_of(node)
        if key in here.local and (rows.size == 1 or operand.as_it_is):
            return here.local[key]
        if key in self.single:
            value = self.single[key]
            if not lanes or node.lanes:
                return value
            return self._remembered(here, ("splat", value), lambda: self._wide(value, node))
        if here.index is None or bool(np.all(rows == rows[0])):
            place = str(int(rows[0]))
            memo: tuple = (key, place)
        else:
            place, memo = self._place(rows, here), (key, rows.tobytes())
        return self._remembered(
            here,
            memo,
            lambda: self.load(self.located(node), node.dtype, place, lanes or node.lanes),
        )

    def _wide(self, value: str, node: Node) -> str:
        return self.splat(value, element(node.dtype))

    def _remembered(self, here: Here, memo: tuple, write: Callable[[], str]) -> str:
        """What has been loaded at this row already need not be loaded again."""
        if memo not in here.loaded:
            here.loaded[memo] = write()
        return here.loaded[memo]

    def _read_constant(self, values: np.ndarray, here: Here, lanes: bool) -> str:
        if len(values) == 1 or np.all(values == values[0]):
            return literal(values[0], values.dtype, lanes)
        if here.index is None:
            raise NotInLanes("several rows where one is wanted")
        memo = ("known", values.tobytes(), str(values.dtype), lanes)
        return self._remembered(here, memo, lambda: self._looked_up(values, here, lanes))

    def _looked_up(self, values: np.ndarray, here: Here, lanes: bool) -> str:
        kind = in_memory(values.dtype)
        pointer = self.code.new(f"getelementptr {kind}, ptr {self.table(values)}, i64 {here.index}")
        value = self.code.new(f"load {kind}, ptr {pointer}")
        if values.dtype == TRUTH:
            value = self.code.new(f"trunc i8 {value} to i1")
        return self.splat(value, element(values.dtype)) if lanes else value

    def _place(self, rows: np.ndarray, here: Here) -> str:
        """Number of the row that a view has at the present row."""
        code, first = self.code, int(rows[0])
        memo = rows.tobytes()
        if memo in here.places:
            return here.places[memo]
        steps, period = np.arange(len(rows)), int(rows.max() - first + 1)
        if np.array_equal(rows, steps + first):
            place = code.new(f"add i64 {here.index}, {first}") if first else str(here.index)
        elif np.array_equal(rows, first + steps % period):
            place = code.new(f"urem i64 {here.index}, {period}")
            place = code.new(f"add i64 {place}, {first}") if first else place
        else:
            table = self.table(rows.astype(np.int32))
            pointer = code.new(f"getelementptr i32, ptr {table}, i64 {here.index}")
            place = code.new(f"load i32, ptr {pointer}, align 4")
            place = code.new(f"sext i32 {place} to i64")
        here.places[memo] = place
        return place

    def located(self, node: Node) -> Buffer:
        """Where a node's rows lie in memory."""
        try:
            return self.buffers[key_of(node)]
        except KeyError:
            raise NotInLanes(f"rows of {type(node).__name__} that were not stored") from None

    def table(self, values: np.ndarray) -> str:
        """Known numbers in the program itself; the same ones are there once."""
        values = np.ascontiguousarray(values)
        kind = in_memory(values.dtype)
        key = kind.encode() + values.tobytes()
        if key not in self._tables:
            raw = values.astype(np.int8) if values.dtype == TRUTH else values
            each = ", ".join(f"{kind} {literal(value, raw.dtype, False)}" for value in raw.ravel())
            self._tables[key] = name = f"@table{len(self._tables)}"
            size = f"[{values.size} x {kind}]"
            self.tables.append(f"{name} = private unnamed_addr constant {size} [{each}], align 64")
        return self._tables[key]

    def splat(self, value: str, kind: str) -> str:
        """One number in every lane."""
        if not value.startswith("%"):
            return f"splat ({kind} {value})"
        typed = f"<{WIDTH} x {kind}>"
        one = self.code.new(f"insertelement {typed} poison, {kind} {value}, i64 0")
        return self.code.new(
            f"shufflevector {typed} {one}, {typed} poison, <{WIDTH} x i32> zeroinitializer"
        )

    def shifted(self, buffer: Buffer, rows: int | str) -> Buffer:
        """The same memory from a later row on."""
        if rows == 0:
            return buffer
        offset = self.code.new(f"mul i64 {buffer.stride}, {rows}")
        pointer = self.code.new(f"getelementptr i8, ptr {buffer.pointer}, i64 {offset}")
        return Buffer(pointer, buffer.stride, buffer.alignment)

    def load(self, buffer: Buffer, dtype: np.dtype, place: str, lanes: bool = True) -> str:
        pointer, kind = self._address(buffer, place), in_memory(dtype)
        typed = f"<{WIDTH} x {kind}>" if lanes else kind
        value = self.code.new(f"load {typed}, ptr {pointer}, align {buffer.alignment}")
        if dtype == TRUTH:
            value = self.code.new(f"trunc {typed} {value} to {row(dtype, lanes)}")
        return value

    def store(self, value: str, dtype: np.dtype, buffer: Buffer, place: str) -> None:
        typed = row(dtype)
        if dtype == TRUTH:
            value = self.code.new(f"zext {typed} {value} to <{WIDTH} x i8>")
            typed = f"<{WIDTH} x i8>"
        pointer = self._address(buffer, place)
        self.code.do(f"store {typed} {value}, ptr {pointer}, align {buffer.alignment}")

    def _address(self, buffer: Buffer, place: str) -> str:
        offset = self.code.new(f"mul i64 {place}, {buffer.stride}")
        return self.code.new(f"getelementptr inbounds i8, ptr {buffer.pointer}, i64 {offset}")

    def copy(self, source: Operand, target: Buffer) -> None:
        """All rows of an operand, one behind the other."""
        flat = flat_rows(source)
        (count,) = flat.lead
        if count == 1:
            self.store(self.read(flat, Here()), source.dtype, target, "0")
            return
        with LoopOver(self.code, count) as here:
            assert here.index is not None
            self.store(self.read(flat, here), source.dtype, target, here.index)


class Variable:
    """Something that code sets again and again; LLVM turns it into a register."""

    def __init__(self, code: Instructions, dtype: np.dtype, lanes: bool = True) -> None:
        self._code, self._typed = code, row(dtype, lanes)
        self._slot = code.reserve(self._typed)

    def set(self, value: str) -> None:
        self._code.do(f"store {self._typed} {value}, ptr {self._slot}")

    def get(self) -> str:
        return self._code.new(f"load {self._typed}, ptr {self._slot}")


class LoopOver:
    """A loop over rows; the code written within is done for each."""

    def __init__(self, code: Instructions, rows: int) -> None:
        self._code, self._rows = code, rows

    def __enter__(self) -> Here:
        code = self._code
        self._head, self._after = code.name("loop"), code.name("end")
        self._index = Variable(code, np.dtype(np.int64), lanes=False)
        self._index.set("0")
        code.do(f"br label %{self._head}")
        code.label(self._head)
        self._now = self._index.get()
        return Here(self._now)

    def __exit__(self, *_: object) -> None:
        code = self._code
        following = code.new(f"add nuw nsw i64 {self._now}, 1")
        self._index.set(following)
        goes_on = code.new(f"icmp ult i64 {following}, {self._rows}")
        code.do(f"br i1 {goes_on}, label %{self._head}, label %{self._after}")
        code.label(self._after)


def flat_rows(operand: Operand) -> Operand:
    """The same in one axis."""
    if isinstance(operand, Constant):
        return Constant(operand.values.reshape(-1))
    return View(operand.node, operand.rows.reshape(-1))
