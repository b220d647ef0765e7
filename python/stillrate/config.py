"""Configurations: one frozen class a method, checked when built, TOML in and out.

The fields left out are filled in by the method itself (the defaults live in one place, beside the numerics), so a
configuration always shows every setting that is in force.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Self

from stillrate import _native
from stillrate.errors import ConfigError
from stillrate.noise import GyroNoise

_NOISE_FIELDS = ("noise.density_dps_sqrt_hz", "noise.rate_random_walk_dps_sqrt_s")


@dataclass(frozen=True, kw_only=True)
class Config:
    """What all configurations share.

    Parameters
    ----------
    sample_rate_hz : float
        Nominal sample rate in Hz.
    noise : GyroNoise, optional
        The gyro's noise. Methods that do not use it ignore it.

    Raises
    ------
    ConfigError
        If a setting is out of range; the text names field, value, unit and range.
    """

    method: ClassVar[str] = ""

    sample_rate_hz: float
    noise: GyroNoise | None = None

    def __post_init__(self) -> None:
        if not self.method:
            raise TypeError("Config is what the methods share: build one of them, such as MsImmIkf(...)")
        resolved = _native.resolve(self.method, self.settings())
        if self.noise is None and all(name in resolved for name in _NOISE_FIELDS):
            density, walk = (float(resolved[name]) for name in _NOISE_FIELDS)
            object.__setattr__(self, "noise", GyroNoise(density_dps_sqrt_hz=density, rate_random_walk_dps_sqrt_s=walk))
        for name, value in resolved.items():
            if name not in _NOISE_FIELDS:
                object.__setattr__(self, name, tuple(value) if isinstance(value, list) else value)

    def settings(self) -> dict[str, float | str | list[float]]:
        """Return every setting by name, noise figures with the prefix ``noise.``; settings left open are left out."""
        found: dict[str, float | str | list[float]] = {}
        for item in dataclasses.fields(self):
            value = getattr(self, item.name)
            if item.name == "noise":
                if value is not None:
                    found[_NOISE_FIELDS[0]] = float(value.density_dps_sqrt_hz)
                    found[_NOISE_FIELDS[1]] = float(value.rate_random_walk_dps_sqrt_s)
            elif isinstance(value, str):
                found[item.name] = value
            elif isinstance(value, (tuple, list)):
                found[item.name] = [float(number) for number in value]
            elif value is not None:
                found[item.name] = float(value)
        return found

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some settings changed (the rest stays as it is in force)."""
        return dataclasses.replace(self, **changes)

    def to_toml(self, path: str | Path | None = None) -> str:
        """Write the configuration as TOML; with `path`, into a new file as well.

        Raises
        ------
        FileExistsError
            If the file exists.
        """
        lines = [f'method = "{self.method}"']
        noise: list[str] = []
        for name, value in self.settings().items():
            if name.startswith("noise."):
                noise.append(f"{name.removeprefix('noise.')} = {_toml(value)}")
            else:
                lines.append(f"{name} = {_toml(value)}")
        text = "\n".join([*lines, *(["", "[noise]", *noise] if noise else [])]) + "\n"
        if path is not None:
            with Path(path).open("x", encoding="utf-8") as file:
                file.write(text)
        return text


def _toml(value: float | str | list[float]) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list):
        return "[" + ", ".join(_toml(number) for number in value) + "]"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return repr(float(value))


@dataclass(frozen=True, kw_only=True)
class MsImmIkf(Config):
    """The recommended filter: an interacting multiple model bank with an on-line manoeuvre frequency.

    One random walk, a ladder of Singer models up to the sample rate, and double oscillators that share a frequency found
    on line. Only the sample rate and the noise must be given.

    Parameters
    ----------
    oscillators : sequence of float, optional
        Half-widths of the double oscillators in rad/s; default (1, 3, 10, 30); ``()`` is the light form, at half the cost.
    ladder_hz : sequence of float, optional
        Bandwidths of the Singer rungs in Hz; default 2, 8, 32, ... up to the first that reaches the sample rate.
    dwell_time_s, rest_dwell_time_s : float, optional
        Mean dwell time in a moving model and at rest, in s; default 20 and 100.
    frequency_memory_s, variance_memory_s : float, optional
        Memory of the manoeuvre frequency and of the prior variances, in s; default 5 and 1.
    derivative_cap : float, optional
        Cap on the acceleration that oscillators take over from other models; default 4; ``inf`` for none.
    moment_limit_hz : float, optional
        Rungs above this bandwidth stay out of the frequency's moments, in Hz; default 33; ``inf`` for none.
    refresh_s : float, optional
        Interval at which the oscillators follow the frequency, in s; default 0.02; 0 for every sample.
    bandwidth_hz : float, optional
        Known bandwidth of the motion in Hz: rungs above it are left out, but never the widest; default ``inf``.
    outlier_probability : float, optional
        Prior probability of an outlier, 0 (off, the default) to below 0.5.
    saturation_dps : float, optional
        Full scale of the sensor in deg/s: samples there count as one-sided bounds; default ``inf``.
    """

    method: ClassVar[str] = "ms-imm-ikf"
    oscillators: Sequence[float] | None = None
    ladder_hz: Sequence[float] | None = None
    dwell_time_s: float | None = None
    rest_dwell_time_s: float | None = None
    frequency_memory_s: float | None = None
    variance_memory_s: float | None = None
    derivative_cap: float | None = None
    moment_limit_hz: float | None = None
    refresh_s: float | None = None
    bandwidth_hz: float | None = None
    outlier_probability: float | None = None
    saturation_dps: float | None = None


