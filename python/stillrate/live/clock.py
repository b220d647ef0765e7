"""Time steps from the stamps that stand in the lines, as the reader of whole logs finds them."""

from __future__ import annotations

import math

import numpy as np

from stillrate import _native
from stillrate.io.names import TIME_UNITS


class Clock:
    """Time step of each sample: nominal where the stamps are within 2 % of it.

    Parameters
    ----------
    sample_rate_hz : float
        Nominal rate in Hz.
    unit_s : float, optional
        Seconds per unit of the stamps; without it the unit that comes nearest to the nominal rate.

    Examples
    --------
    >>> clock = Clock(100.0)
    >>> [clock.step_s(stamp) for stamp in (b"1000", b"1010", b"1035")]
    [None, 0.01, 0.025]
    """

    def __init__(self, sample_rate_hz: float, unit_s: float | None = None) -> None:
        self._rate = sample_rate_hz
        self._unit = unit_s
        self._first: int | float | None = None
        self._last: int | float = 0

    def step_s(self, text: bytes) -> float | None:
        """Return the time since the stamp before in s, NaN if the stamp is none; None for the first sample."""
        stamp = _stamp(text)
        if stamp is None:
            return math.nan
        if self._first is None:
            self._first = self._last = stamp
            return None
        if self._unit is None:
            step = abs(stamp - self._last)
            if step == 0:
                return 0.0
            self._unit = min(TIME_UNITS.values(), key=lambda unit: abs(math.log(step * unit * self._rate)))
        pair = np.array([(self._last - self._first) * self._unit, (stamp - self._first) * self._unit])
        self._last = stamp
        return float(_native.time_steps(pair, self._rate)[1])

    def skip(self) -> None:
        """Let a nominal period pass, for a line whose stamp could not be read."""
        if self._unit is not None:
            self._last += 1.0 / (self._rate * self._unit)


def _stamp(text: bytes) -> int | float | None:
    """Read a stamp: whole numbers stay whole, so that nanoseconds since 1970 keep their digits."""
    try:
        return int(text)
    except ValueError:
        pass
    try:
        stamp = float(text)
    except ValueError:
        return None
    return stamp if math.isfinite(stamp) else None
