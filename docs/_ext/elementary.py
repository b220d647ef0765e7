"""The table of our elementary functions' errors, read from the documentation of the module that defines them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from cells import table
from docutils import nodes
from sphinx.util.docutils import SphinxDirective

SOURCE = Path(__file__).parents[2] / "crates/stillrate/src/elementary/mod.rs"


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_directive("elementary", Elementary)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def rows() -> list[list[str]]:
    """Return the cells of the table in the module's documentation, the head first."""
    lines = re.findall(r"^//! \|(.+)\|$", SOURCE.read_text(encoding="utf-8"), flags=re.M)
    cells = [[cell.replace("`", "").strip() for cell in line.split("|")] for line in lines]
    found = [row for row in cells if not set(row[0]) <= {"-"}]
    if len(found) < 2:
        raise ValueError(f"{SOURCE}: no table of errors")
    return found


class Elementary(SphinxDirective):
    """``{elementary}``: the table."""

    def run(self) -> list[nodes.Node]:
        """Build the table."""
        head, *body = rows()
        return [table(head, body)]
