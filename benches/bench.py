"""Times stillrate and what people use instead: one run, interleaved, by minimum, after checking that outputs agree.

    python benches/bench.py              # writes results.json and the tables of README.md

Figures are nanoseconds a sample and channel. Compare ratios, not times: only they carry over to another machine.
"""

from __future__ import annotations

import json
import math
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import numba_imm
import numpy as np
import others
import recursions
import stillrate as sr
import tables
from textbook_c import (
    ACCEL_MAX,
    ALPHA,
    EVEN,
    PERIOD_S,
    START_ACCELERATION,
    TRANSITION,
    VARIANCE,
    TextbookC,
    singer_matrices,
)
from timing import ROUNDS, Table

RATE_HZ = 1.0 / PERIOD_S


def noise() -> sr.GyroNoise:
    return sr.GyroNoise(density_dps_sqrt_hz=0.015 * math.sqrt(2.0), rate_random_walk_dps_sqrt_s=0.003)


def two_models() -> sr.SingerImmKf:
    return sr.SingerImmKf(
        sample_rate_hz=RATE_HZ,
        noise=noise(),
        alpha_per_s=ALPHA,
        accel_max_dps2=ACCEL_MAX,
        measurement_variance=(VARIANCE, VARIANCE),
        initial_rate_variance=(VARIANCE, VARIANCE),
        initial_acceleration_variance=START_ACCELERATION,
    )


def one_model() -> sr.SingerKf:
    return sr.SingerKf(
        sample_rate_hz=RATE_HZ,
        noise=noise(),
        alpha_per_s=ALPHA[1],
        accel_max_dps2=ACCEL_MAX[1],
        measurement_variance=VARIANCE,
        initial_rate_variance=VARIANCE,
        initial_acceleration_variance=START_ACCELERATION[1],
    )


def signal(n: int, channels: int | None = None) -> np.ndarray:
    shape = n if channels is None else (n, channels)
    wave = 5.0 * np.sin(np.arange(n) * (2 * math.pi * 1.3 / RATE_HZ))
    return np.random.default_rng(1).normal(0.0, 0.45, shape) + (wave if channels is None else wave[:, None])


def run_of(config: sr.Config, channels: int = 1, dtype: str = "float64") -> Callable[[np.ndarray], np.ndarray]:
    def run(z: np.ndarray) -> np.ndarray:
        return sr.Filter(config, channels=channels, dtype=dtype).run(z)

    return run


def imm_table(c: TextbookC, table: Table) -> None:
    z, short = signal(100_000), signal(1_000)
    ours = run_of(two_models())
    expected, expected_short = ours(z), ours(short)
    models = [singer_matrices(0), singer_matrices(1)]
    table.add_checked("IMM: textbook C, gcc -O3", lambda: c.imm(z), expected)
    table.add_checked("IMM: textbook C, sizes as arguments", lambda: c.imm_of_any_size(z), expected)
    table.add_checked("IMM: stillrate, 1 channel f64", lambda: ours(z), expected)
    given = (models, VARIANCE, TRANSITION, EVEN, START_ACCELERATION)
    table.add_peer("IMM: numba", lambda: numba_imm.unrolled(*given), z, expected)
    table.add_peer("IMM: numba, sizes as arguments", lambda: numba_imm.any_size(*given), z, expected)
    table.add_peer("IMM: filterpy", lambda: others.filterpy_imm(*given), short, expected_short)
    bank = sr.MsImmIkf(sample_rate_hz=RATE_HZ, noise=noise())
    light = sr.MsImmIkf(sample_rate_hz=RATE_HZ, noise=noise(), oscillators=())
    for name, config in (("IMM", two_models()), ("bank", bank), ("light bank", light)):
        for channels, dtype in ((1, "float64"), (8, "float64"), (16, "float32")):
            if name == "IMM" and channels == 1:
                continue
            many, run = signal(20_000, channels).astype(dtype), run_of(config, channels, dtype)
            call = lambda run=run, many=many: run(many)  # noqa: E731
            table.add(f"{name}: stillrate, {channels} channel{'s' * (channels > 1)} f{dtype[5:]}", call, many.size)


