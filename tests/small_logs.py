"""Small good logs of every format that is read, written by the tests themselves: one still gyro with a little noise."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROWS, RATE_HZ = 600, 100.0


def samples(rows: int = ROWS) -> tuple[np.ndarray, np.ndarray]:
    """Return time in s and rates in deg/s."""
    return np.arange(rows) / RATE_HZ, np.random.default_rng(8).normal(0.0, 0.1, (rows, 3))


def text(path: Path, rows: int = ROWS, delimiter: str = ",") -> None:
    t, rates = samples(rows)
    lines = [delimiter.join(("t_s", "gx_dps", "gy_dps", "gz_dps"))]
    lines += [
        delimiter.join(f"{value:.6f}" for value in (moment, *rate)) for moment, rate in zip(t, rates, strict=True)
    ]
    path.write_text("\n".join(lines) + "\n")


def tsv(path: Path, rows: int = ROWS) -> None:
    text(path, rows, "\t")


def npz(path: Path, rows: int = ROWS) -> None:
    t, rates = samples(rows)
    np.savez_compressed(path, t_s=t, gx_dps=rates[:, 0], gy_dps=rates[:, 1], gz_dps=rates[:, 2])


def parquet(path: Path, rows: int = ROWS) -> None:
    polars = pytest.importorskip("polars")
    t, rates = samples(rows)
    columns = {"t_s": t, **{f"g{axis}_dps": rates[:, k] for k, axis in enumerate("xyz")}}
    polars.DataFrame(columns).write_parquet(path)


def hdf5(path: Path, rows: int = ROWS) -> None:
    h5py = pytest.importorskip("h5py")
    t, rates = samples(rows)
    with h5py.File(path, "w") as file:
        file["imu/t_s"], file["imu/gyro_dps"] = t, rates


def matlab(path: Path, rows: int = ROWS) -> None:
    t, rates = samples(rows)
    pytest.importorskip("scipy.io").savemat(path, {"t_s": t, "gyro_dps": rates}, do_compression=True)


def ulog(path: Path, rows: int = ROWS) -> None:
    pytest.importorskip("pyulog")
    t, rates = samples(rows)

    def message(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    data = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + message(b"B", bytes(40))
    data += message(b"F", b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;")
    data += message(b"A", struct.pack("<BH", 0, 0) + b"sensor_combined")
    for moment, rate in zip(t, np.radians(rates), strict=True):
        data += message(b"D", struct.pack("<HQ3f", 0, round(moment * 1e6), *rate))
    path.write_bytes(data)


def blackbox(path: Path, rows: int = ROWS) -> None:
    t, rates = samples(rows)

    def signed(value: int) -> bytes:
        zigzag, found = (value << 1) ^ (value >> 63), b""
        while zigzag > 0x7F:
            found += bytes((zigzag & 0x7F | 0x80,))
            zigzag >>= 7
        return found + bytes((zigzag,))

    head = "Product:Blackbox flight data recorder by Nicholas Sherlock|Data version:2|I interval:8|P interval:1/1"
    head += "|Field I name:time,gyroADC[0],gyroADC[1],gyroADC[2]|Field I signed:0,1,1,1|Field I predictor:0,0,0,0"
    head += "|Field I encoding:0,0,0,0|Field P predictor:2,3,3,3|Field P encoding:0,0,0,0|gyro_scale:0x3c23d70a"
    data = "".join(f"H {line}\n" for line in head.split("|")).encode()
    last = before = np.zeros(4, int)
    for index, (moment, rate) in enumerate(zip(t, rates, strict=True)):
        row = np.array([round(moment * 1e6), *np.rint(rate / 0.01)], int)
        middle = (np.abs(last + before) // 2) * np.sign(last + before)
        base = np.array([2 * last[0] - before[0], *middle[1:]]) if index % 8 else np.zeros(4, int)
        data += (b"P" if index % 8 else b"I") + b"".join(signed(int(value)) for value in row - base)
        last, before = row, last if index % 8 else row
    path.write_bytes(data + b"E\xffEnd of log\0")


def _bag(writer: object, rows: int) -> None:
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    of = store.types
    t, rates = samples(rows)
    quaternion, vector = of["geometry_msgs/msg/Quaternion"], of["geometry_msgs/msg/Vector3"]
    with writer as bag:  # type: ignore[attr-defined]
        topic = bag.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=store)
        one = getattr(store, "serialize_ros1" if "rosbag1" in type(writer).__module__ else "serialize_cdr")
        for k, (moment, rate) in enumerate(zip(t, np.radians(rates), strict=True)):
            stamp = of["builtin_interfaces/msg/Time"](sec=1 + int(moment), nanosec=round(moment % 1 * 1e9))
            header = of["std_msgs/msg/Header"](stamp=stamp, frame_id="imu")
            still = {
                f"{name}_covariance": np.zeros(9) for name in ("orientation", "angular_velocity", "linear_acceleration")
            }
            message = of["sensor_msgs/msg/Imu"](
                header=header,
                orientation=quaternion(x=0.0, y=0.0, z=0.0, w=1.0),
                angular_velocity=vector(*map(float, rate)),
                linear_acceleration=vector(x=0.0, y=0.0, z=9.8),
                **still,
            )
            bag.write(topic, 1_000_000_000 + k * 10_000_000, one(message, "sensor_msgs/msg/Imu"))


def rosbag1(path: Path, rows: int = ROWS) -> None:
    _bag(pytest.importorskip("rosbags.rosbag1").Writer(path), rows)


def rosbag2(path: Path, rows: int = ROWS) -> None:
    """Write a folder with a database in it."""
    _bag(pytest.importorskip("rosbags.rosbag2").Writer(path, version=9), rows)


def mcap(path: Path, rows: int = ROWS) -> None:
    module = pytest.importorskip("rosbags.rosbag2")
    folder = path.with_name(path.name + "-bag")
    _bag(module.Writer(folder, version=9, storage_plugin=module.StoragePlugin.MCAP), rows)
    next(folder.glob("*.mcap")).rename(path)


WRITERS: dict[str, Callable[..., None]] = {
    "csv": text,
    "tsv": tsv,
    "npz": npz,
    "parquet": parquet,
    "ulg": ulog,
    "bbl": blackbox,
    "bag": rosbag1,
    "mcap": mcap,
    "h5": hdf5,
    "mat": matlab,
    "ros2": rosbag2,
}
