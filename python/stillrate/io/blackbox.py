"""Betaflight and INAV blackbox: the longest flight of a file; unfiltered gyro if it was logged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stillrate import _native
from stillrate.errors import LogError
from stillrate.io.safely import refuse_zeros_at_end, within_bounds
from stillrate.io.table import Table

_MAGIC = b"H Product:Blackbox"
MAX_BLACKBOX_BYTES = 1_000_000_000


def read(path: Path) -> Table:
    """Read a blackbox file."""
    within_bounds(path)
    if path.stat().st_size > MAX_BLACKBOX_BYTES:
        raise LogError("larger than a gigabyte, which no flight controller writes")
    with path.open("rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise LogError("not a blackbox log (its first bytes are others)")
    refuse_zeros_at_end(path)
    longest, flights, unreadable = _native.read_blackbox(path.read_bytes())
    if longest is None:
        reason = f" ({unreadable[0]})" if unreadable else ""
        raise LogError(f"no flight in it that can be read{reason}")
    notes = []
    if flights > 1:
        notes.append(f"{flights} flights in it: the longest is taken")
    if unreadable:
        notes.append(f"{_counted(len(unreadable), 'flight')} cannot be read ({unreadable[0]})")
    if longest["damaged_places"]:
        notes.append(f"damaged at {_counted(longest['damaged_places'], 'place')}: what stood there is left out")
    if longest["full"]:
        notes.append("longer than can be held: its beginning is taken")
    elif not longest["ended"]:
        notes.append("the log was not closed: it may end early")
    columns: dict[str, Any] = {"time_us": longest["time_us"]}
    names = longest["names"]
    gyro = "gyroUnfilt" if any(name.startswith("gyroUnfilt") for name in names) else "gyroADC"
    for name, values in zip(names, longest["columns"], strict=True):
        if name == "time":  # the clock of 32 bits; the stamps above are its count without overflow
            continue
        columns[f"{name} (deg/s)" if name.startswith(gyro) else name] = values
    meta: dict[str, Any] = {"firmware": longest["firmware"]}
    if notes:
        meta["notes"] = notes
    return Table(columns, meta)


def _counted(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"
