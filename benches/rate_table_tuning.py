"""Tuning one record of 50 000 samples: Brent, the published swarm, evaluations a second beside a numba loop.

Run with `python benches/rate_table_tuning.py [--json FILE]`; needs numba. Ratios are of the best of several repeats.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import stillrate as sr
from numba import njit
from stillrate import _native

SAMPLES = 50_000
RATE_HZ = 2000.0
REPEATS = 7


@njit(cache=False)
def scalar_mse(z: np.ndarray, truth: np.ndarray, q: float) -> float:
    """Mean squared error of the scalar random-walk filter: the loop a numpy user would write."""
    x, p, total = z[0], 1.0, (z[0] - truth[0]) ** 2
    for k in range(1, z.size):
        predicted = p + q
        gain = predicted / (predicted + 1.0)
        x += gain * (z[k] - x)
        p = (1.0 - gain) * predicted
        total += (x - truth[k]) ** 2
    return total / z.size


def best(call: Callable[[], object], repeats: int = REPEATS) -> tuple[float, float]:
    """Return wall and processor time of the best of several runs, s; the latter does not depend on other programs."""
    walls, processors = [], []
    for _ in range(repeats):
        wall, processor = time.perf_counter(), time.process_time()
        call()
        walls.append(time.perf_counter() - wall)
        processors.append(time.process_time() - processor)
    return min(walls), min(processors)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    truth = 4.0 * np.sin(2.0 * np.pi * 0.5 * np.arange(SAMPLES) / RATE_HZ)
    z = _native.rate_table_record(truth.tolist(), 0, 9, RATE_HZ)
    objective = _native.NoiseObjective([z], [truth], "random-walk", "truth", 1.0 / RATE_HZ)
    points = np.linspace(-6.0, 2.0, 10_000)
    few = np.ascontiguousarray(points[::2500])
    ours, theirs = objective.values(few, 1), [scalar_mse(z, truth, 10.0**p) for p in few]
    np.testing.assert_allclose(ours, theirs, rtol=1e-9)
    wide = np.sort(np.random.default_rng(1).uniform(-12.0, 4.0, 10_000))
    seconds = {
        "brent": best(lambda: sr.rate_table.tune(z, RATE_HZ, truth)),
        "brent, innovations": best(lambda: sr.rate_table.tune(z, RATE_HZ)),
        "qpso 100 x 100, log10 Q and log10 R": best(
            lambda: sr.rate_table.tune(z, RATE_HZ, truth, method="qpso", separate=True), 5
        ),
        "qpso 100 x 100, log10 Q/R": best(lambda: sr.rate_table.tune(z, RATE_HZ, truth, method="qpso"), 5),
        "10 000 candidates, settled range": best(lambda: objective.values(points, 1), 5),
        "10 000 candidates, whole range": best(lambda: objective.values(wide, 1), 5),
        "numba, 20 candidates": best(lambda: [scalar_mse(z, truth, 10.0**p) for p in points[::500]]),
    }
    loop = 20 / seconds["numba, 20 candidates"][1]
    rates = {name: 10_000 / seconds[name][1] for name in seconds if name.startswith("10 000")}
    for name, (wall, processor) in seconds.items():
        print(f"| {name} | {1e3 * wall:.1f} ms wall | {1e3 * processor:.1f} ms of processor time |")
    print(f"| numba | {loop:.0f} evaluations/s of a core |")
    for name, rate in rates.items():
        print(f"| {name} | {rate:.0f} evaluations/s of a core | {rate / loop:.1f} x numba, threads not counted |")
    if arguments.json:
        result = {"seconds": seconds, "numba_per_s": loop, "per_s": rates}
        arguments.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
