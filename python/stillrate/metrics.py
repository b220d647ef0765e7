"""Figures of merit: error, lag, settling, and whether a filter knows its own uncertainty.

Errors are estimate minus truth; samples where either is not finite are left out. One channel at a time.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stillrate import _native
from stillrate.arrays import as_column

__all__ = ["Settling", "lag_ms", "nees_mean", "pit_variance", "rms_about_mean", "rmse", "settling"]


class Settling(NamedTuple):
    """Largest error after a step, and the time in s until it stays within the band (inf: it does not).

    Examples
    --------
    >>> found = settling([0.0, 2.0, 4.0, 4.0, 4.0], [5.0] * 5, 10.0, start=0, stop=5, band=0.5)
    >>> found.peak, found.time_s
    (5.0, inf)
    """

    peak: float
    time_s: float


def rmse(estimate: Any, truth: Any) -> float:
    """Return the root mean square error, in the unit of the samples.

    Examples
    --------
    >>> rmse([4.0, -2.0], [1.0, 1.0])
    3.0
    """
    return float(_native.rmse(as_column(estimate), as_column(truth)))


def rms_about_mean(z: Any) -> float:
    """Return the root mean square about the mean: what is left of a record at rest.

    Examples
    --------
    >>> rms_about_mean([4.0, 6.0])
    1.0
    """
    return float(_native.rms_about_mean(as_column(z)))


def nees_mean(estimate: Any, truth: Any, variance: Any) -> float:
    """Return the mean squared error over its predicted variance: 1 for a filter that knows its uncertainty.

    Examples
    --------
    >>> nees_mean([2.0, 0.0], [0.0, 0.0], [4.0, 1.0])
    0.5
    """
    return float(_native.nees_mean(as_column(estimate), as_column(truth), as_column(variance)))


def pit_variance(probability: Any, innovation: Any, innovation_variance: Any) -> float:
    """Return the mean squared normal score of innovations under the mixture that predicted them: 1 is right.

    Parameters
    ----------
    probability : array_like, shape (n, models)
        Predicted (prior) probability of each model.
    innovation, innovation_variance : array_like, shape (n, models)
        Measurement minus prediction of each model and its variance, as in `Trace`.

    Examples
    --------
    >>> pit_variance([[0.5, 0.5]], [[3.0, 3.0]], [[9.0, 9.0]])
    1.0
    """
    tables = [
        np.atleast_2d(np.asarray(table, dtype=np.float64)) for table in (probability, innovation, innovation_variance)
    ]
    if any(table.ndim != 2 or table.shape != tables[0].shape for table in tables):
        raise ValueError(f"tables of shapes {[table.shape for table in tables]} (must all be (n, models))")
    weights, innovations, variances = (np.ascontiguousarray(table).reshape(-1) for table in tables)
    return float(_native.pit_variance(weights, innovations, variances, tables[0].shape[1]))


def lag_ms(estimate: Any, truth: Any, sample_rate_hz: float, *, max_lag_s: float = 0.2) -> float:
    """Return the lag of an estimate in ms, positive when late: the band-limited cross-correlation peak.

    NaN if the record is shorter than about twice `max_lag_s` plus 60 samples, or does not vary.

    Examples
    --------
    >>> import numpy as np
    >>> wave = np.sin(0.2 * np.arange(2000.0)) + np.sin(0.07 * np.arange(2000.0))
    >>> round(lag_ms(wave[:-3], wave[3:], 100.0), 2)
    30.0
    """
    return float(_native.lag_ms(as_column(estimate), as_column(truth), sample_rate_hz, max_lag_s))


def settling(estimate: Any, truth: Any, sample_rate_hz: float, *, start: int, stop: int, band: float) -> Settling:
    """Return peak error and settling time over samples `start` to `stop`, from a step to before the next.

    Examples
    --------
    >>> settling([0.0, 2.0, 4.0, 5.0, 5.0], [5.0] * 5, 10.0, start=0, stop=5, band=0.5)
    Settling(peak=5.0, time_s=0.3)
    """
    return Settling(*_native.settling(as_column(estimate), as_column(truth), sample_rate_hz, start, stop, band))
