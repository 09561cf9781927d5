"""Which of a program's arguments it computes with, and which are part of it."""

from collections.abc import Callable, Hashable, Sequence
from enum import Enum
from typing import Any

import jax
import numpy as np

DEBUGGING = ("jax_disable_jit", "jax_debug_nans", "jax_debug_infs")


class Kind(Enum):
    """What a leaf is by its type."""

    ARRAY = "array"
    TRACED = "traced"
    PART = "part of the program"


_kinds: dict[type, Kind] = {}


def kind_of(leaf: Any) -> Kind:
    """Asked for each type once: `isinstance` of JAX's arrays takes longer than all the rest."""
    found = _kinds.get(type(leaf))
    if found is None:
        found = _kinds[type(leaf)] = _kind_of(leaf)
    return found


def is_array(leaf: Any) -> bool:
    """Whether a leaf is traced; all others are part of the program."""
    return kind_of(leaf) is not Kind.PART


def split(
    leaves: Sequence[Any], form_of: Callable[[Any], Hashable]
) -> tuple[list[Any], tuple[Hashable, ...]] | None:
    """The arrays among some leaves, and what of all of them makes another program.

    Parameters
    ----------
    form_of
        What of an array does.

    Returns
    -------
    None where a function must run as it stands: within another that is being traced, or to look
    for a mistake.
    """
    arrays, forms = [], []
    for leaf in leaves:
        kind = kind_of(leaf)
        if kind is Kind.TRACED:
            return None
        if kind is Kind.ARRAY:
            arrays.append(leaf)
            forms.append(form_of(leaf))
        else:
            forms.append((type(leaf), leaf))
    if any(getattr(jax.config, name) for name in DEBUGGING):
        return None
    return arrays, tuple(forms)


def whole_form(array: Any) -> Hashable:
    """What of an array makes another program of JAX's."""
    form = getattr(array, "aval", array)
    return form.shape, form.dtype, getattr(form, "weak_type", False)


def _kind_of(leaf: Any) -> Kind:
    if isinstance(leaf, jax.core.Tracer):
        return Kind.TRACED
    array = isinstance(leaf, jax.Array | np.ndarray | np.generic | jax.ShapeDtypeStruct)
    return Kind.ARRAY if array else Kind.PART
