"""CSV, TSV and kin: as found in the wild, written back in the same dialect.

What a file was made with stands beside it in ``NAME-metadata.json``, where the W3C's "CSV on the Web" looks for it, so
that the table itself stays readable by everything.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from stillrate import _native
from stillrate.errors import LogError
from stillrate.io.safely import atomic, within_bounds
from stillrate.io.table import Table


def metadata_path(path: Path) -> Path:
    """Return where the metadata of a delimited file stands."""
    return path.with_name(path.name + "-metadata.json")


def read(path: Path) -> Table:
    """Read delimited text."""
    within_bounds(path)
    try:
        found = _native.read_delimited(path)
    except ValueError as error:
        raise LogError(str(error)) from None
    columns = {
        name: values if isinstance(values, np.ndarray) else np.array(values, dtype=str)
        for name, values in zip(found["names"], found["columns"], strict=True)
    }
    style = {name: found[name] for name in ("delimiter", "decimal_comma", "preamble", "named", "missing_word", "names")}
    return Table(columns, _metadata(path), style=style, first_line=int(found["first_row_line"]))


def _metadata(path: Path) -> dict[str, Any]:
    beside = metadata_path(path)
    if not beside.is_file() or beside.stat().st_size > 1_000_000:
        return {}
    try:
        found = json.loads(beside.read_text(encoding="utf-8"))
    except (ValueError, OSError):
        return {}
    own = found.get("stillrate:meta") if isinstance(found, dict) else None
    return dict(own) if isinstance(own, dict) else {}


def write(path: Path, table: Table, *, force: bool) -> None:
    """Write columns as delimited text, and what they were made with beside it."""
    style = table.style
    names = list(table.columns)
    preamble, header = _head(style, names)
    delimiter = style.get("delimiter") or ("\t" if path.suffix.lower() == ".tsv" else ",")
    columns = [_column(values) for values in table.columns.values()]
    with atomic(path, force=force) as temporary:
        _native.write_delimited(
            temporary,
            columns,
            delimiter=delimiter,
            decimal_comma=bool(style.get("decimal_comma", False)),
            preamble=preamble,
            header=header,
            missing_word=style.get("missing_word") or "",
        )
    if table.meta:
        described = {"@context": "http://www.w3.org/ns/csvw", "url": path.name, "stillrate:meta": table.meta}
        with atomic(metadata_path(path), force=True) as temporary:
            temporary.write_text(json.dumps(described, indent=1), encoding="utf-8")


def _head(style: dict[str, Any], names: list[str]) -> tuple[list[str], list[str] | None]:
    """Return the lines to put first and, unless they hold it already, the header."""
    preamble = list(style.get("preamble", []))
    if not style.get("named", True):
        return preamble, None
    if style.get("names") == names:
        return preamble, (None if preamble else names)
    kept = [line for line in preamble if line.lstrip().startswith(("#", "%", "//"))]
    return kept, names


def _column(values: Any) -> Any:
    if values.dtype.kind in "iu":
        return np.ascontiguousarray(values, dtype=np.int64)
    if values.dtype == np.float32:
        # The fewest digits of the single-precision number, not of its double.
        return [repr(float(str(value))) if np.isfinite(value) else "" for value in values]
    if values.dtype.kind == "f":
        return np.ascontiguousarray(values, dtype=np.float64)
    return [str(value) for value in values]
