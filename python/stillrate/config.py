"""Configurations: one frozen class a method, checked when built, TOML in and out.

The fields left out are filled in by the method itself (the defaults live in one place, beside the numerics), so a
configuration always shows every setting that is in force.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Self

from stillrate import _native
from stillrate.errors import ConfigError, nearest
from stillrate.noise import GyroNoise

# What to_toml writes; load_config reads no other.
_FORMAT = 1
_NOISE_FIELDS = ("noise.density_dps_sqrt_hz", "noise.rate_random_walk_dps_sqrt_s")


@dataclass(frozen=True, kw_only=True)
class Config:
    """What all configurations share.

    Parameters
    ----------
    sample_rate_hz : float
        Nominal sample rate in Hz.
    noise : GyroNoise, optional
        The gyro's noise; default a density of 0.01 deg/s/sqrt(Hz), a guess that yours should replace. Methods that do
        not use it ignore it.

    Raises
    ------
    ConfigError
        If a setting is out of range; the text names field, value, unit and range.

    Examples
    --------
    A configuration shows every setting in force, those that were left out too.

    >>> from stillrate import OneEuro
    >>> config = OneEuro(sample_rate_hz=50.0)
    >>> isinstance(config, Config), config.method, config.minimum_cutoff_hz
    (True, 'one-euro', 0.2)
    """

    method: ClassVar[str] = ""

    sample_rate_hz: float
    noise: GyroNoise | None = None

    def __new__(cls, *arguments: Any, **settings: Any) -> Self:
        """Refuse a setting that the method does not have before Python does, with the nearest name."""
        names = cls.__dataclass_fields__
        for name in settings:
            if name not in names:
                raise ConfigError(f"{cls.__name__} has no setting {name!r}{nearest(name, names)}")
        return super().__new__(cls)

    def __reduce__(self) -> tuple[Callable[..., Config], tuple[str, dict[str, Any]]]:
        """Pickle as method and settings: unpickling calls `config_from_settings`, which checks them."""
        return config_from_settings, (self.method, self.settings())

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
        """Return every setting by name, noise figures with the prefix ``noise.``; settings left open are left out.

        Examples
        --------
        >>> from stillrate import Pt1
        >>> Pt1(sample_rate_hz=1000.0).settings()
        {'sample_rate_hz': 1000.0, 'cutoff_hz': 20.0}
        """
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
        """Return a copy with some settings changed (the rest stays as it is in force).

        A memory can be given in seconds or as a factor a sample. The one that is changed decides; at another sample rate the
        seconds stay.

        Examples
        --------
        >>> from stillrate import RecursiveLeastSquares
        >>> slow = RecursiveLeastSquares(sample_rate_hz=50.0, tau_s=0.1)
        >>> fast = slow.replace(sample_rate_hz=500.0)
        >>> fast.tau_s, round(slow.forgetting_factor, 4), round(fast.forgetting_factor, 4)
        (0.1, 0.8187, 0.9802)
        """
        if {"tau_s", "forgetting_factor"} <= self.__dataclass_fields__.keys():
            if "forgetting_factor" in changes:
                changes = {"tau_s": None} | changes
            elif "tau_s" in changes or "sample_rate_hz" in changes:
                changes = {"forgetting_factor": None} | changes
        return dataclasses.replace(self, **changes)

    def to_toml(self, path: str | Path | None = None) -> str:
        """Write the configuration as TOML; with `path`, into a new file as well.

        The text carries a checksum of its settings, so that a file that was cut off or damaged is not mistaken for one.

        Raises
        ------
        FileExistsError
            If the file exists.

        Examples
        --------
        >>> from stillrate import Pt1
        >>> print(Pt1(sample_rate_hz=50.0, cutoff_hz=8.0).to_toml())
        method = "pt1"
        format = 1
        checksum = "4016edb3"
        sample_rate_hz = 50.0
        cutoff_hz = 8.0
        <BLANKLINE>
        """
        settings = self.settings()
        lines = [f'method = "{self.method}"', f"format = {_FORMAT}", f'checksum = "{_checksum(self.method, settings)}"']
        noise: list[str] = []
        for name, value in settings.items():
            if name.startswith("noise."):
                noise.append(f"{name.removeprefix('noise.')} = {_toml(value)}")
            else:
                lines.append(f"{name} = {_toml(value)}")
        text = "\n".join([*lines, *(["", "[noise]", *noise] if noise else [])]) + "\n"
        if path is not None:
            with Path(path).open("x", encoding="utf-8") as file:
                file.write(text)
        return text


def _checksum(method: str, settings: Mapping[str, Any]) -> str:
    """Return a checksum of a method and its settings, whatever their order and however a number is written."""

    def plain(value: Any) -> Any:
        if isinstance(value, list):
            return [plain(part) for part in value]
        return float(value) if isinstance(value, (int, float)) else value

    text = "\n".join([method, *(f"{name} = {plain(settings[name])!r}" for name in sorted(settings))])
    return f"{zlib.crc32(text.encode()):08x}"


def _toml(value: float | str | list[float]) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list):
        return "[" + ", ".join(_toml(number) for number in value) + "]"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return repr(float(value))


def methods() -> dict[str, type[Config]]:
    """Return the configuration class of every method by name.

    Examples
    --------
    >>> methods()["pt1"].__name__
    'Pt1'
    """
    import stillrate.methods  # noqa: F401  (defines the classes)

    return {cls.method: cls for cls in Config.__subclasses__()}


def method_class(name: str) -> type[Config]:
    """Return the configuration class of a method.

    Raises
    ------
    ConfigError
        If there is no such method; the text says which name is nearest.

    Examples
    --------
    >>> method_class("pt2")
    Traceback (most recent call last):
        ...
    stillrate.errors.ConfigError: no method 'pt2': did you mean 'pt1'?
    """
    known = methods()
    if name not in known:
        raise ConfigError(f"no method {name!r}{nearest(name, known, among=True)}")
    return known[name]


def config_from_settings(method: str, settings: dict[str, Any]) -> Config:
    """Build a configuration from settings by name, as `Config.settings` gives them.

    Raises
    ------
    ConfigError
        If the method or a setting is unknown, or a value is out of range.

    Examples
    --------
    >>> config_from_settings("pt1", {"sample_rate_hz": 50.0, "cutoff_hz": 8.0}).cutoff_hz
    8.0
    """
    cls = method_class(method)
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
        raise ConfigError(f"{method} has no setting {unknown[0]!r}{nearest(unknown[0], names)}")
    return cls(noise=noise, **values)


def load_config(path: str | Path) -> Config:
    """Read a configuration from a TOML file, as `Config.to_toml` writes it.

    Raises
    ------
    ConfigError
        If the file is no TOML, larger than a megabyte, of another format, or a setting cannot be used; or if it has a checksum and
        the settings are not those it was written for. Who changes a setting by hand removes that line.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from stillrate import Pt1
    >>> path = Path(tempfile.mkdtemp()) / "filter.toml"
    >>> _ = Pt1(sample_rate_hz=50.0, cutoff_hz=8.0).to_toml(path)
    >>> load_config(path).cutoff_hz
    8.0
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
    form, checksum = table.pop("format", _FORMAT), table.pop("checksum", None)
    if form != _FORMAT:
        raise ConfigError(f"{path}: settings of format {form!r}, this version reads format {_FORMAT}")
    settings = {**table, **{f"noise.{name}": value for name, value in noise.items()}}
    if checksum is not None and checksum != _checksum(method, settings):
        raise ConfigError(
            f"{path}: the settings are not those that were written (cut off, damaged or changed; if you changed them"
            " yourself, remove the line that begins with checksum)"
        )
    return config_from_settings(method, settings)
