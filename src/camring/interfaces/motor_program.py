"""One compiled program for all motors of the same counts and laws, whatever they are called."""

from collections.abc import Callable
from copy import copy
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import jax

from camring.interfaces.kept_program import KeptProgram
from camring.physics.motor import Motor

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def motor_program(
    function: Callable[Arguments, Result], compiler_options: dict[str, Any] | None = None
) -> Callable[Arguments, Result]:
    """The function compiled and kept (`KeptProgram`); motors in its result have no name.

    A name is no number. As part of a program it would make another one for each motor
    file; see `named` for giving it back.
    """
    kept = KeptProgram(function, compiler_options)

    @wraps(function)
    def called(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        args, kwargs = named((args, kwargs), "")
        return kept(*args, **kwargs)

    return called


def named(tree: Result, name: str) -> Result:
    """The same with this name for every motor in it."""

    def is_motor(node: object) -> bool:
        return isinstance(node, Motor)

    def rename(node: Any) -> Any:
        if not is_motor(node) or node.name == name:
            return node
        other = copy(node)  # `dataclasses.replace` would convert every number anew
        object.__setattr__(other, "name", name)
        return other

    return jax.tree.map(rename, tree, is_leaf=is_motor)
