"""The numbers that a report and a summary show, as the lab computes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stillrate import _native
from stillrate.allan_deviation import allan
from stillrate.cleaning import Cleaned
from stillrate.errors import LogError
from stillrate.io.log import Floats, Log
from stillrate.report.packing import plain

QUIET_S = 2.0
"""Length of the quiet stretch that is looked for, in s."""

_SEGMENT = 4096
_MOTION_RATIO = 3.0


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
    in_motion : bool
        Even there the scatter is far above the noise in force: the ratio would say nothing.
    removed_dps : float
        RMS of what was taken away over the whole record in deg/s.
    """

    channel: str
    density: float | None
    quiet: tuple[int, int]
    before_dps: float
    after_dps: float
    removed_dps: float
    in_motion: bool

    def cells(self) -> list[str]:
        """Return the figures as words: channel, density, before, after, ratio, removed."""
        density = "-" if self.density is None else f"{self.density:.3g}"
        if self.in_motion:
            ratio = "never at rest"
        elif self.after_dps > 0:
            times = self.before_dps / self.after_dps
            ratio = f"{times:,.0f}x" if times >= 100 else f"{times:.3g}x"
        else:
            ratio = "-"
        return [
            self.channel,
            density,
            f"{self.before_dps:.3g}",
            f"{self.after_dps:.3g}",
            ratio,
            f"{self.removed_dps:.3g}",
        ]


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
        before, after = float(effect["before"]), float(effect["after"])
        in_motion = density is not None and before > _MOTION_RATIO * density * done.raw.sample_rate_hz**0.5
        found.append(AxisFigures(channel, density, quiet, before, after, float(effect["removed"]), in_motion))
    return found


def spectra(raw: Floats, clean: Floats, log: Log) -> dict[str, Any] | None:
    """Return frequencies in Hz and both one-sided densities in (deg/s)^2/Hz, thinned out for a picture."""
    segment = min(_SEGMENT, max(256, len(log) // 8))
    frequency, before = _native.welch(raw, log.sample_rate_hz, segment)
    _, after = _native.welch(clean, log.sample_rate_hz, segment)
    if not len(frequency) or not before.any():
        return None
    return {"x": plain(frequency), "raw": plain(before), "clean": plain(after)}


def allan_curves(raw: Floats, clean: Floats, log: Log) -> dict[str, Any] | None:
    """Return averaging times in s and both Allan deviations in deg/s."""
    try:
        before = allan(raw, log.sample_rate_hz, taus="dense")
        after = allan(clean, log.sample_rate_hz, taus="dense")
    except LogError:
        return None
    return {"x": plain(before.tau_s), "raw": plain(before.deviation), "clean": plain(after.deviation)}


def remarks(done: Cleaned) -> list[str]:
    """Return what a user should know: units, time stamps, flagged samples."""
    found = [*done.notes, *done.raw.meta.get("notes", []), *done.raw.timing.remarks()]
    for channel, counts in done.counts.items():
        words = ", ".join(f"{count} {name.lower().replace('_', ' ')}" for name, count in counts.items())
        if words:
            found.append(f"{channel}: {words}")
    return found


def column(table: Floats, index: int) -> Floats:
    """Return one channel, contiguous."""
    return np.ascontiguousarray(table[:, index])
