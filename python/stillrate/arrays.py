"""Anything that holds samples, as an array that the numerics can read in place."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


def as_samples(values: Any) -> npt.NDArray[Any]:
    """Return `values` as a one- or two-dimensional ``float32`` or ``float64`` array.

    Masked samples become NaN (missing). Series and frames of pandas and polars, lists and integers are converted;
    arrays with negative strides are copied.

    Parameters
    ----------
    values : array_like, shape (n,) or (n, channels)

    Raises
    ------
    TypeError
        If the values are not real numbers.
    ValueError
        If there are no or more than two dimensions.
    """
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    array = np.asarray(values)
    if array.dtype not in (np.float32, np.float64):
        if array.dtype.kind not in "fiubO":
            raise TypeError(f"samples must be real numbers, not {array.dtype}")
        array = array.astype(np.float64)
    if array.ndim not in (1, 2):
        raise ValueError(f"samples have {array.ndim} dimensions (shape must be (n,) or (n, channels))")
    if any(stride < 0 for stride in array.strides):
        array = np.ascontiguousarray(array)
    return np.asarray(array)


def as_column(values: Any) -> npt.NDArray[np.float64]:
    """Return one channel as a contiguous ``float64`` array of shape (n,); masked samples become NaN.

    Raises
    ------
    ValueError
        If there is more than one channel.
    """
    array = as_samples(values)
    if array.ndim == 2:
        if array.shape[1] != 1:
            raise ValueError(f"samples have {array.shape[1]} channels (take one at a time: z[:, k])")
        array = array[:, 0]
    return np.ascontiguousarray(array, dtype=np.float64)
