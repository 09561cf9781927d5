"""Commands that fill a folder after long work, and go on with it another day."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camring.evaluation.answers import Remember
    from camring.evaluation.unfinished import Request
    from camring.files.motor import MotorFile


def requested(command: str, motor: Path, **options: Any) -> "tuple[Request, MotorFile]":
    """A command as it was given, with the motor file as it is now.

    Raises
    ------
    InputError
        When the file cannot be read.
    """
    from camring.evaluation.unfinished import Request
    from camring.files.motor import read_motor_file

    file = read_motor_file(motor)
    return Request(command, file.text, str(motor), options), file


@contextmanager
def work_on(
    request: "Request", out: Path | None
) -> "Iterator[tuple[Remember, Callable[[str], None]]]":
    """Who remembers its answers, and who says how far it is; see `Unfinished`."""
    from camring.evaluation.answers import forget
    from camring.evaluation.progress import SIMULATING, Spoken
    from camring.evaluation.unfinished import Unfinished

    with Spoken(SIMULATING) as say:
        if out is None:
            yield forget, say
            return
        with Unfinished(out, request) as work:
            if work.known:
                say(f"Going on with what {work.place.name} holds: {work.known} answers.")
            yield work.remember, say


def go_on(request: "Request", out: Path, *, as_json: bool) -> int:
    """Ends what a command has begun; the exit code."""
    from camring.evaluation.unfinished import done
    from camring.files.motor import parse_motor_file
    from camring.files.visible import say

    if out.exists():  # it was stopped at its very end
        done(out)
        say(f"{out} stands whole; there is nothing left to do.", err=as_json)
        return 0
    file = parse_motor_file(request.motor, Path(request.path))
    carry_out: Callable[..., int]
    carry_out = import_module(f"camring.cli.{request.command}").carry_out
    return carry_out(request, file, out, as_json=as_json)
