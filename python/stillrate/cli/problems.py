"""What can go wrong at the command line, as one line of text."""

from __future__ import annotations


class UsageError(Exception):
    """The command was called in a way that has no meaning."""


def one_line(error: BaseException) -> str:
    """Return an error as one line that says which file and what is wrong with it."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {(error.strerror or type(error).__name__).lower()}"
    text = " ".join(str(error).split())
    return text or type(error).__name__