@dataclass(frozen=True, kw_only=True)
class SingerKf(Config):
    """Singer Kalman filter: one manoeuvre model with a fixed time constant.

    Parameters
    ----------
    alpha_per_s : float, optional
        Reciprocal manoeuvre time constant in 1/s; default 0.01.
    accel_max_dps2 : float, optional
        Largest acceleration in deg/s^2; default 30.
    measurement_variance : float, optional
        Variance of a sample in (deg/s)^2; default that of the noise at the sample rate.
    initial_rate_variance, initial_acceleration_variance : float, optional
        Variances before the first sample, in (deg/s)^2 and (deg/s^2)^2; default the same, and 100.
    """

    method: ClassVar[str] = "singer-kf"
    alpha_per_s: float | None = None
    accel_max_dps2: float | None = None
    measurement_variance: float | None = None
    initial_rate_variance: float | None = None
    initial_acceleration_variance: float | None = None


@dataclass(frozen=True, kw_only=True)
class SingerImmKf(Config):
    """Two interacting Singer models, one for rest and one for motion.

    The defaults reproduce the published static figures. Pairs are (rest, motion).

    Parameters
    ----------
    alpha_per_s, accel_max_dps2 : pair of float, optional
        Reciprocal manoeuvre time constants in 1/s, default (.001, .01); largest accelerations in deg/s^2, default (1.5, 30).
    transition : four floats, optional
        Transition probabilities a sample, row by row; default (.95, .05, .05, .95).
    initial_probability : pair of float, optional
        Probabilities before the first sample; default (.5, .5).
    measurement_variance : pair of float, optional
        Variance of a sample in (deg/s)^2; default that of the noise at the sample rate.
    initial_rate_variance, initial_acceleration_variance : pair of float, optional
        Variances before the first sample, in (deg/s)^2 and (deg/s^2)^2; default the same, and (1, 100).
    """

    method: ClassVar[str] = "singer-imm-kf"
    alpha_per_s: Sequence[float] | None = None
    accel_max_dps2: Sequence[float] | None = None
    transition: Sequence[float] | None = None
    initial_probability: Sequence[float] | None = None
    measurement_variance: Sequence[float] | None = None
    initial_rate_variance: Sequence[float] | None = None
    initial_acceleration_variance: Sequence[float] | None = None


