"""Every method on a log without a truth: what it gains at rest, and what that costs in motion.

Suppression alone would favour the slowest filter, so each row shows its price: how late it is against the raw record,
how much more than the sensor's noise it takes from the motion, and how long it needs to follow a step (on a simulated
step of 40 deg/s at the log's rate and noise).
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np

from stillrate import metrics, simulate
from stillrate._native import Filter
from stillrate.config import Config, method_class, methods
from stillrate.demo import STEP_DPS, STEP_S, STEP_UNTIL_S
from stillrate.io.log import Floats, Log
from stillrate.noise import GyroNoise, noise_from_log

LAG_REACH_S = 0.2

# Samples that the stopwatch sees, and how many it takes at a time.
COST_SAMPLES = 20_000
COST_PIECE = 1000

REST_RATIO = 2.0
"""A stretch that scatters more than so many times the noise is not at rest."""


@dataclass(frozen=True)
class Comparison:
    """How one method did on one channel.

    Attributes
    ----------
    method, channel : str
    suppression : float
        Scatter at rest, raw over filtered; NaN if the log never rests.
    lag_ms : float
        Delay against the raw record, positive is late.
    distortion : float
        RMS of what was taken away while moving, over the sensor's own noise: above 1 it took motion as well.
    settling_s : float
        Until a simulated step is followed.
    cost_ns : float
        Time per sample on this machine.
    """

    method: str
    channel: str
    suppression: float
    lag_ms: float
    distortion: float
    settling_s: float
    cost_ns: float


def compare(log: Log, names: tuple[str, ...] = ()) -> list[Comparison]:
    """Run methods (all when none is named) over a log.

    Raises
    ------
    ConfigError
        If a method is unknown.
    """
    known = methods()
    for name in names:
        method_class(name)
    found = []
    figures = noise_from_log(log.rate_dps, log.sample_rate_hz)
    for index, channel in enumerate(log.channels):
        raw = np.ascontiguousarray(log.rate_dps[:, index])
        noise = GyroNoise(
            density_dps_sqrt_hz=figures[index].density_dps_sqrt_hz,
            rate_random_walk_dps_sqrt_s=figures[index].rate_random_walk_dps_sqrt_s,
        )
        rest: slice | None = figures[index].quiet
        if metrics.rms_about_mean(raw[rest]) > REST_RATIO * noise.density_dps_sqrt_hz * math.sqrt(log.sample_rate_hz):
            rest = None
        for name in names or tuple(known):
            config = known[name](sample_rate_hz=log.sample_rate_hz, noise=noise)
            found.append(_one(log, channel, raw, config, noise, rest))
    return found


def _one(log: Log, channel: str, raw: Floats, config: Config, noise: GyroNoise, rest: slice | None) -> Comparison:
    clean = Filter(config).run(raw, dt_s=log.steps_s())
    sigma = noise.density_dps_sqrt_hz * math.sqrt(log.sample_rate_hz)
    moving = np.ones(len(raw), dtype=bool)
    suppression = math.nan
    if rest is not None:
        moving[rest] = False
        after = metrics.rms_about_mean(clean[rest])
        suppression = metrics.rms_about_mean(raw[rest]) / after if after > 0 else math.inf
    distortion = metrics.rmse(clean[moving], raw[moving]) / sigma if moving.any() else math.nan
    lag = metrics.lag_ms(clean, raw, log.sample_rate_hz, max_lag_s=LAG_REACH_S) if moving.any() else math.nan
    return Comparison(
        config.method, channel, suppression, lag, distortion, _settling(config, noise), _cost_ns(config, raw)
    )


def _cost_ns(config: Config, raw: Floats) -> float:
    """Return the time a sample: the median over short pieces, which a busy machine interrupts seldom."""
    flt = Filter(config)
    costs = []
    for begin in range(0, min(len(raw), COST_SAMPLES), COST_PIECE):
        piece = raw[begin : begin + COST_PIECE]
        began = time.perf_counter_ns()
        flt.run(piece)
        costs.append((time.perf_counter_ns() - began) / len(piece))
    return float(np.median(costs))


def _settling(config: Config, noise: GyroNoise) -> float:
    rate = config.sample_rate_hz
    gyro = simulate.GyroModel(density_dps_sqrt_hz=noise.density_dps_sqrt_hz)
    bed = simulate.steps(rate, 1, noise=gyro, duration_s=STEP_UNTIL_S + 1.0)
    estimate = Filter(config).run(bed.measured_dps)
    start, stop = round(STEP_S * rate), round(STEP_UNTIL_S * rate)
    band = max(0.01 * STEP_DPS, 4.0 * noise.density_dps_sqrt_hz * math.sqrt(rate))
    return metrics.settling(estimate, bed.truth_dps, rate, start=start, stop=stop, band=band).time_s
