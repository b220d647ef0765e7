"""Kalman filters on simple signal models, recursive least squares and its adaptive forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from stillrate.config import Config


@dataclass(frozen=True, kw_only=True)
class ArKf(Config):
    """Kalman filter on an autoregressive model of the signal.

    The default is the AR(1) that was fitted to the published figures: it attenuates motion and noise alike.

    Parameters
    ----------
    coefficients : sequence of float, optional
        phi_1, phi_2, ..., at most 8.
    process_variance_dps2 : float, optional
        Variance of the driving noise in (deg/s)^2.
    measurement_variance_dps2 : float, optional
        Variance of the measurement noise in (deg/s)^2.

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> ArKf(sample_rate_hz=50.0, noise=noise).coefficients
    (0.0004,)
    """

    method: ClassVar[str] = "ar-kf"
    coefficients: Sequence[float] | None = None
    process_variance_dps2: float | None = None
    measurement_variance_dps2: float | None = None


@dataclass(frozen=True, kw_only=True)
class SageHusaKf(Config):
    """Kalman filter with Sage-Husa adaptation of the measurement variance.

    Parameters
    ----------
    bandwidth_hz : float, optional
        Bandwidth of the motion model in Hz; default 2, at most a quarter of the sample rate.
    alpha_per_s : float, optional
        Reciprocal of the manoeuvre time constant in 1/s; default 0.01.
    memory_s : float, optional
        Memory of the measurement variance in s; default 1.

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> SageHusaKf(sample_rate_hz=4.0, noise=noise).bandwidth_hz
    1.0
    """

    method: ClassVar[str] = "sage-husa-kf"
    bandwidth_hz: float | None = None
    alpha_per_s: float | None = None
    memory_s: float | None = None


@dataclass(frozen=True, kw_only=True)
class LinearPrediction(Config):
    """Forward linear prediction of order 16, adapted on line.

    Parameters
    ----------
    step_size : float, optional
        Step size of the learning rule, above 0 and below 2; default 0.05.

    Examples
    --------
    >>> from stillrate import Filter, GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> Filter(LinearPrediction(sample_rate_hz=50.0, noise=noise)).run([3.0, 3.0, 3.0]).tolist()
    [3.0, 3.0, 3.0]
    """

    method: ClassVar[str] = "linear-prediction"
    step_size: float | None = None


@dataclass(frozen=True, kw_only=True)
class RandomWalkKf(Config):
    """Random-walk Kalman filter ("HMM/KF"): the level of the signal with the exact gain from the first sample.

    Parameters
    ----------
    variance_ratio : float, optional
        Q/R: variance of the walk over one period over that of a sample; default from the noise (a gyro at rest).

    Examples
    --------
    >>> from stillrate import Filter, GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> Filter(RandomWalkKf(sample_rate_hz=50.0, noise=noise, variance_ratio=0.0)).run([1.0, 2.0, 6.0]).tolist()
    [1.0, 1.5, 3.0]
    """

    method: ClassVar[str] = "hmm-kf"
    variance_ratio: float | None = None


@dataclass(frozen=True, kw_only=True)
class RecursiveLeastSquares(Config):
    """Recursive least squares ("HMM/RLS"): exponentially weighted mean or line, with zero start-up delay.

    Parameters
    ----------
    order : float, optional
        1 (default): weighted mean; 2: weighted straight line.
    tau_s : float, optional
        Memory in s: the weight of a sample falls to 1/e in this time; default 0.1.
    forgetting_factor : float, optional
        The same as a factor a sample, in (0, 1].

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> config = RecursiveLeastSquares(sample_rate_hz=50.0, noise=noise, forgetting_factor=0.95)
    >>> round(config.tau_s, 4)
    0.3899
    """

    method: ClassVar[str] = "hmm-rls"
    order: float | None = None
    tau_s: float | None = None
    forgetting_factor: float | None = None


@dataclass(frozen=True, kw_only=True)
class VariableForgetting(Config):
    """Recursive least squares that forgets when the innovation grows.

    Parameters
    ----------
    order : float, optional
        1 (default): level; 2: level and slope.
    forgetting_factor_max : float, optional
        Forgetting factor at rest; default 0.9507 (order 2: 0.98).
    forgetting_factor_min : float, optional
        Forgetting factor in full motion; default 0.1 (order 2: 0.5).
    smoothing : float, optional
        How fast the innovation is smoothed, in (0, 1]; default 0.45 (order 2: 0.36).
    threshold : float, optional
        Standard deviations of the smoothed innovation where forgetting begins; default 3.2 (order 2: 2.8).
    width : float, optional
        Standard deviations from there to full motion; default 1.4 (order 2: 2.4).

    Examples
    --------
    >>> from stillrate import Filter, GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> config = VariableForgetting(sample_rate_hz=50.0, noise=noise)
    >>> Filter(config).run([0.0] * 100 + [5.0] * 3).round(1)[-3:].tolist()  # a sudden turn
    [1.7, 4.2, 4.9]
    """

    method: ClassVar[str] = "variable-forgetting"
    order: float | None = None
    forgetting_factor_max: float | None = None
    forgetting_factor_min: float | None = None
    smoothing: float | None = None
    threshold: float | None = None
    width: float | None = None


@dataclass(frozen=True, kw_only=True)
class CusumForgetting(Config):
    """Recursive least squares that a CUSUM test opens again at a change.

    Parameters
    ----------
    tau_s : float, optional
        Memory between changes in s; default twenty samples.
    forgetting_factor : float, optional
        The same as a factor a sample, in (0, 1]; default 0.951.
    drift : float, optional
        Standard deviations that count as no change; default 0.9.
    threshold : float, optional
        Sum at which a change is declared; default 4.75.
    samples_kept : float, optional
        Samples' worth of the past that survive a change; default 1.33.

    Examples
    --------
    >>> from stillrate import Filter, GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> config = CusumForgetting(sample_rate_hz=50.0, noise=noise)
    >>> Filter(config).run([0.0] * 100 + [5.0] * 3).round(1)[-3:].tolist()  # a sudden turn
    [3.8, 4.7, 4.8]
    """

    method: ClassVar[str] = "cusum-forgetting"
    tau_s: float | None = None
    forgetting_factor: float | None = None
    drift: float | None = None
    threshold: float | None = None
    samples_kept: float | None = None