@dataclass(frozen=True, kw_only=True)
class MsImmIkfPaper(Config):
    """The published MS-IMM-IKF: two modified Singer models with alpha as a state, and a fading factor.

    Parameters
    ----------
    mode : str, optional
        Sets the defaults of the rest. ``"paper"`` (default) reproduces the published static figures; ``"printed"`` is the
        equations to the letter, which diverge by themselves and say so in the flags; ``"exact-jacobian"`` and
        ``"log-alpha"`` estimate alpha, or its logarithm, with the exact derivative.
    alpha_per_s, accel_max_dps2, transition, initial_probability, measurement_variance, initial_rate_variance, initial_acceleration_variance : optional
        As in `SingerImmKf`.
    initial_alpha_variance, alpha_noise_density : pair of float, optional
        Variance of the third state before the first sample, and density of its random walk.
    alpha_mixing : {"private", "shared"}, optional
        Whether alpha is mixed like any state.
    jacobian : {"printed", "exact"}, optional
        Whether F holds the derivative by alpha; ``"exact"`` needs ``alpha_mixing="shared"``.
    fading : {"none", "absolute", "signed"}, optional
        Whether the fading factor is max(1, abs(C)), as printed, or max(1, C).
    fading_source : {"measurement", "innovation", "windowed"}, optional
        What C compares with its expectation: the measurement (printed), the innovation, or its windowed square.
    fading_scale : float, optional
        Factor of that square; default sqrt(1/2) for the measurement, 1 for the others.
    fading_scope : {"rate-acceleration", "all"}, optional
        What the fading factor multiplies.
    fading_gate : {"always", "while-moving", "second-model-while-moving"}, optional
        When it acts.
    fading_memory, fading_softening : float, optional
        Forgetting factor and softening of the windowed form; default .95 and 1.5.
    static_stay_probability : float, optional
        Probability of staying while rest is declared; 0 keeps `transition`.
    static_alpha_per_s : float, optional
        Rest is declared while the mean alpha does not exceed this, in 1/s; default .0055.
    """

    method: ClassVar[str] = "ms-imm-ikf-paper"
    mode: str | None = None
    alpha_per_s: Sequence[float] | None = None
    accel_max_dps2: Sequence[float] | None = None
    transition: Sequence[float] | None = None
    initial_probability: Sequence[float] | None = None
    measurement_variance: Sequence[float] | None = None
    initial_rate_variance: Sequence[float] | None = None
    initial_acceleration_variance: Sequence[float] | None = None
    initial_alpha_variance: Sequence[float] | None = None
    alpha_noise_density: Sequence[float] | None = None
    alpha_mixing: str | None = None
    jacobian: str | None = None
    fading: str | None = None
    fading_source: str | None = None
    fading_scale: float | None = None
    fading_scope: str | None = None
    fading_gate: str | None = None
    fading_memory: float | None = None
    fading_softening: float | None = None
    static_stay_probability: float | None = None
    static_alpha_per_s: float | None = None


@dataclass(frozen=True, kw_only=True)
class Pt1(Config):
    """First-order low-pass, the usual flight-controller gyro filter.

    Parameters
    ----------
    cutoff_hz : float, optional
        Cut-off frequency in Hz; default 20 Hz, at most a quarter of the sample rate.
    """

    method: ClassVar[str] = "pt1"
    cutoff_hz: float | None = None


def methods() -> dict[str, type[Config]]:
    """Return the configuration class of every method by name.

    Examples
    --------
    >>> methods()["pt1"].__name__
    'Pt1'
    """
    return {cls.method: cls for cls in Config.__subclasses__()}


def config_from_settings(method: str, settings: dict[str, Any]) -> Config:
    """Build a configuration from settings by name, as `Config.settings` gives them.

    Raises
    ------
    ConfigError
        If the method or a setting is unknown, or a value is out of range.
    """
    known = methods()
    if method not in known:
        raise ConfigError(f"no method {method!r} (one of {', '.join(sorted(known))})")
    cls = known[method]
    names = {item.name for item in dataclasses.fields(cls)}
    values = dict(settings)
    noise = None
    if _NOISE_FIELDS[0] in values:
        noise = GyroNoise(
            density_dps_sqrt_hz=values.pop(_NOISE_FIELDS[0]),
            rate_random_walk_dps_sqrt_s=values.pop(_NOISE_FIELDS[1], None),
        )
    if "sample_rate_hz" not in values:
        raise ConfigError("sample_rate_hz is missing (a number in Hz)")
    if unknown := sorted(set(values) - names):
        raise ConfigError(_unknown(method, unknown[0], names))
    return cls(noise=noise, **values)


def _unknown(method: str, name: str, names: set[str]) -> str:
    import difflib

    near = difflib.get_close_matches(name, names, n=1)
    return f"{method} has no setting {name!r}" + (f": did you mean {near[0]!r}?" if near else "")


def load_config(path: str | Path) -> Config:
    """Read a configuration from a TOML file, as `Config.to_toml` writes it.

    Raises
    ------
    ConfigError
        If the file is no TOML, larger than a megabyte, or a setting cannot be used.
    OSError
        If the file cannot be read.
    """
    path = Path(path)
    if path.stat().st_size > 1_000_000:
        raise ConfigError(f"{path}: larger than a megabyte, no configuration")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not a TOML file: {error}") from error
    method = table.pop("method", "ms-imm-ikf")
    noise = table.pop("noise", {})
    if not isinstance(noise, dict) or not isinstance(method, str):
        raise ConfigError(f"{path}: method must be a word and noise a table")
    return config_from_settings(method, {**table, **{f"noise.{name}": value for name, value in noise.items()}})
