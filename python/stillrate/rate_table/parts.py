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
    """

    name: str
    held_out_dps: float
    residual_dps: float
    steepest_slope: float
    refused: str | None


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """The points behind a model and the candidates it was chosen from. All arrays have shape (points,), in deg/s."""

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
        corrected over raw: above 1 the correction does harm.
    out_of_range : float
        Share of samples outside the calibrated range, where the edge value was held.
    held_out : bool
        Whether the figures come from rates that were left out of the fit.
    """

    raw_dps: float
    corrected_dps: float
    ratio: float
    out_of_range: float
    held_out: bool
