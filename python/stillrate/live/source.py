"""Where lines come from: stdin, UDP datagrams, a serial port.

A source waits a fifth of a second at most, so that whoever reads it can look up between two waits.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import select
import socket
import stat
import struct
import sys
import time
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import urlsplit

from stillrate.errors import LogError
from stillrate.io.safely import needs

WAIT_S = 0.2
LONGEST_LINE = 1 << 16
"""A line without an end is cut off here, and counts as one malformed line."""

_RETRY_S = 0.5
_RECEIVE_BUFFER = 1 << 22
_LINUX_STAMP, _LINUX_DROPS = 35, 40  # SO_TIMESTAMPNS, SO_RXQ_OVFL: the socket module does not name them


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
    """

    __slots__ = ("arrived_ns", "gap_s", "lines")

    def __init__(self, lines: list[bytes], arrived_ns: int, gap_s: float = 0.0) -> None:
        self.lines, self.arrived_ns, self.gap_s = lines, arrived_ns, gap_s


class Source(Protocol):
    """Something that lines come from.

    Attributes
    ----------
    name : str
        As the user calls it.
    dropped : int
        Datagrams that the system threw away because nobody fetched them in time.
    reconnections : int
        How often the connection came back.
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


class StandardInput:
    """Lines on a file descriptor, stdin by default."""

    name = "stdin"
    dropped = 0
    reconnections = 0

    def __init__(self, descriptor: int = 0) -> None:
        self._descriptor = descriptor
        self._splitter = Splitter()
        self._ended = False

    def read(self) -> Batch | None:
        """Return the lines that have come."""
        if self._ended:
            raise EOFError
        # Windows can wait for sockets only: there a read blocks until a line comes.
        if sys.platform != "win32" and not select.select([self._descriptor], [], [], WAIT_S)[0]:
            return None
        data = os.read(self._descriptor, 1 << 16)
        arrived = time.time_ns()
        self._ended = not data
        lines = self._splitter.feed(data) if data else self._splitter.last()
        return Batch(lines, arrived) if lines else None

    def close(self) -> None:
        """Leave stdin open: it is not ours."""


class Udp:
    """Datagrams of one or more lines."""

    reconnections = 0

    def __init__(self, host: str, port: int) -> None:
        family, kind, _, _, address = socket.getaddrinfo(
            host or "0.0.0.0", port, type=socket.SOCK_DGRAM, flags=socket.AI_PASSIVE
        )[0]
        self.dropped = 0
        self._socket = socket.socket(family, kind)
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER)
            if sys.platform == "linux":
                for option in (_LINUX_STAMP, _LINUX_DROPS):
                    self._socket.setsockopt(socket.SOL_SOCKET, option, 1)
            self._socket.bind(address)
        except OSError as error:
            self._socket.close()
            raise LogError(f"udp://{host}:{port}: cannot listen ({error.strerror})") from None
        self._socket.settimeout(WAIT_S)
        self.port: int = self._socket.getsockname()[1]
        self.name = f"udp://{host}:{self.port}"

    def read(self) -> Batch | None:
        """Return the lines of the next datagram."""
        try:
            if sys.platform == "linux":
                data, extra, _, _ = self._socket.recvmsg(1 << 16, 128)
                arrived = self._stamp(extra)
            else:
                data, arrived = self._socket.recv(1 << 16), 0
        except TimeoutError:
            return None
        lines = data.removesuffix(b"\n").split(b"\n")
        return Batch([line.removesuffix(b"\r") for line in lines], arrived or time.time_ns())

    def _stamp(self, extra: list[tuple[int, int, bytes]]) -> int:
        """Return the kernel's receive stamp in ns, 0 if there is none; keep its count of dropped datagrams."""
        arrived = 0
        for _, kind, data in extra:
            if kind == _LINUX_STAMP and len(data) == 16:
                seconds, nanoseconds = struct.unpack("qq", data)
                arrived = seconds * 1_000_000_000 + nanoseconds
            elif kind == _LINUX_DROPS:
                (self.dropped,) = struct.unpack("I", data[:4])
        return arrived

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class SerialPort:
    """A serial port, or anything else that pyserial opens (``socket://host:port``); found again when it vanishes.

    What comes before the first line end is dropped: it may be the tail of a line.
    """

    dropped = 0

    def __init__(self, name: str, baud: int) -> None:
        self.name = name
        self.reconnections = 0
        self._baud = baud
        self._serial = needs("serial", "live", "a serial port")
        self._lost_at: float | None = None
        self._retry_at = 0.0
        try:
            self._port: Any = self._open()
        except (OSError, ValueError) as error:
            if getattr(error, "errno", None) == errno.ENOENT:
                raise LogError(f"{name}: there is no such port (`-` is stdin, udp://HOST:PORT is UDP)") from None
            raise LogError(f"{name}: cannot open the port ({error})") from None

    def _open(self) -> Any:
        self._splitter = Splitter()
        self._aligned = False
        return self._serial.serial_for_url(self.name, baudrate=self._baud, timeout=WAIT_S)

    def read(self) -> Batch | None:
        """Return the lines that have come; None while the port is away."""
        if self._port is None and not self._again():
            return None
        try:
            data: bytes = self._port.read(1)
            if data:
                data += self._port.read(self._port.in_waiting)
        except (OSError, TypeError):  # TypeError: pyserial, when the port is closed under it
            self._lose()
            return None
        if not data:
            return None
        arrived = time.time_ns()
        lines = self._splitter.feed(data)
        if lines and not self._aligned:
            self._aligned = True
            lines = lines[1:]
        if not lines:
            return None
        gap_s, self._lost_at = (0.0, None) if self._lost_at is None else (time.monotonic() - self._lost_at, None)
        return Batch(lines, arrived, gap_s)

    def _lose(self) -> None:
        self.close()
        self._port = None
        if self._lost_at is None:
            self._lost_at = time.monotonic()
        self._retry_at = time.monotonic()

    def _again(self) -> bool:
        """Try to open the port, twice a second."""
        wait = self._retry_at - time.monotonic()
        if wait > 0:
            time.sleep(min(wait, WAIT_S))
            return False
        try:
            self._port = self._open()
        except (OSError, ValueError):
            self._retry_at = time.monotonic() + _RETRY_S
            return False
        self.reconnections += 1
        return True

    def close(self) -> None:
        """Close the port."""
        if self._port is not None:
            with contextlib.suppress(OSError):
                self._port.close()


def open_source(name: str, *, baud: int = 115200) -> Source:
    """Open ``-`` (stdin), ``udp://[HOST]:PORT``, a serial port, or a URL that pyserial knows.

    Raises
    ------
    LogError
        If the name means nothing, is a file, or cannot be opened.
    """
    if name == "-":
        return StandardInput()
    if name.startswith("udp:"):
        return Udp(*endpoint(name))
    if "://" in name or re.fullmatch(r"COM\d+", name, re.IGNORECASE):
        return SerialPort(name, baud)
    path = Path(name)
    if path.exists() and not stat.S_ISCHR(path.stat().st_mode):
        raise LogError(f"{name}: is no live source; clean a log with filter, or replay it: live - < {name}")
    return SerialPort(name, baud)


def endpoint(name: str) -> tuple[str, int]:
    """Return host and port of ``udp://HOST:PORT``.

    Raises
    ------
    LogError
        If there is no port.
    """
    try:
        parts = urlsplit(name)
        host, port = parts.hostname or "", parts.port
    except ValueError:
        host, port = "", None
    if port is None or not name.startswith("udp://"):
        raise LogError(f"{name}: must be udp://HOST:PORT, such as udp://127.0.0.1:5005")
    return host, port
