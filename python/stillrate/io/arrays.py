"""Named arrays, as npz, HDF5 and MATLAB files hold them, into a table."""

from __future__ import annotations

from typing import Any

import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io.names import gyro_axis, rate_unit
from stillrate.io.table import Table

_AXES = ("x", "y", "z")


def to_table(arrays: dict[str, npt.NDArray[Any]], meta: dict[str, Any]) -> Table:
    """Take the arrays of the most frequent length as columns; three columns of a rate become three channels."""
    arrays = {name: _flat(values) for name, values in arrays.items()}
    lengths = [len(values) for values in arrays.values() if values.ndim > 0 and len(values) > 1]
    if not lengths:
        raise LogError("no array with samples in it")
    rows = max(set(lengths), key=lambda length: (lengths.count(length), length))
    columns: dict[str, npt.NDArray[Any]] = {}
    extras: dict[str, Any] = {}
    for name, values in arrays.items():
        if values.ndim == 2 and values.shape == (3, rows) and rows != 3 and _is_rate(name):
            values = values.T
        if values.ndim == 2 and len(values) == rows and values.shape[1] == 3 and _is_rate(name):
            stem, _ = rate_unit(name)
            unit = name[len(stem) :]
            columns.update({f"{stem}_{axis}{unit}": values[:, index] for index, axis in enumerate(_AXES)})
        elif values.ndim > 0 and len(values) == rows:
            columns[name] = values
        else:
            extras[name] = values
    return Table(columns, meta, extras)


def _flat(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Take (n, 1) and (1, n), as MATLAB has vectors, for (n,)."""
    return values.ravel() if values.ndim == 2 and 1 in values.shape and values.size > 1 else values


def _is_rate(name: str) -> bool:
    return gyro_axis(f"{rate_unit(name)[0]}_x") is not None
