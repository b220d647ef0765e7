"""HDF5 through h5py: every dataset of samples is a column, named by its path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io.arrays import to_table
from stillrate.io.safely import MAX_BYTES, first_line, needs, refuse_zeros_at_end, within_bounds
from stillrate.io.table import Table


def read(path: Path) -> Table:
    """Read an HDF5 file (MATLAB 7.3 files are of this kind)."""
    within_bounds(path)
    if _longer_than_it_says(path):
        refuse_zeros_at_end(path)
    h5py = needs("h5py", "logs", "HDF5")
    arrays: dict[str, npt.NDArray[Any]] = {}
    size = 0

    def take(name: str, item: Any) -> None:
        nonlocal size
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "iufb" or item.ndim not in (1, 2):
            return
        size += item.size * item.dtype.itemsize
        if size > MAX_BYTES:
            raise LogError(f"unpacks to more than {MAX_BYTES / 1e9:.0f} GB")
        arrays[name] = np.asarray(item[()])

    try:
        with h5py.File(path, "r") as file:
            file.visititems(take)
    except LogError:
        raise
    except Exception as error:  # h5py turns damage into OSError, RuntimeError, KeyError and others
        raise LogError(f"not a readable HDF5 file ({first_line(error)})") from None
    return to_table(arrays, {})


def _longer_than_it_says(path: Path) -> bool:
    """Whether the end that the first block of the file gives (addresses of eight bytes) lies before its real end."""
    with path.open("rb") as file:
        head = file.read(64)
    if not head.startswith(b"\x89HDF\r\n\x1a\n") or len(head) < 64:
        return False
    at = {0: 40, 1: 44, 2: 28, 3: 28}.get(head[8])
    return at is not None and path.stat().st_size > int.from_bytes(head[at : at + 8], "little")
