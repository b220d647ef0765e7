"""Drift propagation: from a gyro's noise to the angle error of a rate loop or a tracked loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from stillrate import _native
from stillrate.errors import ConfigError

Polynomials = tuple[Sequence[float], Sequence[float]]
"""Numerator and denominator, coefficients in descending powers of s."""


@dataclass(frozen=True, kw_only=True)
class LoopNoise:
    """Noise at the input of a loop, deg/s.

    Parameters
    ----------
    density_dps_sqrt_hz : float
        N, two-sided, deg/s/sqrt(Hz): an integrator gathers N^2 T.
    bias_sigma_dps, bias_time_s : float
        Gauss-Markov part: standard deviation in deg/s and time constant in s.
    rate_random_walk_dps_sqrt_s : float
        K, deg/s/sqrt(s).

    Examples
    --------
    The same gyro, as four data sheets might state it:

    >>> gyro = LoopNoise.from_std_at_rate(0.1074, 50.0)
    >>> round(gyro.density_dps_sqrt_hz, 6)
    0.015189
    >>> stated = LoopNoise.from_density_two_sided(0.015189), LoopNoise.from_density_one_sided(0.021480)
    >>> [round(other.density_dps_sqrt_hz, 6) for other in (*stated, LoopNoise.from_arw_deg_sqrt_h(0.91132))]
    [0.015189, 0.015189, 0.015189]
    """

    density_dps_sqrt_hz: float = 0.0
    bias_sigma_dps: float = 0.0
    bias_time_s: float = 0.0
    rate_random_walk_dps_sqrt_s: float = 0.0

    @classmethod
    def from_arw_deg_sqrt_h(cls, arw: float, **rest: float) -> LoopNoise:
        """From an angle random walk in deg/sqrt(h)."""
        return cls(density_dps_sqrt_hz=arw / 60.0, **rest)

    @classmethod
    def from_std_at_rate(cls, sigma_dps: float, sample_rate_hz: float, **rest: float) -> LoopNoise:
        """From the standard deviation of white samples at a rate."""
        if not sample_rate_hz > 0.0:
            raise ConfigError(f"sample_rate_hz = {sample_rate_hz:g} (must be finite and > 0 Hz)")
        return cls(density_dps_sqrt_hz=sigma_dps / sample_rate_hz**0.5, **rest)

    @classmethod
    def from_density_one_sided(cls, density: float, **rest: float) -> LoopNoise:
        """From a one-sided density in deg/s/sqrt(Hz): what most data sheets state."""
        return cls(density_dps_sqrt_hz=density / 2.0**0.5, **rest)

    @classmethod
    def from_density_two_sided(cls, density: float, **rest: float) -> LoopNoise:
        """From a two-sided density in deg/s/sqrt(Hz)."""
        return cls(density_dps_sqrt_hz=density, **rest)


@dataclass(frozen=True)
class Drift:
    """Variance of the angle by cause, deg^2, and the angle that a constant rate bias of 1 deg/s leaves, deg.

    Examples
    --------
    >>> gyro = LoopNoise.from_density_two_sided(0.015, rate_random_walk_dps_sqrt_s=0.001)
    >>> minute, ten = drift(gyro, time_s=60.0), drift(gyro, time_s=600.0)
    >>> round(ten.white / minute.white), round(ten.rate_random_walk / minute.rate_random_walk)
    (10, 1000)
    >>> round(minute.total - minute.white - minute.rate_random_walk, 12), round(minute.rms_deg, 3)
    (0.0, 0.292)
    """

    white: float
    gauss_markov: float
    rate_random_walk: float
    bias_gain_s: float

    @property
    def total(self) -> float:
        """All causes together."""
        return self.white + self.gauss_markov + self.rate_random_walk

    @property
    def rms_deg(self) -> float:
        """Root of the total, deg."""
        return float(self.total**0.5)


def _pair(polynomials: Polynomials | None) -> tuple[list[float], list[float]] | None:
    if polynomials is None:
        return None
    numerator, denominator = polynomials
    return [float(c) for c in numerator], [float(c) for c in denominator]


def drift(
    noise: LoopNoise,
    *,
    rate_loop: Polynomials | None = None,
    tracking: Polynomials | float | None = None,
    filter: Polynomials | None = None,
    filter_position: str = "before-loop",
    dead_time_s: float = 0.0,
    time_s: float | None = None,
    band_rad_s: tuple[float, float] | None = None,
) -> Drift:
    """Angle error that gyro noise causes in a servo.

    Parameters
    ----------
    noise : LoopNoise
        The gyro.
    rate_loop : (numerator, denominator), optional
        Closed rate loop in s, descending powers; default perfect (a pure integrator of the noise).
    tracking : gain in 1/s, or (kb, ka), optional
        Angle loop around it, with an angle sensor that does not come from the gyro; default none: the error grows.
    filter : (numerator, denominator), optional
        A filter, at `filter_position`: "before-loop", "rate-feedback" or "forward-path".
    dead_time_s : float
        Dead time in the rate loop, s (needs `band_rad_s`).
    time_s : float, optional
        Variance this many seconds after a start at rest; default the steady state.
    band_rad_s : (low, high), optional
        Hard band limits in rad/s; computed by quadrature.

    Raises
    ------
    ConfigError
        Unstable (naming the Routh row), infinite variance, or a growing error that needs `time_s`.

    Examples
    --------
    >>> noise = LoopNoise.from_std_at_rate(0.1074, 50.0)
    >>> round(drift(noise, rate_loop=([20.0], [1.0, 20.0]), time_s=60.0).rms_deg, 4)
    0.1176
    >>> round(drift(noise, rate_loop=([20.0], [1.0, 20.0]), tracking=2.0).rms_deg, 5)
    0.00759
    """
    around: Polynomials | None = ([tracking], [1.0]) if isinstance(tracking, (int, float)) else tracking
    white, markov, walk, bias = _native.servo_drift(
        _pair(rate_loop),
        _pair(around),
        _pair(filter),
        filter_position,
        dead_time_s,
        (noise.density_dps_sqrt_hz, noise.bias_sigma_dps, noise.bias_time_s, noise.rate_random_walk_dps_sqrt_s),
        time_s,
        band_rad_s,
    )
    return Drift(white, markov, walk, bias)


def variance(
    numerator: Sequence[float],
    denominator: Sequence[float],
    *,
    time_s: float | None = None,
    band_rad_s: tuple[float, float] | None = None,
    algorithm: str = "astrom",
) -> float:
    """Variance of a transfer function's output for white noise of two-sided density 1.

    Parameters
    ----------
    numerator, denominator : sequence of float
        Descending powers of s.
    time_s : float, optional
        After this time in s from rest (Van Loan and doubling); default the steady state.
    band_rad_s : (low, high), optional
        Over a hard band in rad/s (quadrature).
    algorithm : str
        For the steady state: "astrom", "lyapunov" or "van-loan".

    Examples
    --------
    >>> variance([6.0], [1.0, 6.0])
    3.0
    """
    if algorithm not in ("astrom", "lyapunov", "van-loan"):
        raise ConfigError(f"algorithm = {algorithm} (must be astrom, lyapunov or van-loan)")
    transfer = ([float(c) for c in numerator], [float(c) for c in denominator])
    return float(_native.servo_variance(transfer, time_s, band_rad_s, algorithm))
