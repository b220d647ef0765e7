"""Fitting: from a rate-table log to an `ErrorModel`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.rate_table.model import ErrorModel, wrap
from stillrate.rate_table.parts import Calibration, Candidate, as_floats, refusals


def plateaus(
    rate_dps: npt.ArrayLike, table_rates_dps: Sequence[float], sample_rate_hz: float
) -> list[tuple[int, int, float]]:
    """Find the segments of a log in which the table stood at one of its rates.

    Returns
    -------
    list of (first, end, rate_dps)
        First sample, one past the last, and the table's rate.

    Examples
    --------
    >>> table = np.repeat([0.0, 2.0, -2.0], 500)
    >>> rate = table + 0.01 * np.sin(np.arange(1500) * 2.4)
    >>> [rate_dps for _, _, rate_dps in plateaus(rate, [-2.0, 0.0, 2.0], 100.0)]
    [0.0, 2.0, -2.0]
    """
    found: list[tuple[int, int, float]] = refusals(
        _native.rate_table_plateaus, as_floats(rate_dps, "rate_dps"), list(table_rates_dps), sample_rate_hz
    )
    return found


def fit(
    rate_dps: npt.ArrayLike,
    true_dps: npt.ArrayLike,
    temperature_c: npt.ArrayLike | None = None,
    *,
    segments: Sequence[tuple[int, int]] | None = None,
    sample_rate_hz: float | None = None,
    candidates: Sequence[str] | None = None,
    slope_limit: float = 0.1,
    seed: int = 1,
) -> ErrorModel:
    """Fit the error of a gyro over its rate from a rate-table log.

    The true rate (never the noisy measured one) is the regressor; offset, line, polynomials and small networks compete
    by predicting rates left out of the fit.

    Parameters
    ----------
    rate_dps : array_like, shape (n,)
        Measured rate; NaN where missing.
    true_dps : array_like, shape (n,) or (rates,)
        True rate at each sample; or the rates the table was set to, with `sample_rate_hz`: the segments are then found
        in the log. A true rate that never stands still (an encoder) is averaged in cells.
    temperature_c : array_like, shape (n,), optional
        Temperature at each sample; becomes an input. Give it if the unit drifts with temperature.
    segments : sequence of (first, end), optional
        Samples to average, instead of finding them.
    sample_rate_hz : float, optional
        Noted in the model; needed to find segments.
    candidates : sequence of str, optional
        Some of "offset", "line", "quadratic", "cubic", "network".
    slope_limit : float, optional
        Curves steeper than this are refused.
    seed : int, optional
        Of the networks' starts.

    Raises
    ------
    LogError
        If the log does not support a model: too few samples or rates, no noise, wrong unit or sign, ...

    References
    ----------
    Leave-one-rate-out is cross-validation by groups: Hastie, Tibshirani, Friedman, *The Elements of Statistical Learning*, section 7.10.

    Examples
    --------
    >>> table = np.repeat([-6.0, -3.0, 0.0, 3.0, 6.0], 400)  # 4 s at each rate
    >>> rate = 1.002 * table + 0.03 + 0.01 * np.sin(np.arange(table.size) * 2.4)
    >>> model = fit(rate, table)
    >>> model.rates, bool(abs(model.predict([1.5])[0] - 0.033) < 1e-3)
    (5, True)
    >>> fit(rate, [-6, -3, 0, 3, 6], sample_rate_hz=100.0).rates  # the segments are found in the log
    5
    """
    measured, true = as_floats(rate_dps, "rate_dps"), as_floats(true_dps, "true_dps")
    temperature = None if temperature_c is None else as_floats(temperature_c, "temperature_c")
    spans = None if segments is None else [(int(first), int(end)) for first, end in segments]
    if true.size != measured.size and sample_rate_hz is not None and spans is None:
        found = plateaus(measured, [float(rate) for rate in true], sample_rate_hz)
        spans = [(first, end) for first, end, _ in found]
        true = np.full(measured.size, np.nan)
        for first, end, rate in found:
            true[first:end] = rate
    names = None if candidates is None else list(candidates)
    made = refusals(_native.rate_table_fit, measured, true, temperature, spans, names, slope_limit, seed)
    return _finished(made, sample_rate_hz)


def fit_points(
    rate_dps: npt.ArrayLike,
    error_dps: npt.ArrayLike,
    standard_error_dps: npt.ArrayLike,
    temperature_c: npt.ArrayLike | None = None,
    *,
    candidates: Sequence[str] | None = None,
    slope_limit: float = 0.1,
    seed: int = 1,
) -> ErrorModel:
    """Fit averaged calibration points: true rate, mean error and its standard error, all in deg/s, shape (points,).

    A point's weight is 1/standard_error^2. Keywords and errors are those of `fit`.

    Examples
    --------
    >>> rates = np.array([-6.0, -3.0, 0.0, 3.0, 6.0])
    >>> model = fit_points(rates, 0.03 + 0.002 * rates, np.full(5, 1e-3), candidates=["offset", "line"])
    >>> model.kind, round(float(model.predict([4.0])[0]), 9)
    ('line', 0.038)
    """
    columns = [
        as_floats(values, name).tolist()
        for values, name in (
            (rate_dps, "rate_dps"),
            (error_dps, "error_dps"),
            (standard_error_dps, "standard_error_dps"),
        )
    ]
    temperature = None if temperature_c is None else as_floats(temperature_c, "temperature_c").tolist()
    names = None if candidates is None else list(candidates)
    made = refusals(_native.rate_table_fit_points, *columns, temperature, names, slope_limit, seed)
    return _finished(made, None)


def _finished(made: dict[str, Any], sample_rate_hz: float | None) -> ErrorModel:
    native = made["model"] if sample_rate_hz is None else made["model"].with_sample_rate(sample_rate_hz)
    calibration = Calibration(
        rate_dps=made["rate"],
        temperature_c=made["temperature"],
        error_dps=made["error"],
        standard_error_dps=made["standard_error"],
        residual_dps=made["residual"],
        samples=made["samples"],
        candidates=tuple(
            Candidate(name=name, held_out_dps=held_out, residual_dps=residual, steepest_slope=slope, refused=refused)
            for name, held_out, residual, slope, refused in made["scores"]
        ),
    )
    return wrap(native, calibration)
