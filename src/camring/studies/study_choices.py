"""What the caller of a study chose in place of its file: method, and who evaluates designs."""

import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.fmu import command_for
from camring.files.errors import InputError, quote
from camring.files.motor import MotorFile
from camring.files.motor.entries import Unfit
from camring.files.motor.evaluator_table import USUAL_TIMEOUT, EvaluatorTable
from camring.files.motor.goal_tables import GRADIENT, METHODS, SCBO
from camring.files.named_units import read_units


def command_of(
    motor_file: MotorFile,
    evaluator: str | Sequence[str] | UserCommand | None,
    timeout: str | float | None,
    units: Mapping[str, str] | None = None,
) -> UserCommand | None:
    """The program that evaluates designs; None when our simulation does.

    Raises
    ------
    InputError
        When it cannot be run, or the time cannot be read.
    """
    table = motor_file.evaluator
    if evaluator is None and table is None:
        if timeout is not None:
            raise InputError("--timeout", "has no effect without --evaluator", "give both")
        if units:
            raise InputError("--unit", "has no effect without --evaluator", "give both")
        return None
    named = read_units(units or {}, "--unit")
    patience = USUAL_TIMEOUT if table is None else table.timeout
    if timeout is not None:
        patience = _seconds(timeout)
    if isinstance(evaluator, UserCommand):
        command = evaluator
    elif evaluator is not None:
        command = UserCommand(_words(evaluator), patience, os.getcwd(), named)
    else:
        assert table is not None
        folder = Path(motor_file.path).resolve().parent
        words = command_for(folder / table.fmu) if table.fmu else table.command or []
        named = tuple({**(table.units or {}), **dict(named)}.items())
        command = UserCommand(tuple(words), patience, str(folder), named)
    command.require_runnable()
    return command


def method_of(motor_file: MotorFile, method: str | None, command: UserCommand | None) -> str:
    """How designs are sought; without slopes a trust region unless another is named.

    Raises
    ------
    InputError
        When there is no such method, or it needs slopes and there are none.
    """
    if method is not None and method not in METHODS:
        raise InputError("method", f"is {method!r}", f"choose one of {', '.join(METHODS)}")
    if command is None:
        return motor_file.search.method if method is None else method
    if method == GRADIENT:
        raise InputError(
            "method",
            f"is {quote(method)}, which needs slopes that `{command}` does not give",
            f"leave it out, or choose {SCBO}",
        )
    chosen = motor_file.search.method if method is None else method
    return SCBO if chosen == GRADIENT else chosen


def _words(evaluator: str | Sequence[str]) -> tuple[str, ...]:
    try:
        # On Windows a backslash separates folders.
        words = (
            shlex.split(evaluator, posix=os.name != "nt")
            if isinstance(evaluator, str)
            else evaluator
        )
    except ValueError as error:
        raise InputError(
            "--evaluator", f"is {quote(evaluator)}: {str(error).lower()}", "close every quote"
        ) from None
    if not words or not words[0]:
        raise InputError("--evaluator", "is empty", 'give such as "python my_model.py"')
    return tuple(map(str, words))


def _seconds(timeout: str | float) -> float:
    entry = next(e for e in EvaluatorTable.model_fields["timeout"].metadata if hasattr(e, "read"))
    try:
        return float(entry.read(_plain(timeout)))
    except Unfit as error:
        raise InputError(f"--timeout{error.inside}", error.problem, error.way_out) from None


def _plain(timeout: str | float) -> str | float:
    """On a command line 60 arrives as text."""
    try:
        return float(timeout)
    except ValueError:
        return timeout
