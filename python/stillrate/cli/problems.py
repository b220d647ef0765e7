"""What can go wrong at the command line, as one line of text."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stillrate.errors import LogError


class UsageError(Exception):
    """The command was called in a way that has no meaning."""


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put a log's path before what is said of its content, where it does not stand there already."""
    try:
        yield
    except LogError as error:
        text = str(error)
        raise LogError(text if text.startswith(str(path)) else f"{path}: {text}") from None


def one_line(error: BaseException) -> str:
    """Return an error as one line that says which file and what is wrong with it."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {(error.strerror or type(error).__name__).lower()}"
    text = " ".join(str(error).split())
    return text or type(error).__name__
