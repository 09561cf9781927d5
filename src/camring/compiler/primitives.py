"""What a processor does for each of JAX's primitives that works row by row."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from camring.compiler.graph import NotInLanes
from camring.compiler.instructions import Instructions
from camring.compiler.numbers import WIDTH, element, intrinsic, literal, row

TRUTH = np.dtype(bool)

FLAGS = "contract arcp"
"""A product and a sum may round once, a quotient may be a product with the inverse."""


@dataclass(frozen=True)
class Step:
    """One primitive on rows, or on single numbers where there are no lanes."""

    code: Instructions
    name: str
    given: list[str]
    kinds: list[np.dtype]
    result: np.dtype
    lanes: bool
    params: dict[str, Any] = field(default_factory=dict)

    @property
    def kind(self) -> np.dtype:
        """Of what is computed with."""
        return self.kinds[-1] if self.name == "select_n" else self.kinds[0]

    @property
    def typed(self) -> str:
        return row(self.kind, self.lanes)

    @property
    def real(self) -> bool:
        return self.kind.kind == "f"

    def number(self, value: Any) -> str:
        """A known number of the same type."""
        return literal(value, self.kind, self.lanes)

    def plain(self, instruction: str, *given: str) -> str:
        return self.code.new(f"{instruction} {self.typed} {', '.join(given)}")

    def function(self, name: str, *given: str, flags: str = "") -> str:
        """One of LLVM's own, of numbers of the same type."""
        pairs = [(self.typed, each) for each in given]
        called = intrinsic(name, self.kind, self.lanes)
        return self.code.call(called, self.typed, *pairs, flags=flags)

    def either(self, choice: str, yes: str, no: str) -> str:
        truth, typed = row(TRUTH, self.lanes), self.typed
        return self.code.new(f"select {truth} {choice}, {typed} {yes}, {typed} {no}")


def pointwise(
    code: Instructions,
    name: str,
    params: dict[str, Any],
    given: list[str],
    kinds: list[np.dtype],
    result: np.dtype,
    lanes: bool,
) -> str:
    """Writes a primitive; the name of what it gives.

    Raises
    ------
    NotInLanes
        For numbers that it has no code for.
    """
    step = Step(code, name, given, kinds, result, lanes, params)
    try:
        return _PRIMITIVES[name](step)
    except KeyError:
        raise NotInLanes(f"no code for `{name}` of {step.kind}") from None


def _arithmetic(step: Step) -> str:
    if step.kind == TRUTH:
        raise NotInLanes(f"no code for `{step.name}` of truths")
    return step.plain(f"f{step.name} {FLAGS}" if step.real else step.name, *step.given)


def _quotient(step: Step) -> str:
    return _arithmetic(step) if step.real else _whole_quotient(step)


def _rest(step: Step) -> str:
    """Of a division, exact; no number where the quotient has more digits than numbers have."""
    if not step.real:
        return _whole_rest(step)
    value, by = step.given
    whole = step.function("trunc", step.plain("fdiv", value, by))
    rest = step.function("fma", step.plain("fneg", whole), by, value)
    # A quotient rounded up to a whole number leaves a rest of the other sign.
    signed = step.function("copysign", rest, value)
    crossed = step.plain("fcmp one", rest, signed)
    more = step.function("copysign", step.function("fabs", by), value)
    found = step.either(crossed, step.plain("fadd", rest, more), signed)
    found = step.either(step.plain("fcmp oeq", whole, step.number(0)), value, found)
    digits = {8: 52, 4: 23}[step.kind.itemsize]
    few = step.plain("fcmp olt", step.function("fabs", whole), step.number(2.0**digits))
    return step.either(few, found, step.number(np.nan))


def _extreme(step: Step) -> str:
    if step.kind == TRUTH:
        return step.plain("or" if step.name == "max" else "and", *step.given)
    name = {"f": f"{step.name}imum", "i": f"s{step.name}", "u": f"u{step.name}"}
    return step.function(name[step.kind.kind], *step.given)


def _compared(step: Step) -> str:
    if step.real:
        return step.plain("fcmp une" if step.name == "ne" else f"fcmp o{step.name}", *step.given)
    sign = "u" if step.kind.kind in "ub" else "s"
    return step.plain(
        f"icmp {step.name if step.name in ('eq', 'ne') else sign + step.name}", *step.given
    )


def _modulus(step: Step) -> str:
    if step.real:
        return step.function("fabs", *step.given)
    called = intrinsic("abs", step.kind, step.lanes)
    return step.code.call(called, step.typed, (step.typed, step.given[0]), ("i1", "false"))


def _negative(step: Step) -> str:
    if step.real:
        return step.plain("fneg", *step.given)
    return step.plain("sub", step.number(0), *step.given)


def _sign(step: Step) -> str:
    (value,) = step.given
    one = step.number(1)
    if step.real:
        off = step.plain("fcmp one", value, step.number(0))  # neither nil nor no number
        return step.either(off, step.function("copysign", one, value), value)
    if step.kind.kind == "u":
        return step.function("umin", value, one)
    return step.function("smax", step.function("smin", value, one), step.number(-1))


def _rounded(step: Step) -> str:
    to_even = int(step.params["rounding_method"]) == 1
    return step.function("roundeven" if to_even else "round", *step.given)


