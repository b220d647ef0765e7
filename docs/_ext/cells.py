"""A table of docutils from its cells, for the directives that make one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from docutils import nodes

Cell = str | nodes.Node


def table(
    head: Sequence[Cell],
    body: Iterable[Sequence[Cell]],
    widths: Sequence[int] = (),
    classes: Sequence[str] = (),
) -> nodes.table:
    """Build a table; widths are relative, equal where none are given."""
    group = nodes.tgroup(cols=len(head))
    for width in widths or [1] * len(head):
        group += nodes.colspec(colwidth=width)
    group += nodes.thead("", _row(head))
    group += nodes.tbody("", *(_row(cells) for cells in body))
    return nodes.table("", group, classes=list(classes))


def _row(cells: Sequence[Cell]) -> nodes.row:
    return nodes.row("", *(nodes.entry("", _paragraph(cell)) for cell in cells))


def _paragraph(cell: Cell) -> nodes.Node:
    if isinstance(cell, str):
        return nodes.paragraph(text=cell)
    return cell if isinstance(cell, nodes.paragraph) else nodes.paragraph("", "", cell)
