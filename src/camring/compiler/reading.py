"""From a traced function to its graph."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.extend.core import ClosedJaxpr, Jaxpr, Literal

from camring.compiler.building import (
    TRACED_LANES,
    Builder,
    Flattened,
    Wanted,
    constant,
    has_lanes,
    lead_of,
    mapped,
)
from camring.compiler.elementary import ELEMENTARY
from camring.compiler.graph import (
    AcrossLanes,
    Constant,
    Input,
    Node,
    NotInLanes,
    Operand,
    Pointwise,
    Region,
    Result,
    Rounds,
    Scan,
    View,
    While,
)
from camring.compiler.plain_numbers import PLAIN
from camring.compiler.primitives import ROW_BY_ROW
from camring.compiler.steps import FOLDS, STEPS, fold
from camring.compiler.views import VIEWS

SAME = frozenset(["stop_gradient", "copy", "copy_p", "device_put", "optimization_barrier"])
INSIDE = {
    "jit": "jaxpr",
    "pjit": "jaxpr",
    "closed_call": "call_jaxpr",
    "core_call": "call_jaxpr",
    "remat": "jaxpr",
    "remat2": "jaxpr",
    "checkpoint": "jaxpr",
    "custom_jvp_call": "call_jaxpr",
    "custom_vjp_call": "call_jaxpr",
}
"""Primitives that are another function, and where they have it."""


def trace(function: Callable, arguments: Any) -> tuple[ClosedJaxpr, Any]:
    """A function of arrays with lanes, and the shape of its results."""

    def widened(leaf: Any) -> Any:
        leaf = np.asarray(leaf) if np.isscalar(leaf) else leaf
        shape = (*leaf.shape[:-1], TRACED_LANES) if leaf.shape else ()
        if TRACED_LANES in leaf.shape[:-1]:
            raise NotInLanes(f"an axis of {TRACED_LANES}")
        return jax.ShapeDtypeStruct(shape, jnp.result_type(leaf))

    return jax.make_jaxpr(function, return_shape=True)(jax.tree.map(widened, arguments))


def read(traced: ClosedJaxpr) -> Region:
    """The graph of a function; its inputs and outputs in order.

    Raises
    ------
    NotInLanes
        For a primitive, or a use of one, that there is no code for.
    """
    reader = _Reader()
    inputs = [reader.input(place, var.aval) for place, var in enumerate(traced.jaxpr.invars)]
    outputs = reader.run(traced.jaxpr, traced.consts, [each.whole() for each in inputs])
    for variable, output in zip(traced.jaxpr.outvars, outputs, strict=True):
        _refuse_flattened([output])
        if not has_lanes(variable.aval.shape) and not _largest_of_blocks(output):
            raise NotInLanes("one number for all lanes that blocks of them cannot tell")
    return Region(inputs, _needed(reader.nodes, outputs), outputs)


class _Reader(Builder):
    """Goes through a function, primitive by primitive."""

    def run(
        self, jaxpr: Jaxpr, consts: Sequence[Any], arguments: Sequence[Operand]
    ) -> list[Operand]:
        values: dict[Any, Operand] = dict(zip(jaxpr.invars, arguments, strict=True))
        values.update(zip(jaxpr.constvars, map(constant, consts), strict=True))

        def value(var: Any) -> Operand:
            return constant(var.val) if isinstance(var, Literal) else values[var]

        for equation in jaxpr.eqns:
            found = self.step(equation, [value(var) for var in equation.invars])
            values.update(zip(equation.outvars, found, strict=True))
        return [value(var) for var in jaxpr.outvars]

    def step(self, equation: Any, given: list[Operand]) -> list[Operand]:
        name, params = equation.primitive.name, equation.params
        if name in INSIDE:
            inner = params[INSIDE[name]]
            closed = inner if isinstance(inner, ClosedJaxpr) else ClosedJaxpr(inner, ())
            return self.run(closed.jaxpr, closed.consts, given)
        if name in SAME:
            return list(given)
        control = {"cond": self.branch, "scan": self.scan, "while": self.repetition}.get(name)
        if control is not None:
            _refuse_flattened(given)
            return control(params, given)
        if len(equation.outvars) != 1:
            raise NotInLanes(f"no code for `{name}`")
        return [self.single(equation, given)]

    def single(self, equation: Any, given: list[Operand]) -> Operand:
        """A primitive with one result."""
        name, params = equation.primitive.name, equation.params
        aval = equation.outvars[0].aval
        if all(isinstance(each, Constant) for each in given):
            return _known(equation, given)
        if any(isinstance(each, Flattened) for each in given):
            return _of_flattened(name, given)
        wanted = Wanted(lead_of(aval.shape), np.dtype(aval.dtype), params)
        more = VIEWS.get(name) or STEPS.get(name)
        if more is not None:
            return more(self, given, wanted)
        if name in FOLDS:
            return fold(self, FOLDS[name], given[0], params["axes"], wanted.dtype)
        if name in ROW_BY_ROW:
            keys = {"integer_pow": ("y",), "round": ("rounding_method",)}.get(name, ())
            kept = {key: params[key] for key in keys}
            return self.pointwise(name, given, wanted.lead, wanted.dtype, **kept)
        if name in ELEMENTARY:
            inner = _elementary(name, tuple((v.aval.shape, v.aval.dtype) for v in equation.invars))
            return self.run(inner.jaxpr, inner.consts, given)[0]
        raise NotInLanes(f"no code for `{name}`")

    def branch(self, params: dict, given: list[Operand]) -> list[Operand]:
        """One that is known beforehand, as in `computed_once`."""
        which, *arguments = given
        if not isinstance(which, Constant):
            raise NotInLanes("a branch that is chosen by a number")
        taken = params["branches"][int(which.values)]
        return self.run(taken.jaxpr, taken.consts, arguments)

    def region(self, closed: ClosedJaxpr, consts: list[Operand], inputs: list[Input]) -> Region:
        inner = _Reader(self)
        arguments = [*consts, *(inner.own(each).whole() for each in inputs)]
        outputs = inner.run(closed.jaxpr, closed.consts, arguments)
        _refuse_flattened(outputs)
        return Region(inputs, _needed(inner.nodes, outputs), outputs)

    def scan(self, params: dict, given: list[Operand]) -> list[Operand]:
        """Row by row where single rows are carried and read; else round by round."""
        fixed, carries, length = params["num_consts"], params["num_carry"], params["length"]
        closed, backwards = params["jaxpr"], params["reverse"]
        variables = closed.jaxpr.invars[fixed:]
        inputs = [self.input(place, var.aval) for place, var in enumerate(variables)]
        begin, along = given[fixed : fixed + carries], given[fixed + carries :]
        if backwards:
            along = [mapped(each, lambda rows: rows[::-1]) for each in along]
        body = self.region(closed, given[:fixed], inputs)
        plain = all(not node.lead and isinstance(node, Pointwise) for node in body.nodes)
        node: Scan | Rounds
        if plain and not any(each.lead for each in inputs):
            node = Scan((length,), np.dtype(float), body=body, begin=begin, along=along)
        elif carries or not all(isinstance(each, View) for each in along):
            raise NotInLanes("a scan that carries more than single rows")
        else:
            views = [self.following(each) for each in along if isinstance(each, View)]
            node = Rounds((), np.dtype(float), count=length, body=body, along=views)
        self.add(node)
        found: list[Operand] = []
        for number, output in enumerate(closed.jaxpr.outvars):
            lead, dtype = lead_of(output.aval.shape), np.dtype(output.aval.dtype)
            lead = lead if number < carries else (length, *lead)
            result = self.add(Result(lead, dtype, of=node, number=number))
            turned = backwards and number >= carries
            found.append(mapped(result, lambda rows: rows[::-1]) if turned else result)
        return found

    def repetition(self, params: dict, given: list[Operand]) -> list[Operand]:
        asked, fixed = params["cond_nconsts"], params["body_nconsts"]
        condition, body = params["cond_jaxpr"], params["body_jaxpr"]
        variables = body.jaxpr.invars[fixed:]
        inputs = [self.input(place, var.aval) for place, var in enumerate(variables)]
        asking = self.region(condition, given[:asked], inputs)
        doing = self.region(body, given[asked : asked + fixed], inputs)
        loop = While(
            (), np.dtype(float), condition=asking, body=doing, begin=given[asked + fixed :]
        )
        self.add(loop)
        return [
            self.add(Result(each.lead, each.dtype, each.lanes, of=loop, number=number))
            for number, each in enumerate(inputs)
        ]


@lru_cache(maxsize=64)
def _elementary(name: str, seen: tuple[tuple[tuple[int, ...], Any], ...]) -> ClosedJaxpr:
    """An elementary function of arrays of these shapes and types, in plain arithmetic."""
    return jax.make_jaxpr(ELEMENTARY[name])(*(jax.ShapeDtypeStruct(*each) for each in seen))


def _known(equation: Any, given: list[Operand]) -> Constant:
    """Done here and now. Lanes of a constant are not kept: it is the same in all."""
    kinds = [var.aval.dtype for var in equation.outvars]
    if any(jax.dtypes.issubdtype(kind, jax.dtypes.extended) for kind in kinds):
        raise NotInLanes(f"no code for `{equation.primitive.name}`")
    arrays = []
    for var, operand in zip(equation.invars, given, strict=True):
        assert isinstance(operand, Constant)
        shape = var.aval.shape
        values = operand.values[..., None] if has_lanes(shape) else operand.values
        arrays.append(np.broadcast_to(values, shape))
    plain = PLAIN.get(equation.primitive.name)
    if plain is not None:
        (var,) = equation.outvars
        found = plain(*arrays, **equation.params)
        return constant(np.broadcast_to(found, var.aval.shape).astype(var.aval.dtype))
    with jax.ensure_compile_time_eval():
        found = equation.primitive.bind(*arrays, **equation.params)
        return constant(found[0] if equation.primitive.multiple_results else found)


def _of_flattened(name: str, given: list[Operand]) -> Operand:
    """What `computed_once` asks of rows and lanes in one axis, of which nothing counts."""
    first = next(each for each in given if isinstance(each, Flattened))
    others = [each for each in given if each is not first]
    negative = all(isinstance(each, Constant) and np.all(each.values < 0) for each in others)
    if name == "lt" and first is given[0] and first.modulus and negative:
        return Constant(np.zeros((), bool))  # no modulus is below a negative number
    return Flattened(first.node, first.rows, modulus=name == "abs")


def _refuse_flattened(operands: list[Operand]) -> None:
    if any(isinstance(each, Flattened) for each in operands):
        raise NotInLanes("rows and lanes in one axis, or some of the lanes")


def _largest_of_blocks(output: Operand) -> bool:
    """Whether the largest of what each block says is what all lanes together would."""
    if isinstance(output, Constant):
        return True
    node = output.node
    if isinstance(node, AcrossLanes):
        return node.how in ("max", "or")
    counts = isinstance(node, Result) and isinstance(node.of, While)
    return isinstance(node, Input) or (counts and node.dtype.kind in "iu")


def _needed(nodes: list[Node], outputs: Sequence[Operand]) -> list[Node]:
    wanted = {id(each.node) for each in outputs if isinstance(each, View)}
    kept = []
    for node in reversed(nodes):
        if id(node) in wanted:
            kept.append(node)
            wanted.update(id(each.node) for each in node.operands if isinstance(each, View))
    return kept[::-1]
