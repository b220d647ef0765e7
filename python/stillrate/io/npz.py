"""numpy's npz: one array a column, ``meta_json`` for the rest. Pickled objects are refused."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io.safely import MAX_BYTES, atomic, within_bounds
from stillrate.io.table import Table

SUFFIXES = (".npz",)


def read(path: Path) -> Table:
    """Read an npz file."""
    within_bounds(path)
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(item.file_size for item in archive.infolist())
        if size > MAX_BYTES:
            raise LogError(f"unpacks to {size / 1e9:.1f} GB, the limit is {MAX_BYTES / 1e9:.0f} GB")
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except LogError:
        raise
    except (
        ValueError,
        OSError,
        EOFError,
        KeyError,
        zipfile.BadZipFile,
        MemoryError,
        NotImplementedError,
    ) as error:
        raise LogError(f"not a readable npz file ({_first_line(error)})") from None
    except Exception as error:  # zlib.error and struct.error of damaged members have no common base
        raise LogError(f"damaged npz file ({_first_line(error)})") from None
    return _table(arrays)


def _first_line(error: BaseException) -> str:
    return (str(error) or type(error).__name__).splitlines()[0][:120]


def _table(arrays: dict[str, npt.NDArray[Any]]) -> Table:
    meta: dict[str, Any] = {}
    if "meta_json" in arrays:
        try:
            found = json.loads(str(arrays.pop("meta_json")))
            meta = found if isinstance(found, dict) else {}
        except ValueError:
            pass
    lengths = [len(values) for values in arrays.values() if values.ndim > 0]
    if not lengths:
        raise LogError("no array with samples in it")
    rows = max(set(lengths), key=lambda length: (lengths.count(length), length))
    columns: dict[str, npt.NDArray[Any]] = {}
    extras: dict[str, Any] = {}
    for name, values in arrays.items():
        if values.ndim == 2 and len(values) == rows and values.shape[1] == 3 and _is_rate(name):
            columns.update({f"{name}_{axis}": values[:, index] for index, axis in enumerate("xyz")})
        elif values.ndim > 0 and len(values) == rows:
            columns[name] = values
        else:
            extras[name] = values
    return Table(columns, meta, extras)


def _is_rate(name: str) -> bool:
    from stillrate.io.names import gyro_axis, rate_unit

    stem, _ = rate_unit(name)
    return gyro_axis(f"{stem}_x") is not None


def write(path: Path, table: Table, *, force: bool) -> None:
    """Write columns as npz."""
    arrays = {**table.columns, **table.extras}
    if table.meta:
        arrays["meta_json"] = np.array(json.dumps(table.meta))
    with atomic(path, force=force) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
