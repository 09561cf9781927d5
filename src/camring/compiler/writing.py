"""LLVM code for a graph: loops over rows, as many lanes in each instruction as a register holds.

One function does all blocks of lanes, one after the other. What a block computes for
itself lies in a working memory that is small enough for a core's own cache.
"""

import numpy as np

from camring.compiler.graph import (
    AcrossLanes,
    Constant,
    Counted,
    Input,
    Node,
    NotInLanes,
    Operand,
    Part,
    Pointwise,
    Product,
    Region,
    Result,
    Rounds,
    Taken,
    View,
    While,
)
from camring.compiler.loops import member, write_loop
from camring.compiler.memory import Buffer, Span
from camring.compiler.numbers import WIDTH, element, intrinsic, literal, row
from camring.compiler.products import write_count, write_product
from camring.compiler.rows import Here, LoopOver, Rows, Variable, key_of
from camring.compiler.schedule import Loop, Step, leaves_rows, nodes_of, row_by_row, schedule

ENTRY = "camring_lanes"

Spans = list[tuple[Node, Span]]
"""Working memory, and the node whose readers decide how long it is kept."""


def write(region: Region) -> tuple[str, int]:
    """The code of a function, as LLVM's text, and the bytes of working memory it needs."""
    writer = _Writer()
    code = writer.code
    code.do("br label %begin")
    code.label("begin")
    block = code.new("phi i64 [ %first, %start ], [ %following, %next ]")
    more = code.new(f"icmp slt i64 {block}, %last")
    code.do(f"br i1 {more}, label %block, label %done")
    code.label("block")
    for given in region.inputs:
        writer.take_in(given, block)
    writer.region(region)
    for number, output in enumerate(region.outputs):
        writer.copy(output, writer.outside("%outputs", number, output.dtype, block))
    code.do("br label %next")
    code.label("next")
    code.do(f"%following = add i64 {block}, 1")
    code.do("br label %begin")
    code.label("done")
    code.do("ret void")
    head = (
        f"define void @{ENTRY}(ptr noalias %inputs, ptr noalias %outputs, ptr noalias %work, "
        "i64 %lanes, i64 %first, i64 %last) #0 {\nstart:"
    )
    wide = '"prefer-vector-width"="512" "min-legal-vector-width"="512"'
    text = [
        *writer.tables,
        *sorted(code.declared),
        head,
        *code.reserved,
        *code.lines,
        "}",
        f"attributes #0 = {{ nounwind {wide} }}",
    ]
    return "\n".join(text) + "\n", writer.memory.size


