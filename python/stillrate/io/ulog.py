"""PX4 ULog through pyulog: the gyro of ``sensor_combined``, else the first of ``sensor_gyro``."""

from __future__ import annotations

import contextlib
import io
import struct
from pathlib import Path
from typing import Any

from stillrate.errors import LogError
from stillrate.io.safely import first_line, needs, refuse_zeros_at_end, within_bounds
from stillrate.io.table import Table

_MAGIC = b"ULog\x01\x12\x35"
_HEADER_BYTES = 16
_SOURCES = {
    "sensor_combined": ("gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"),
    "sensor_gyro": ("x", "y", "z"),
}


def read(path: Path) -> Table:
    """Read a ULog file."""
    within_bounds(path)
    refuse_zeros_at_end(path)
    pyulog = needs("pyulog", "logs", "ULog")
    _walk(path)
    try:
        # The library reports damage by printing.
        with contextlib.redirect_stdout(io.StringIO()):
            log = pyulog.ULog(str(path), message_name_filter_list=list(_SOURCES))
    except Exception as error:
        raise LogError(f"not a readable ULog file ({first_line(error)})") from None
    if log.file_corruption:
        raise LogError("damaged ULog file: a message of it cannot be read")
    for name, fields in _SOURCES.items():
        found = [data for data in log.data_list if data.name == name and len(data.data["timestamp"]) > 1]
        if found:
            return _table(found, fields)
    raise LogError(f"no {' or '.join(_SOURCES)} in it: log one of them")


def _walk(path: Path) -> None:
    """Follow the chain of messages to the end of the file: pyulog takes a cut file for a short one."""
    with path.open("rb") as file:
        content = file.read()
    if content[: len(_MAGIC)] != _MAGIC:
        raise LogError("not a ULog file (its first bytes are others)")
    at = _HEADER_BYTES
    while at < len(content):
        if at + 3 > len(content):
            raise LogError(f"the file ends within a message at byte {at}: half-written")
        size, kind = struct.unpack_from("<HB", content, at)
        if size == 0 and kind == 0:
            raise LogError(f"zeros instead of a message at byte {at}: the file is damaged")
        at += 3 + size
    if at != len(content):
        raise LogError(f"the file ends within its last message ({at - len(content)} bytes short): half-written")


def _table(found: list[Any], fields: tuple[str, str, str]) -> Table:
    data = found[0].data
    columns = {"timestamp_us": data["timestamp"].astype("int64")}
    columns.update({f"g{axis}_rad_s": data[field] for axis, field in zip("xyz", fields, strict=True)})
    columns.update({name: values for name, values in data.items() if name not in (*fields, "timestamp")})
    meta: dict[str, Any] = {"message": found[0].name}
    if len(found) > 1:
        meta["notes"] = [f"{len(found)} sensors in it: the first is taken"]
    return Table(columns, meta)
