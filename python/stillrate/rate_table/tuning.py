"""Noise tuning: Q/R of the small Kalman filters and the two noise figures of the recommended bank, from records."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import LogError
from stillrate.noise import GyroNoise
from stillrate.rate_table.optimise import Progress, minimise
from stillrate.rate_table.parts import Floats, as_floats, refusals


class TuningWarning(UserWarning):
    """The result is what was asked for but may not be what is wanted.

    Examples
    --------
    >>> still = np.random.default_rng(1).standard_normal(4000)
    >>> with warnings.catch_warnings(record=True, action="always", category=TuningWarning) as said:
    ...     tuned = tune(still, 100.0)
    >>> str(said[0].message).partition(":")[0]
    'nothing moves in these records'
    """


@dataclass(frozen=True, kw_only=True)
class TunedNoise:
    """Tuned noise.

    Attributes
    ----------
    model : str
        "random-walk", "rate-acceleration" or "imm".
    log10_ratio : float
        log10 of Q/R (NaN for the bank).
    process_noise : float
        Q, in (deg/s)^2 a step for the random walk, (deg/s)^2/s^3 for rate and acceleration.
    measurement_variance : float
        R that the innovations imply, (deg/s)^2.
    noise : GyroNoise or None
        Noise figures, for the bank.
    objective : float
        The objective's value at the result.
    evaluations : int
        How many points were valued.
    moving : bool
        Whether something moved in the records.
    warnings : tuple of str
        What makes the result doubtful, in words.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> rate = np.cumsum(0.1 * rng.standard_normal(4000)) + rng.standard_normal(4000)
    >>> tuned = tune(rate, 100.0)
    >>> tuned.model, bool(abs(tuned.measurement_variance - 1.0) < 0.1), tuned.moving, tuned.warnings
    ('random-walk', True, True, ())
    """

    model: str
    log10_ratio: float
    process_noise: float
    measurement_variance: float
    noise: GyroNoise | None
    objective: float
    evaluations: int
    moving: bool
    warnings: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class KalmanRun:
    """A run of the scalar random-walk filter.

    Attributes
    ----------
    rate_dps, variance : ndarray, shape (n,)
        Estimate and its variance.
    gain : ndarray, shape (n - 1,)
        Gains from the second sample on.
    innovation : float
        ln R^ + mean ln F + 1, F in units of R: minus twice the log likelihood a sample, R concentrated out.
    implied_variance : float
        R^, the measurement variance that the innovations imply.
    settled_gain : float
        Gain of the steady state.

    Examples
    --------
    >>> run = kalman(np.zeros(100), process_noise=0.5, measurement_variance=1.0)
    >>> round(run.settled_gain, 12), round(float(run.gain[-1]), 12), round(float(run.variance[-1]), 12)
    (0.5, 0.5, 0.5)
    """

    rate_dps: Floats
    variance: Floats
    gain: Floats
    innovation: float
    implied_variance: float
    settled_gain: float


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Mean absolute (deg/s), mean squared ((deg/s)^2) and root mean squared error (deg/s).

    Examples
    --------
    >>> errors = compare([1.5, 2.5], [1.0, 2.0])  # a constant offset: both means agree
    >>> errors.mae, errors.mse, errors.rmse
    (0.5, 0.25, 0.5)
    """

    mae: float
    mse: float
    rmse: float


def compare(estimate_dps: npt.ArrayLike, true_dps: npt.ArrayLike) -> Errors:
    """Return the errors of an estimate, shape (n,), against the truth.

    Examples
    --------
    >>> compare([1.0, 3.0], [1.0, 1.0]).rmse == 2**0.5
    True
    """
    mse, mae = refusals(_native.compare_rates, as_floats(estimate_dps, "estimate_dps"), as_floats(true_dps, "true_dps"))
    return Errors(mae=mae, mse=mse, rmse=float(np.sqrt(mse)))