class _Writer(Rows):
    def take_in(self, node: Input, block: str) -> None:
        """One of the function's arguments; a single number is read at once."""
        buffer = self.outside("%inputs", node.place, node.dtype, block if node.lanes else "0")
        if node.lanes:
            self.buffers[key_of(node)] = buffer
        else:
            self.single[key_of(node)] = self.load(buffer, node.dtype, "0", False)

    def outside(self, table: str, number: int, dtype: np.dtype, block: str) -> Buffer:
        """Where this block's lanes of an argument or result lie."""
        code, size = self.code, dtype.itemsize
        slot = code.new(f"getelementptr ptr, ptr {table}, i64 {number}")
        base = code.new(f"load ptr, ptr {slot}, align 8")
        offset = code.new(f"mul i64 {block}, {WIDTH * size}")
        pointer = code.new(f"getelementptr i8, ptr {base}, i64 {offset}")
        return Buffer(pointer, code.new(f"mul i64 %lanes, {size}"), size)

    def region(self, region: Region, carried: bool = False) -> Spans:
        """All steps of a region; working memory that nobody reads any more is used again.

        Where what comes out is `carried` to the next round, rows go straight to where they
        are read from then, if nobody needs what lies there any more. Returns what is still in
        use when all is done.
        """
        steps = schedule(region.nodes)
        stored, last = _uses(steps, region)
        if carried:
            for given, output in zip(region.inputs, region.outputs, strict=True):
                if _may_replace(steps, region, given, output):
                    assert isinstance(output, View)
                    self.buffers[key_of(output.node)] = self.buffers[key_of(given)]
        spans: Spans = []
        for number, step in enumerate(steps):
            if isinstance(step, Loop):
                for node in step.members:
                    spans += self._span_for(node, stored)
                write_loop(self, step, stored)
            else:
                spans += self._straight(step)
            ended = [span for node, span in spans if last.get(id(node), -1) <= number]
            spans = [each for each in spans if last.get(id(each[0]), -1) > number]
            self.memory.give_back(ended)
        return spans

    def _span_for(self, node: Node, stored: set[int]) -> Spans:
        """Working memory for what a loop leaves for later."""
        owner = node.whole_of if isinstance(node, Part) else node
        needed = isinstance(node, Part) or (leaves_rows(node) and id(node) in stored)
        if not needed or key_of(owner) in self.buffers:
            return []
        span, self.buffers[key_of(owner)] = self.buffer(owner.rows, owner.dtype)
        return [(owner, span)]

    def _straight(self, node: Node) -> Spans:
        """A step that is no loop of its own kind."""
        if isinstance(node, Pointwise | Taken):
            self.single[key_of(node)] = member(self, node, Here())
        elif isinstance(node, AcrossLanes):
            self.single[key_of(node)] = self._across(node)
        elif isinstance(node, Product | Counted):
            span, target = self.buffer(node.rows, node.dtype)
            self.buffers[key_of(node)] = target
            if isinstance(node, Product):
                write_product(self, node, target)
            else:
                write_count(self, node, target)
            return [(node, span)]
        elif isinstance(node, While):
            return self._repetition(node)
        elif isinstance(node, Rounds):
            return self._rounds(node)
        else:
            raise NotInLanes(f"no code for {type(node).__name__}")
        return []

    def _across(self, node: AcrossLanes) -> str:
        value, typed, dtype = self.read(node.given, Here()), row(node.dtype), node.dtype
        how = {
            "f": {"max": "fmaximum", "min": "fminimum", "add": "fadd"},
            "u": {"max": "umax", "min": "umin"},
            "b": {"max": "or", "min": "and"},
            "i": {"max": "smax", "min": "smin"},
        }[dtype.kind].get(node.how, node.how)
        name = intrinsic(f"vector.reduce.{how}", dtype, True)
        start = [(element(dtype), literal(0, dtype, False))] if how == "fadd" else []
        return self.code.call(name, element(dtype), *start, (typed, value))

    def _rounds(self, node: Rounds) -> Spans:
        """One entry of the first axis after the other; what comes out lies one behind the other."""
        spans: Spans = []
        results: list[Buffer] = []
        for number, output in enumerate(node.body.outputs):
            rows = node.count * int(np.prod(output.lead, dtype=int))
            span, buffer = self.buffer(rows, output.dtype)
            self.buffers[id(node), number] = buffer
            spans.append((node, span))
            results.append(buffer)
        with LoopOver(self.code, node.count) as here:
            for view, given in zip(node.along, node.body.inputs, strict=True):
                whole = self.shifted(self.located(view.node), int(view.rows.flat[0]))
                self.buffers[key_of(given)] = self._entry(whole, here, given.rows)
            rest = self.region(node.body)
            for output, buffer in zip(node.body.outputs, results, strict=True):
                rows = int(np.prod(output.lead, dtype=int))
                self.copy(output, self._entry(buffer, here, rows))
            self.memory.give_back([span for _, span in rest])
        return spans

    def _entry(self, buffer: Buffer, here: Here, rows: int) -> Buffer:
        return self.shifted(buffer, self.code.new(f"mul i64 {here.index}, {rows}"))

    def _repetition(self, node: While) -> Spans:
        code, inputs = self.code, node.body.inputs
        spans: Spans = []
        variables: dict[int, Variable] = {}
        for place, (operand, given) in enumerate(zip(node.begin, inputs, strict=True)):
            if given.rows == 1:
                variables[place] = Variable(code, given.dtype, given.lanes)
                variables[place].set(self.read(operand, Here(), given.lanes))
            else:
                span, buffer = self.buffer(given.rows, given.dtype)
                self.buffers[key_of(given)] = self.buffers[id(node), place] = buffer
                spans.append((node, span))
                self.copy(operand, buffer)
        asked, again, after = code.name("asked"), code.name("again"), code.name("after")
        code.do(f"br label %{asked}")
        code.label(asked)
        self._carry_in(node.condition.inputs, variables)
        rest = self.region(node.condition)
        goes_on = self.read(node.condition.outputs[0], Here(), False)
        self.memory.give_back([span for _, span in rest])
        code.do(f"br i1 {goes_on}, label %{again}, label %{after}")
        code.label(again)
        self._carry_in(inputs, variables)
        rest = self.region(node.body, carried=True)
        self._carry_over(node.body, variables)
        self.memory.give_back([span for _, span in rest])
        code.do(f"br label %{asked}")
        code.label(after)
        for place, variable in variables.items():
            self.single[id(node), place] = variable.get()
        return spans

    def _carry_in(self, inputs: list[Input], variables: dict[int, Variable]) -> None:
        for place, variable in variables.items():
            self.single[key_of(inputs[place])] = variable.get()

    def _carry_over(self, body: Region, variables: dict[int, Variable]) -> None:
        """What a round leaves is what the next one begins with."""
        new = {
            place: self.read(body.outputs[place], Here(), body.inputs[place].lanes)
            for place in variables
        }
        for place, value in new.items():
            variables[place].set(value)
        for place, (given, output) in enumerate(zip(body.inputs, body.outputs, strict=True)):
            if place in variables or self._in_place(output, given):
                continue
            if isinstance(output, View) and isinstance(output.node, Input):
                raise NotInLanes("carried rows that change places")
            self.copy(output, self.buffers[key_of(given)])

    def _in_place(self, output: Operand, given: Input) -> bool:
        if not isinstance(output, View) or not output.as_it_is:
            return False
        return self.buffers.get(key_of(output.node)) is self.buffers[key_of(given)]


