"""One compiled program for all motors of the same counts and laws, whatever they are called."""

from collections.abc import Callable
from concurrent.futures import Future
from copy import copy
from functools import lru_cache, wraps
from typing import Any, ParamSpec, TypeVar

import jax

from camring.objective.objective import Goal
from camring.physics.motor import Motor
from camring.programs.kept_program import KeptProgram

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


_kept: dict[Callable[..., Any], KeptProgram[..., Any]] = {}


def motor_program(
    function: Callable[Arguments, Result], compiler_options: dict[str, Any] | None = None
) -> Callable[Arguments, Result]:
    """The function compiled and kept (`KeptProgram`); motors in its result have no name.

    A name is no number. As part of a program it would make another one for each motor
    file; see `named` for giving it back. Nor is a limit or a weight part of it, but data.
    """
    kept: KeptProgram[Arguments, Result] = KeptProgram(function, compiler_options)

    @wraps(function)
    def called(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        args, kwargs = bare(args, kwargs)
        return kept(*args, **kwargs)

    _kept[called] = kept
    return called


def begin(program: Callable[..., Any], *args: Any) -> "Future[Any]":
    """Compiles a `motor_program` beside what else is done; see `KeptProgram.begin`."""
    args, _ = bare(args, {})
    return _kept[program].begin(*args)


def bare(args: Any, kwargs: Any) -> Any:
    """Arguments as a program is given them: motors without names, the numbers of goals as data."""
    args = tuple(map(_as_data, args))
    kwargs = {name: _as_data(each) for name, each in kwargs.items()}
    return named((args, kwargs), "")


def _as_data(argument: Any) -> Any:
    if not isinstance(argument, Goal):
        return argument
    try:
        return _goal_as_data(argument)
    except TypeError:  # arrays, as of one whose weights are differentiated, have no hash
        return argument


@lru_cache(maxsize=64)
def _goal_as_data(goal: Goal) -> Goal:
    return goal.as_data()


def named(tree: Result, name: str) -> Result:
    """The same with this name for every motor in it."""
    leaves, structure = jax.tree.flatten(tree)
    other = _named(structure, name)
    return tree if other == structure else jax.tree.unflatten(other, leaves)


@lru_cache(maxsize=512)
def _named(structure: Any, name: str) -> Any:
    """A tree's structure, of which names are part: found once, where a call is made often."""

    def is_motor(node: object) -> bool:
        return isinstance(node, Motor)

    def rename(node: Any) -> Any:
        if not is_motor(node) or node.name == name:
            return node
        other = copy(node)  # `dataclasses.replace` would convert every number
        object.__setattr__(other, "name", name)
        return other

    tree = jax.tree.unflatten(structure, [0.0] * structure.num_leaves)
    return jax.tree.structure(jax.tree.map(rename, tree, is_leaf=is_motor))