def single_table(c: TextbookC, table: Table) -> None:
    z, short = signal(100_000), signal(1_000)
    ours = run_of(one_model())
    expected, expected_short = ours(z), ours(short)
    f, q = singer_matrices(1)
    start = np.diag([VARIANCE, START_ACCELERATION[1]])
    table.add_checked("Kalman: textbook C, gcc -O3", lambda: c.kalman(z), expected)
    table.add_checked("Kalman: stillrate", lambda: ours(z), expected)
    for name, make in others.KALMAN.items():
        table.add_peer(f"Kalman: {name}", lambda make=make: make(f, q, VARIANCE, start), short, expected_short)


def lowpass_table(table: Table) -> None:
    for channels in (1, 8):
        z = signal(100_000, channels)
        for name, config, theirs, agreement in recursions.twins(RATE_HZ, noise()):
            ours = run_of(config, channels)
            label = f"{channels} channel{'s' * (channels > 1)}"
            table.add(f"{name} {label}: stillrate", lambda run=ours, z=z: run(z), z.size)
            for other, call in theirs.items():
                if other in recursions.SLOW and channels > 1:
                    continue
                part = z[:2_000] if other in recursions.SLOW else z
                table.add_checked(f"{name} {label}: {other}", lambda c=call, z=part: c(z), ours(part), agreement)


def streaming_table(table: Table) -> None:
    values = signal(20_000).tolist()
    axes = signal(20_000, 3).tolist()
    one, three = sr.Filter(two_models()), sr.Filter(two_models(), channels=3)

    def loop_of_three() -> None:
        update = three.update
        for a, b, c in axes:
            update(a, b, c)

    table.add_call("call: math.sin", lambda: math.sin, values)
    table.add_call("call: stillrate update, one float", lambda: one.update, values)
    table.add("call: stillrate update, three floats", loop_of_three, len(axes))
    for name, make in others.CALLS.items():
        table.add_call(f"call: {name}", lambda make=make: make(PERIOD_S), values)


def allan_table(table: Table) -> None:
    z = signal(1_000_000)
    table.add("Allan octave: stillrate", lambda: sr.allan(z, RATE_HZ), z.size)
    allantools = table.tried("Allan octave: allantools", others.allantools_octave)
    if allantools is not None:
        table.add("Allan octave: allantools", lambda: allantools(z, RATE_HZ), z.size)


def import_milliseconds() -> dict[str, float]:
    best = {"numpy": math.inf, "stillrate": math.inf}
    for _ in range(7):
        for name in best:
            code = f"import time; t = time.perf_counter(); import {name}; print((time.perf_counter() - t) * 1e3)"
            found = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
            best[name] = min(best[name], float(found))
    return best


def machine() -> dict[str, str]:
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines() if sys.platform == "linux" else []
    model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.processor())
    gcc = subprocess.run(["gcc", "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]
    packages = ["numpy", *others.PACKAGES]
    versions = {}
    for name in packages:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            versions[name] = "not installed"
    return {"cpu": model, "python": platform.python_version(), "gcc": gcc, "stillrate": sr.__version__} | versions


def main() -> None:
    table = Table()
    with tempfile.TemporaryDirectory() as folder:
        c = TextbookC(Path(folder))
        imm_table(c, table)
        single_table(c, table)
        lowpass_table(table)
        streaming_table(table)
        allan_table(table)
        found = table.run()
    rounded = {name: round(value, 3) for name, value in found.items()}
    results = {"machine": machine(), "rounds": ROUNDS, "ns_per_sample": rounded, "left_out": table.missing}
    results["import_ms"] = {name: round(value, 1) for name, value in import_milliseconds().items()}
    tables.RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    tables.write()


if __name__ == "__main__":
    main()
