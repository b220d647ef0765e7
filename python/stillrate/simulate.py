"""Signals with a known truth: beds for scoring filters, a gyro's noise, and the bound for any causal filter.

The same seed gives the same numbers on every platform.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.arrays import as_column
from stillrate.errors import ConfigError
from stillrate.results import brief

__all__ = [
    "Bed",
    "GyroModel",
    "Reading",
    "bed",
    "best_at_rest",
    "chirp",
    "gyro",
    "rough_waves",
    "static",
    "steps",
    "waves",
]

Array = npt.NDArray[np.float64]
Kind = Literal["static", "waves", "rough-waves", "steps", "chirp"]


@dataclass(frozen=True, kw_only=True)
class GyroModel:
    """A simulated gyro; the defaults are those of the beds.

    Parameters
    ----------
    density_dps_sqrt_hz : float
        Two-sided density of the white noise in deg/s/sqrt(Hz).
    bias_sigma_dps, bias_time_s : float
        Gauss-Markov bias: standard deviation in deg/s and correlation time in s.
    rate_random_walk_dps_sqrt_s : float
        Rate random walk in deg/s/sqrt(s).
    lsb_dps : float
        Quantisation step in deg/s; 0 for none.
    saturation_dps : float
        Full scale in deg/s.
    missing_probability : float
        Probability that a gap begins at a sample.
    gap_samples : int
        Length of a gap in samples.
    bias_instability_dps : float
        Flicker noise B in deg/s; the Allan deviation has its floor at 0.664 B. With it there is no bound.

    Examples
    --------
    >>> quantised = GyroModel(lsb_dps=0.0625)
    >>> set(static(50.0, 1, noise=quantised).measured_dps % 0.0625)
    {np.float64(0.0)}
    """

    density_dps_sqrt_hz: float = 0.1068 / math.sqrt(50.0)
    bias_sigma_dps: float = 0.01
    bias_time_s: float = 20.0
    rate_random_walk_dps_sqrt_s: float = 0.001
    lsb_dps: float = 0.0
    saturation_dps: float = math.inf
    missing_probability: float = 0.0
    gap_samples: int = 1
    bias_instability_dps: float = 0.0


@dataclass(frozen=True, repr=False)
class Bed:
    """A simulated run.

    Attributes
    ----------
    kind : str
        The motion, as `bed` names it.
    sample_rate_hz : float
    seed : int
    t_s : ndarray, shape (n,)
        Time in s.
    motion_dps, drift_dps, truth_dps : ndarray, shape (n,)
        Motion, slow drift of the gyro, and their sum, which a filter is to estimate, in deg/s.
    measured_dps : ndarray, shape (n,)
        What the gyro reads in deg/s; NaN where a sample is missing.
    bound_dps, bound_variance : ndarray or None
        Estimate and variance of the best linear filter, which knows everything but the random numbers; None
        for steps, chirps, and where it was not asked for.
    scored : slice
        Samples over which the motion is scored.
    calm : slice or None
        Samples of the calm after the waves.

    Examples
    --------
    No causal filter does better on these very samples than the bound; where it stands, its variance says how far off it is.

    >>> from stillrate import metrics
    >>> run = static(50.0, 1, bound=True)
    >>> bool((run.motion_dps == 0.0).all() and (run.truth_dps == run.drift_dps).all())
    True
    >>> raw = metrics.rmse(run.measured_dps, run.truth_dps)
    >>> best = metrics.rmse(run.bound_dps[run.scored], run.truth_dps[run.scored])
    >>> raw > 10 * best, bool(0.5 < best**2 / run.bound_variance[-1] < 2.0)
    (True, True)
    """

    kind: str
    sample_rate_hz: float
    seed: int
    t_s: Array
    motion_dps: Array
    drift_dps: Array
    truth_dps: Array
    measured_dps: Array
    bound_dps: Array | None
    bound_variance: Array | None
    scored: slice
    calm: slice | None

    def __repr__(self) -> str:
        return f"Bed({self.kind!r}, {self.sample_rate_hz:g} Hz, seed={self.seed}, {len(self.t_s)} samples)"


def bed(
    kind: Kind,
    sample_rate_hz: float,
    seed: int,
    *,
    duration_s: float | None = None,
    waves_end_s: float | None = None,
    noise: GyroModel | None = None,
    bound: bool = False,
) -> Bed:
    """Simulate a bed.

    Parameters
    ----------
    kind : {"static", "waves", "rough-waves", "steps", "chirp"}
        At rest (60 s); 2 Hz waves that calm down (180 s); the same driven by white noise; steps and slews
        (120 s); a logarithmic chirp from 0.1 to 10 Hz (60 s).
    sample_rate_hz : float
        Sample rate in Hz.
    seed : int
        Seed, 0 to 2**64 - 1.
    duration_s, waves_end_s : float, optional
        Length of the run and, for waves, when they begin to die down, in s.
    noise : GyroModel, optional
        The gyro.
    bound : bool, optional
        Whether to run the best linear filter as well.

    Raises
    ------
    ConfigError
        For a setting out of range.

    Examples
    --------
    >>> run = bed("waves", 50.0, 1, bound=True)
    >>> len(run.t_s), run.calm
    (9000, slice(6460, 9000, None))
    """
    _check_seed(seed)
    numbers = None if noise is None else astuple(noise)
    found = _native.simulate_bed(kind, sample_rate_hz, seed, duration_s, waves_end_s, numbers, bound)
    found["scored"] = slice(*found["scored"])
    found["calm"] = None if found["calm"] is None else slice(*found["calm"])
    return Bed(kind=kind, sample_rate_hz=sample_rate_hz, seed=seed, **found)


def static(sample_rate_hz: float, seed: int, **options: Any) -> Bed:
    """Simulate a gyro at rest; options as in `bed`.

    Examples
    --------
    >>> static(50.0, 1).measured_dps.shape
    (3000,)
    """
    return bed("static", sample_rate_hz, seed, **options)


def waves(sample_rate_hz: float, seed: int, **options: Any) -> Bed:
    """Simulate 2 Hz waves that calm down; options as in `bed`.

    Examples
    --------
    >>> run = waves(50.0, 1)
    >>> bool(abs(run.motion_dps[run.scored]).max() > 1), bool(abs(run.motion_dps[-50:]).max() < 0.1)
    (True, True)
    """
    return bed("waves", sample_rate_hz, seed, **options)


def rough_waves(sample_rate_hz: float, seed: int, **options: Any) -> Bed:
    """Simulate rough 2 Hz waves that calm down; options as in `bed`.

    Examples
    --------
    >>> run = rough_waves(50.0, 1, duration_s=60.0, waves_end_s=30.0)
    >>> len(run.t_s)
    3000
    """
    return bed("rough-waves", sample_rate_hz, seed, **options)


def steps(sample_rate_hz: float, seed: int, **options: Any) -> Bed:
    """Simulate steps and slews; options as in `bed`.

    Examples
    --------
    >>> run = steps(50.0, 1)
    >>> float(run.motion_dps.min()), float(run.motion_dps.max())
    (-10.0, 60.0)
    """
    return bed("steps", sample_rate_hz, seed, **options)


def chirp(sample_rate_hz: float, seed: int, **options: Any) -> Bed:
    """Simulate a logarithmic chirp; options as in `bed`.

    Examples
    --------
    >>> chirp(50.0, 1, duration_s=10.0).t_s[-1].round(2)
    np.float64(9.98)
    """
    return bed("chirp", sample_rate_hz, seed, **options)


def _check_seed(seed: int) -> None:
    if not 0 <= seed < 1 << 64:
        raise ConfigError(f"seed = {seed} (must be from 0 to 2**64 - 1)")


@dataclass(frozen=True)
class Reading:
    """What a simulated gyro reads of a motion, the truth (motion + drift) and the drift, in deg/s; arrays of shape (n,).

    Examples
    --------
    >>> reading = gyro([10.0] * 5000, 50.0, 1)
    >>> bool((reading.truth_dps == 10.0 + reading.drift_dps).all())
    True
    >>> round(float((reading.measured_dps - reading.truth_dps).std()), 2)  # density times the root of the rate
    0.11
    """

    measured_dps: Array
    truth_dps: Array
    drift_dps: Array

    __repr__ = brief


def gyro(motion_dps: Any, sample_rate_hz: float, seed: int, noise: GyroModel | None = None) -> Reading:
    """Read a motion of your own with a simulated gyro.

    Raises
    ------
    ConfigError
        For a setting out of range.

    Examples
    --------
    >>> reading = gyro([0.0] * 100, 50.0, 1, GyroModel(lsb_dps=0.5))
    >>> set(reading.measured_dps % 0.5)
    {np.float64(0.0)}
    """
    _check_seed(seed)
    numbers = astuple(noise if noise is not None else GyroModel())
    return Reading(*_native.simulate_gyro(as_column(motion_dps), sample_rate_hz, seed, numbers))


def best_at_rest(measured_dps: Any, sample_rate_hz: float, noise: GyroModel | None = None) -> tuple[Array, Array]:
    """Return estimate and variance of the best linear filter for a gyro at rest, run on the given samples.

    Examples
    --------
    >>> run = static(50.0, 1)
    >>> rate, variance = best_at_rest(run.measured_dps, 50.0)
    >>> bool(variance[-1] < 0.01**2)
    True
    """
    numbers = astuple(noise if noise is not None else GyroModel())
    rate, variance = _native.best_at_rest(as_column(measured_dps), sample_rate_hz, numbers)
    return rate, variance