def _uses(steps: list[Step], region: Region) -> tuple[set[int], dict[int, int]]:
    """Nodes that must lie in memory, and the last step that reads each."""
    stored: set[int] = set()
    last: dict[int, int] = {}

    def read(node: Node, number: int) -> None:
        last[id(node)] = max(number, last.get(id(node), -1))
        if isinstance(node, Result):
            last[id(node.of)] = max(number, last.get(id(node.of), -1))

    for number, step in enumerate(steps):
        together = {id(node) for node in nodes_of(step)} if isinstance(step, Loop) else set()
        for node in nodes_of(step):
            for each in node.operands:
                if isinstance(each, Constant):
                    continue
                read(each.node, number)
                if id(each.node) not in together or not row_by_row(node, each):
                    stored.add(id(each.node))
    for output in region.outputs:
        if isinstance(output, View):
            read(output.node, len(steps))
            stored.add(id(output.node))
    return stored, last


def _may_replace(steps: list[Step], region: Region, given: Input, output: Operand) -> bool:
    """Whether an output may be written over an input, row by row."""
    if given.rows == 1 or not isinstance(output, View) or not output.as_it_is:
        return False
    node = output.node
    views = [each for each in region.outputs if isinstance(each, View)]
    if not isinstance(node, Pointwise) or sum(each.node in (node, given) for each in views) != 1:
        return False
    loops = [k for k, step in enumerate(steps) if isinstance(step, Loop) and node in step.members]
    if not loops:
        return False
    for place, step in enumerate(steps):
        for reader in nodes_of(step):
            for each in reader.operands:
                if isinstance(each, Constant) or each.node is not given or place < loops[0]:
                    continue
                if place > loops[0] or not row_by_row(reader, each):
                    return False
    return True
