"""The command line: finds the commands, and turns errors into a sentence and an exit code.

Each command is one module in `commands` that holds a function of the module's
name; it imports what is heavy inside that function, so that `--help` answers at
once.

Exit codes: 0 done, 1 failed, 2 bad input, 3 infeasible or not validated, 130 interrupted.
"""

import atexit
import gc
import os
import shlex
import sys
from importlib import import_module
from typing import Annotated, Any, NoReturn

import typer
from typer.core import TyperGroup

from camring.evaluation.interrupt import EXIT_CODE as INTERRUPTED
from camring.evaluation.interrupt import end_at_once, end_promptly, was_interrupted
from camring.files.errors import CamringError
from camring.files.visible import say
from camring.programs.compilation_cache import keep_compiled_programs
from camring.version import __version__

COMMANDS = (
    "new",
    "check",
    "simulate",
    "map",
    "sweep",
    "compare",
    "optimise",
    "layouts",
    "pareto",
    "sensitivities",
    "tolerance",
    "robust",
    "fit",
    "resume",
    "report",
    "export",
    "studio",
)
DEBUG = "CAMRING_DEBUG"
FAILED = 1


class _Commands(TyperGroup):
    """Runs one command; whatever goes wrong in it ends as one sentence on stderr."""

    def invoke(self, ctx: Any) -> Any:
        keep_compiled_programs()
        try:
            return super().invoke(ctx)
        except CamringError as error:
            raise typer.Exit(_say(str(error), error.exit_code, error)) from error
        except KeyboardInterrupt as error:
            raise typer.Exit(_say("Interrupted.", INTERRUPTED, error)) from error
        except BrokenPipeError as error:
            # Whoever read our output has gone; the interpreter must not try again at exit.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(FAILED) from error
        except Exception as error:
            if _is_the_command_line_librarys_own(error):
                raise
            sentence = (
                f"{type(error).__name__}: {_first_line(error)} This is a fault of camring, not "
                f"yours; {DEBUG}=1 {_command_line()} shows where it happened."
            )
            raise typer.Exit(_say(sentence, FAILED, error)) from error


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        say(f"camring {__version__}")
        raise typer.Exit


@app.callback()
def _camring(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Better cam rings and valve timing for radial-piston hydraulic motors.

    Begin with `camring new motor.toml`, check it with `camring check motor.toml`,
    and let `camring optimise motor.toml --out study` find a better one.
    """


for _name in COMMANDS:
    app.command(_name)(getattr(import_module(f"camring.cli.{_name}"), _name))


def main() -> NoReturn:
    """Runs the command line of this process."""
    code = FAILED
    end_promptly()
    # What reads a motor's laws makes objects by the million, and hardly one of them is garbage.
    gc.set_threshold(50_000)
    try:
        app()
    except SystemExit as exit_:
        code = exit_.code if isinstance(exit_.code, int) else int(exit_.code is not None)
    except KeyboardInterrupt as error:  # between two steps of the command line's library
        code = _say("Interrupted.", INTERRUPTED, error)
    if code == FAILED and was_interrupted():
        code = INTERRUPTED
    _end(code)


def _end(code: int) -> NoReturn:
    """Ends the process at once.

    Python would take a second and a half to give back the memory of compiled programs piece by
    piece, and wait for a thread deep in a compilation that cannot be stopped.
    """
    end_at_once()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:  # nobody reads there any more, or the disk is full: Python says which
        sys.exit(code)
    if code != INTERRUPTED:
        atexit._run_exitfuncs()
    os._exit(code)


def _say(sentence: str, code: int, error: BaseException) -> int:
    if os.environ.get(DEBUG, "") not in ("", "0"):
        import traceback

        traceback.print_exception(error)
    say(f"camring: {sentence}", err=True)
    return code


def _first_line(error: BaseException) -> str:
    line = next(iter(str(error).splitlines()), "").strip()
    return line if line.endswith((".", "!", "?")) else f"{line}."


def _command_line() -> str:
    return shlex.join(["camring", *sys.argv[1:]])


def _is_the_command_line_librarys_own(error: Exception) -> bool:
    # Usage errors and exits: the library prints them itself. Its classes come from
    # `click` or from a copy inside typer, depending on typer's version.
    return type(error).__module__.startswith(("click.", "typer.")) or any(
        base.__module__.startswith(("click.", "typer.")) for base in type(error).__mro__
    )
