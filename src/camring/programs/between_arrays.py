"""A function between two lists of arrays, and the tree that its answers belong into.

Machine code knows arrays alone; all else in arguments and result is part of a program.
"""

from collections.abc import Callable, Iterable
from typing import Any

import jax

from camring.programs.leaves import is_array


class _Place:
    """Stands in a result for one of the program's arrays."""


class Program:
    """Machine code between lists of arrays, and the tree that its answers belong into."""

    def __init__(self, call: Callable[[list[Any]], list[Any]], result: Any) -> None:
        self._call = call
        self._leaves, self._structure = jax.tree.flatten(result)

    def __call__(self, arrays: list[Any]) -> Any:
        return filled(self._leaves, self._structure, self._call(arrays))


def filled(leaves: list[Any], structure: Any, answers: Iterable[Any]) -> Any:
    """A tree with a program's answers in their places."""
    ordered = iter(answers)
    whole = [next(ordered) if isinstance(leaf, _Place) else leaf for leaf in leaves]
    return jax.tree.unflatten(structure, whole)


class ResultTree:
    """The tree of a function's result, known once the function has been traced."""

    tree: Any = None


def between_arrays(function: Callable, given: Any) -> tuple[Callable[[list], list], ResultTree]:
    """A function of the arrays in some arguments alone, all else being part of it.

    What comes back besides it is filled in when the function is traced.
    """
    leaves, structure = jax.tree.flatten(given)
    result = ResultTree()

    def called(chosen: list[Any]) -> list[Any]:
        places = iter(chosen)
        filled = [next(places) if is_array(leaf) else leaf for leaf in leaves]
        args, kwargs = jax.tree.unflatten(structure, filled)
        answer = function(*args, **kwargs)
        result.tree = jax.tree.map(lambda leaf: _Place() if is_array(leaf) else leaf, answer)
        return [leaf for leaf in jax.tree.leaves(answer) if is_array(leaf)]

    called.__name__ = function.__name__  # in JAX's logs and profiles
    return called, result
