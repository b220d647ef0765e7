"""Files without harm: bounded sizes, whole or not at all, nothing overwritten unasked."""

from __future__ import annotations

import errno
import importlib
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from stillrate.errors import LogError

MAX_BYTES = 8_000_000_000
"""No log is read that is larger, packed or unpacked."""


def within_bounds(path: Path) -> None:
    """Raise LogError unless the path is a file of a size that can be read."""
    size = path.stat().st_size
    if size == 0:
        raise LogError("the file is empty")
    if size > MAX_BYTES:
        raise LogError(f"{size / 1e9:.1f} GB, the limit is {MAX_BYTES / 1e9:.0f} GB")


def first_line(error: BaseException) -> str:
    """Return what a library said, in one short line."""
    return ((str(error) or type(error).__name__).splitlines() or [""])[0][:120]


def refuse_zeros_at_end(path: Path) -> None:
    """Raise LogError if a file ends in zeros, as one that was never finished does."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - 4096))
        if not any(file.read(4096)):
            raise LogError("ends in zeros: the file is half-written")


def needs(module: str, extra: str, what: str) -> Any:
    """Import an optional library, or say how to get it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        raise LogError(f"{what} needs {module}: pip install 'stillrate[{extra}]'") from None


@contextmanager
def atomic(path: Path, *, force: bool) -> Iterator[Path]:
    """Give a temporary path in the same folder; it becomes `path` at the end, or vanishes on an error.

    Raises
    ------
    FileExistsError
        If `path` exists and `force` is not set.
    OSError
        If there is no such folder, or the file cannot be written; it names `path`, not the temporary one.
    """
    refuse_existing(path, force=force)
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path.parent))
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        yield temporary
        if force:
            os.replace(temporary, path)
        else:
            _place(temporary, path)
    except FileExistsError:
        raise
    except OSError as error:
        if error.filename not in (None, str(temporary)):
            raise
        raise type(error)(error.errno, error.strerror or str(error), str(path)) from None
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str, *, force: bool) -> None:
    """Write a text whole or not at all.

    Raises
    ------
    OSError
        As `atomic`.
    """
    with atomic(path, force=force) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _place(temporary: Path, path: Path) -> None:
    """Give a finished file its name, unless another file took it meanwhile."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise FileExistsError(f"{path} exists: --force overwrites it") from None
    except OSError:
        # A file system without hard links.
        refuse_existing(path, force=False)
        os.replace(temporary, path)


def refuse_existing(path: Path, *, force: bool) -> None:
    """Raise FileExistsError if a path is taken and may not be overwritten."""
    if not force and (path.exists() or path.is_symlink()):
        raise FileExistsError(f"{path} exists: --force overwrites it")
