"""How far a study is: what it tells whoever shows a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

Advance = Callable[[float], None]
"""Is told which part of a study is done, from 0 to 1."""

Item = TypeVar("Item")


def unwatched(done: float) -> None:
    """Tell nobody."""


def parts(items: Sequence[Item], advance: Advance, begin: float = 0.0, end: float = 1.0) -> Iterator[Item]:
    """Yield the items of one stretch of a study, from `begin` to `end` of the whole, and tell how many are done.

    Examples
    --------
    >>> told = []
    >>> [letter for letter in parts("ab", told.append, end=0.5)]
    ['a', 'b']
    >>> told
    [0.25, 0.5]
    """
    for count, item in enumerate(items, start=1):
        yield item
        advance(begin + (end - begin) * count / len(items))
