"""Betaflight and INAV blackbox: the longest flight of a file; unfiltered gyro if it was logged.

Not offered by `stillrate.read` yet: blackbox-log 0.4.3 predicts the first frame after a keyframe from the frame before
the keyframe where the firmware averages the keyframe with itself, so that gyro values come out up to 2 deg/s wrong
until the next keyframe.
"""

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
    flights, unreadable = _native.read_blackbox(path.read_bytes())
    if not flights:
        reason = f" ({unreadable[0]})" if unreadable else ""
        raise LogError(f"no flight in it that can be read{reason}")
    longest = max(flights, key=lambda flight: len(flight["time_us"]))
    notes = []
    if len(flights) > 1:
        notes.append(f"{len(flights)} flights in it: the longest is taken")
    if unreadable:
        notes.append(f"{len(unreadable)} flights cannot be read ({unreadable[0]})")
    columns: dict[str, Any] = {"time_us": longest["time_us"]}
    names = longest["names"]
    gyro = "gyroUnfilt" if any(name.startswith("gyroUnfilt") for name in names) else "gyroADC"
    for name, values in zip(names, longest["columns"], strict=True):
        columns[f"{name} (deg/s)" if name.startswith(gyro) else name] = values
    meta: dict[str, Any] = {"firmware": longest["firmware"]}
    if notes:
        meta["notes"] = notes
    return Table(columns, meta)
