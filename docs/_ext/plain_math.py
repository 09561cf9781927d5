"""Equations as MathML, which every browser draws itself: nothing is fetched, nothing installed.

docutils turns LaTeX into MathML; what it cannot read is an error of the build.
"""

from docutils import nodes
from docutils.utils.math import MathError, latex2mathml
from sphinx.locale import _
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

logger = logging.getLogger(__name__)


def _mathml(node, as_block: bool) -> str:
    try:
        return latex2mathml.tex2mathml(node.astext(), as_block=as_block)
    except MathError as error:
        logger.warning("equation %r: %s", node.astext(), error, location=node)
        return ""


def _inline(self, node):
    self.body.append(_mathml(node, as_block=False))
    raise nodes.SkipNode


def _displayed(self, node):
    number = ""
    if node["number"]:
        number = f'<span class="eqno">({get_node_equation_number(self, node)})'
        self.body.append(self.starttag(node, "div", CLASS="math equation"))
        self.body.append(number)
        self.add_permalink_ref(node, _("Link to this equation"))
        self.body.append("</span>")
    else:
        self.body.append(self.starttag(node, "div", CLASS="math equation"))
    # In a box of its own, which scrolls by itself where the page is narrow.
    self.body.append(f'<div class="formula">{_mathml(node, as_block=True)}</div></div>\n')
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("plain", (_inline, None), (_displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
