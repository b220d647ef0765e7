"""Low-pass filters that users would reach for instead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from stillrate.config import Config


@dataclass(frozen=True, kw_only=True)
class Pt1(Config):
    """First-order low-pass, the usual flight-controller gyro filter.

    Parameters
    ----------
    cutoff_hz : float, optional
        Cut-off frequency in Hz; default 20 Hz, at most a quarter of the sample rate.

    Examples
    --------
    >>> Pt1(sample_rate_hz=50.0).cutoff_hz
    12.5
    """

    method: ClassVar[str] = "pt1"
    cutoff_hz: float | None = None


@dataclass(frozen=True, kw_only=True)
class Biquad(Config):
    """Second-order low-pass by the bilinear transform.

    Parameters
    ----------
    cutoff_hz : float, optional
        Cut-off frequency in Hz; default 20 Hz, at most a quarter of the sample rate.
    quality : float, optional
        Quality factor; default 1/sqrt(2) (Butterworth).

    Examples
    --------
    >>> round(Biquad(sample_rate_hz=1000.0, cutoff_hz=30.0).quality, 4)
    0.7071
    """

    method: ClassVar[str] = "biquad"
    cutoff_hz: float | None = None
    quality: float | None = None


@dataclass(frozen=True, kw_only=True)
class OneEuro(Config):
    """One-euro filter: a first-order low-pass whose cut-off grows with the speed of the signal.

    Parameters
    ----------
    minimum_cutoff_hz : float, optional
        Cut-off at rest in Hz; default 0.2.
    beta : float, optional
        Cut-off gained per deg/s^2, in Hz; default 0.5 for a density of 0.0151 deg/s/sqrt(Hz), in inverse proportion.
    derivative_cutoff_hz : float, optional
        Cut-off for the derivative in Hz; default 1.

    Examples
    --------
    >>> from stillrate import GyroNoise
    >>> OneEuro(sample_rate_hz=50.0, noise=GyroNoise(density_dps_sqrt_hz=0.0151)).beta
    0.5
    """

    method: ClassVar[str] = "one-euro"
    minimum_cutoff_hz: float | None = None
    beta: float | None = None
    derivative_cutoff_hz: float | None = None


@dataclass(frozen=True, kw_only=True)
class FirLowPass(Config):
    """Finite impulse response low-pass; the boxcar is the moving mean.

    Parameters
    ----------
    window : str, optional
        ``"boxcar"`` (default), ``"hann"``, ``"hamming"`` or ``"blackman"``.
    length : float, optional
        Number of taps, 1 to 128; default the noise of a recursive mean with a memory of 0.1 s.
    cutoff_hz : float, optional
        Cut-off of a windowed-sinc low-pass in Hz; 0 (default): the window itself is the low-pass.
    taps : sequence of float, optional
        Taps of your own, newest sample first; they replace window, length and cut-off.
    start : str, optional
        ``"first-sample"`` (default) fills the register with the first sample, ``"zero"`` starts it with zeros.

    Examples
    --------
    >>> from stillrate import Filter
    >>> Filter(FirLowPass(sample_rate_hz=50.0, length=2)).run([1.0, 3.0, 5.0]).tolist()
    [1.0, 2.0, 4.0]
    """

    method: ClassVar[str] = "fir"
    window: str | None = None
    length: float | None = None
    cutoff_hz: float | None = None
    taps: Sequence[float] | None = None
    start: str | None = None
