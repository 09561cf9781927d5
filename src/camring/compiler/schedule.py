"""In what order a graph is computed, and what shares a loop.

Rows that are computed from rows of the same number share one loop, whatever else has to
wait: what a loop computes for itself never leaves the registers, and what several later
loops read is stored once. That is what makes the difference to a compiler that fuses
each result's own history and computes it again for the next result.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import prod

from camring.compiler.graph import (
    Constant,
    Folded,
    Joined,
    Node,
    NotInLanes,
    Part,
    Pointwise,
    Result,
    Scan,
    Taken,
    View,
)


@dataclass(eq=False)
class Loop:
    """Nodes computed row by row, together."""

    rows: int
    members: list[Node]


Step = Node | Loop


def nodes_of(step: Step) -> list[Node]:
    """Those that a step computes."""
    return step.members if isinstance(step, Loop) else [step]


def row_by_row(reader: Node, view: View) -> bool:
    """Whether a node needs of an operand, at each row, that very row."""
    whole = isinstance(reader, Taken) and view is reader.table
    first = isinstance(reader, Scan) and any(view is begin for begin in reader.begin)
    return view.as_it_is and not whole and not first


def schedule(nodes: list[Node]) -> list[Step]:
    """Steps that compute the nodes, given in an order in which they could be."""
    steps: list[Step] = []
    waiting = {id(node) for node in nodes}
    rest = list(nodes)
    while rest:
        later = []
        for node in rest:  # what needs no loop, as early as possible
            if not in_loop(node) and _ready(node, waiting):
                if not isinstance(node, Joined | Result):
                    steps.append(node)
                waiting.discard(id(node))
            else:
                later.append(node)
        moved, rest = len(later) < len(rest), later
        begin = (node for node in rest if in_loop(node) and _ready(node, waiting))
        first = next(begin, None)
        if first is None:
            if rest and not moved:
                raise NotInLanes("steps that wait for each other")
            continue
        loop = Loop(loop_rows(first), [])
        inside: set[int] = set()
        for node in rest:
            if in_loop(node) and loop_rows(node) == loop.rows and _joins(node, waiting, inside):
                loop.members.append(node)
                inside.add(id(node))
        waiting -= inside
        rest = [node for node in rest if id(node) not in inside]
        steps.append(loop)
    _sink(steps)
    return [step for step in steps if not isinstance(step, Loop) or step.members]


def in_loop(node: Node) -> bool:
    """Whether a node is computed row by row."""
    if isinstance(node, Folded | Scan | Part):
        return True
    if isinstance(node, Result):
        return isinstance(node.of, Scan) and bool(node.lead)
    return isinstance(node, Pointwise | Taken) and node.rows > 1


def loop_rows(node: Node) -> int:
    """Rows of the loop that it belongs to."""
    return prod(node.given.lead) if isinstance(node, Folded) else node.rows


def leaves_rows(node: Node) -> bool:
    """Whether each row that a loop member computes can be read in the same pass."""
    return not isinstance(node, Folded | Scan)


def _ready(node: Node, waiting: set[int]) -> bool:
    return all(id(each.node) not in waiting for each in _views(node))


def _joins(node: Node, waiting: set[int], inside: set[int]) -> bool:
    if isinstance(node, Result):
        return id(node.of) in inside
    for each in _views(node):
        if id(each.node) not in waiting:
            continue
        there = id(each.node) in inside and leaves_rows(each.node)
        if not there or not row_by_row(node, each):
            return False
    return True


def _views(node: Node) -> Iterable[View]:
    return (each for each in node.operands if not isinstance(each, Constant))


def _sink(steps: list[Step]) -> None:
    """Moves what only one later loop reads into it, where all it needs is stored anyway."""
    place: dict[int, int] = {}
    for number, step in enumerate(steps):
        for node in nodes_of(step):
            place[id(node)] = number
    readers: dict[int, set[int]] = {}
    direct: dict[int, bool] = {}
    for number, step in enumerate(steps):
        for node in nodes_of(step):
            for each in _views(node):
                readers.setdefault(id(each.node), set()).add(number)
                direct[id(each.node)] = direct.get(id(each.node), True) and row_by_row(node, each)
    for number in range(len(steps) - 1, -1, -1):
        step = steps[number]
        if not isinstance(step, Loop):
            continue
        for node in reversed(list(step.members)):
            if not isinstance(node, Pointwise):
                continue
            at = readers.get(id(node), set())
            if len(at) != 1 or not direct[id(node)]:
                continue
            (target,) = at
            other = steps[target]
            if target == number or not isinstance(other, Loop) or other.rows != step.rows:
                continue
            if all(_stored(each, number, place, readers) for each in _views(node)):
                step.members.remove(node)
                other.members.insert(0, node)
                place[id(node)] = target
                for each in _views(node):
                    readers[id(each.node)].add(target)


def _stored(view: View, here: int, place: dict[int, int], readers: dict[int, set[int]]) -> bool:
    return place.get(id(view.node)) != here or bool(readers[id(view.node)] - {here})
