"""The look of the tables that commands print: words to the left, numbers to the right."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

from rich import box
from rich.table import Table


def plain_table(
    title: str,
    heads: Iterable[str],
    *,
    words: Collection[str],
    caption: str | None = None,
    no_wrap: bool = False,
    **style: Any,
) -> Table:
    """Return an empty table with its heads.

    Parameters
    ----------
    title
        Stands above it.
    heads
        One a column.
    words
        Those heads whose columns hold words; all others hold numbers.
    caption
        Stands below it.
    no_wrap
        Whether cells are never broken into lines.
    **style
        What else `rich.table.Table` takes.
    """
    table = Table(
        title=title, caption=caption, box=box.SIMPLE_HEAD, title_justify="left", caption_justify="left", **style
    )
    for head in heads:
        table.add_column(head, justify="left" if head in words else "right", no_wrap=no_wrap)
    return table
