"""Where lines come from, by name: stdin, UDP datagrams, or a serial port."""

from __future__ import annotations

import os
import re
import select
import socket
import stat
import struct
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

from stillrate.errors import ConfigError, LogError
from stillrate.live.batch import WAIT_S, Batch, Source, Splitter
from stillrate.live.serial_port import SerialPort

_RECEIVE_BUFFER = 1 << 22
_LINUX_STAMP, _LINUX_DROPS = 35, 40  # SO_TIMESTAMPNS, SO_RXQ_OVFL: the socket module does not name them


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
        try:
            found = socket.getaddrinfo(host or "0.0.0.0", port, type=socket.SOCK_DGRAM, flags=socket.AI_PASSIVE)[0]
        except OSError as error:
            raise LogError(f"udp://{host}:{port}: no such host ({error.strerror})") from None
        family, kind, _, _, address = found
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


def open_source(name: str, *, baud: int = 115200) -> Source:
    """Open ``-`` (stdin), ``udp://[HOST]:PORT``, a serial port, or a URL that pyserial knows.

    Raises
    ------
    LogError
        If the name means nothing, is a file, or cannot be opened.

    Examples
    --------
    Port 0 is any that is free; the source's name says which.

    >>> from stillrate.live import open_sink
    >>> source = open_source("udp://127.0.0.1:0")
    >>> sink = open_sink(source.name)
    >>> sink.write([b"0.1", b"0.2"])
    >>> source.read().lines
    [b'0.1', b'0.2']
    >>> sink.close(), source.close()
    (None, None)
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
    ConfigError
        If there is no port.
    """
    try:
        parts = urlsplit(name)
        host, port = parts.hostname or "", parts.port
    except ValueError:
        host, port = "", None
    if port is None or not name.startswith("udp://"):
        raise ConfigError(f"{name}: must be udp://HOST:PORT, such as udp://127.0.0.1:5005")
    return host, port
