"""Formulas as MathML, made while the site is built: browsers render it by themselves, without a script or a font."""

from __future__ import annotations

from typing import Any

from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.errors import SphinxError


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _converted(node: Any, as_block: bool) -> str:
    try:
        return str(tex2mathml(node.astext(), as_block=as_block))
    except Exception as error:
        raise SphinxError(f"cannot set the formula {node.astext()!r}: {error}") from error


def _inline(translator: Any, node: Any) -> None:
    from docutils import nodes

    translator.body.append(_converted(node, False))
    raise nodes.SkipNode


def _block(translator: Any, node: Any) -> None:
    from docutils import nodes

    translator.body.append(f'<div class="formula">{_converted(node, True)}</div>\n')
    raise nodes.SkipNode
