"""A traced function as a graph of what is computed, and where each number is found.

Arrays have lanes along their last axis (`numerics/batch.py`). What lies before it is
counted in rows: an array of shape (3, 40, lane) has 120. A *node* computes rows; a
*view* says in which rows of a node an operand's numbers are. Slicing, reshaping,
broadcasting and rolling are therefore no work at all: they make another table of row
numbers, known before anything runs.
"""

from dataclasses import KW_ONLY, dataclass, field
from math import prod
from typing import Any

import numpy as np

EXPENSIVE = frozenset({"div", "sqrt"})
"""Instructions that a processor takes long for."""

Lead = tuple[int, ...]
"""The shape before the lanes."""


class NotInLanes(Exception):
    """The function has a step that has no code here; it must go another way."""


@dataclass(eq=False)
class Node:
    """Something computed: `rows` rows of numbers, or one number for all lanes."""

    lead: Lead
    dtype: np.dtype
    lanes: bool = True
    """Whether there is a number for each lane; one for all of them otherwise."""

    @property
    def rows(self) -> int:
        return prod(self.lead)

    @property
    def operands(self) -> list["Operand"]:
        return []

    def whole(self) -> "View":
        return View(self, np.arange(self.rows).reshape(self.lead))


@dataclass(eq=False)
class Constant:
    """Numbers known while the code is written, shape `lead`; the same in every lane."""

    values: np.ndarray

    @property
    def lead(self) -> Lead:
        return self.values.shape

    @property
    def dtype(self) -> np.dtype:
        return self.values.dtype


@dataclass(eq=False)
class View:
    """An operand: the rows of a node in which its numbers are, shape `lead`."""

    node: Node
    rows: np.ndarray

    @property
    def lead(self) -> Lead:
        return self.rows.shape

    @property
    def dtype(self) -> np.dtype:
        return self.node.dtype

    @property
    def as_it_is(self) -> bool:
        """Whether it is the whole node in its own order."""
        count = self.node.rows
        return self.rows.size == count and bool(np.all(self.rows.ravel() == np.arange(count)))


Operand = Constant | View


@dataclass(eq=False)
class Input(Node):
    """Given from outside, by its place."""

    _: KW_ONLY
    place: int


@dataclass(eq=False)
class Pointwise(Node):
    """An instruction done to every row alike."""

    _: KW_ONLY
    name: str
    inputs: list[Operand]
    params: dict[str, Any] = field(default_factory=dict)

    @property
    def operands(self) -> list[Operand]:
        return self.inputs


@dataclass(eq=False)
class Taken(Node):
    """In each lane the rows of some numbers."""

    _: KW_ONLY
    table: View
    number: Operand

    @property
    def operands(self) -> list[Operand]:
        return [self.number, self.table]


@dataclass(eq=False)
class OfOne(Node):
    """Computed from one operand."""

    _: KW_ONLY
    given: Operand

    @property
    def operands(self) -> list[Operand]:
        return [self.given]


@dataclass(eq=False, kw_only=True)
class Part(OfOne):
    """A part of a `Joined`, from row `first` on."""

    whole_of: "Joined"
    first: int


@dataclass(eq=False)
class Joined(Node):
    """Parts one behind the other."""

    parts: list[Part] = field(default_factory=list)

    @property
    def operands(self) -> list[Operand]:
        return [part.whole() for part in self.parts]


@dataclass(eq=False, kw_only=True)
class Folded(OfOne):
    """All rows of an operand added, or the largest or smallest; one row."""

    how: str


@dataclass(eq=False, kw_only=True)
class AcrossLanes(OfOne):
    """The largest, smallest or the sum of a row's lanes: one number for all."""

    how: str


@dataclass(eq=False, kw_only=True)
class Counted(OfOne):
    """How often each row's number is among some numbers, in each lane."""


@dataclass(eq=False, kw_only=True)
class Product(OfOne):
    """A constant matrix times rows; shape (row, term) times (term, *rest)."""

    matrix: np.ndarray
    given: View


@dataclass(eq=False)
class Region:
    """Nodes in an order in which they can be computed, and what they are computed for."""

    inputs: list[Input]
    nodes: list[Node]
    outputs: list[Operand]

    def outside(self) -> list[Operand]:
        """Views of nodes that belong to a region around this one."""
        own = {id(node) for node in (*self.nodes, *self.inputs)}
        used = [view for node in self.nodes for view in node.operands] + self.outputs
        return [view for view in used if isinstance(view, View) and id(view.node) not in own]


@dataclass(eq=False)
class Scan(Node):
    """Row after row with something carried along.

    Its `Result`s are first what is carried out of the last row, one row each, then what
    is left in each row.
    """

    _: KW_ONLY
    body: Region
    begin: list[Operand]
    along: list[Operand]

    @property
    def operands(self) -> list[Operand]:
        return [*self.begin, *self.along, *self.body.outside()]


@dataclass(eq=False)
class Rounds(Node):
    """The same for each entry of a first axis; its `Result`s have that axis in front."""

    _: KW_ONLY
    count: int
    body: Region
    along: list[View]

    @property
    def operands(self) -> list[Operand]:
        return [*self.along, *self.body.outside()]


@dataclass(eq=False)
class While(Node):
    """Repeated as long as a condition holds; its `Result`s are what it leaves behind."""

    _: KW_ONLY
    condition: Region
    body: Region
    begin: list[Operand]

    @property
    def operands(self) -> list[Operand]:
        return [*self.begin, *self.condition.outside(), *self.body.outside()]


@dataclass(eq=False)
class Result(Node):
    """One of the things that a node with several leaves."""

    _: KW_ONLY
    of: Scan | Rounds | While
    number: int

    @property
    def operands(self) -> list[Operand]:
        return [View(self.of, np.zeros((), int))]
