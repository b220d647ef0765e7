"""Keeps the words of a type, such as the lengths in "shape (n, channels)", from becoming links to whatever has the same name.

Classes of the package begin with a capital; nothing else in a type leads anywhere on this site.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx import addnodes


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("doctree-read", _unlink)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _unlink(app: Any, doctree: nodes.document) -> None:
    for link in list(doctree.findall(addnodes.pending_xref)):
        target = str(link.get("reftarget", ""))
        if (
            link.get("refdomain") == "py"
            and link.get("reftype") == "class"
            and target.islower()
        ):
            link.replace_self(link.children)
