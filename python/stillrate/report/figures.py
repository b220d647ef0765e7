"""The numbers that a report and a summary show, as the lab computes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.cleaning import Cleaned

QUIET_S = 2.0
"""Length of the quiet stretch that is looked for, in s."""

_SEGMENT = 4096


@dataclass(frozen=True)
class AxisFigures:
    """What a filter did to one channel.

    Attributes
    ----------
    channel : str
    density : float, optional
        Noise density in force, deg/s/sqrt(Hz).
    quiet : tuple of int
        First and last sample (exclusive) of the quietest two seconds.
    before_dps, after_dps : float
        Scatter about the mean there in deg/s, raw and filtered.
    removed_dps : float
        RMS of what was taken away over the whole record in deg/s.
    """

    channel: str
    density: float | None
    quiet: tuple[int, int]
    before_dps: float
    after_dps: float
    removed_dps: float


def axis_figures(done: Cleaned) -> list[AxisFigures]:
    """Return the figures of each channel."""
    window = max(16, round(QUIET_S * done.raw.sample_rate_hz))
    found = []
    for index, channel in enumerate(done.raw.channels):
        raw, clean = column(done.raw.rate_dps, index), column(done.clean.rate_dps, index)
        effect = _native.filter_effect(raw, clean, window)
        noise = done.configs[channel].noise
        density = None if noise is None else noise.density_dps_sqrt_hz
        quiet = (int(effect["start"]), int(effect["stop"]))
        found.append(
            AxisFigures(channel, density, quiet, effect["before"], effect["after"], effect["removed"])
        )
    return found


def spectrum(samples: npt.NDArray[np.float64], sample_rate_hz: float) -> tuple[npt.NDArray[np.float64], ...]:
    """Return frequencies in Hz and one-sided density in (deg/s)^2/Hz."""
    return _native.welch(samples, sample_rate_hz, min(_SEGMENT, max(256, len(samples) // 8)))


def column(table: npt.NDArray[np.float64], index: int) -> npt.NDArray[np.float64]:
    """Return one channel, contiguous."""
    return np.ascontiguousarray(table[:, index])
