"""What sources hand over: lines that came together, cut out of a stream of bytes.

A source waits a fifth of a second at most, so that whoever reads it can look up between two waits.
"""

from __future__ import annotations

from typing import Protocol

WAIT_S = 0.2
LONGEST_LINE = 1 << 16
"""A line without an end is cut off here, and counts as one malformed line."""


class Batch:
    """Lines that came together.

    Attributes
    ----------
    lines : list of bytes
        Without their ends.
    arrived_ns : int
        When they came, in ns of the system's clock; by the kernel's stamp where it gives one.
    gap_s : float
        Time without a connection just before, in s.

    Examples
    --------
    >>> batch = Batch([b"0.1", b"0.2"], arrived_ns=1_700_000_000_000_000_000)
    >>> len(batch.lines), batch.gap_s
    (2, 0.0)
    """

    __slots__ = ("arrived_ns", "gap_s", "lines")

    def __init__(self, lines: list[bytes], arrived_ns: int, gap_s: float = 0.0) -> None:
        self.lines, self.arrived_ns, self.gap_s = lines, arrived_ns, gap_s


class Source(Protocol):
    """Something that lines come from: whatever has these fields and methods.

    Attributes
    ----------
    name : str
        As the user calls it.
    dropped : int
        Datagrams that the system threw away because nobody fetched them in time.
    reconnections : int
        How often the connection came back.

    Examples
    --------
    A source of one's own, here a list in place of a sensor's driver:

    >>> import time
    >>> class Recorded:
    ...     name, dropped, reconnections = "a list", 0, 0
    ...
    ...     def __init__(self, *lines):
    ...         self.left = list(lines)
    ...
    ...     def read(self):
    ...         if not self.left:
    ...             raise EOFError
    ...         return Batch([self.left.pop(0)], time.time_ns())
    ...
    ...     def close(self):
    ...         self.left = []
    >>> import stillrate as sr
    >>> from stillrate.live import LineFormat, Loop, open_sink
    >>> loop = Loop(sr.Pt1(sample_rate_hz=50.0), Recorded(b"1.0", b"1.0"), open_sink("udp://127.0.0.1:9"), LineFormat())
    >>> loop.run()
    >>> loop.sink.close()
    >>> loop.statistics.samples, loop.filter.estimate.rate
    (2, 1.0)
    """

    name: str
    dropped: int
    reconnections: int

    def read(self) -> Batch | None:
        """Return what has come, or None after a short wait; EOFError at the end."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...


class Splitter:
    r"""Bytes into lines, of bounded length.

    Examples
    --------
    >>> splitter = Splitter()
    >>> splitter.feed(b"1.0\n2."), splitter.feed(b"5\n")
    ([b'1.0'], [b'2.5'])
    """

    def __init__(self) -> None:
        self._rest = b""
        self._cut = False

    def feed(self, data: bytes) -> list[bytes]:
        """Return the lines that end in this piece."""
        *lines, rest = (self._rest + data).split(b"\n")
        if self._cut and lines:
            lines[0], self._cut = b"?", False
        if len(rest) > LONGEST_LINE or self._cut:
            rest, self._cut = b"", True
        self._rest = rest
        return [line.removesuffix(b"\r") if len(line) <= LONGEST_LINE else b"?" for line in lines]

    def last(self) -> list[bytes]:
        """Return what is left at the end."""
        rest, self._rest = self._rest, b""
        return [b"?"] if self._cut else [rest] if rest else []
