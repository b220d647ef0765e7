"""What a terminal shows of a live run: rate, jitter, latency, and each channel with its model in force."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from stillrate.live.loop import Loop
from stillrate.live.statistics import words
from stillrate.report.page import model_names
from stillrate.results import Estimate, Flags

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

_REFRESH_HZ = 4.0
_SWITCH_S = 2e-4
_RATE_WINDOW_S = 1.0
_RATE_TOLERANCE = 0.05


class Picture:
    """The tables, drawn anew at each look."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._seen = (time.monotonic(), 0)
        self._rate = math.nan

    def __call__(self) -> RenderableType:
        """Draw."""
        from rich.console import Group
        from rich.table import Table

        counts, loop = self._loop.statistics, self._loop
        facts = Table.grid(padding=(0, 2))
        facts.add_row("from", f"{loop.source.name} to {loop.sink.name}, {loop.config.method}")
        facts.add_row("lines", f"{counts.lines_in} in, {counts.lines_out} out{troubles(loop)}")
        facts.add_row("rate", f"{self._now():.1f} Hz{remark(loop)}")
        facts.add_row("jitter", words(counts.jitter))
        facts.add_row("latency", words(counts.latency))
        table = Table(box=None, padding=(0, 2))
        for name in ("channel", "raw", "clean deg/s", "±", "model in force", "frequency", ""):
            table.add_column(name, justify="right" if name in ("raw", "clean deg/s", "±", "frequency") else "left")
        for name, raw, estimate in zip(loop.lines.names, counts.raw, estimates(loop), strict=False):
            table.add_row(
                name,
                "missing" if math.isnan(raw) else f"{raw:.3f}",
                f"{estimate.rate:.3f}",
                f"{math.sqrt(max(0.0, estimate.variance)):.3f}",
                in_force(loop, estimate),
                "" if math.isnan(estimate.frequency_hz) else f"{estimate.frequency_hz:.2f} Hz",
                _flag_words(estimate.flags),
            )
        return Group(facts, table)

    def _now(self) -> float:
        """Return the rate over the last second or so."""
        at, samples = time.monotonic(), self._loop.statistics.samples
        if at - self._seen[0] >= _RATE_WINDOW_S:
            self._rate = (samples - self._seen[1]) / (at - self._seen[0])
            self._seen = (at, samples)
        return self._rate


def estimates(loop: Loop) -> tuple[Estimate, ...]:
    """Return the last estimate of each channel."""
    if loop.filter is None:
        return ()
    found = loop.filter.estimate
    return (found,) if isinstance(found, Estimate) else found


def in_force(loop: Loop, estimate: Estimate) -> str:
    """Return the most probable model by name."""
    if len(estimate.probability) < 2:
        return "-"
    names = model_names(loop.config, len(estimate.probability))
    probability, name = max(zip(estimate.probability, names, strict=True))
    return f"{name} ({100 * probability:.0f} %)"


def troubles(loop: Loop) -> str:
    """Return what went wrong so far in words, empty if nothing did."""
    counts = loop.statistics
    found = [
        f"{count} {word}"
        for count, word in (
            (counts.malformed, "malformed"),
            (counts.missing, "with a missing value"),
            (loop.source.dropped, "dropped by the system"),
            (loop.source.reconnections, "reconnections"),
            (loop.sink.failed, "not sent"),
        )
        if count
    ]
    return "".join(f", {trouble}" for trouble in found)


def remark(loop: Loop) -> str:
    """Return a warning if samples do not come at the rate of the settings."""
    rate, nominal = loop.statistics.rate_hz, loop.config.sample_rate_hz
    if loop.statistics.samples < nominal or not abs(rate / nominal - 1.0) > _RATE_TOLERANCE:
        return ""
    return f" (the settings are for {nominal:.6g} Hz: samples come at {rate:.4g} Hz)"


def _flag_words(flags: Flags) -> str:
    return ", ".join(flag.name.lower().replace("_", " ") for flag in Flags if flag and flag in flags and flag.name)


@contextmanager
def shown(loop: Loop, console: Console) -> Iterator[None]:
    """Show a loop on a terminal while the block runs."""
    from rich.live import Live

    # The thread that draws must not keep a sample waiting for the interpreter's usual 5 ms.
    before = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_S)
    try:
        with Live(
            get_renderable=Picture(loop),
            console=console,
            refresh_per_second=_REFRESH_HZ,
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
        ):
            yield
    finally:
        sys.setswitchinterval(before)
