"""Where clean lines go: stdout or UDP."""

from __future__ import annotations

import os
import select
import socket
import sys
from typing import Any, Protocol

from stillrate.errors import ConfigError, LogError
from stillrate.live.source import endpoint


class Sink(Protocol):
    """Something that takes lines: whatever has these fields and methods.

    Attributes
    ----------
    name : str
        As the user calls it.
    failed : int
        Lines that could not be sent.

    Examples
    --------
    A sink of one's own, here a list:

    >>> class Kept:
    ...     name, failed = "a list", 0
    ...
    ...     def __init__(self):
    ...         self.lines = []
    ...
    ...     def write(self, lines):
    ...         self.lines += lines
    ...
    ...     def close(self):
    ...         pass
    >>> import os
    >>> import stillrate as sr
    >>> from stillrate.live import LineFormat, Loop
    >>> from stillrate.live.source import StandardInput
    >>> read, write = os.pipe()
    >>> os.write(write, b"17,2.5,ok"), os.close(write)
    (9, None)
    >>> kept = Kept()
    >>> Loop(sr.Pt1(sample_rate_hz=50.0), StandardInput(read), kept, LineFormat(columns=["2"])).run()
    >>> kept.lines
    [b'17,2.5,ok']
    """

    name: str
    failed: int

    def write(self, lines: list[bytes]) -> None:
        """Write lines at once; BrokenPipeError if nobody reads them any more."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...


class StandardOutput:
    """Lines on a file descriptor, stdout by default, without a buffer between."""

    name = "stdout"
    failed = 0

    def __init__(self, descriptor: int = 1) -> None:
        self._descriptor = descriptor

    def write(self, lines: list[bytes]) -> None:
        """Write lines whole."""
        left = memoryview(b"\n".join(lines) + b"\n")
        while left:
            try:
                left = left[os.write(self._descriptor, left) :]
            except BlockingIOError:
                if sys.platform != "win32":
                    select.select([], [self._descriptor], [])

    def close(self) -> None:
        """Leave stdout open: it is not ours."""


class UdpSink:
    """One datagram out for one in."""

    def __init__(self, host: str, port: int) -> None:
        try:
            found = socket.getaddrinfo(host or "127.0.0.1", port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise LogError(f"udp://{host}:{port}: no such host ({error.strerror})") from None
        family, kind, _, _, address = found
        self._address: tuple[Any, ...] = address
        self._socket = socket.socket(family, kind)
        self.name = f"udp://{host or '127.0.0.1'}:{port}"
        self.failed = 0

    def write(self, lines: list[bytes]) -> None:
        """Send lines as one datagram; what cannot be sent is counted."""
        try:
            self._socket.sendto(b"\n".join(lines) + b"\n", self._address)
        except OSError:
            self.failed += len(lines)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def open_sink(name: str) -> Sink:
    """Open ``-`` (stdout) or ``udp://HOST:PORT``.

    Raises
    ------
    ConfigError
        If the name is neither.
    LogError
        If the host is unknown.

    Examples
    --------
    >>> sink = open_sink("udp://127.0.0.1:5005")
    >>> sink.write([b"0.1", b"0.2"])  # one datagram; nobody need listen
    >>> sink.close()
    """
    if name == "-":
        return StandardOutput()
    if name.startswith("udp:"):
        return UdpSink(*endpoint(name))
    raise ConfigError(f"{name}: cannot send there (- for stdout, or udp://HOST:PORT)")
