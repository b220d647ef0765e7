"""Anything that holds samples, as an array that the numerics can read in place."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt


def as_samples(values: Any) -> npt.NDArray[Any]:
    """Return `values` as a one- or two-dimensional ``float32`` or ``float64`` array.

    Masked, null and NA samples become NaN (missing). Series and frames of pandas and polars, lists and integers are
    converted; arrays with negative strides are copied.

    Parameters
    ----------
    values : array_like, shape (n,) or (n, channels)

    Raises
    ------
    TypeError
        If the values are not real numbers.
    ValueError
        If there are no or more than two dimensions.

    Examples
    --------
    >>> as_samples(np.ma.masked_array([1.0, 2.0], mask=[False, True]))
    array([ 1., nan])
    """
    if isinstance(values, np.ma.MaskedArray):
        floating = values if values.dtype in (np.float32, np.float64) else values.astype(np.float64)
        values = np.ma.filled(floating, np.nan)
    elif _library(values) == "pandas":
        values = _from_pandas(values)
    elif isinstance(values, (list, tuple)):
        values = [as_number(value) if _is_missing(value) else value for value in values]
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


def like(given: Any, result: npt.NDArray[Any]) -> Any:
    """Return a result as what the samples came as: a series or frame keeps index, names and library.

    Everything else, lists and masked arrays too, becomes an array: nothing is missing in a result.

    Examples
    --------
    >>> import polars
    >>> like(polars.Series("gz", [1, 2]), np.array([0.5, 1.5])).name
    'gz'
    """
    library, kind = _library(given), type(given).__name__
    if kind not in ("Series", "DataFrame"):
        return result
    if library == "pandas":
        if kind == "Series":
            return type(given)(result, index=given.index, name=given.name)
        return type(given)(result, index=given.index, columns=given.columns)
    if library == "polars":
        if kind == "Series":
            return type(given)(given.name, result)
        return type(given)({name: result[:, index] for index, name in enumerate(given.columns)})
    return result


def as_number(value: Any) -> float:
    """Return one sample as a float; what is masked, None or NA is NaN.

    Raises
    ------
    TypeError
        If it is no number.

    Examples
    --------
    >>> as_number(None)
    nan
    """
    if _is_missing(value):
        return math.nan
    if isinstance(value, (str, bytes)):
        raise TypeError(f"a sample must be a number, not {type(value).__name__}")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"a sample must be a number, not {type(value).__name__}") from None


def _is_missing(value: Any) -> bool:
    return value is None or value is np.ma.masked or type(value).__name__ == "NAType"


def _library(values: Any) -> str:
    """Return the package that a type comes from, without importing it."""
    return type(values).__module__.partition(".")[0]


def _from_pandas(values: Any) -> Any:
    """Return a series' or frame's values, NA as NaN; numpy's own conversion stops at nullable columns."""
    if type(values).__name__ not in ("Series", "DataFrame"):
        return values
    kinds = set(values.dtypes) if values.ndim == 2 else {values.dtype}
    for kind in kinds:
        if kind.kind not in "fiubO":
            raise TypeError(f"samples must be real numbers, not {kind}")
    return values.to_numpy(dtype=np.float32 if kinds <= {"float32", "Float32"} else np.float64, na_value=np.nan)


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
