"""Parquet and Arrow IPC through polars; the configuration stands in the file's key-value metadata."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from stillrate.errors import LogError
from stillrate.io.safely import atomic, first_line, needs, within_bounds
from stillrate.io.table import Table

KEY = "stillrate"


def read(path: Path) -> Table:
    """Read a Parquet file."""
    within_bounds(path)
    polars = needs("polars", "tables", "Parquet")
    try:
        # The footer first: it is what a half-written file lacks.
        metadata = polars.read_parquet_metadata(path)
        frame = polars.read_parquet(path)
    except Exception as error:  # polars' compute errors, and panics of its Parquet decoder on damaged pages
        raise LogError(f"not a readable Parquet file ({first_line(error)})") from None
    except BaseException as error:
        if type(error).__name__ != "PanicException":
            raise
        raise LogError("damaged Parquet file") from None
    meta: dict[str, Any] = {}
    try:
        found = json.loads(metadata.get(KEY, "{}"))
        meta = found if isinstance(found, dict) else {}
    except ValueError:
        pass
    return Table({name: _column(frame[name]) for name in frame.columns}, meta)


def _column(series: Any) -> Any:
    kind = str(series.dtype)
    if kind.startswith(("Float", "Int", "UInt", "Decimal")):
        if series.null_count() or kind.startswith("Decimal"):
            return series.cast(type(series.dtype) if kind == "Float32" else _float64()).fill_null(np.nan).to_numpy()
        return series.to_numpy()
    if kind.startswith("Datetime"):
        return series.to_numpy()
    if kind == "Boolean" and not series.null_count():
        return series.to_numpy()
    return np.array(series.cast(_string(), strict=False).fill_null("").to_list(), dtype=str)


def _float64() -> Any:
    return needs("polars", "tables", "Parquet").Float64


def _string() -> Any:
    return needs("polars", "tables", "Parquet").String


def write(path: Path, table: Table, *, force: bool) -> None:
    """Write columns as Parquet."""
    polars = needs("polars", "tables", "Parquet")
    frame = polars.DataFrame({name: values for name, values in table.columns.items() if values.ndim == 1})
    with atomic(path, force=force) as temporary:
        frame.write_parquet(temporary, metadata={KEY: json.dumps(table.meta)} if table.meta else None)
