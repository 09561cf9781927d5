"""How the documentation is built: `python -m sphinx -W docs docs/_build` (extra `docs`)."""

import sys
from pathlib import Path

from sphinx.util import logging

import camring

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "camring"
author = "the camring team"
release = camring.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "executed",
    "plain_math",
    "glossary_of_keys",
]
myst_enable_extensions = ["dollarmath"]
html_math_renderer = "plain"
html_static_path = ["_static"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "_ext", "_static"]
html_theme = "alabaster"
html_theme_options = {
    "description": "Better cam rings and valve timing for radial-piston hydraulic motors",
    "page_width": "1100px",
    "sidebar_width": "230px",
    "show_powered_by": False,
    # Nothing is asked of any other server.
    "github_banner": False,
}
html_show_sourcelink = False
autodoc_typehints = "none"
napoleon_google_docstring = False
suppress_warnings = ["myst.xref_missing"]  # links to files of the repository that are no pages


def _unresolved(app, environment, node, contents):
    """A function that the theory names and that is not there breaks the build."""
    if node.get("refdomain") == "py" and node["refdoc"] in ("theory", "adding"):
        logging.getLogger(__name__).warning("no %s", node["reftarget"], location=node)


def setup(app):
    app.connect("missing-reference", _unresolved)
