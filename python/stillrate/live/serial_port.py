"""Lines from a serial port, which may vanish and come back."""

from __future__ import annotations

import contextlib
import errno
import time
from typing import Any

from stillrate.errors import LogError
from stillrate.io.safely import needs
from stillrate.live.batch import WAIT_S, Batch, Splitter

_RETRY_S = 0.5


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
