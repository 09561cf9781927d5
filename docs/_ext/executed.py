"""The directive `run`: commands and Python of a tutorial run at build and shown with what they say.

`{run} sh` runs one command a line; `{run} python` runs in one namespace a page, or with
`:script: NAME` as a program of its own (with `:written:` only written). `:picture: FILE WORDS` is
a picture that was made; `:first: N` and `:last: N` only the first or last lines printed,
`:folded: WORDS` folds the Python away below these words. What fails is an error of the build. All
pages share one folder, so a study made by one page is there for the next; when one is stale all are
run again. `__file__` is the page.
`python -m sphinx -D run_pages=0 ...` shows the pages without running anything.
"""

import contextlib
import html
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

SPACES: dict[str, dict] = {}  # of Python names, by page
TERMINAL = {"COLUMNS": "96", "NO_COLOR": "1", "MPLBACKEND": "agg"}


class Run(SphinxDirective):
    has_content, required_arguments = True, 1
    option_spec = dict.fromkeys(
        ("picture", "script", "written", "first", "last", "folded"), directives.unchanged
    )

    def run(self):
        folder = _folder(self.env)
        self.env.metadata[self.env.docname]["executed"] = "yes"
        source, script = "\n".join(self.content), self.options.get("script")
        if not self.config.run_pages:
            return [_block("python" if self.arguments[0] == "python" else "sh", source)]
        if self.arguments[0] == "sh":
            shown = [
                _block("console", "\n".join(self.shell(line, folder) for line in self.content))
            ]
        elif script:
            (folder / script).write_text(source + "\n", encoding="utf-8")
            if "written" in self.options:
                return [_block("python", source)]
            said = self.shell(f"python {script}", folder)
            shown = [_block("python", source), _block("console", said)]
        else:
            shown = [_block("python", source)]
            if "folded" in self.options:
                shown = _folded(self.options["folded"], shown)
            if said := self.python(source, folder):
                shown.append(_block("text", said))
        if "picture" in self.options:
            name, _, words = self.options["picture"].partition(" ")
            if not (folder / name).exists():
                raise self.error(f"no picture {name} was made")
            inside = os.path.relpath(folder / name, self.env.srcdir)
            shown.append(nodes.image(uri=f"/{inside}", alt=words))
        return shown

    def shell(self, line: str, folder: Path) -> str:
        command = re.fullmatch(r"camring ((?!optimise)[^|<>&;$]*)", line)
        run = partial(_within, command[1]) if command else partial(_as_a_process, line)
        code, said = run(folder)
        if code:
            raise self.error(f"`{line}` ended with {code}:\n{said}")
        return f"$ {line}\n{self.cut(said.replace(f'{folder}/', ''))}"

    def python(self, source: str, folder: Path) -> str:
        from camring.programs.compilation_cache import keep_compiled_programs

        keep_compiled_programs()
        with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()) as said:
            try:
                page = {"__file__": self.env.doc2path(self.env.docname)}
                exec(source, SPACES.setdefault(self.env.docname, page))
            except Exception as error:
                raise self.error(f"Python failed: {type(error).__name__}: {error}") from error
        return self.cut(said.getvalue())

    def cut(self, said: str) -> str:
        lines = [line.rstrip() for line in said.rstrip().splitlines()]
        if (first := int(self.options.get("first", len(lines)))) < len(lines):
            lines = [*lines[:first], "..."]
        return "\n".join(lines[-int(self.options.get("last", 0)) :])


def _within(words: str, folder: Path) -> tuple[int, str]:
    """A command in this process, which has JAX and the programs: to start one takes seconds."""
    from typer.testing import CliRunner

    from camring.cli.app import app

    with contextlib.chdir(folder):
        done = CliRunner(env=TERMINAL).invoke(app, shlex.split(words), prog_name="camring")
    return done.exit_code, done.output


def _as_a_process(line: str, folder: Path) -> tuple[int, str]:
    """What starts others, or is no command of ours."""
    paths = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        line, shell=True, cwd=folder, env=os.environ | TERMINAL | {"PATH": paths}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    return done.returncode, done.stdout


def _block(language: str, text: str) -> nodes.Node:
    return nodes.literal_block(text, text, language=language)


def _folded(words: str, inside: list[nodes.Node]) -> list[nodes.Node]:
    head = f"<details><summary>{html.escape(words)}</summary>"
    return [nodes.raw("", head, format="html"), *inside, nodes.raw("", "</details>", format="html")]


def _folder(env) -> Path:
    folder = Path(env.app.doctreedir) / "executed"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _all_or_none(app, env, added, changed, removed):
    pages = {page for page, said in env.metadata.items() if "executed" in said}
    stale = added | changed
    if pages and not pages & stale:
        return []
    shutil.rmtree(_folder(env), ignore_errors=True)
    SPACES.clear()
    return sorted(pages)


def setup(app):
    app.add_config_value("run_pages", True, "env", types=(bool,))
    app.add_directive("run", Run)
    app.connect("env-get-outdated", _all_or_none)
    return {"parallel_read_safe": False}
