"""What a filter hands back besides the filtered samples."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntFlag
from typing import Any

import numpy as np
import numpy.typing as npt

_SHORT_ARRAY = 6
_SHORT_WORD = 60


def brief(thing: Any) -> str:
    """Return a frozen record in one line: short values as they are, arrays by type and shape.

    Examples
    --------
    >>> from stillrate.simulate import Reading
    >>> brief(Reading(np.zeros(50), np.zeros(2), np.zeros((4, 3))))
    'Reading(measured_dps=<float64 (50,)>, truth_dps=[0. 0.], drift_dps=<float64 (4, 3)>)'
    """
    words = ", ".join(f"{item.name}={_word(getattr(thing, item.name))}" for item in fields(thing) if item.repr)
    return f"{type(thing).__name__}({words})"


def _word(value: Any) -> str:
    if isinstance(value, np.ndarray):
        if value.ndim == 1 and value.size <= _SHORT_ARRAY:
            return np.array2string(value, precision=4, separator=" ")
        return f"<{value.dtype} {value.shape}>"
    text = repr(value)
    if len(text) <= _SHORT_WORD:
        return text
    if isinstance(value, (tuple, list, dict)):
        return f"<{type(value).__name__} of {len(value)}>"
    return text if hasattr(value, "__dataclass_fields__") else f"{text[:_SHORT_WORD]}..."


class Flags(IntFlag):
    """What happened to a sample.

    Attributes
    ----------
    MISSING
        NaN, infinite or masked: the filter coasted.
    NO_DATA_YET
        Nothing usable has come in so far: the output is a finite placeholder.
    BAD_TIME
        The time step was zero, negative or not finite: the sample was not used.
    RESTARTED
        The gap before was so long that the filter started anew.
    SATURATED
        At the sensor's rail: used as a one-sided bound.
    OUTLIER
        So far out that the outlier model took most of it.
    DIVERGED
        The filter lost its own state and started anew.
    OUT_OF_RANGE
        Beyond any physical rate: treated as missing.
    CHANGE
        A change detector fired.

    Examples
    --------
    >>> Flags(5)
    <Flags.MISSING|BAD_TIME: 5>
    >>> Flags.MISSING in Flags(5)
    True
    """

    NONE = 0
    MISSING = 1
    NO_DATA_YET = 2
    BAD_TIME = 4
    RESTARTED = 8
    SATURATED = 16
    OUTLIER = 32
    DIVERGED = 64
    OUT_OF_RANGE = 128
    CHANGE = 256


@dataclass(frozen=True)
class Estimate:
    """The last estimate of one channel.

    Attributes
    ----------
    rate : float
        Filtered rate, in the unit of the samples.
    acceleration : float
        Its time derivative, per second; 0 for methods that do not estimate it.
    variance : float
        Variance of the rate; 0 for methods that have no opinion.
    probability : tuple of float
        Posterior probability of each model.
    frequency_hz : float
        Manoeuvre frequency; NaN for methods without one.
    flags : Flags
        What happened to the sample.

    Examples
    --------
    >>> import stillrate as sr
    >>> flt = sr.Filter(sr.Pt1(sample_rate_hz=50.0))
    >>> flt.update(0.12)
    0.12
    >>> flt.estimate.rate, flt.estimate.flags
    (0.12, <Flags.NONE: 0>)
    """

    rate: float
    acceleration: float
    variance: float
    probability: tuple[float, ...]
    frequency_hz: float
    flags: Flags

    def __post_init__(self) -> None:
        object.__setattr__(self, "flags", Flags(self.flags))


@dataclass(frozen=True)
class Trace:
    """A run seen from inside: arrays of shape (n,) or (n, channels); by model (n, models) or (n, models, channels).

    Attributes
    ----------
    rate, acceleration, variance, frequency_hz : ndarray
        As in `Estimate`, for every sample.
    flags : ndarray of uint32
        Bits of `Flags`.
    probability : ndarray
        Posterior probability by model.
    innovation, innovation_variance, fading, alpha, model_rate : ndarray
        What each model did: measurement minus prediction (NaN when missing), its variance, the fading factor applied
        (1: none), the reciprocal of the manoeuvre time constant in 1/s, and the model's own rate.

    Examples
    --------
    >>> import stillrate as sr
    >>> trace = sr.Filter(sr.Pt1(sample_rate_hz=50.0)).run([0.1, float("nan"), 0.1], trace=True)
    >>> trace.rate.tolist(), trace.flags.tolist()
    ([0.1, 0.1, 0.1], [0, 1, 0])
    """

    rate: npt.NDArray[Any]
    acceleration: npt.NDArray[Any]
    variance: npt.NDArray[Any]
    probability: npt.NDArray[Any]
    frequency_hz: npt.NDArray[Any]
    flags: npt.NDArray[np.uint32]
    innovation: npt.NDArray[Any]
    innovation_variance: npt.NDArray[Any]
    fading: npt.NDArray[Any]
    alpha: npt.NDArray[Any]
    model_rate: npt.NDArray[Any]

    @classmethod
    def from_native(cls, dtype: str, **arrays: npt.NDArray[Any]) -> Trace:
        """Build from the compiled half, in the precision of the filter (an exact conversion).

        Examples
        --------
        >>> names = [item.name for item in fields(Trace)]
        >>> arrays = {name: np.zeros((2, 1), np.uint32 if name == "flags" else np.float64) for name in names}
        >>> trace = Trace.from_native("float32", **arrays)
        >>> trace.rate.dtype, trace.flags.dtype
        (dtype('float32'), dtype('uint32'))
        """
        return cls(**{name: a if name == "flags" else a.astype(dtype, copy=False) for name, a in arrays.items()})

    def __repr__(self) -> str:
        names = ", ".join(f.name for f in fields(self))
        return f"Trace(shape={self.rate.shape}, models={self.probability.shape[1]}: {names})"
