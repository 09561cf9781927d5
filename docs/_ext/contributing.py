"""CONTRIBUTING.md as a page: what is marked in its fences runs at build, its links are the page's.

On the page that includes it a fence ` ```sh run ` is the directive `run` of `executed.py`, and
` ```python NAME.py ` a program of that name (with `written` behind it only written). Where the
repository's pages are shown as they are, the marks are not seen.
"""

import re
from pathlib import Path


def as_page(text: str) -> str:
    """Fences become directives, links from the root of the repository links from `docs`."""
    text = re.sub(r"(?m)^```sh run$", "```{run} sh", text)
    text = re.sub(r"(?m)^```python (\w+\.py)$", r"```{run} python\n:script: \1", text)
    written = r"```{run} python\n:script: \1\n:written:"
    text = re.sub(r"(?m)^```python (\w+\.py) written$", written, text)
    text = re.sub(r"\]\((?!\w+:|#)(?!docs/)", "](../", text)
    return text.replace("](docs/", "](")


def _read(app, relative_path, parent_docname, content):
    if Path(relative_path).name == "CONTRIBUTING.md":
        content[0] = as_page(content[0])


def setup(app):
    app.connect("include-read", _read)
    return {"parallel_read_safe": True}
