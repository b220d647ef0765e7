"""Counts and times of a live run, in bounded memory."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

_STEP = math.log(1.04)
_SMALLEST_S = 1e-6
_BINS = 520  # up to 700 s
_PAUSE_S = 0.25


class Histogram:
    """Durations in bins of 4 %, from 1 us on.

    Examples
    --------
    >>> durations = Histogram()
    >>> for k in range(1, 101):
    ...     durations.add(1e-3 * k)
    >>> round(durations.percentile_s(50.0), 2)
    0.05
    """

    def __init__(self) -> None:
        self._counts = [0] * _BINS
        self.count = 0
        self.largest_s = 0.0

    def add(self, duration_s: float, times: int = 1) -> None:
        """Count a duration."""
        index = int(math.log(duration_s / _SMALLEST_S) / _STEP) + 1 if duration_s > _SMALLEST_S else 0
        self._counts[min(index, _BINS - 1)] += times
        self.count += times
        if duration_s > self.largest_s:
            self.largest_s = duration_s

    def percentile_s(self, percent: float) -> float:
        """Return the duration that so many per cent do not exceed, NaN without any."""
        if not self.count:
            return math.nan
        wanted, seen = self.count * percent / 100.0, 0
        for index, count in enumerate(self._counts):
            seen += count
            if count and seen >= wanted:
                return min(_SMALLEST_S * math.exp(index * _STEP), self.largest_s)
        return self.largest_s


@dataclass
class Statistics:
    """What a live run counts.

    Attributes
    ----------
    period_s : float
        Nominal period in s.
    lines_in, lines_out : int
        All lines, with blank ones, comments and the header.
    samples, malformed, missing : int
        Lines that held or should have held a sample; those that could not be read; good lines with a missing value.
    latency, jitter : Histogram
        From arrival to sent; distance of the intervals between arrivals from nominal.
    raw, clean : tuple of float
        The last sample in and out in deg/s.

    Examples
    --------
    Batches that come every 20 ms, one sample each; a pause is no rate.

    >>> counts = Statistics(period_s=0.02)
    >>> now = time.time_ns()
    >>> for k in range(50):
    ...     counts.arrived(now + k * 20_000_000, 1, connected=True)
    >>> counts.arrived(now + 60_000_000_000, 1, connected=True)
    >>> round(counts.rate_hz, 6)
    50.0
    >>> counts.sent(time.time_ns() - 2_000_000, lines=1)  # it came 2 ms ago
    >>> counts.latency.largest_s >= 0.002
    True
    >>> counts.summary()[1]
    'rate 50 Hz (settings 50 Hz), interval off nominal p50 0.001 ms, p99 59000.000 ms, longest 59000.000 ms'
    """

    period_s: float
    lines_in: int = 0
    lines_out: int = 0
    samples: int = 0
    malformed: int = 0
    missing: int = 0
    latency: Histogram = field(default_factory=Histogram)
    jitter: Histogram = field(default_factory=Histogram)
    raw: tuple[float, ...] = ()
    clean: tuple[float, ...] = ()
    started_s: float = field(default_factory=time.monotonic)
    first_ns: int = 0
    last_ns: int = 0
    _rate_samples: int = field(default=0, init=False, repr=False)
    _rate_span_s: float = field(default=0.0, init=False, repr=False)

    def arrived(self, at_ns: int, samples: int, *, connected: bool) -> None:
        """Count the arrival of a batch."""
        if not self.first_ns:
            self.first_ns = at_ns
        elif samples and connected:
            passed = (at_ns - self.last_ns) * 1e-9
            self.jitter.add(abs(passed / samples - self.period_s))
            # A pause of the sender is no rate.
            if passed < max(_PAUSE_S, 20.0 * self.period_s):
                self._rate_samples += samples
                self._rate_span_s += passed
        self.last_ns = at_ns

    def sent(self, arrived_ns: int, lines: int) -> None:
        """Count lines that are out."""
        self.lines_out += lines
        self.latency.add((time.time_ns() - arrived_ns) * 1e-9, lines)

    @property
    def rate_hz(self) -> float:
        """Mean rate of arrival in Hz without pauses, NaN before the second batch."""
        return self._rate_samples / self._rate_span_s if self._rate_span_s > 0 else math.nan

    def summary(self) -> list[str]:
        """Return the figures in words."""
        found = [
            f"{self.lines_in} lines in, {self.lines_out} out; {self.samples} samples,"
            f" {self.malformed} malformed, {self.missing} with a missing value"
        ]
        if self.jitter.count:
            found.append(
                f"rate {self.rate_hz:.6g} Hz (settings {1.0 / self.period_s:.6g} Hz), interval off nominal"
                f" {words(self.jitter)}"
            )
        if self.latency.count:
            found.append(f"added latency {words(self.latency)}")
        return found


def words(histogram: Histogram) -> str:
    """Return percentiles in words."""
    middle, high = (1e3 * histogram.percentile_s(percent) for percent in (50.0, 99.0))
    return f"p50 {middle:.3f} ms, p99 {high:.3f} ms, longest {1e3 * histogram.largest_s:.3f} ms"
