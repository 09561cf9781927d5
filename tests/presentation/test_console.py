"""Where commands print: what is read by programs is not folded at any width."""

import io

from rich.console import Console
from rich.table import Table

from camring.presentation.console import WIDTH_IN_PIPES, console

SENTENCE = "72 points in " + "/a_long_folder" * 20 + "/ring.csv, um along the normal."


def printed(out: Console, thing: object) -> list[str]:
    out.file = io.StringIO()
    out.print(thing)
    return out.file.getvalue().splitlines()


def test_a_sentence_in_a_pipe_is_one_line():
    assert printed(console(), SENTENCE) == [SENTENCE]


def test_a_table_in_a_pipe_keeps_its_width():
    table = Table("a", "b")
    table.add_row("word " * 40, "word " * 40)
    assert max(map(len, printed(console(), table))) <= WIDTH_IN_PIPES
