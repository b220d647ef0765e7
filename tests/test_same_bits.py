"""One log gives the bits of tests/embedded/bits.txt through Python: batch and streaming, float32 and float64.

Rust, C and the emulated Cortex-M are held to the same table (crates/stillrate-c/tests/c_abi.rs, tests/embedded).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import stillrate
from every_method import METHODS
from numpy.typing import NDArray
from stillrate.config import config_from_settings

SAMPLES = 10_240
TABLE = [
    line.split() for line in (Path(__file__).parent / "embedded" / "bits.txt").read_text(encoding="utf-8").splitlines()
]


def log(dtype: type[np.floating]) -> tuple[NDArray[np.floating], NDArray[np.float64]]:
    """The log of tests/embedded/unit.c: values in the filter's type, time steps computed in it."""
    k = np.arange(SAMPLES, dtype=np.uint32)
    bits = (k + np.uint32(1)) * np.uint32(2654435761)
    bits ^= bits >> np.uint32(15)
    value = ((bits & np.uint32(1023)).astype(np.float64) - 512) / 1024
    value += np.where((k // 512) % 2 == 1, (k % 512) * 0.125, 0.0)
    value[k % 509 == 300] = np.nan
    value[k % 1531 == 1000] = 16384
    period = dtype(1 / 50)
    dt = np.full(SAMPLES, period, dtype)
    dt[k == 7000] = 11
    dt[k % 811 == 500] = dtype(2.5) * period
    dt[k % 701 == 400] = 0
    return value.astype(dtype), dt.astype(np.float64)


def fnv1a(words: list[int]) -> str:
    total = 2166136261
    for word in words:
        total = ((total ^ word) * 16777619) & 0xFFFFFFFF
    return f"{total:08x}"


def test_the_table_holds_every_filter() -> None:
    names = {
        f"{method.replace('-', '_')}{form}" for method, form in (*((m, "") for m in METHODS), ("ms-imm-ikf", "_light"))
    }
    assert {line[0] for line in TABLE} == {f"stillrate_{name}_{real}" for name in names for real in ("f32", "f64")}


@pytest.mark.parametrize("line", TABLE, ids=lambda line: line[0])
def test_python_gives_the_bits_of_the_table(line: list[str]) -> None:
    name, _, rates, flags = line
    method, _, precision = name.removeprefix("stillrate_").rpartition("_")
    dtype = np.float32 if precision == "f32" else np.float64
    settings: dict[str, object] = {"sample_rate_hz": 50.0, "noise.density_dps_sqrt_hz": 0.0151}
    if method.endswith("_light"):
        method, settings = method.removesuffix("_light"), {**settings, "oscillators": ()}
    config = config_from_settings(method.replace("_", "-"), settings)
    values, dt = log(dtype)
    batch = stillrate.Filter(config, dtype=dtype).run(values, dt_s=dt)
    streaming = stillrate.Filter(config, dtype=dtype)
    one_by_one = np.array([streaming.update(float(v), dt_s=float(t)) for v, t in zip(values, dt, strict=True)], dtype)
    assert np.array_equal(batch.view(np.uint8), one_by_one.view(np.uint8))
    assert fnv1a(batch.view(np.uint8).tolist()) == rates
    trace = stillrate.Filter(config, dtype=dtype).run(values, dt_s=dt, trace=True)
    assert fnv1a(np.asarray(trace.flags).tolist()) == flags
