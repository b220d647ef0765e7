"""A log in memory: time stamps, rates, what else the file held, and how the file was laid out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.errors import LogError

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Timing:
    """What the time stamps say; nothing is repaired.

    Attributes
    ----------
    regular : bool
        Every step is within 2 % of nominal.
    gaps, repeats, backward, missing : tuple of int
        Indices of samples that come after a gap (more than 1.5 periods), have the stamp of the sample before, an
        earlier one, or none.
    longest_step_s, median_step_s : float
        Steps between stamps in s.
    """

    regular: bool
    gaps: tuple[int, ...]
    repeats: tuple[int, ...]
    backward: tuple[int, ...]
    missing: tuple[int, ...]
    longest_step_s: float
    median_step_s: float

    def remarks(self) -> list[str]:
        """Return one short sentence for each kind of irregularity."""
        found = []
        if self.gaps:
            found.append(f"{len(self.gaps)} gap{_s(self.gaps)}, the longest {self.longest_step_s:.3g} s")
        for name, where in (
            ("repeated", self.repeats),
            ("backward", self.backward),
            ("missing", self.missing),
        ):
            if where:
                found.append(f"{len(where)} {name} time stamp{_s(where)}, the first at sample {where[0]}")
        if not found and not self.regular:
            found.append("time stamps jitter by more than 2 %")
        return found


def _s(items: tuple[int, ...]) -> str:
    return "" if len(items) == 1 else "s"


@dataclass(frozen=True)
class Layout:
    """How the columns stood in the file, so that they can be written back.

    Attributes
    ----------
    order : tuple of str
        All column names in file order.
    time : str, optional
        Name of the time column.
    stamps : ndarray, optional
        The time column as it was.
    factors : dict of str to float
        deg/s per unit of each channel's column.
    original : dict of str to ndarray
        The channels' columns as they were.
    extras : dict
        What is in the file besides columns.
    style : dict
        Delimiter, decimal comma and the like, for text.
    """

    order: tuple[str, ...] = ()
    time: str | None = None
    stamps: npt.NDArray[Any] | None = None
    factors: Mapping[str, float] = field(default_factory=dict)
    original: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    extras: Mapping[str, Any] = field(default_factory=dict)
    style: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Log:
    """A recording.

    Parameters
    ----------
    t_s : ndarray, shape (n,)
        Time in s from the first sample; gaps, repeats and jumps back are kept.
    rate_dps : ndarray, shape (n, channels)
        Rates in deg/s; NaN where missing.
    channels : tuple of str
        Their names, as the columns of the file.
    sample_rate_hz : float, optional
        Nominal sample rate; estimated from `t_s` when left out.
    columns : dict of str to ndarray
        The other columns.
    meta : dict
        Where it comes from: format, units, remarks, and how it was filtered.
    layout : Layout
        How the columns stood in the file, for who writes them back.

    Attributes
    ----------
    timing : Timing
        What the time stamps say.

    Raises
    ------
    LogError
        If shapes do not fit or no sample rate can be had.

    Examples
    --------
    >>> import numpy as np
    >>> log = Log(t_s=np.arange(100) / 50.0, rate_dps=np.zeros((100, 1)), channels=("gz_dps",))
    >>> round(log.sample_rate_hz, 6)
    50.0
    """

    t_s: Floats
    rate_dps: Floats
    channels: tuple[str, ...]
    sample_rate_hz: float = float("nan")
    columns: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    meta: Mapping[str, Any] = field(default_factory=dict)
    layout: Layout = field(default_factory=Layout, repr=False)
    timing: Timing = field(init=False)

    def __post_init__(self) -> None:
        t_s = np.ascontiguousarray(self.t_s, dtype=np.float64)
        rates = np.asarray(self.rate_dps, dtype=np.float64)
        if rates.ndim == 1:
            rates = rates[:, np.newaxis]
        if rates.ndim != 2 or t_s.shape != rates.shape[:1] or len(self.channels) != rates.shape[1]:
            raise LogError(
                f"t_s {t_s.shape}, rate_dps {rates.shape} and {len(self.channels)} channel names do not fit"
                " (must be (n,), (n, channels) and one name a channel)"
            )
        found = _native.analyse_timebase(t_s)
        rate = float(self.sample_rate_hz)
        if not (np.isfinite(rate) and rate > 0):
            # Nine digits: what is beyond them is the rounding of the stamps.
            rate = float(f"{found['sample_rate_hz']:.9g}")
        if not (np.isfinite(rate) and rate > 0):
            raise LogError("the time stamps give no sample rate: say it (--rate HZ)")
        timing = Timing(
            regular=bool(found["regular"]),
            longest_step_s=float(found["longest_step_s"]),
            median_step_s=float(found["median_step_s"]),
            **{name: tuple(found[name]) for name in ("gaps", "repeats", "backward", "missing")},
        )
        for name, value in (("t_s", t_s), ("rate_dps", rates), ("sample_rate_hz", rate), ("timing", timing)):
            object.__setattr__(self, name, value)

    def steps_s(self) -> Floats | None:
        """Return each sample's time step in s, shape (n,), for a filter; None where the rate is regular.

        Examples
        --------
        >>> log = Log(t_s=[0.0, 0.02, 0.04, 0.10, 0.12], rate_dps=np.zeros(5), channels=("gz_dps",))
        >>> log.steps_s().round(3).tolist()
        [0.02, 0.02, 0.02, 0.06, 0.02]
        >>> Log(t_s=[0.0, 0.02, 0.04], rate_dps=np.zeros(3), channels=("gz_dps",)).steps_s() is None
        True
        """
        if self.timing.regular:
            return None
        return _native.time_steps(self.t_s, self.sample_rate_hz)

    def __len__(self) -> int:
        return len(self.t_s)

    def __repr__(self) -> str:
        span = f"{len(self)} samples of {', '.join(self.channels)} at {self.sample_rate_hz:.6g} Hz"
        remarks = "; ".join(self.timing.remarks())
        return f"Log({span}{': ' + remarks if remarks else ''})"
