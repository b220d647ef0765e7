"""Where a gimballed head stands, how it is built and what to estimate; names of the coefficients."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from stillrate import _native

Floats = npt.NDArray[np.float64]

NAMES: tuple[str, ...] = tuple(_native.gimbal_names())
"""Names of all 41 coefficients in order; the last eight are optional."""

# The coefficients of the basic model; what follows is optional.
_BASIC = 33


@dataclass(frozen=True, kw_only=True)
class Head:
    """Where a head stands, how it is built, and what to estimate.

    Attributes
    ----------
    gravity_m_s2, latitude_rad, earth_rate_rad_s : float
        The place.
    gauge : {"accelerometer", "gyro", "none"}
        Which three mounting angles are zero by convention: a common turn of all axes cannot be seen.
    torquer, quadratic, latency, latitude : bool
        Estimate torquer scale errors (3), quadratic accelerometer terms (3), the latency of the accelerometers (1), the
        error of the latitude (1).
    scale : tuple of float, optional
        Prior standard deviations in the order of `NAMES` (the first ones, or all).
    prior : tuple of float, optional
        Prior mean.
    angle_random_walk_deg_sqrt_h : float
        Random walk the filters allow for.
    robust : bool
        Find spikes by a Theil-Sen line in every window.
    reference : {"model", "commanded"}
        What is subtracted inside the windows: the model output (recommended) or the commanded specific force.
    cut_off_rad : float
        Leave out epochs with an input axis nearer to the horizontal than this (loses information; off).
    second_order : float
        Weight of the second-order terms in the on-line filter.
    half_window : int, optional
        Samples to either side of an epoch, 0 for single samples.
    refined : bool
        Fourth-order step of the model.
    single : bool
        Square root in single precision.
    every : int
        History every so many epochs.
    gyro_triads, accelerometer_triads : tuple
        Platform axis (0, 1, 2) of each instrument's input, output, spin (input, pendulous, output) axis.

    Examples
    --------
    >>> import stillrate as sr
    >>> head = sr.gimbal.Head(latitude_rad=0.84, latency=True)
    >>> head.settings()["latency"], "scale" in head.settings()  # what is not set keeps its default
    (True, False)
    >>> len(sr.gimbal.bound(sr.gimbal.trajectory(), head=head).names)  # 30, and the latency
    31
    """

    gravity_m_s2: float = 9.8
    latitude_rad: float = 0.6981317007977318
    earth_rate_rad_s: float = 7.292115e-5
    gauge: Literal["accelerometer", "gyro", "none"] = "accelerometer"
    torquer: bool = False
    quadratic: bool = False
    latency: bool = False
    latitude: bool = False
    scale: tuple[float, ...] | None = None
    prior: tuple[float, ...] | None = None
    angle_random_walk_deg_sqrt_h: float = 0.0
    robust: bool = True
    reference: Literal["model", "commanded"] = "model"
    cut_off_rad: float = 0.0
    second_order: float = 5.0
    half_window: int | None = None
    refined: bool = True
    single: bool = False
    every: int = 4
    gyro_triads: tuple[tuple[int, int, int], ...] | None = None
    accelerometer_triads: tuple[tuple[int, int, int], ...] | None = None

    def settings(self) -> dict[str, Any]:
        """Return what is set, for the compiled half."""
        found = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        return {
            name: [list(row) if isinstance(row, tuple) else row for row in value] if isinstance(value, tuple) else value
            for name, value in found.items()
            if value is not None
        }


def rows(values: npt.ArrayLike) -> Floats:
    """Return a table of numbers; what is masked becomes NaN."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2:
        raise ValueError(f"expected an array of shape (n, 3), not {array.shape}")
    return array


def shown(head: Head) -> list[int]:
    """Return the places in `NAMES` that a result lists."""
    optional = [head.torquer] * 3 + [head.quadratic] * 3 + [head.latency, head.latitude]
    return [*range(_BASIC), *(_BASIC + i for i, on in enumerate(optional) if on)]
