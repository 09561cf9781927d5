"""Nouns as people read them: a line for every number, with its unit."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import jax
import numpy as np

DIGITS = 6


def readable(noun: Any) -> str:
    """Kind and numbers of a noun, parts indented: what `repr` shows of it."""
    return "\n".join([type(noun).__name__, *_lines(noun, "  ")])


def written_fields(noun: Any) -> Iterator[tuple[str, str, str]]:
    """Name, value and SI unit of each field that is no part with fields of its own."""
    units = units_of(noun.__class__)
    for each in fields(noun):
        value = getattr(noun, each.name)
        if not is_dataclass(value):
            yield each.name, written_value(value), units.get(each.name, "")


def written_value(value: Any) -> str:
    """A number, the range of many, or what else there is, short."""
    if isinstance(value, jax.core.Tracer):
        return f"(traced, shape {value.shape})"
    if not isinstance(value, jax.Array | np.ndarray | np.generic | float):
        return repr(value)
    numbers = np.asarray(value)
    if numbers.ndim == 0:
        return f"{numbers[()]:.{DIGITS}g}"
    if not numbers.size:
        return "none"
    low, high = numbers.min(), numbers.max()
    span = f"{low:.{DIGITS}g} to {high:.{DIGITS}g}" if low != high else f"{low:.{DIGITS}g}"
    return f"{span} (shape {numbers.shape})"


@cache
def units_of(kind: type) -> dict[str, str]:
    """SI units of a noun's numbers as people write them; none for plain numbers."""
    return {
        name: "" if get_args(hint)[1] == "1" else str(get_args(hint)[1]).replace(".", " ")
        for name, hint in get_type_hints(kind, include_extras=True).items()
        if get_origin(hint) is Annotated
    }


def _lines(noun: Any, indent: str) -> Iterator[str]:
    units = units_of(noun.__class__)
    for each in fields(noun):
        value = getattr(noun, each.name)
        parts = value if isinstance(value, tuple) else (value,)
        if any(is_dataclass(part) for part in parts):
            for part in parts:
                yield f"{indent}{each.name}: {type(part).__name__}"
                yield from _lines(part, indent + "  ")
        elif not (value is None or (isinstance(value, str | tuple) and not value)):
            unit = units.get(each.name, "")
            yield f"{indent}{each.name}: {written_value(value)} {unit}".rstrip()


__all__ = ["readable", "units_of", "written_fields", "written_value"]
