"""MATLAB files up to version 7 through scipy; version 7.3 is HDF5. Fields of a structure are columns too."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io import hdf5
from stillrate.io.arrays import to_table
from stillrate.io.safely import first_line, needs, within_bounds
from stillrate.io.table import Table

_HDF5 = b"\x89HDF\r\n\x1a\n"


def read(path: Path) -> Table:
    """Read a MATLAB file."""
    within_bounds(path)
    with path.open("rb") as file:
        head = file.read(1024)
    if _HDF5 in (head[:8], head[512:520]):
        return hdf5.read(path)
    matlab = needs("scipy.io", "logs", "a MATLAB file")
    try:
        found = matlab.loadmat(str(path), squeeze_me=True, struct_as_record=False)
    except Exception as error:  # damaged files raise nearly anything
        raise LogError(f"not a readable MATLAB file ({first_line(error)})") from None
    arrays: dict[str, npt.NDArray[Any]] = {}
    for name, value in found.items():
        if not name.startswith("__"):
            _collect(name, value, arrays, depth=3)
    return to_table(arrays, {})


def _collect(name: str, value: Any, arrays: dict[str, npt.NDArray[Any]], *, depth: int) -> None:
    """Take arrays, and those in structures."""
    fields = getattr(value, "_fieldnames", None)
    if fields is not None and depth:
        for field in fields:
            _collect(f"{name}.{field}", getattr(value, field), arrays, depth=depth - 1)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "iufb" and value.ndim in (1, 2):
        arrays[name] = value
