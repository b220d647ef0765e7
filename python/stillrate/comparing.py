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
from stillrate.demo import STEP_UNTIL_S, step_settling_s
from stillrate.io.log import Floats, Log
from stillrate.noise import GyroNoise, noise_from_log

LAG_REACH_S = 0.2

# Samples that the stopwatch sees, and how many it takes at a time.
COST_SAMPLES = 20_000
COST_PIECE = 1000

REST_RATIO = 2.0
"""A stretch that scatters more than so many times the noise is not at rest."""

# A picture shows so much of a log at rest and where it moves most, within bounds on its samples.
STRETCH_S = 3.0
STRETCH_SAMPLES = (100, 3000)
AT_REST, MOVING = "at rest", "where it moves most"
"""Titles of the two."""


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


@dataclass(frozen=True)
class Stretch:
    """A few seconds of one channel, as each method saw them.

    Attributes
    ----------
    channel, title : str
    where : slice
        The samples of the log.
    sigma_dps : float
        Scatter of the noise that the methods were given.
    raw : ndarray
    clean : dict of str to ndarray
        By method.
    """

    channel: str
    title: str
    where: slice
    sigma_dps: float
    raw: Floats
    clean: dict[str, Floats]


def compare(log: Log, names: tuple[str, ...] = ()) -> list[Comparison]:
    """Run methods (all when none is named) over a log.

    Raises
    ------
    ConfigError
        If a method is unknown.
    """
    return compare_with_stretches(log, names)[0]


def compare_with_stretches(log: Log, names: tuple[str, ...] = ()) -> tuple[list[Comparison], list[Stretch]]:
    """Do the same, and keep what a picture needs: each method at rest and where the log moves most.

    Raises
    ------
    ConfigError
        If a method is unknown.
    """
    known = methods()
    for name in names:
        method_class(name)
    names = tuple(dict.fromkeys(names)) or tuple(known)
    found: list[Comparison] = []
    stretches: list[Stretch] = []
    figures = noise_from_log(log.rate_dps, log.sample_rate_hz)
    for index, channel in enumerate(log.channels):
        raw = np.ascontiguousarray(log.rate_dps[:, index])
        noise = figures[index].gyro
        rest: slice | None = figures[index].quiet
        sigma = noise.density_dps_sqrt_hz * math.sqrt(log.sample_rate_hz)
        if metrics.rms_about_mean(raw[rest]) > REST_RATIO * sigma:
            rest = None
        seen = [
            Stretch(channel, title, where, sigma, raw[where], {}) for title, where in _stretches(log, raw, rest).items()
        ]
        for name in names:
            config = known[name](sample_rate_hz=log.sample_rate_hz, noise=noise)
            clean = Filter(config).run(raw, dt_s=log.steps_s())
            found.append(_one(log, channel, raw, clean, config, noise, rest))
            for stretch in seen:
                stretch.clean[name] = clean[stretch.where].copy()
        stretches += seen
    return found, stretches


def _stretches(log: Log, raw: Floats, rest: slice | None) -> dict[str, slice]:
    """Return the middle of the rest and the stretch that scatters most."""
    fewest, most = STRETCH_SAMPLES
    count = min(len(raw), max(fewest, min(most, round(STRETCH_S * log.sample_rate_hz))))
    found = {}
    if rest is not None:
        length = min(count, rest.stop - rest.start)
        begin = (rest.start + rest.stop - length) // 2
        found[AT_REST] = slice(begin, begin + length)
    starts = range(0, len(raw) - count + 1, max(1, count // 2))
    present = [begin for begin in starts if np.isfinite(raw[begin : begin + count]).any()]
    if present:
        begin = max(present, key=lambda at: metrics.rms_about_mean(raw[at : at + count]))
        found[MOVING] = slice(begin, begin + count)
    return found


def _one(
    log: Log, channel: str, raw: Floats, clean: Floats, config: Config, noise: GyroNoise, rest: slice | None
) -> Comparison:
    sigma = noise.density_dps_sqrt_hz * math.sqrt(log.sample_rate_hz)
    moving = np.ones(len(raw), dtype=bool)
    suppression = math.nan
    if rest is not None:
        moving[rest] = False
        before, after = metrics.rms_about_mean(raw[rest]), metrics.rms_about_mean(clean[rest])
        if before > 0:
            suppression = before / after if after > 0 else math.inf
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
    return step_settling_s(Filter(config).run(bed.measured_dps), bed, noise)
