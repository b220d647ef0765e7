"""Interacting multiple models and the Singer filter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from stillrate.config import Config


@dataclass(frozen=True, kw_only=True)
class MsImmIkf(Config):
    """The recommended filter: an interacting multiple model bank with an on-line manoeuvre frequency.

    One random walk, a ladder of Singer models up to the sample rate, and double oscillators that share a frequency
    found on line. Only the sample rate and the noise must be given.

    Parameters
    ----------
    oscillators : sequence of float, optional
        Half-widths of the double oscillators in rad/s; default (1, 3, 10, 30); ``()`` is the
        light form, at half the cost.
    ladder_hz : sequence of float, optional
        Bandwidths of the Singer rungs in Hz; default 2, 8, 32, ... up to the first that reaches the sample rate.
    dwell_time_s : float, optional
        Mean dwell time in a moving model in s; default 20.
    rest_dwell_time_s : float, optional
        Mean dwell time at rest in s; default 100.
    frequency_memory_s : float, optional
        Memory of the manoeuvre frequency in s; default 5.
    variance_memory_s : float, optional
        Memory of the mean square acceleration that sets the prior variances, in s; default 1.
    derivative_cap : float, optional
        Cap on the acceleration that oscillators take over from other models; default 4; ``inf`` for none.
    moment_limit_hz : float, optional
        Rungs above this bandwidth stay out of the frequency's moments, in Hz; default 33; ``inf`` for none.
    refresh_s : float, optional
        Interval at which the oscillators follow the frequency, in s; default 0.02; 0 for every sample.
    bandwidth_hz : float, optional
        Known bandwidth of the motion in Hz: rungs above it are left out, but never the widest; default ``inf``.
    outlier_probability : float, optional
        Prior probability of an outlier, 0 (off, the default) to below 0.5.
    saturation_dps : float, optional
        Full scale of the sensor in deg/s: samples there count as one-sided bounds; default ``inf``.

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> MsImmIkf(sample_rate_hz=50.0, noise=noise).ladder_hz
    (2.0, 8.0, 32.0, 128.0)
    >>> light = MsImmIkf(sample_rate_hz=50.0, noise=noise, oscillators=())
    """

    method: ClassVar[str] = "ms-imm-ikf"
    oscillators: Sequence[float] | None = None
    ladder_hz: Sequence[float] | None = None
    dwell_time_s: float | None = None
    rest_dwell_time_s: float | None = None
    frequency_memory_s: float | None = None
    variance_memory_s: float | None = None
    derivative_cap: float | None = None
    moment_limit_hz: float | None = None
    refresh_s: float | None = None
    bandwidth_hz: float | None = None
    outlier_probability: float | None = None
    saturation_dps: float | None = None


@dataclass(frozen=True, kw_only=True)
class SingerKf(Config):
    """Singer Kalman filter: one manoeuvre model with a fixed time constant.

    Parameters
    ----------
    alpha_per_s : float, optional
        Reciprocal manoeuvre time constant in 1/s; default 0.01.
    accel_max_dps2 : float, optional
        Largest acceleration in deg/s^2; default 30.
    measurement_variance : float, optional
        Variance of a sample in (deg/s)^2; default that of the noise at the sample rate.
    initial_rate_variance : float, optional
        Variance of the rate before the first sample in (deg/s)^2; default that of a sample.
    initial_acceleration_variance : float, optional
        Variance of the acceleration before the first sample in (deg/s^2)^2; default 100.

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> SingerKf(sample_rate_hz=50.0, noise=noise).measurement_variance  # density squared times rate
    0.01125
    """

    method: ClassVar[str] = "singer-kf"
    alpha_per_s: float | None = None
    accel_max_dps2: float | None = None
    measurement_variance: float | None = None
    initial_rate_variance: float | None = None
    initial_acceleration_variance: float | None = None


@dataclass(frozen=True, kw_only=True)
class SingerImmKf(Config):
    """Two interacting Singer models, one for rest and one for motion.

    The defaults reproduce the published static figures. Pairs are (rest, motion).

    Parameters
    ----------
    alpha_per_s : pair of float, optional
        Reciprocal manoeuvre time constants in 1/s; default (.001, .01).
    accel_max_dps2 : pair of float, optional
        Largest accelerations in deg/s^2; default (1.5, 30).
    transition : four floats, optional
        Transition probabilities a sample, row by row; default (.95, .05, .05, .95).
    initial_probability : pair of float, optional
        Probabilities before the first sample; default (.5, .5).
    measurement_variance : pair of float, optional
        Variance of a sample in (deg/s)^2; default that of the noise at the sample rate.
    initial_rate_variance : pair of float, optional
        Variances of the rate before the first sample in (deg/s)^2; default that of a sample.
    initial_acceleration_variance : pair of float, optional
        Variances of the acceleration before the first sample in (deg/s^2)^2; default (1, 100).

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> SingerImmKf(sample_rate_hz=50.0, noise=noise).accel_max_dps2
    (1.5, 30.0)
    >>> SingerImmKf(sample_rate_hz=50.0, noise=noise, alpha_per_s=0.02).alpha_per_s  # one for both
    (0.02, 0.02)
    """

    method: ClassVar[str] = "singer-imm-kf"
    alpha_per_s: Sequence[float] | None = None
    accel_max_dps2: Sequence[float] | None = None
    transition: Sequence[float] | None = None
    initial_probability: Sequence[float] | None = None
    measurement_variance: Sequence[float] | None = None
    initial_rate_variance: Sequence[float] | None = None
    initial_acceleration_variance: Sequence[float] | None = None


@dataclass(frozen=True, kw_only=True)
class MsImmIkfPaper(Config):
    """The published MS-IMM-IKF: two modified Singer models with alpha as a state, and a fading factor.

    Parameters
    ----------
    mode : str, optional
        Sets the defaults of the rest. ``"paper"`` (default) comes nearest to the published static figures; ``"printed"`` is
        the equations to the letter, which diverge by themselves and say so in the flags; ``"exact-jacobian"`` and
        ``"log-alpha"`` estimate alpha, or its logarithm, with the exact derivative.
    alpha_per_s, accel_max_dps2, transition, initial_probability, measurement_variance, initial_rate_variance, initial_acceleration_variance : optional
        As in `SingerImmKf`.
    initial_alpha_variance : pair of float, optional
        Variance of the third state before the first sample.
    alpha_noise_density : pair of float, optional
        Density of the third state's random walk.
    alpha_mixing : {"private", "shared"}, optional
        Whether alpha is mixed like any state.
    jacobian : {"printed", "exact"}, optional
        Whether F holds the derivative by alpha; ``"exact"`` needs ``alpha_mixing="shared"``.
    fading : {"none", "absolute", "signed"}, optional
        Whether the fading factor is 1, max(1, abs(C)), as printed, or max(1, C).
    fading_source : {"measurement", "innovation", "windowed"}, optional
        What C compares with its expectation: the measurement (printed), the innovation, or its windowed square.
    fading_scale : float, optional
        Factor of that square; default sqrt(1/2) for the measurement, 1 for the others.
    fading_scope : {"rate-acceleration", "all"}, optional
        What the fading factor multiplies.
    fading_gate : {"always", "while-moving", "second-model-while-moving"}, optional
        When it acts.
    fading_memory : float, optional
        Forgetting factor of the windowed form; default .95.
    fading_softening : float, optional
        Factor on the measurement variance in the windowed form; default 1.5.
    static_stay_probability : float, optional
        Probability of staying while rest is declared; 0 keeps `transition`; default .9985 in the mode ``"paper"``, else 0.
    static_alpha_per_s : float, optional
        Rest is declared while the mean alpha does not exceed this, in 1/s; default .0055.

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> noise = GyroNoise(density_dps_sqrt_hz=0.015)
    >>> MsImmIkfPaper(sample_rate_hz=50.0, noise=noise, mode="exact-jacobian").fading
    'none'
    """

    method: ClassVar[str] = "ms-imm-ikf-paper"
    mode: str | None = None
    alpha_per_s: Sequence[float] | None = None
    accel_max_dps2: Sequence[float] | None = None
    transition: Sequence[float] | None = None
    initial_probability: Sequence[float] | None = None
    measurement_variance: Sequence[float] | None = None
    initial_rate_variance: Sequence[float] | None = None
    initial_acceleration_variance: Sequence[float] | None = None
    initial_alpha_variance: Sequence[float] | None = None
    alpha_noise_density: Sequence[float] | None = None
    alpha_mixing: str | None = None
    jacobian: str | None = None
    fading: str | None = None
    fading_source: str | None = None
    fading_scale: float | None = None
    fading_scope: str | None = None
    fading_gate: str | None = None
    fading_memory: float | None = None
    fading_softening: float | None = None
    static_stay_probability: float | None = None
    static_alpha_per_s: float | None = None
