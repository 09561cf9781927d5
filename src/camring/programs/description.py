"""What makes one compiled program another one, in words that the next process finds again."""

import dataclasses
import hashlib
from collections.abc import Iterator
from enum import Enum
from functools import lru_cache
from pathlib import Path
from types import BuiltinFunctionType, FunctionType
from typing import Any

import jax
import numpy as np

KNOWN = frozenset({"builtins", "camring", "equinox", "jax", "jaxlib", "numpy"})
"""Packages of which source or version are part of a description."""

MODEL = ("numerics", "compiler", "geometry", "physics", "metrics", "objective")
"""Packages that know nothing of the others."""


class Indescribable(Exception):
    """Something whose source is not known here, or that has no lasting name."""


def described(value: Any) -> str:
    """Everything that a trace of a function can see of its arguments, except numbers in arrays.

    Raises
    ------
    Indescribable
        For an object of a class, or a function, that is not this package's own.
    """
    return "".join(_words(value))


def _words(value: Any) -> Iterator[str]:
    if isinstance(value, jax.Array | np.ndarray | np.generic | jax.ShapeDtypeStruct):
        yield f"{value.dtype}{value.shape}{getattr(value, 'weak_type', False)};"
    elif value is None or type(value) in (bool, int, float, complex, str, bytes):
        yield f"{value!r};"
    elif isinstance(value, type | FunctionType | BuiltinFunctionType):
        yield f"{_name(value)};"
    elif isinstance(value, Enum):
        yield f"{_name(type(value))}.{value.name};"
    elif type(value) is dict:
        yield from _group("dict", [each for item in value.items() for each in item])
    elif isinstance(value, tuple) or type(value) is list:
        yield from _group(_name(type(value)), list(value))
    elif dataclasses.is_dataclass(value):
        parts = [(field.name, getattr(value, field.name)) for field in dataclasses.fields(value)]
        yield from _group(_name(type(value)), [each for part in parts for each in part])
    else:
        raise Indescribable(f"{type(value).__module__}.{type(value).__qualname__}")


def _group(name: str, parts: list[Any]) -> Iterator[str]:
    yield f"{name}["
    for each in parts:
        yield from _words(each)
    yield "]"


def _name(value: Any) -> str:
    name = f"{value.__module__}.{value.__qualname__}"
    package, _, rest = value.__module__.partition(".")
    if package not in KNOWN or "<" in name:
        raise Indescribable(name)
    if package != "camring":
        return name
    return f"{name} {_source(*MODEL) if rest.partition('.')[0] in MODEL else _source('.')}"


@lru_cache
def _source(*folders: str) -> str:
    """A word for every line in some folders of the package."""
    digest = hashlib.sha256()
    package = Path(__file__).parents[1]
    for folder in folders:
        for source in sorted((package / folder).rglob("*.py")):
            digest.update(str(source.relative_to(package)).encode() + source.read_bytes())
    return digest.hexdigest()
