"""How time grows with channels, samples and threads: python benches/scaling.py (writes scaling.json and scaling.md).

Each figure is the minimum of several runs in a process of its own, whose peak memory is read at its end. Long records run in pieces
through one filter with `out=`, as a program that reads a file would do it.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import stillrate as sr

HERE = Path(__file__).parent
CHANNELS = (1, 2, 3, 4, 8, 12, 16, 24, 32, 48, 64)
SAMPLES = (1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000)
PIECE = 1_000_000
RATE_HZ = 1000.0
REPEATS = 5


def configurations() -> dict[str, sr.Config]:
    noise = sr.GyroNoise(density_dps_sqrt_hz=0.0212, rate_random_walk_dps_sqrt_s=0.003)
    return {
        "two-model IMM": sr.SingerImmKf(sample_rate_hz=RATE_HZ, noise=noise),
        "bank": sr.MsImmIkf(sample_rate_hz=RATE_HZ, noise=noise),
        "PT1": sr.Pt1(sample_rate_hz=RATE_HZ, noise=noise),
    }


def one(method: str, channels: int, samples: int, dtype: str) -> dict[str, float]:
    """Time a sample and channel in ns and the growth of peak memory in MB after the filter was made and warm."""
    import resource

    piece = min(samples, PIECE)
    z = np.random.default_rng(1).normal(0.0, 0.5, (piece, channels)).astype(dtype)
    flt = sr.Filter(configurations()[method], channels=channels, dtype=dtype)
    out = np.empty_like(z)
    flt.run(z, out=out)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    best = math.inf
    for _ in range(1 if samples > PIECE else REPEATS):
        start = time.perf_counter_ns()
        for _ in range(samples // piece):
            flt.run(z, out=out)
        best = min(best, (time.perf_counter_ns() - start) / (samples * channels))
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024.0
    return {"ns": round(best, 3), "grown_mb": round(grown, 2)}


def measured(threads: int, *arguments: object) -> dict[str, float]:
    environment = os.environ | {"RAYON_NUM_THREADS": str(threads)}
    command = [sys.executable, __file__, *map(str, arguments)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout)


def page(results: dict[str, dict[str, dict[str, float]]]) -> str:
    parts = [HEADER, "## Channels\n", "Nanoseconds a sample and channel; 20 000 samples.\n"]
    parts += ["| case | " + " | ".join(map(str, CHANNELS)) + " |", "|---|" + "---|" * len(CHANNELS)]
    parts += [
        f"| {name} | " + " | ".join(f"{row['ns']:.3g}" for row in rows.values()) + " |"
        for name, rows in results["channels"].items()
    ]
    parts += [
        "\n## Samples\n",
        "Nanoseconds a sample, one channel, and by how much the peak memory of the process grew.\n",
    ]
    parts += ["| case | " + " | ".join(f"{n:.0e}" for n in SAMPLES) + " |", "|---|" + "---|" * len(SAMPLES)]
    for name, rows in results["samples"].items():
        parts.append(
            f"| {name} | " + " | ".join(f"{row['ns']:.3g} ({row['grown_mb']:g} MB)" for row in rows.values()) + " |"
        )
    return "\n".join(parts) + "\n"


HEADER = """# Scaling

Written by `python benches/scaling.py`; do not edit. Default settings at 1 kHz, minimum of five runs (one run above a million samples).
Channels run in groups of 8 (f64) or 16 (f32); groups are shared among threads. Records of more than a million samples pass through
one filter in pieces of a million with `out=`.
"""


def main() -> None:
    if len(sys.argv) > 1:
        method, channels, samples, dtype = sys.argv[1:]
        print(json.dumps(one(method, int(channels), int(samples), dtype)))
        return
    results: dict[str, dict[str, dict[str, float]]] = {"channels": {}, "samples": {}}
    for method in configurations():
        for dtype in ("float64", "float32"):
            for threads in (1, 2):
                name = f"{method}, f{dtype[5:]}, {threads} thread{'s' * (threads > 1)}"
                rows = {str(count): measured(threads, method, count, 20_000, dtype) for count in CHANNELS}
                results["channels"][name] = rows
        results["samples"][method] = {str(count): measured(1, method, 1, count, "float64") for count in SAMPLES}
    (HERE / "scaling.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    (HERE / "scaling.md").write_text(page(results), encoding="utf-8")


if __name__ == "__main__":
    main()