def tune(
    rate_dps: npt.ArrayLike | Sequence[npt.ArrayLike],
    sample_rate_hz: float,
    true_dps: npt.ArrayLike | Sequence[npt.ArrayLike] | None = None,
    *,
    model: str = "random-walk",
    objective: str | None = None,
    method: str = "brent",
    separate: bool = False,
    progress: Progress | None = None,
    **options: Any,
) -> TunedNoise:
    """Find the noise of a filter on one or several records.

    Parameters
    ----------
    rate_dps : array_like, shape (n,), or a sequence of such
        Measured rate; several records share one noise. They must contain the motion to be expected: on constant
        records the result suits standing still, and a `TuningWarning` says so.
    sample_rate_hz : float
    true_dps : like `rate_dps`, optional
        True rate.
    model : {"random-walk", "rate-acceleration", "imm"}
        The scalar filter, the two-state filter, or the recommended bank (which has no motion to tune for).
    objective : {"innovation", "truth"}, optional
        Likelihood of the innovations (default without truth), or mean squared error to `true_dps` (default with it).
    method : {"brent", "qpso", "de"}
    separate : bool
        Search log10 Q and log10 R in -10..10 as the publication does; only their difference matters.
    progress : callable, optional
        Called with iteration, evaluations and best value; returning False stops.
    **options
        Of the method, see `minimise`.

    Raises
    ------
    LogError
        If a record has fewer than 64 usable samples, no noise, or a truth that does not fit.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> motion = np.cumsum(0.1 * rng.standard_normal(4000))
    >>> bool(abs(tune(motion + rng.standard_normal(4000), 100.0).log10_ratio + 2.0) < 0.3)
    True
    """
    period = _period_s(sample_rate_hz)
    measured = _records(rate_dps, "rate_dps")
    true = None if true_dps is None else _records(true_dps, "true_dps")
    wanted = objective or ("innovation" if true is None else "truth")
    small = "rate-acceleration" if model == "imm" else model
    native = refusals(_native.NoiseObjective, measured, true, small, wanted, period)
    if model == "imm":
        if wanted != "innovation" or method != "brent" or separate or options:
            raise LogError("model 'imm' is tuned by its innovations with method 'brent' and no options")
        density, walk, value, evaluations = refusals(_native.tune_bank, native, progress)
        noise = GyroNoise(density_dps_sqrt_hz=density, rate_random_walk_dps_sqrt_s=walk)
        return TunedNoise(
            model=model,
            log10_ratio=float("nan"),
            process_noise=walk**2 * period,
            measurement_variance=density**2 * sample_rate_hz,
            noise=noise,
            objective=value,
            evaluations=evaluations,
            moving=bool(refusals(native.moving)),
            warnings=(),
        )
    if method == "de":
        low, high = native.range()
        lower, upper = ([-10.0, -10.0], [10.0, 10.0]) if separate else ([low], [high])
        best = minimise(
            lambda points: native.values(np.ascontiguousarray(points).ravel(), len(lower)),
            lower,
            upper,
            "de",
            progress=progress,
            **options,
        )
        found = native.finish(best.point.tolist(), best.value, best.evaluations)
    else:
        if method == "qpso" and "target" not in options:
            # The published stop rule is met by initial draws; the search is to find a minimum.
            options["target"] = float("-inf")
        found = refusals(_native.tune_noise, native, method, options, separate, progress)
    for text in found["warnings"]:
        warnings.warn(text, TuningWarning, stacklevel=2)
    return TunedNoise(model=model, noise=None, **{**found, "warnings": tuple(found["warnings"])})


def kalman(
    rate_dps: npt.ArrayLike,
    process_noise: float,
    measurement_variance: float,
    start_rate_dps: float | None = None,
    start_variance: float | None = None,
) -> KalmanRun:
    """Run the scalar random-walk filter (A = H = 1); by default it starts at the first sample with variance R.

    Parameters
    ----------
    rate_dps : array_like, shape (n,)
        Measured rate; NaN where missing.
    process_noise, measurement_variance : float
        Q a step and R, (deg/s)^2.
    start_rate_dps, start_variance : float, optional
        Estimate at the first sample and its variance.

    Raises
    ------
    LogError
        If Q is negative, R not positive, or anything not finite.

    Examples
    --------
    >>> kalman([4.0, 0.0, 2.0], process_noise=0.0, measurement_variance=1.0).rate_dps.tolist()  # the running mean
    [4.0, 2.0, 2.0]
    """
    measured = as_floats(rate_dps, "rate_dps")
    if measured.size == 0:
        raise LogError("no samples")
    start = float(measured[0]) if start_rate_dps is None else start_rate_dps
    variance = measurement_variance if start_variance is None else start_variance
    arguments = (measured, process_noise, measurement_variance, start, variance)
    return KalmanRun(**refusals(_native.kalman_random_walk, *arguments))


def track(rate_dps: npt.ArrayLike, tuned: TunedNoise, sample_rate_hz: float) -> Floats:
    """Return the rate of a small filter with tuned noise, shape (n,); missing samples are coasted over.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> true = np.cumsum(0.1 * rng.standard_normal(4000))
    >>> rate = true + rng.standard_normal(4000)
    >>> compare(track(rate, tune(rate, 100.0), 100.0), true).rmse < 0.35  # 1 deg/s of noise before
    True
    """
    rate: Floats = refusals(
        _native.kalman_track, as_floats(rate_dps, "rate_dps"), tuned.model, tuned.log10_ratio, _period_s(sample_rate_hz)
    )
    return rate


def _period_s(sample_rate_hz: float) -> float:
    if not (np.isfinite(sample_rate_hz) and sample_rate_hz > 0):
        raise LogError(f"sample_rate_hz = {sample_rate_hz:g} (must be finite and > 0 Hz)")
    return 1.0 / sample_rate_hz


def _records(values: Any, name: str) -> list[Floats]:
    """Return one record or several as a list of arrays."""
    if isinstance(values, np.ndarray) and values.ndim == 2:
        return [as_floats(row, name) for row in values]
    if isinstance(values, (list, tuple)) and len(values) > 0 and np.ndim(values[0]) == 1:
        return [as_floats(record, name) for record in values]
    return [as_floats(values, name)]
