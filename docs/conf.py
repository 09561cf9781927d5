"""How the documentation is built: `python -m sphinx -W docs docs/_build` (extra `docs`)."""

import camring

project = "camring"
author = "the camring team"
release = camring.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_heading_anchors = 3
exclude_patterns = ["_build"]
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
