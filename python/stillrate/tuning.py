"""Settings from a log: noise figures where the sensor stood still, and a method around them."""

from __future__ import annotations

import inspect
import textwrap
from dataclasses import dataclass

import numpy as np

from stillrate.allan_deviation import Allan, allan
from stillrate.cleaning import DEFAULT_METHOD
from stillrate.config import Config, method_class
from stillrate.errors import LogError
from stillrate.io.log import Floats, Log
from stillrate.noise import GyroNoise, NoiseFromLog, noise_from_log

_LONGEST_GRID_RATIO = 4
"""A log with gaps is laid on a regular grid only if that has at most so many times its samples."""


@dataclass(frozen=True)
class Tuned:
    """Settings and where they come from.

    Attributes
    ----------
    config : Config
    axes : dict of str to NoiseFromLog
        What each channel showed.
    """

    config: Config
    axes: dict[str, NoiseFromLog]

    def to_toml(self) -> str:
        """Return the settings with a comment on where each noise figure comes from."""
        lines = [f"# Settings for `stillrate filter --config`, measured at {self.config.sample_rate_hz:.6g} Hz.", "#"]
        for name, found in self.axes.items():
            span = f"samples {found.quiet.start} to {found.quiet.stop}"
            lines.append(
                f"# {name}: N = {found.density_dps_sqrt_hz:.4g} (deg/s)/sqrt(Hz), K ="
                f" {found.rate_random_walk_dps_sqrt_s:.4g} (deg/s)/sqrt(s), {span}: {found.reason}"
            )
            if not found.at_rest:
                lines.append(f"#   {name} is never at rest: an upper bound, measure it at rest")
        lines += [
            "#",
            "# The figures below are the largest of the axes at rest: too high a density is safer than too low.",
            "",
        ]
        return "\n".join(lines) + _commented(self.config)


_GENERAL = {
    "method": "The filter.",
    "checksum": "Of the settings below. Remove this line when you change one by hand.",
    "sample_rate_hz": "Samples a second of the logs that these settings are for, in Hz.",
    "density_dps_sqrt_hz": "Two-sided density of the white noise (angle random walk), N in (deg/s)/sqrt(Hz).",
    "rate_random_walk_dps_sqrt_s": "Random walk of the rate, K in (deg/s)/sqrt(s).",
}


def _commented(config: Config) -> str:
    """Return the settings as TOML, above each what it is: the words of the method's own documentation."""
    told = {**_documented(type(config)), **_GENERAL}
    lines: list[str] = []
    last = None
    for line in config.to_toml().splitlines():
        words = told.get(line.split(" = ")[0]) if " = " in line else None
        if words is not None and words != last:
            lines += ["", *textwrap.wrap(words, 100, initial_indent="# ", subsequent_indent="# ")]
        last = words or last
        if line or words:
            lines.append(line)
    return "\n".join(lines).replace("\n[noise]", "\n\n[noise]") + "\n"


def _documented(kind: type[Config]) -> dict[str, str]:
    """Return what the class says of each parameter (numpy style: names, then indented words)."""
    found: dict[str, str] = {}
    names: list[str] = []
    for line in inspect.cleandoc(kind.__doc__ or "").splitlines():
        if line and not line.startswith(" "):
            names = [name.strip() for name in line.partition(" : ")[0].split(",")] if " : " in line else []
        for name in names if line.startswith(" ") else ():
            found[name] = f"{found.get(name, '')} {line.strip()}".strip().replace("``", "").replace("()", "[]")
    return found


def tune(log: Log, method: str = DEFAULT_METHOD, *, rest: slice | None = None) -> Config:
    """Return a configuration with the noise of a log.

    Parameters
    ----------
    log : Log
    method : str
        Method by name.
    rest : slice, optional
        Samples where the sensor stood still; found by itself when left out.

    Raises
    ------
    ConfigError
        If the method is unknown.
    LogError
        If there are too few samples.

    Examples
    --------
    >>> import stillrate as sr
    >>> run = sr.simulate.static(50.0, 1)
    >>> log = sr.Log(t_s=run.t_s, rate_dps=run.measured_dps, channels=("gz_dps",))
    >>> bool(abs(sr.tune(log).noise.density_dps_sqrt_hz / 0.0151 - 1) < 0.1)
    True
    """
    return tune_with_reasons(log, method, rest=rest).config


def tune_with_reasons(log: Log, method: str = DEFAULT_METHOD, *, rest: slice | None = None) -> Tuned:
    """As `tune`, with what each axis showed."""
    cls = method_class(method)
    rates = log.rate_dps if rest is None else log.rate_dps[rest]
    if len(rates) < 8:
        raise LogError(f"{len(rates)} samples of rest (must be at least 8)")
    found = noise_from_log(rates, log.sample_rate_hz)
    noise = GyroNoise.from_log(rates, sample_rate_hz=log.sample_rate_hz)
    config = cls(sample_rate_hz=log.sample_rate_hz, noise=noise)
    return Tuned(config, dict(zip(log.channels, found, strict=True)))


def allan_of(log: Log, channel: int, *, taus_per_decade: int = 20, confidence: float = 0.9) -> Allan:
    """Return the Allan deviation of one channel; gaps of the log stay gaps."""
    return allan(
        on_grid(log, channel), log.sample_rate_hz, taus="dense", per_decade=taus_per_decade, confidence=confidence
    )


def on_grid(log: Log, channel: int) -> Floats:
    """Return one channel on a regular grid, NaN in the gaps."""
    samples = np.ascontiguousarray(log.rate_dps[:, channel])
    timing = log.timing
    if not timing.gaps or timing.backward or timing.missing:
        return samples
    place = np.rint((log.t_s - log.t_s[0]) * log.sample_rate_hz).astype(np.int64)
    if place[-1] >= _LONGEST_GRID_RATIO * len(samples):
        return samples
    grid = np.full(int(place[-1]) + 1, np.nan)
    grid[place] = samples
    return grid