def _power(step: Step) -> str:
    power = int(step.params["y"])
    if power == 0:
        return step.number(1)
    times = "fmul" if step.real else "mul"
    total, square, left = None, step.given[0], abs(power)
    while left:
        if left & 1:
            total = square if total is None else step.plain(times, total, square)
        left >>= 1
        if left:
            square = step.plain(times, square, square)
    assert total is not None
    return total if power > 0 else step.plain(f"fdiv {FLAGS}", step.number(1), total)


def _choice(step: Step) -> str:
    if step.kinds[0] != TRUTH:
        raise NotInLanes("a choice by number")
    choice, no, yes = step.given
    return step.either(choice, yes, no)


def _finite(step: Step) -> str:
    return step.plain("fcmp olt", step.function("fabs", *step.given), step.number(np.inf))


def _not(step: Step) -> str:
    return step.plain("xor", *step.given, step.number(True if step.kind == TRUTH else -1))


def _of_bits(step: Step) -> str:
    to = row(step.result, step.lanes)
    return step.code.new(f"bitcast {step.typed} {step.given[0]} to {to}")


def _shifted(step: Step) -> str:
    """By more than there are digits: none of them are left."""
    value, count = step.given
    digits = 8 * step.kind.itemsize
    how = {"shift_left": "shl", "shift_right_logical": "lshr"}.get(step.name, "ashr")
    found = step.plain(how, value, step.function("umin", count, step.number(digits - 1)))
    if how == "ashr":
        return found
    return step.either(step.plain("icmp ult", count, step.number(digits)), found, step.number(0))


def _careful(step: Step) -> tuple[str, str]:
    """A divisor that no processor refuses, and whether the given one is zero."""
    value, by = step.given
    none = refused = step.plain("icmp eq", by, step.number(0))
    if step.kind.kind == "i":
        truth = row(TRUTH, step.lanes)
        lowest = step.plain("icmp eq", value, step.number(np.iinfo(step.kind).min))
        minus = step.plain("icmp eq", by, step.number(-1))
        beyond = step.code.new(f"and {truth} {lowest}, {minus}")
        refused = step.code.new(f"or {truth} {none}, {beyond}")
    return step.either(refused, step.number(1), by), none


def _whole_quotient(step: Step) -> str:
    """All digits one where the divisor is zero, as JAX has it."""
    if step.kind == TRUTH:
        raise NotInLanes("no code for `div` of truths")
    safe, none = _careful(step)
    unsigned = step.kind.kind == "u"
    found = step.plain("udiv" if unsigned else "sdiv", step.given[0], safe)
    return step.either(none, step.number(np.iinfo(step.kind).max if unsigned else -1), found)


def _whole_rest(step: Step) -> str:
    """The number itself where the divisor is zero, as JAX has it."""
    safe, none = _careful(step)
    found = step.plain("urem" if step.kind.kind == "u" else "srem", step.given[0], safe)
    return step.either(none, step.given[0], found)


def _converted(step: Step) -> str:
    before, after, (value,) = step.kind, step.result, step.given
    if before == after:
        return value
    if after == TRUTH:
        return step.plain("fcmp une" if step.real else "icmp ne", value, step.number(0))
    if before.kind == "f" and after.kind != "f":
        return _saturated(step)
    if before.kind == "f":
        how = "fptrunc" if after.itemsize < before.itemsize else "fpext"
    elif after.kind == "f":
        how = "sitofp" if before.kind == "i" else "uitofp"
    elif before == TRUTH or (before.kind == "u" and after.itemsize > before.itemsize):
        how = "zext"
    elif after.itemsize == before.itemsize:
        return value
    else:
        how = "trunc" if after.itemsize < before.itemsize else "sext"
    return step.code.new(f"{how} {step.typed} {value} to {row(after, step.lanes)}")


def _saturated(step: Step) -> str:
    """The nearest whole number there is room for, and zero for what is no number."""
    how = "fptosi.sat" if step.result.kind == "i" else "fptoui.sat"
    short = {"double": "f64", "float": "f32"}[element(step.kind)]
    many = f"v{WIDTH}" if step.lanes else ""
    name = f"@llvm.{how}.{many}{element(step.result)}.{many}{short}"
    return step.code.call(name, row(step.result, step.lanes), (step.typed, step.given[0]))


_PRIMITIVES: dict[str, Callable[[Step], str]] = {
    "same": lambda step: step.given[0],
    **dict.fromkeys(("add", "sub", "mul"), _arithmetic),
    "div": _quotient,
    "rem": _rest,
    **dict.fromkeys(("max", "min"), _extreme),
    **dict.fromkeys(("lt", "le", "gt", "ge", "eq", "ne"), _compared),
    **dict.fromkeys(("and", "or", "xor"), lambda step: step.plain(step.name, *step.given)),
    **dict.fromkeys(("sqrt", "floor", "ceil"), lambda s: s.function(s.name, *s.given, flags=FLAGS)),
    **dict.fromkeys(("shift_left", "shift_right_logical", "shift_right_arithmetic"), _shifted),
    "abs": _modulus,
    "neg": _negative,
    "not": _not,
    "sign": _sign,
    "round": _rounded,
    "integer_pow": _power,
    "select_n": _choice,
    "is_finite": _finite,
    "convert_element_type": _converted,
    "bitcast_convert_type": _of_bits,
}

ROW_BY_ROW = frozenset(_PRIMITIVES)
"""Names of JAX's primitives that there is an instruction for, or a few."""
