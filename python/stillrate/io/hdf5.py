"""HDF5 through h5py: every dataset of samples is a column, named by its path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io.arrays import to_table
from stillrate.io.safely import MAX_BYTES, first_line, needs, within_bounds
from stillrate.io.table import Table


def read(path: Path) -> Table:
    """Read an HDF5 file (MATLAB 7.3 files are of this kind)."""
    within_bounds(path)
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
