"""A terminal that text from files cannot lead: see `visible`."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions
from rich.segment import Segment
from rich.text import Text

from camring.files.visible import visible

__all__ = ["Terminal"]


class Terminal(Console):
    """Whatever is printed shows signs that would lead a terminal, and obeys none of them.

    What rich itself sends to draw bars and colours goes through.
    """

    def render_str(self, text: str, **options: Any) -> Text:
        """As `rich.console.Console.render_str`: shown before its width is measured."""
        return super().render_str(_lines(text), **options)

    def render(self, renderable: Any, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """The segments of `rich.console.Console.render`, their text made visible."""
        for each in super().render(renderable, options):
            yield each if each.control else _visible(each)


def _visible(segment: Segment) -> Segment:
    if segment.text.isprintable() or segment.text == "\n":
        return segment
    return Segment(_lines(segment.text), segment.style)


def _lines(text: str) -> str:
    return "\n".join(visible(line) for line in text.split("\n"))
