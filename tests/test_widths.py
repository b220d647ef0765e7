"""The same bits whether a channel runs alone, beside others, or on another thread."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
import stillrate as sr

NOISE = sr.GyroNoise(density_dps_sqrt_hz=0.02, rate_random_walk_dps_sqrt_s=0.003)
CONFIGS = [
    sr.MsImmIkf(sample_rate_hz=200.0, noise=NOISE),
    sr.MsImmIkf(sample_rate_hz=200.0, noise=NOISE, oscillators=()),
    sr.SingerImmKf(sample_rate_hz=200.0, noise=NOISE),
    sr.SingerKf(sample_rate_hz=200.0, noise=NOISE),
    sr.Pt1(sample_rate_hz=200.0, noise=NOISE),
]


def samples(channels: int) -> np.ndarray:
    """Waves with noise; missing, infinite and absurd samples at other places in every channel."""
    random = np.random.default_rng(7)
    n = 700
    z = 20.0 * np.sin(np.arange(n)[:, None] * 0.01 * np.arange(1, channels + 1)) + random.normal(0, 0.3, (n, channels))
    z[random.random(z.shape) < 0.01] = np.nan
    z[random.random(z.shape) < 0.002] = np.inf
    z[random.random(z.shape) < 0.002] = 1e30
    z[:3, channels // 2] = np.nan
    return z


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.method)
@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("channels", [3, 8, 21])
def test_a_channel_beside_others_gives_the_bits_it_gives_alone(config, dtype, channels):
    z = samples(channels)
    steps = np.full(len(z), 0.005)
    steps[[50, 300]] = 0.02, 12.0
    for dt_s in (None, steps):
        together = sr.Filter(config, channels=channels, dtype=dtype).run(z, dt_s=dt_s)
        for c in range(channels):
            alone = sr.Filter(config, dtype=dtype).run(np.ascontiguousarray(z[:, c]), dt_s=dt_s)
            assert together[:, c].tobytes() == alone.tobytes(), f"channel {c}"


def test_the_number_of_threads_changes_no_bit():
    code = (
        "import hashlib, numpy as np, stillrate as sr\n"
        "z = np.random.default_rng(3).normal(0, 1, (4000, 37))\n"
        "config = sr.SingerImmKf(sample_rate_hz=200.0, noise=sr.GyroNoise(density_dps_sqrt_hz=0.02))\n"
        "print(hashlib.sha256(sr.Filter(config, channels=37).run(z).tobytes()).hexdigest())\n"
    )
    prints = {
        subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"RAYON_NUM_THREADS": threads},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for threads in ("1", "2", "5")
    }
    assert len(prints) == 1
