"""What need not be computed where it is multiplied by zero.

A port that is shut in all eight lanes lets nothing through, whatever the pressure. Its
area is known before the loop: where it is zero, roots and divisions of its flow are left out.
"""

from dataclasses import dataclass, field

from camring.numerics.native.graph import Constant, Node, Operand, Pointwise, View

DEAR = frozenset({"sqrt", "div"})
WORTH = 2
"""Dear instructions that a branch must be able to leave out."""


@dataclass(eq=False)
class Gate:
    """Nodes of a loop that count only where some factor is not zero."""

    factor: View
    products: list[Pointwise]
    members: list[Node] = field(default_factory=list)
    """The products and all that only they read, in order."""


def gates(members: list[Node], stored: set[int]) -> list[Gate]:
    """Gates of a loop's members, none of them within another."""
    inside = {id(node): place for place, node in enumerate(members)}
    readers: dict[int, list[Node]] = {id(node): [] for node in members}
    for node in members:
        for each in node.operands:
            if isinstance(each, View) and id(each.node) in inside:
                readers[id(each.node)].append(node)
    by_factor: dict[tuple, Gate] = {}
    for node in members:
        factor = _factor(node, inside)
        if factor is not None:
            key = id(factor.node), factor.rows.tobytes()
            gate = by_factor.setdefault(key, Gate(factor, []))
            gate.products.append(node)  # type: ignore[arg-type]
    found: list[Gate] = []
    taken: set[int] = set()
    for gate in by_factor.values():
        gate.members = _only_for(gate, members, readers, stored)
        dear = sum(isinstance(n, Pointwise) and n.name in DEAR for n in gate.members)
        free = not any(id(node) in taken for node in gate.members)
        if dear >= WORTH and free and _before(gate, members, inside):
            found.append(gate)
            taken.update(id(node) for node in gate.members)
    return found


def _factor(node: Node, inside: dict[int, int]) -> View | None:
    """The factor of a product that was known before the loop and differs from row to row."""
    if not isinstance(node, Pointwise) or node.name != "mul" or node.dtype.kind != "f":
        return None
    known = [each for each in node.inputs if _known_rows(each, inside)]
    others = [each for each in node.inputs if isinstance(each, View) and id(each.node) in inside]
    return known[0] if len(known) == 1 and len(others) == 1 else None  # type: ignore[return-value]


def _known_rows(operand: Operand, inside: dict[int, int]) -> bool:
    if isinstance(operand, Constant) or id(operand.node) in inside:
        return False
    return bool((operand.rows != operand.rows.flat[0]).any())


def _only_for(
    gate: Gate, members: list[Node], readers: dict[int, list[Node]], stored: set[int]
) -> list[Node]:
    own = {id(node) for node in gate.products}
    for node in reversed(members):
        if id(node) in own or id(node) in stored or not isinstance(node, Pointwise):
            continue
        if readers[id(node)] and all(id(reader) in own for reader in readers[id(node)]):
            own.add(id(node))
    return [node for node in members if id(node) in own]


def _before(gate: Gate, members: list[Node], inside: dict[int, int]) -> bool:
    """Whether all that the gate's members need comes before the first of its products."""
    own = {id(node) for node in gate.members}
    first = min(inside[id(node)] for node in gate.products)
    return all(
        inside[id(each.node)] < first
        for node in gate.members
        for each in node.operands
        if isinstance(each, View) and id(each.node) in inside and id(each.node) not in own
    )
