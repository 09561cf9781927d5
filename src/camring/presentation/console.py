"""Where commands print: a terminal of its own width, or a pipe whose lines stay whole."""

from typing import Any

from rich.console import Console
from rich.text import Text

from camring.files.terminal import Terminal

WIDTH_IN_PIPES = 100


class PipeConsole(Terminal):
    """Tables of one width; a sentence stays one line, so that programs and `grep` find its words.

    A terminal folds a sentence itself; folded in a pipe, a long path would be cut in two.
    """

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(width=WIDTH_IN_PIPES, stderr=stderr, highlight=False)

    def print(self, *objects: Any, **options: Any) -> None:
        """As `Terminal.print`, with sentences not folded."""
        if all(isinstance(each, str | Text) for each in objects):
            options.setdefault("soft_wrap", True)
        super().print(*objects, **options)


def console(*, stderr: bool = False) -> Console:
    """Where tables and sentences go."""
    found = Terminal(stderr=stderr, highlight=False)
    return found if found.is_terminal else PipeConsole(stderr=stderr)
