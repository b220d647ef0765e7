"""Logs in and out: one format a file, found by the name's ending.

A format is a module with ``read(path) -> Table`` and, if it can be written, ``write(path, table, force=)``. It is imported
when a file of its kind is met.
"""

from __future__ import annotations

import dataclasses
import errno
import importlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stillrate.errors import LogError
from stillrate.io.log import Layout, Log, Timing
from stillrate.io.table import Table, Wishes, to_log

__all__ = ["Layout", "Log", "Timing", "read", "readable", "writable", "write"]

_FORMATS: Mapping[str, str] = {
    ".csv": "delimited",
    ".tsv": "delimited",
    ".txt": "delimited",
    ".dat": "delimited",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".npz": "npz",
    ".ulg": "ulog",
    ".mcap": "rosbag",
    ".bag": "rosbag",
    ".db3": "rosbag",
    ".bbl": "blackbox",
    ".bfl": "blackbox",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".mat": "matlab",
}
_WRITABLE = ("delimited", "parquet", "npz")


def readable() -> tuple[str, ...]:
    """Return the endings of files that can be read.

    Examples
    --------
    >>> ".csv" in readable() and ".ulg" in readable()
    True
    """
    return tuple(_FORMATS)


def writable() -> tuple[str, ...]:
    """Return the endings of files that can be written.

    Examples
    --------
    >>> ".csv" in writable(), ".ulg" in writable()
    (True, False)
    """
    return tuple(suffix for suffix, name in _FORMATS.items() if name in _WRITABLE)


def read(
    path: str | Path,
    *,
    rate_hz: float | None = None,
    columns: Sequence[str] | None = None,
    time: str | None = None,
    unit: str | None = None,
    time_unit: str | None = None,
) -> Log:
    r"""Read a log.

    Parameters
    ----------
    path : str or Path
        The file, or the folder of a ROS 2 bag; the ending says the format.
    rate_hz : float, optional
        Nominal sample rate in Hz; needed if the file has no time column.
    columns : sequence of str, optional
        The columns to take as rates; found by name when left out.
    time : str, optional
        The time column; found by name when left out.
    unit : str, optional
        Unit of the rates ("deg/s", "rad/s", "mdps"), if their names do not say.
    time_unit : str, optional
        Unit of the time column ("s", "ms", "us", "ns"), if its name does not say.

    Returns
    -------
    Log
        Time in s from the first sample, rates in deg/s, all other columns as they are.

    Raises
    ------
    LogError
        If the file is of no known format, damaged, or has no rates; one sentence says where and what to do.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "log.csv"
    >>> _ = path.write_text("time_ms,gx_rad_s,note\n0,0.1,7\n20,0.2,8\n40,0.1,9\n")
    >>> log = read(path)
    >>> log.channels, log.sample_rate_hz, log.rate_dps.round(2)[:, 0].tolist()
    (('gx_rad_s',), 50.0, [5.73, 11.46, 5.73])
    """
    path = Path(path)
    wishes = Wishes(rate_hz=rate_hz, columns=columns, time=time, unit=unit, time_unit=time_unit)
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    try:
        table = _format(path).read(path)
        log = to_log(table, wishes)
    except LogError as error:
        raise LogError(f"{path}: {error}") from None
    except MemoryError:
        raise LogError(f"{path}: too large for the memory of this machine") from None
    return dataclasses.replace(log, meta={"source": path.name, **log.meta})


def write(path: str | Path, log: Log, *, force: bool = False) -> None:
    """Write a log with all its columns, each rate in the unit it had, in the format of the name's ending.

    Parameters
    ----------
    path : str or Path
    log : Log
    force : bool
        Overwrite an existing file.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    LogError
        If the ending is of no format that can be written.

    Examples
    --------
    >>> import tempfile
    >>> from stillrate import demo
    >>> path = Path(tempfile.mkdtemp()) / "log.csv"
    >>> write(path, demo.wave_log(demo.runs()))
    >>> path.read_text().splitlines()[0]
    't_s,gx_dps,gx_true_dps'
    """
    path = Path(path)
    if _FORMATS.get(path.suffix.lower()) not in _WRITABLE:
        raise LogError(
            f"{path}: cannot write {path.suffix or 'a file without ending'} (one of {', '.join(writable())})"
        )
    _format(path).write(path, to_table(log, flat=path.suffix.lower() != ".npz"), force=force)


def to_table(log: Log, *, flat: bool) -> Table:
    """Return a log's columns in their order; with `flat`, arrays of several columns are spread."""
    layout = log.layout
    rates = {
        name: log.rate_dps[:, index] / layout.factors.get(name, 1.0)
        if layout.factors.get(name, 1.0) != 1.0
        else np.ascontiguousarray(log.rate_dps[:, index])
        for index, name in enumerate(log.channels)
    }
    everything: dict[str, Any] = {**log.columns, **rates}
    if layout.time is not None and layout.stamps is not None:
        everything[layout.time] = layout.stamps
    elif not layout.order:
        everything = {"t_s": log.t_s, **rates, **log.columns}
    order = [name for name in layout.order if name in everything]
    order += [name for name in everything if name not in order]
    columns: dict[str, Any] = {}
    for name in order:
        values = everything[name]
        if flat and values.ndim == 2:
            columns.update({f"{name}_{index}": values[:, index] for index in range(values.shape[1])})
        elif not (flat and values.ndim != 1):
            columns[name] = values
    return Table(columns, dict(log.meta), {} if flat else dict(layout.extras), dict(layout.style))


def _format(path: Path) -> Any:
    if (path / "metadata.yaml").is_file():
        return importlib.import_module("stillrate.io.rosbag")
    if path.is_dir():
        raise LogError("is a folder, and no ROS 2 bag")
    suffix = path.suffix.lower()
    if suffix not in _FORMATS:
        raise LogError(f"no reader for {suffix or 'a file without ending'} (one of {', '.join(_FORMATS)})")
    return importlib.import_module(f"stillrate.io.{_FORMATS[suffix]}")
