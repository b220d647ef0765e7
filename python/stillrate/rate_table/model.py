"""The error model: kept in a file that a person can read, applied to rates, scored."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import LogError
from stillrate.rate_table.parts import Calibration, Floats, Score, as_floats, refusals

MAX_BYTES = 65_536
"""No model file is larger."""


@dataclass(frozen=True, kw_only=True)
class ErrorModel:
    """Error of a gyro over its rate (and temperature), with the range it was calibrated on.

    Outside the calibrated range the value at the edge is held; `outside` says where.

    Attributes
    ----------
    kind : str
        Which class of curves it is.
    low_dps, high_dps : float
        Calibrated range of the rate, deg/s.
    temperature_range_c : tuple of float or None
        Calibrated range of the temperature in °C, if it is an input.
    held_out_dps : float
        RMS error at rates left out of the fit, deg/s.
    uncorrected_dps : float
        RMS error, deg/s, that subtracting nothing leaves at the same points.
    rates : int
        Distinct rates behind the fit.
    sample_rate_hz : float or None
        Sample rate of the calibration log, Hz.
    slope_limit : float
        Steepest slope that was allowed, deg/s per deg/s.
    calibration : Calibration or None
        Points and candidates; not kept in the file.

    Examples
    --------
    >>> import numpy as np
    >>> from stillrate.rate_table import fit
    >>> true = np.repeat(np.arange(-6.0, 7.0), 400)
    >>> rate = 1.002 * true + 0.03 + 0.01 * np.sin(np.arange(true.size) * 2.4)
    >>> model = fit(rate, true)
    >>> bool(abs(model.predict([5.0])[0] - 0.04) < 1e-3), bool(abs(model.correct([5.04])[0] - 5.0) < 1e-3)
    (True, True)
    >>> model.outside([5.0, 9.0]).tolist(), model.slope([9.0]).tolist()
    ([False, True], [0.0])
    >>> model.check()  # no steeper than a sensor's error
    >>> model.steepest_slope() < 0.01, model.score().ratio < 0.1  # of the error without correction, at rates left out
    (True, True)
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     model.save(Path(folder, "gyro.json"))
    ...     ErrorModel.load(Path(folder, "gyro.json")) == model
    True
    """

    kind: str
    low_dps: float
    high_dps: float
    temperature_range_c: tuple[float, float] | None
    held_out_dps: float
    uncorrected_dps: float
    rates: int
    sample_rate_hz: float | None
    slope_limit: float
    native: Any = field(repr=False, compare=False)
    calibration: Calibration | None = field(default=None, repr=False, compare=False)

    def predict(self, rate_dps: npt.ArrayLike, temperature_c: npt.ArrayLike | None = None) -> Floats:
        """Return the error at true rates.

        Parameters
        ----------
        rate_dps : array_like, shape (n,)
            True rates, deg/s.
        temperature_c : array_like, shape (n,), optional
            Needed if the model was calibrated with it.

        Returns
        -------
        ndarray, shape (n,)
            Error in deg/s: measured = true + error + noise.
        """
        return self._map("error", rate_dps, temperature_c)[0]

    def correct(self, rate_dps: npt.ArrayLike, temperature_c: npt.ArrayLike | None = None) -> Floats:
        """Return measured rates less their error; NaN stays NaN.

        Filter first: the error is best taken at the filtered rate.
        """
        return self._map("correct", rate_dps, temperature_c)[0]

    def outside(self, rate_dps: npt.ArrayLike, temperature_c: npt.ArrayLike | None = None) -> npt.NDArray[np.bool_]:
        """Return where rates lie outside the calibrated range."""
        return self._map("error", rate_dps, temperature_c)[1]

    def slope(self, rate_dps: npt.ArrayLike, temperature_c: npt.ArrayLike | None = None) -> Floats:
        """Return the slope of the error in the rate; 0 outside the calibrated range."""
        return self._map("slope", rate_dps, temperature_c)[0]

    def steepest_slope(self) -> float:
        """Return the largest magnitude of the slope in the calibrated range."""
        return float(self.native.steepest())

    def check(self, slope_limit: float | None = None) -> None:
        """Raise LogError if the curve is too steep to be a sensor's: it then draws the rates it was trained at."""
        refusals(self.native.guard, self.slope_limit if slope_limit is None else slope_limit)

    def score(
        self,
        rate_dps: npt.ArrayLike | None = None,
        true_dps: npt.ArrayLike | None = None,
        temperature_c: npt.ArrayLike | None = None,
    ) -> Score:
        """Return how much the correction helps on a log, or on the left-out rates of the fit if no log is given."""
        if rate_dps is None or true_dps is None:
            return _score(self.uncorrected_dps, self.held_out_dps, 0.0, held_out=True)
        measured, true = as_floats(rate_dps, "rate_dps"), as_floats(true_dps, "true_dps")
        if measured.size != true.size:
            raise LogError(f"{true.size} true rates for {measured.size} measured ones (must be as many)")
        temperature = None if temperature_c is None else as_floats(temperature_c, "temperature_c")
        return _score(*refusals(self.native.score, measured, true, temperature), held_out=False)

    def save(self, path: str | Path, *, force: bool = False) -> None:
        """Write the model as JSON with version and checksum.

        Raises
        ------
        FileExistsError
            If the file exists and `force` is not set.
        """
        from stillrate.io.safely import atomic

        with atomic(Path(path), force=force) as temporary:
            temporary.write_text(self.native.to_text(), encoding="utf-8")

    @classmethod
    def load(cls, path: str | Path) -> ErrorModel:
        """Read a model file; refused unless version, counts, ranges, slope and checksum fit.

        Raises
        ------
        LogError
            With the reason.
        """
        path = Path(path)
        if path.stat().st_size > MAX_BYTES:
            raise LogError(f"{path}: {path.stat().st_size} bytes (a model has at most {MAX_BYTES})")
        try:
            return wrap(_native.RateTableModel.from_text(path.read_text(encoding="utf-8")))
        except ValueError as error:
            raise LogError(f"{path}: {error}") from None

    def _map(
        self, what: str, rate_dps: npt.ArrayLike, temperature_c: npt.ArrayLike | None
    ) -> tuple[Floats, npt.NDArray[np.bool_]]:
        rates = as_floats(np.atleast_1d(rate_dps), "rate_dps")
        temperature = None
        if temperature_c is not None:
            temperature = as_floats(np.broadcast_to(temperature_c, rates.shape), "temperature_c")
        pair: tuple[Floats, npt.NDArray[np.bool_]] = refusals(getattr(self.native, what), rates, temperature)
        return pair


def _score(raw: float, corrected: float, outside: float, *, held_out: bool) -> Score:
    nothing = np.inf if corrected > 0.0 else np.nan  # where there was no error to correct
    ratio = corrected / raw if raw > 0.0 else nothing
    return Score(raw_dps=raw, corrected_dps=corrected, ratio=ratio, out_of_range=outside, held_out=held_out)


def wrap(native: Any, calibration: Calibration | None = None) -> ErrorModel:
    """Return a compiled model as an `ErrorModel`."""
    facts = native.facts()
    low, high = facts["low"], facts["high"]
    return ErrorModel(
        kind=facts["kind"],
        low_dps=low[0],
        high_dps=high[0],
        temperature_range_c=(low[1], high[1]) if facts["needs_temperature"] else None,
        held_out_dps=facts["held_out_dps"],
        uncorrected_dps=facts["uncorrected_dps"],
        rates=facts["rates"],
        sample_rate_hz=facts["sample_rate_hz"],
        slope_limit=facts["slope_limit"],
        native=native,
        calibration=calibration,
    )
