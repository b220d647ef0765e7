"""What the recursive filters do, without running them: gain, noise, lag, bandwidth, and the ways to say "memory".

For a constant forgetting factor (above 0, at most 1) and regular samples. Delays are in samples, frequencies a
fraction of the sample rate, noise a variance over that of one white sample.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import ConfigError


def _factor(forgetting_factor: float) -> float:
    value = float(forgetting_factor)
    if not 0.0 < value <= 1.0:
        raise ConfigError(f"forgetting_factor = {value:g} (must be above 0 and at most 1)")
    return value


def rls_gain(forgetting_factor: float, n: int) -> float:
    """Return the gain of recursive least squares at sample `n` (1 for the first).

    Examples
    --------
    >>> rls_gain(0.95, 1), rls_gain(1.0, 4)
    (1.0, 0.25)
    """
    return float(_native.closed_form("rls_gain", _factor(forgetting_factor), n))


def kf_gain(forgetting_factor: float, n: int) -> float:
    """Return the gain of the random-walk Kalman filter at sample `n`, Q/R being that of `forgetting_factor`.

    Examples
    --------
    >>> kf_gain(0.95, 1), kf_gain(1.0, 4)
    (1.0, 0.25)
    """
    return float(_native.closed_form("kf_gain", _factor(forgetting_factor), n))


def rls_noise(forgetting_factor: float, n: int) -> float:
    """Return the noise variance of recursive least squares after `n` samples of a constant rate.

    Examples
    --------
    >>> rls_noise(1.0, 4)  # the mean of four
    0.25
    """
    return float(_native.closed_form("rls_noise", _factor(forgetting_factor), n))


def steady_noise(forgetting_factor: float, order: int = 1) -> float:
    """Return the noise variance in the steady state, order 1 or 2.

    Examples
    --------
    >>> round(steady_noise(0.9), 4), round(steady_noise(0.9, order=2), 4)
    (0.0526, 0.1261)
    """
    name = "steady_noise" if order == 1 else "steady_noise_order_2"
    return float(_native.closed_form(name, _factor(forgetting_factor)))


def lag_samples(forgetting_factor: float) -> float:
    """Return the lag on a ramp (order 1), which is also the delay at zero frequency.

    Examples
    --------
    >>> lag_samples(0.5)
    1.0
    """
    return float(_native.closed_form("lag_samples", _factor(forgetting_factor)))


def boxcar_length(forgetting_factor: float) -> float:
    """Return the length of the moving mean with the same noise, and exactly the same lag.

    Examples
    --------
    >>> round(boxcar_length(0.9), 9)
    19.0
    """
    return float(_native.closed_form("boxcar_length", _factor(forgetting_factor)))


def phase_delay_samples(forgetting_factor: float, frequency: float) -> float:
    """Return the phase delay at a frequency (fraction of the sample rate).

    Examples
    --------
    >>> round(phase_delay_samples(0.9, 0.01), 2), round(lag_samples(0.9), 2)
    (8.07, 9.0)
    """
    return float(_native.closed_form("phase_delay_samples", _factor(forgetting_factor), frequency))


def half_power_frequency(forgetting_factor: float) -> float | None:
    """Return the -3 dB frequency; None below 3 - 2 sqrt 2, where there is none.

    Examples
    --------
    >>> round(half_power_frequency(0.9512), 5)
    0.00796
    >>> half_power_frequency(0.1) is None
    True
    """
    value = float(_native.closed_form("half_power_frequency", _factor(forgetting_factor)))
    return None if value != value else value


def tau_samples(forgetting_factor: float) -> float:
    """Return the memory in samples, -1/ln lambda.

    Examples
    --------
    >>> tau_samples(1.0)
    inf
    """
    return float(_native.closed_form("tau_samples", _factor(forgetting_factor)))


def forgetting_factor_of_tau(tau_samples: float) -> float:
    """Return exp(-1/tau).

    Examples
    --------
    >>> round(tau_samples(forgetting_factor_of_tau(20.0)), 9)
    20.0
    """
    return float(_native.closed_form("forgetting_factor_of_tau", tau_samples))


def variance_ratio(forgetting_factor: float) -> float:
    """Return Q/R of the random-walk Kalman filter with the steady gain 1 - lambda.

    Examples
    --------
    >>> variance_ratio(0.5)
    0.5
    """
    return float(_native.closed_form("variance_ratio", _factor(forgetting_factor)))


def forgetting_factor_of_variance_ratio(variance_ratio: float) -> float:
    """Return lambda of a Q/R.

    Examples
    --------
    >>> forgetting_factor_of_variance_ratio(0.5)
    0.5
    """
    return float(_native.closed_form("forgetting_factor_of_variance_ratio", variance_ratio))


def order_2_gains(forgetting_factor: float, count: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return g1 and g2 of order 2 at samples 1 to `count`.

    Examples
    --------
    >>> [gain.round(4).tolist() for gain in order_2_gains(1.0, 3)]
    [[1.0, 1.0, 0.8333], [0.0, 1.0, 0.5]]
    """
    level, slope = _native.order_2_gains(_factor(forgetting_factor), count)
    return level, slope


def fir_taps(window: str, length: int, cutoff: float = 0.0) -> npt.NDArray[np.float64]:
    """Return the taps of a window, or of the low-pass it shapes with `cutoff` as a fraction of the sample rate.

    Examples
    --------
    >>> fir_taps("boxcar", 2).tolist()
    [0.5, 0.5]
    """
    taps: npt.NDArray[np.float64] = _native.fir_taps(window, float(length), float(cutoff))
    return taps
