"""What need not be computed where it is multiplied by zero.

A port that is shut in all lanes of a row lets nothing through, whatever the pressure. Its
area is known before the loop: where it is zero, roots and divisions of its flow are left out.
"""

from dataclasses import dataclass, field

from camring.compiler.building import differs_by_row
from camring.compiler.graph import EXPENSIVE, Node, Pointwise, View

WORTH = 2
"""Expensive instructions that a branch must be able to leave out."""


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
        if not isinstance(node, Pointwise) or node.name != "mul" or node.dtype.kind != "f":
            continue
        for factor in _factors(node, inside):
            key = id(factor.node), factor.rows.tobytes()
            by_factor.setdefault(key, Gate(factor, [])).products.append(node)
    found: list[Gate] = []
    taken: set[int] = set()
    for gate in by_factor.values():
        gate.members = _only_for(gate, members, readers, stored)
        expensive = sum(isinstance(n, Pointwise) and n.name in EXPENSIVE for n in gate.members)
        free = not any(id(node) in taken for node in gate.members)
        if expensive >= WORTH and free and _before(gate, members, inside):
            found.append(gate)
            taken.update(id(node) for node in gate.members)
    return found


def _factors(product: Pointwise, inside: dict[int, int]) -> list[View]:
    """The factor of a product that was known before the loop and differs from row to row.

    None where there are two of them, or where the other one was known, too.
    """
    views = [each for each in product.inputs if isinstance(each, View)]
    computed = [each for each in views if id(each.node) in inside]
    known = [each for each in views if id(each.node) not in inside and differs_by_row(each)]
    return known if len(known) == len(computed) == 1 else []


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
