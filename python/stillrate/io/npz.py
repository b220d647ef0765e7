"""numpy's npz: one array a column, ``meta_json`` for the rest. Pickled objects are refused."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError
from stillrate.io.arrays import to_table
from stillrate.io.safely import MAX_BYTES, atomic, first_line, within_bounds
from stillrate.io.table import Table


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
        raise LogError(f"not a readable npz file ({first_line(error)})") from None
    except Exception as error:  # zlib.error and struct.error of damaged members have no common base
        raise LogError(f"damaged npz file ({first_line(error)})") from None
    return _table(arrays)


def _table(arrays: dict[str, npt.NDArray[Any]]) -> Table:
    meta: dict[str, Any] = {}
    if "meta_json" in arrays:
        try:
            found = json.loads(str(arrays.pop("meta_json")))
            meta = found if isinstance(found, dict) else {}
        except ValueError:
            pass
    return to_table(arrays, meta)


def write(path: Path, table: Table, *, force: bool) -> None:
    """Write columns as npz."""
    arrays = {**table.columns, **table.extras}
    if table.meta:
        arrays["meta_json"] = np.array(json.dumps(table.meta))
    with atomic(path, force=force) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
