"""What a gyro does at rest: white noise density and rate random walk, in whatever unit the datasheet has."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self


class _ByName:
    """What refuses a figure that there is not before Python does; a class of its own, so that help shows the figures."""

    def __new__(cls, *arguments: Any, **figures: Any) -> Self:
        known = [name for name in getattr(cls, "__dataclass_fields__", ()) if not name.startswith("_")]
        if arguments or not figures.keys() <= set(known):
            from stillrate.errors import ConfigError, nearest

            if arguments:
                raise ConfigError(f"{cls.__name__} takes its figures by name: {known[0]}, or see from_datasheet")
            unknown = next(name for name in figures if name not in known)
            raise ConfigError(f"{cls.__name__} has no figure {unknown!r}{nearest(unknown, known)}")
        return super().__new__(cls)


@dataclass(frozen=True, kw_only=True)
class GyroNoise(_ByName):
    """White noise density and rate random walk of a gyro.

    Parameters
    ----------
    density_dps_sqrt_hz : float
        Two-sided density N in deg/s/sqrt(Hz), the same number as the angle random walk in deg/sqrt(s): white samples
        at rate f have the standard deviation ``N * sqrt(f)``.
    rate_random_walk_dps_sqrt_s : float, optional
        Rate random walk K in deg/s/sqrt(s); default a thousandth of the density.
    bias_sigma_dps : float, optional
        Standard deviation in deg/s of a bias instability as a Gauss-Markov process; with `bias_time_s` it is folded into the
        walk: K^2 grows by 2 sigma^2 / tau.
    bias_time_s : float, optional
        Its correlation time tau in s.

    Examples
    --------
    >>> round(GyroNoise.from_datasheet(angle_random_walk_deg_sqrt_h=0.9).density_dps_sqrt_hz, 6)
    0.015
    """

    density_dps_sqrt_hz: float
    rate_random_walk_dps_sqrt_s: float | None = None
    bias_sigma_dps: float | None = None
    bias_time_s: float | None = None

    def __post_init__(self) -> None:
        from stillrate import _native
        from stillrate.errors import ConfigError

        def check(name: str, value: float, allow_zero: bool, unit: str) -> None:
            if bounds := _native.setting_range("ms-imm-ikf", f"noise.{name}"):
                low, high, words, unit = bounds
                if not low <= value <= high:
                    raise ConfigError(f"{name} = {value:g} (must be {words} {unit})")
            elif not (math.isfinite(value) and (value > 0 or (allow_zero and value == 0))):
                allowed = ">= 0" if allow_zero else "> 0"
                raise ConfigError(f"{name} = {value:g} (must be finite and {allowed} {unit})")

        check("density_dps_sqrt_hz", self.density_dps_sqrt_hz, False, "deg/s/sqrt(Hz)")
        walk = self.rate_random_walk_dps_sqrt_s
        if walk is None:
            walk = 1e-3 * self.density_dps_sqrt_hz
        check("rate_random_walk_dps_sqrt_s", walk, True, "deg/s/sqrt(s)")
        if (self.bias_sigma_dps is None) != (self.bias_time_s is None):
            raise ConfigError("bias_sigma_dps and bias_time_s must be given together")
        if self.bias_sigma_dps is not None and self.bias_time_s is not None:
            check("bias_sigma_dps", self.bias_sigma_dps, True, "deg/s")
            check("bias_time_s", self.bias_time_s, False, "s")
            walk = math.sqrt(walk**2 + 2.0 * self.bias_sigma_dps**2 / self.bias_time_s)
            object.__setattr__(self, "bias_sigma_dps", None)
            object.__setattr__(self, "bias_time_s", None)
        object.__setattr__(self, "rate_random_walk_dps_sqrt_s", walk)

    @classmethod
    def from_datasheet(
        cls,
        *,
        angle_random_walk_deg_sqrt_h: float | None = None,
        density_one_sided_dps_sqrt_hz: float | None = None,
        density_two_sided_dps_sqrt_hz: float | None = None,
        standard_deviation_dps: float | None = None,
        lsb_dps: float | None = None,
        sample_rate_hz: float | None = None,
        rate_random_walk_dps_sqrt_s: float | None = None,
        bias_sigma_dps: float | None = None,
        bias_time_s: float | None = None,
    ) -> GyroNoise:
        """Build from exactly one of the datasheet's noise figures.

        Parameters
        ----------
        angle_random_walk_deg_sqrt_h : float
            Angle random walk in deg/sqrt(h).
        density_one_sided_dps_sqrt_hz : float
            One-sided noise density in deg/s/sqrt(Hz), which MEMS datasheets nearly always mean.
        density_two_sided_dps_sqrt_hz : float
            Two-sided noise density in deg/s/sqrt(Hz), as everywhere in this library.
        standard_deviation_dps : float
            Standard deviation of samples at rest in deg/s; needs `sample_rate_hz`.
        lsb_dps : float
            Resolution in deg/s of a sensor with no other noise; needs `sample_rate_hz`.
        sample_rate_hz : float
            Sample rate in Hz that the two before are for.
        rate_random_walk_dps_sqrt_s, bias_sigma_dps, bias_time_s : float, optional
            As in the class.

        Raises
        ------
        ConfigError
            If none or several of the noise figures are given, or one is out of range.
        """
        from stillrate.errors import ConfigError

        def rate() -> float:
            if sample_rate_hz is None or not sample_rate_hz > 0:
                raise ConfigError(f"sample_rate_hz = {sample_rate_hz} (must be finite and > 0 Hz)")
            return sample_rate_hz

        found: list[float] = []
        if angle_random_walk_deg_sqrt_h is not None:
            found.append(angle_random_walk_deg_sqrt_h / 60.0)
        if density_one_sided_dps_sqrt_hz is not None:
            found.append(density_one_sided_dps_sqrt_hz / math.sqrt(2.0))
        if density_two_sided_dps_sqrt_hz is not None:
            found.append(density_two_sided_dps_sqrt_hz)
        if standard_deviation_dps is not None:
            found.append(standard_deviation_dps / math.sqrt(rate()))
        if lsb_dps is not None:
            found.append(lsb_dps / math.sqrt(12.0 * rate()))
        if len(found) != 1:
            raise ConfigError(f"{len(found)} noise figures given (must be exactly one)")
        return cls(
            density_dps_sqrt_hz=found[0],
            rate_random_walk_dps_sqrt_s=rate_random_walk_dps_sqrt_s,
            bias_sigma_dps=bias_sigma_dps,
            bias_time_s=bias_time_s,
        )

    @classmethod
    def from_log(cls, z: Any, *, sample_rate_hz: float) -> GyroNoise:
        """Measure the noise in a log; with several channels, the largest figures of those that were at rest.

        See `noise_from_log` for what was measured, where, whether motion dominates, and what is refused.

        Examples
        --------
        >>> from stillrate import simulate
        >>> noise = GyroNoise.from_log(simulate.static(50.0, 1).measured_dps, sample_rate_hz=50.0)
        >>> bool(abs(noise.density_dps_sqrt_hz / 0.0151 - 1) < 0.1)
        True
        """
        return _as_a_filter_takes_them(*_measure(z, sample_rate_hz)[1])


@dataclass(frozen=True)
class NoiseFromLog:
    """Noise figures measured in one channel of a log.

    Attributes
    ----------
    density_dps_sqrt_hz, rate_random_walk_dps_sqrt_s : float
        White density N and rate random walk K.
    lsb_dps : float
        Quantisation step seen in the values; 0 if none.
    quiet : slice
        Samples over which they were measured.
    moving_fraction : float
        Part of the log in which the rate scatters or wanders more than noise does.
    motion_dominated : bool
        Whether more than half of the log moves, or none of it is at rest.
    reason : str
        Where the figures came from, in words.

    Examples
    --------
    In a log that never rests the density is an upper bound: a filter built on it smooths too much rather than too little.

    >>> from stillrate import simulate
    >>> resting = noise_from_log(simulate.static(50.0, 1).measured_dps, 50.0)[0]
    >>> moving = noise_from_log(simulate.chirp(50.0, 1).measured_dps, 50.0)[0]
    >>> resting.at_rest, moving.at_rest, resting.constant
    (True, False, False)
    >>> moving.gyro.density_dps_sqrt_hz > resting.gyro.density_dps_sqrt_hz
    True
    """

    density_dps_sqrt_hz: float
    rate_random_walk_dps_sqrt_s: float
    lsb_dps: float
    quiet: slice
    moving_fraction: float
    motion_dominated: bool
    reason: str

    @property
    def gyro(self) -> GyroNoise:
        """The two figures as a filter takes them: a channel that never changes gets the least density that is allowed."""
        return _as_a_filter_takes_them(self.density_dps_sqrt_hz, self.rate_random_walk_dps_sqrt_s)

    @property
    def at_rest(self) -> bool:
        """Whether the figures come from a stretch at rest; otherwise they are an upper bound."""
        return not self.reason.startswith("motion dominates")

    @property
    def constant(self) -> bool:
        """Whether all samples are equal, as those of a dead axis: there was no noise to measure."""
        return self.reason.startswith("all samples are equal")


def noise_from_log(z: Any, sample_rate_hz: float) -> list[NoiseFromLog]:
    """Measure the noise of every channel of a log, at rest or not.

    Parameters
    ----------
    z : array_like, shape (n,) or (n, channels)
        Samples in deg/s; NaN, infinite or masked ones are left out.
    sample_rate_hz : float
        Sample rate in Hz.

    Returns
    -------
    list of NoiseFromLog
        One a channel.

    Raises
    ------
    LogError
        If a channel holds fewer than 8 usable samples.
    ConfigError
        If the sample rate is out of range.

    Examples
    --------
    >>> from stillrate import simulate
    >>> found = noise_from_log(simulate.chirp(50.0, 1).measured_dps, 50.0)
    >>> found[0].motion_dominated
    True
    """
    return [
        NoiseFromLog(**{**figures, "quiet": slice(*figures["quiet"])}) for figures in _measure(z, sample_rate_hz)[0]
    ]


def _as_a_filter_takes_them(density: float, walk: float) -> GyroNoise:
    from stillrate import _native

    least = _native.setting_range("ms-imm-ikf", "noise.density_dps_sqrt_hz")
    return GyroNoise(
        density_dps_sqrt_hz=density if least is None else max(density, least[0]), rate_random_walk_dps_sqrt_s=walk
    )


def _measure(z: Any, sample_rate_hz: float) -> tuple[list[dict[str, Any]], tuple[float, float]]:
    from stillrate import _native
    from stillrate.arrays import as_column, as_samples

    samples = as_samples(z)
    columns = [samples] if samples.ndim == 1 else list(samples.T)
    figures, shared = _native.noise_from_log([as_column(column) for column in columns], sample_rate_hz)
    return figures, shared
