"""One line from a raw array to a clean one."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, TypeVar, overload

import numpy as np
import numpy.typing as npt

from stillrate._native import Filter
from stillrate.arrays import as_samples, like
from stillrate.config import method_class
from stillrate.noise import GyroNoise, noise_from_log


class MotionDominated(UserWarning):
    """Most of the signal is motion: the noise figures are an upper bound, the filter can take out little."""


_Container = TypeVar("_Container")


@overload
def denoise(
    samples: npt.NDArray[Any] | Sequence[Any],
    *,
    sample_rate_hz: float,
    method: str = ...,
    noise: GyroNoise | None = ...,
    dt_s: Any = ...,
) -> npt.NDArray[Any]: ...


@overload
def denoise(
    samples: _Container,
    *,
    sample_rate_hz: float,
    method: str = ...,
    noise: GyroNoise | None = ...,
    dt_s: Any = ...,
) -> _Container: ...


def denoise(
    samples: Any,
    *,
    sample_rate_hz: float,
    method: str = "ms-imm-ikf",
    noise: GyroNoise | None = None,
    dt_s: Any = None,
) -> Any:
    """Clean a gyro signal; without `noise`, each channel's noise is estimated from the signal itself.

    Parameters
    ----------
    samples : array_like, shape (n,) or (n, channels)
        Rates in deg/s; NaN, infinite or masked samples are missing.
    sample_rate_hz : float
        Nominal sample rate in Hz.
    method : str, optional
        Name of a method, see `stillrate.config.methods`.
    noise : GyroNoise, optional
        The noise of all channels, where it is known.
    dt_s : float or array_like, optional
        Time steps in s, where samples are irregular.

    Returns
    -------
    ndarray
        Same shape as `samples`, n in, n out; a series or frame of pandas or polars for one, with its index and names.

    Warns
    -----
    MotionDominated
        If a channel hardly ever rests.

    Raises
    ------
    LogError
        If the noise cannot be estimated (fewer than 8 usable samples).
    ConfigError
        If the method is unknown or a setting out of range.

    Examples
    --------
    >>> from stillrate import simulate
    >>> bed = simulate.static(50.0, 1)
    >>> clean = denoise(bed.measured_dps, sample_rate_hz=50.0)
    >>> float(clean.std()) < 0.2 * float(bed.measured_dps.std())
    True
    """
    array = as_samples(samples)
    columns = array[:, None] if array.ndim == 1 else array
    clean = np.empty_like(columns)
    kind = method_class(method)
    figures = None if noise is not None else noise_from_log(columns, sample_rate_hz)
    for channel in range(columns.shape[1]):
        if figures is not None:
            found = figures[channel]
            noise = found.gyro
            if found.motion_dominated:
                warnings.warn(f"channel {channel}: {found.reason}", MotionDominated, stacklevel=2)
        config = kind(sample_rate_hz=sample_rate_hz, noise=noise)
        clean[:, channel] = Filter(config, dtype=str(array.dtype)).run(columns[:, channel], dt_s=dt_s)
    return like(samples, clean.reshape(array.shape))
