"""The live loop: every line that comes is answered at once, n in, n out.

A malformed line is a missing sample: the filter coasts and the answer is its estimate.
"""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from stillrate._native import Filter
from stillrate.config import Config
from stillrate.errors import LogError
from stillrate.live.batch import Source
from stillrate.live.clock import Clock
from stillrate.live.lines import LineFormat, Row
from stillrate.live.sink import Sink
from stillrate.live.statistics import Statistics


class Tap(Protocol):
    """Something that looks on: whatever has this method.

    Examples
    --------
    >>> class Largest:
    ...     seen = 0.0
    ...
    ...     def sample(self, arrived_ns, raw, clean):
    ...         self.seen = max(self.seen, *map(abs, clean))
    >>> import os
    >>> import stillrate as sr
    >>> from stillrate.live import open_sink
    >>> from stillrate.live.source import StandardInput
    >>> read, write = os.pipe()
    >>> os.write(write, b"1.0,-3.0"), os.close(write)
    (8, None)
    >>> tap, sink = Largest(), open_sink("udp://127.0.0.1:9")
    >>> Loop(sr.Pt1(sample_rate_hz=50.0), StandardInput(read), sink, LineFormat(), tap).run()
    >>> sink.close()
    >>> tap.seen
    3.0
    """

    def sample(self, arrived_ns: int, raw: tuple[float, ...], clean: tuple[float, ...]) -> None:
        """Take a sample of all channels, before and after, in deg/s, and when it came in ns; must not wait."""
        ...


class Loop:
    r"""Lines through a filter.

    Parameters
    ----------
    config : Config
        Settings of every channel.
    source, sink : Source, Sink
        Where lines come from and go.
    lines : LineFormat
        How they are laid out.
    tap : Tap, optional
        Is shown every sample.

    Attributes
    ----------
    statistics : Statistics
        Counts and times so far.
    filter : Filter or None
        The filter with its last estimate; None before the first good line, which says how many channels there are.

    Examples
    --------
    >>> import os
    >>> import stillrate as sr
    >>> from stillrate.live.source import StandardInput
    >>> from stillrate.live.sink import StandardOutput
    >>> (inward, write), (read, outward) = os.pipe(), os.pipe()
    >>> os.write(write, b"1.0\nwhat?\n")
    10
    >>> os.close(write)
    >>> Loop(sr.Pt1(sample_rate_hz=50.0), StandardInput(inward), StandardOutput(outward), LineFormat()).run()
    >>> os.read(read, 100)
    b'1.0\n1.0\n'
    """

    def __init__(self, config: Config, source: Source, sink: Sink, lines: LineFormat, tap: Tap | None = None) -> None:
        self.config, self.source, self.sink, self.lines = config, source, sink, lines
        self.statistics = Statistics(period_s=1.0 / config.sample_rate_hz)
        self.filter: Filter | None = None
        self._clock: Clock | None = None
        self._tap = tap
        self._waiting = 0
        self._gap_s = 0.0

    def run(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Answer lines until the source ends, nobody reads the answers, or `stopped` says so.

        Raises
        ------
        LogError
            If the lines do not hold what was asked for, or none held a number.
        """
        counts = self.statistics
        while not stopped():
            try:
                batch = self.source.read()
            except EOFError:
                break
            if batch is None:
                continue
            counts.lines_in += len(batch.lines)
            before = counts.samples
            self._gap_s += batch.gap_s
            answers = [answer for line in batch.lines for answer in self._answer(line, batch.arrived_ns)]
            counts.arrived(batch.arrived_ns, counts.samples - before, connected=not batch.gap_s)
            if not answers:
                continue
            try:
                self.sink.write(answers)
            except BrokenPipeError:
                break
            counts.sent(batch.arrived_ns, len(answers))
        if self.filter is None and self._waiting:
            raise LogError(f"{self.source.name}: none of {self._waiting} lines holds numbers")

    def _answer(self, line: bytes, arrived_ns: int) -> list[bytes]:
        """Return the answer to a line; nothing yet for malformed lines before the first good one, which come with it."""
        if self.lines.passes(line):
            return [line]
        counts = self.statistics
        counts.samples += 1
        row = self.lines.parse(line)
        if row is None:
            counts.malformed += 1
            if self.filter is None:
                self._waiting += 1
                return []
        answers = []
        if self.filter is None or self.filter.channels != len(self.lines.names):
            self.filter = Filter(self.config, channels=len(self.lines.names))
            if self.lines.has_time:
                self._clock = Clock(self.config.sample_rate_hz, self.lines.time_unit_s)
            answers = [self._step(None, arrived_ns) for _ in range(self._waiting)]
            self._waiting = 0
        answers.append(self._step(row, arrived_ns))
        return answers

    def _step(self, row: Row | None, arrived_ns: int) -> bytes:
        assert self.filter is not None
        counts = self.statistics
        raw = (math.nan,) * self.filter.channels if row is None else tuple(row.values)
        if row is not None and any(map(math.isnan, raw)):
            counts.missing += 1
        dt_s = self._step_s(row)
        one = self.filter.channels == 1
        clean = (self.filter.update(raw[0], dt_s=dt_s),) if one else self.filter.update(raw, dt_s=dt_s)
        counts.raw, counts.clean = raw, clean
        if self._tap is not None:
            self._tap.sample(arrived_ns, raw, clean)
        return self.lines.format(row, clean)

    def _step_s(self, row: Row | None) -> float | None:
        """Return the time step: from the stamps, the time without a connection, or nominal (None)."""
        gap_s, self._gap_s = self._gap_s, 0.0
        if self._clock is None:
            return gap_s or None
        if row is not None and row.stamp is not None:
            return self._clock.step_s(row.stamp)
        self._clock.skip()
        return None


@contextmanager
def stop_on_signals() -> Iterator[Callable[[], bool]]:
    """Give a function that says whether ctrl-C or SIGTERM came; the second ctrl-C interrupts for good.

    Examples
    --------
    >>> with stop_on_signals() as stopped:
    ...     before = stopped()
    ...     signal.raise_signal(signal.SIGINT)  # ctrl-C
    ...     print(before, stopped())
    False True
    """
    event = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        # Python lets only the main thread handle signals.
        yield event.is_set
        return

    def stop(number: int, frame: object) -> None:
        event.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield event.is_set
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
