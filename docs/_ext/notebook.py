"""The directive `code-cell`: a page is a notebook too, and runs when the documentation is built.

Pages with `code-cell` fences are notebooks in MyST's form, which Jupyter opens through jupytext. A
cell shows what it prints and its last value as a notebook does: a picture, a table, else its text.
A cell of lines that begin with `!` is commands. Each page has one namespace (see `executed.py`).
"""

import ast
import os
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from executed import SPACES, Run, _block, _folder

VALUE = "_value_of_the_cell"


def with_value(source: str) -> str:
    """The cell with its last expression, if it ends with one, kept under a name."""
    body = ast.parse(source).body
    if not body or not isinstance(body[-1], ast.Expr) or source.rstrip().endswith(";"):
        return source
    lines, first = source.splitlines(), body[-1].lineno - 1
    return "\n".join([*lines[:first], f"{VALUE} = (", *lines[first:], ")"])


class Cell(Run):
    """One cell of the page's notebook."""

    required_arguments, optional_arguments = 0, 1
    option_spec = dict.fromkeys(("tags",), directives.unchanged)

    def run(self) -> list[nodes.Node]:
        page, folder = self.env.docname, _folder(self.env)
        self.env.metadata[page]["executed"] = "yes"
        source = "\n".join(self.content)
        commands = [line[1:].strip() for line in self.content if line.startswith("!")]
        if not self.config.run_pages:
            return [_block("python", source)]
        if commands:
            return [_block("console", "\n".join(self.shell(line, folder) for line in commands))]
        shown: list[nodes.Node] = [_block("python", source)]
        if said := self.python(with_value(source), folder):
            shown.append(_block("text", said))
        value = SPACES[page].pop(VALUE, None)
        return shown if value is None else [*shown, self.displayed(value, folder)]

    def displayed(self, value: Any, folder: Path) -> nodes.Node:
        """A value as a notebook shows it."""
        if hasattr(value, "_repr_png_"):
            name = f"{Path(self.env.docname).name}-{self.lineno}.png"
            (folder / name).write_bytes(value._repr_png_())
            inside = os.path.relpath(folder / name, self.env.srcdir)
            return nodes.image(uri=f"/{inside}", alt=self.alternative())
        if hasattr(value, "_repr_html_"):
            table = f'<div class="cell-table">{value._repr_html_()}</div>'
            return nodes.raw("", table, format="html")
        return _block("text", repr(value))

    def alternative(self) -> str:
        """Words for a picture: the cell's first comment."""
        comments = (line.lstrip("# ") for line in self.content if line.startswith("#"))
        return next(comments, "Picture drawn by the cell above")


def setup(app):
    app.setup_extension("executed")
    app.add_directive("code-cell", Cell)
    return {"parallel_read_safe": False}
