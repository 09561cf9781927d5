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
    "notebook",
    "contributing",
    "plain_math",
    "glossary_of_keys",
]
myst_enable_extensions = ["dollarmath"]
html_math_renderer = "plain"
html_static_path = ["_static"]
html_css_files = ["custom.css"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "_ext", "_static"]
html_title = "camring"
html_theme = "pydata_sphinx_theme"
html_theme_options = {
    # Nothing is asked of any other server: no icon links, no analytics, no list of versions.
    "navbar_align": "left",
    "header_links_before_dropdown": 7,
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
}
html_context = {"default_mode": "auto"}
html_show_sourcelink = False
html_show_sphinx = False
copyright = "the camring authors, MIT licence"
autodoc_typehints = "none"
napoleon_google_docstring = False
suppress_warnings = ["myst.xref_missing"]  # links to files of the repository that are no pages


def _unresolved(app, environment, node, contents):
    """A function that the theory names and that is not there breaks the build."""
    if node.get("refdomain") == "py" and node["refdoc"] == "theory":
        logging.getLogger(__name__).warning("no %s", node["reftarget"], location=node)


def setup(app):
    app.connect("missing-reference", _unresolved)
