"""ROS 1 and 2 bags and MCAP through rosbags: messages of type ``sensor_msgs/Imu``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stillrate.errors import LogError
from stillrate.io.safely import first_line, needs, refuse_zeros_at_end, within_bounds
from stillrate.io.table import Table

_TYPE = "sensor_msgs/msg/Imu"


def read(path: Path) -> Table:
    """Read a bag (a file, or the folder of a ROS 2 bag)."""
    if path.suffix.lower() == ".db3":
        path = path.parent
    for file in [path] if path.is_file() else [item for item in path.iterdir() if item.is_file()]:
        within_bounds(file)
        if file.suffix.lower() in (".mcap", ".bag") or (file.suffix.lower() == ".db3" and _longer_than_its_pages(file)):
            refuse_zeros_at_end(file)
    highlevel = needs("rosbags.highlevel", "logs", "a ROS bag")
    try:
        with highlevel.AnyReader([path], default_typestore=_types()) as reader:
            return _table(reader)
    except LogError:
        raise
    except Exception as error:  # the library's own errors, and those of sqlite, lz4, struct on damaged files
        raise LogError(f"not a readable bag ({first_line(error)})") from None


def _longer_than_its_pages(path: Path) -> bool:
    """Whether there is more in a database file than its header tells (size of a page, number of pages)."""
    with path.open("rb") as file:
        head = file.read(32)
    if len(head) < 32:
        return False
    page, count = int.from_bytes(head[16:18], "big"), int.from_bytes(head[28:32], "big")
    return path.stat().st_size > (65536 if page == 1 else page) * count > 0


def _types() -> Any:
    typesys = needs("rosbags.typesys", "logs", "a ROS bag")
    return typesys.get_typestore(typesys.Stores.LATEST)


def _table(reader: Any) -> Table:
    topics = [connection for connection in reader.connections if connection.msgtype == _TYPE]
    if not topics:
        found = ", ".join(sorted({connection.msgtype for connection in reader.connections})) or "nothing"
        raise LogError(f"no {_TYPE} in it (there is {found})")
    topic = max(topics, key=lambda connection: connection.msgcount)
    expected = topic.msgcount
    stamps, rows = np.empty(expected, np.int64), np.empty((expected, 6))
    count = 0
    for _, _, raw in reader.messages(connections=[topic]):
        message = reader.deserialize(raw, topic.msgtype)
        if count == expected:
            break
        stamp, rate, force = message.header.stamp, message.angular_velocity, message.linear_acceleration
        stamps[count] = stamp.sec * 1_000_000_000 + stamp.nanosec
        rows[count] = (rate.x, rate.y, rate.z, force.x, force.y, force.z)
        count += 1
    if count != expected or count == 0:
        raise LogError(f"{count} messages where {expected} are announced: the bag is damaged")
    columns: dict[str, Any] = {"stamp_ns": stamps}
    names = ("gx_rad_s", "gy_rad_s", "gz_rad_s", "ax_m_s2", "ay_m_s2", "az_m_s2")
    columns.update({name: np.ascontiguousarray(rows[:, index]) for index, name in enumerate(names)})
    meta: dict[str, Any] = {"topic": topic.topic}
    others = sorted({connection.topic for connection in topics} - {topic.topic})
    if others:
        meta["notes"] = [f"taken from {topic.topic}; there are also {', '.join(others)}"]
    return Table(columns, meta)
