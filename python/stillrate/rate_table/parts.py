"""What a calibration is made of: its points, the candidates and their scores; arrays and refusals of native code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate.errors import LogError

Floats = npt.NDArray[np.float64]


def as_floats(values: npt.ArrayLike, name: str) -> Floats:
    """Return one-dimensional contiguous double precision; masked samples become NaN."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise LogError(f"{name} has {array.ndim} dimensions (must have 1)")
    return array


def refusals(call: Any, *arguments: Any) -> Any:
    """Call native code and turn its refusal into LogError."""
    try:
        return call(*arguments)
    except ValueError as error:
        raise LogError(str(error)) from None


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """How one class of curves did.

    Attributes
    ----------
    name : str
        "offset", "line", "quadratic", "cubic" or a line with a small network.
    held_out_dps : float
        RMS error of predicting each rate from the others, deg/s; NaN if it could not be fitted.
    residual_dps : float
        RMS error on the points it was fitted to, deg/s.
    steepest_slope : float
        Largest magnitude of the error's slope in the rate.
    refused : str or None
        Why it was not allowed to win.

    Examples
    --------
    >>> from stillrate.rate_table import fit_points
    >>> model = fit_points([-3.0, 0.0, 3.0], [0.01, 0.02, 0.03], [0.001] * 3)
    >>> {found.name: found.refused for found in model.calibration.candidates}["cubic"]
    '3 distinct rates (must be at least 5)'
    """

    name: str
    held_out_dps: float
    residual_dps: float
    steepest_slope: float
    refused: str | None


def told(found: Candidate, chosen: str) -> list[str]:
    """Return a row of a table: the candidate's name, its figures, and why it is not the `chosen` one."""
    figures = (found.held_out_dps, found.residual_dps, found.steepest_slope)
    note = found.refused or ("chosen" if found.name == chosen else "")
    return [found.name, *(f"{v:.4g}" if np.isfinite(v) else "-" for v in figures), note]


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """The points behind a model and the candidates it was chosen from.

    Attributes
    ----------
    rate_dps, error_dps, standard_error_dps, residual_dps : ndarray, shape (points,)
        True rate, mean error, its standard error, and what the model leaves of the error.
    temperature_c : ndarray, shape (points,)
        Mean temperature; NaN without one.
    samples : ndarray, shape (points,)
        Samples in each mean.
    candidates : tuple of Candidate
        All curves, simplest first.

    Examples
    --------
    >>> from stillrate.rate_table import fit
    >>> table = np.repeat([-4.0, 0.0, 4.0], 300)
    >>> points = fit(table + 0.02 + 0.01 * np.sin(np.arange(900) * 2.4), table).calibration
    >>> points.rate_dps.tolist(), points.samples.tolist()
    ([-4.0, 0.0, 4.0], [300.0, 300.0, 300.0])
    >>> bool(np.abs(points.error_dps - 0.02).max() < 1e-3)
    True
    """

    rate_dps: Floats
    temperature_c: Floats
    error_dps: Floats
    standard_error_dps: Floats
    residual_dps: Floats
    samples: Floats
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True, kw_only=True)
class Score:
    """RMS error before and after correction.

    Attributes
    ----------
    raw_dps, corrected_dps : float
        RMS of measured (corrected) less true rate, deg/s. For noisy samples both are dominated by the noise.
    ratio : float
        corrected over raw: above 1 the correction does harm; NaN where there was no error and none was added.
    out_of_range : float
        Share of samples outside the calibrated range, where the edge value was held.
    held_out : bool
        Whether the figures come from rates that were left out of the fit.

    Examples
    --------
    >>> from stillrate.rate_table import fit_points
    >>> model = fit_points([-3.0, 0.0, 3.0], [0.01, 0.02, 0.03], [0.001] * 3)
    >>> score = model.score([1.0, 5.0], [0.977, 4.97])  # 0.023 deg/s of error, then 0.03 beyond the calibrated range
    >>> round(score.raw_dps, 4), score.ratio < 0.1, score.out_of_range
    (0.0267, True, 0.5)
    """

    raw_dps: float
    corrected_dps: float
    ratio: float
    out_of_range: float
    held_out: bool
