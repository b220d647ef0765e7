"""Samples into text for a page: whole multiples of a step, differences, zigzag, byte planes, deflate, base64.

What is packed is for the eye; the step says how fine. Nothing that is computed goes through here.
"""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

_LARGEST = 2**30


def pack(values: npt.NDArray[np.float64], step: float, *, wide: bool = False) -> dict[str, Any]:
    """Pack numbers, rounded to a multiple of `step` (made coarser if they do not fit 30 bits).

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN stands for missing.
    step : float
    wide : bool
        Unpack in double precision.
    """
    finite = np.isfinite(values)
    filled = _fill(values, finite)
    offset = float(filled[0]) if len(filled) else 0.0
    span = float(np.max(np.abs(filled - offset), initial=0.0))
    step = max(step, span / _LARGEST, np.finfo(float).tiny)
    whole = np.rint((filled - offset) / step).astype(np.int64)
    change = np.diff(whole, prepend=np.int64(0))
    zigzag = ((change << 1) ^ (change >> 63)).astype(np.uint32)
    planes = np.concatenate([(zigzag >> shift & 0xFF).astype(np.uint8) for shift in (0, 8, 16, 24)])
    data = base64.b64encode(zlib.compress(planes.tobytes(), 6)).decode("ascii")
    return {
        "count": len(values),
        "offset": offset,
        "step": step,
        "wide": wide,
        "missing": _runs(~finite),
        "data": data,
    }


def _fill(values: npt.NDArray[np.float64], finite: npt.NDArray[np.bool_]) -> npt.NDArray[np.float64]:
    """Put the last finite value where one is missing."""
    if finite.all():
        return values
    last = np.maximum.accumulate(np.where(finite, np.arange(len(values)), -1))
    return np.where(last >= 0, values[np.maximum(last, 0)], 0.0)


def _runs(missing: npt.NDArray[np.bool_]) -> list[list[int]]:
    """Return where runs of missing samples begin and end."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], missing.astype(np.int8), [0]))))
    return [[int(a), int(b)] for a, b in zip(edges[::2], edges[1::2], strict=True)]


def plain(values: npt.NDArray[Any], digits: int = 4) -> list[float | None]:
    """Return a short list of rounded numbers, None where not finite."""
    return [float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values.tolist()]
