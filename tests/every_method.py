"""Every method by name, with its defaults for one gyro."""

from __future__ import annotations

import stillrate as sr
from stillrate.config import Config, methods

METHODS = sorted(methods())
NOISE = sr.GyroNoise(density_dps_sqrt_hz=0.015, rate_random_walk_dps_sqrt_s=0.003)


def build(method: str, rate_hz: float = 100.0, noise: sr.GyroNoise = NOISE) -> Config:
    return methods()[method](sample_rate_hz=rate_hz, noise=noise)
