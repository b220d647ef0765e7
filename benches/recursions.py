"""Low-passes and means with a twin elsewhere, each set up to give the same output."""

from __future__ import annotations

import math

import numpy as np
import stillrate as sr
from others import Filter

CUTOFF_HZ, TAU_S = 20.0, 0.1
# Timed on a short record of one channel.
SLOW = ("padasip FilterRLS",)


def impulse_response(config: sr.Config, n: int) -> np.ndarray:
    return sr.Filter(config).run(np.r_[0.0, 1.0, np.zeros(n)])[1:]


def scipy_pt1(config: sr.Config) -> Filter:
    from scipy.signal import lfilter

    gain = float(impulse_response(config, 2)[0])
    return lambda z: lfilter([gain], [1.0, gain - 1.0], z, axis=0, zi=np.atleast_2d((1.0 - gain) * z[0]))[0]


def scipy_butterworth(rate_hz: float) -> Filter:
    from scipy.signal import butter, sosfilt, sosfilt_zi

    sections = butter(2, CUTOFF_HZ, fs=rate_hz, output="sos")
    start = sosfilt_zi(sections)

    def run(z: np.ndarray) -> np.ndarray:
        zi = start.reshape(1, 2, *([1] * (z.ndim - 1))) * z[0]
        return sosfilt(sections, z, axis=0, zi=zi)[0]

    return run


def scipy_fir(config: sr.FirLowPass) -> Filter:
    from scipy.signal import lfilter, lfilter_zi

    taps = impulse_response(config.replace(start="zero"), int(config.length))[: int(config.length)]
    start = lfilter_zi(taps, 1.0)

    def run(z: np.ndarray) -> np.ndarray:
        return lfilter(taps, 1.0, z, axis=0, zi=start.reshape(-1, *([1] * (z.ndim - 1))) * z[0])[0]

    return run


def scipy_settled_mean(factor: float) -> Filter:
    """The recursive mean with its final gain from the start."""
    from scipy.signal import lfilter

    return lambda z: lfilter([1.0 - factor], [1.0, -factor], z, axis=0, zi=np.atleast_2d(factor * z[0]))[0]


def pandas_mean(factor: float) -> Filter:
    def run(z: np.ndarray) -> np.ndarray:
        import pandas

        return pandas.DataFrame(z).ewm(alpha=1.0 - factor, adjust=True).mean().to_numpy()

    return run


def padasip_mean(factor: float) -> Filter:
    """Recursive least squares with one weight and a constant regressor; its start is a large but finite covariance."""

    def run(z: np.ndarray) -> np.ndarray:
        import padasip

        one = padasip.filters.FilterRLS(n=1, mu=factor, eps=1e-8, w="zeros")
        out, regressor = np.empty(len(z)), np.ones(1)
        for t, value in enumerate(z.ravel()):
            one.adapt(value, regressor)
            out[t] = one.w[0]
        return out

    return run


def twins(rate_hz: float, noise: sr.GyroNoise) -> list[tuple[str, sr.Config, dict[str, Filter], float]]:
    """Name, our configuration, theirs, and the relative difference up to which outputs agree."""
    factor = math.exp(-1.0 / (TAU_S * rate_hz))
    pt1 = sr.Pt1(sample_rate_hz=rate_hz, noise=noise, cutoff_hz=CUTOFF_HZ)
    biquad = sr.Biquad(sample_rate_hz=rate_hz, noise=noise, cutoff_hz=CUTOFF_HZ)
    mean = sr.RecursiveLeastSquares(sample_rate_hz=rate_hz, noise=noise, tau_s=TAU_S)
    short, long = (
        sr.FirLowPass(sample_rate_hz=rate_hz, noise=noise, window="hamming", length=length, cutoff_hz=CUTOFF_HZ)
        for length in (21, 101)
    )
    return [
        ("PT1", pt1, {"scipy lfilter": scipy_pt1(pt1)}, 1e-9),
        ("biquad", biquad, {"scipy sosfilt": scipy_butterworth(rate_hz)}, 1e-9),
        ("FIR of 21 taps", short, {"scipy lfilter": scipy_fir(short)}, 1e-9),
        ("FIR of 101 taps", long, {"scipy lfilter": scipy_fir(long)}, 1e-9),
        # The settled mean differs while it starts, so only its speed counts; pandas and padasip compute what we do.
        ("RLS", mean, {"scipy lfilter": scipy_settled_mean(factor)}, math.inf),
        ("RLS", mean, {"pandas ewm": pandas_mean(factor)}, 1e-9),
        ("RLS", mean, {"padasip FilterRLS": padasip_mean(factor)}, 1e-6),
    ]
