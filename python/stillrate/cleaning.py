"""A log through a filter: noise and settings for each axis, in chunks, with what a report needs to be seen.

A long log goes through in chunks that continue the same state, so the result does not depend on their length.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from stillrate import __version__
from stillrate._native import Filter
from stillrate.config import Config, method_class
from stillrate.errors import LogError
from stillrate.io.log import Log
from stillrate.noise import GyroNoise, noise_from_log
from stillrate.results import Flags, brief

DEFAULT_METHOD = "ms-imm-ikf"
CHUNK_ROWS = 1 << 14
VIEW_POINTS = 4000
"""How many points of probability and frequency are kept for a picture."""

_RATE_TOLERANCE = 0.02

Progress = Callable[[int], None]


@dataclass(frozen=True)
class View:
    """What happened inside a filter, thinned out for a picture.

    Attributes
    ----------
    index : ndarray of int
        The samples that are shown.
    probability : ndarray, shape (points, models)
    frequency_hz : ndarray, shape (points,)
        NaN for methods without one.
    """

    index: npt.NDArray[np.int64]
    probability: npt.NDArray[Any]
    frequency_hz: npt.NDArray[Any]

    __repr__ = brief


@dataclass(frozen=True)
class Cleaned:
    """A filtered log.

    Attributes
    ----------
    raw, clean : Log
        Before and after, same rows and columns.
    configs : dict of str to Config
        What each channel was filtered with.
    flags : ndarray of uint32, shape (n, channels)
        Bits of `Flags`.
    counts : dict of str to dict of str to int
        By channel, how many samples carry each flag.
    views : dict of str to View
        Inside of each channel's filter; empty unless asked for.
    notes : tuple of str
        What a reader should know about the settings.
    """

    raw: Log
    clean: Log
    configs: Mapping[str, Config]
    flags: npt.NDArray[np.uint32]
    counts: Mapping[str, Mapping[str, int]]
    views: Mapping[str, View]
    notes: tuple[str, ...]

    __repr__ = brief


@dataclass(frozen=True)
class _Channel:
    rate: npt.NDArray[np.float64]
    flags: npt.NDArray[np.uint32]
    counts: dict[str, int]
    view: View | None


def settings_for(
    log: Log, *, method: str | None = None, config: Config | None = None
) -> tuple[dict[str, Config], list[str]]:
    """Return a configuration for each channel: the given one at the log's rate, or noise taken from the log itself.

    Raises
    ------
    ConfigError
        If the method is unknown or the noise cannot be found.

    Examples
    --------
    >>> from stillrate import demo
    >>> log = demo.wave_log(demo.runs())
    >>> configs, notes = settings_for(log, method="pt1")
    >>> configs["gx_dps"].cutoff_hz
    12.5
    """
    rate = log.sample_rate_hz
    if config is not None:
        config, notes = at_rate(config, rate)
        return dict.fromkeys(log.channels, config), notes
    cls = method_class(DEFAULT_METHOD if method is None else method)
    noise, notes = noise_of(log)
    return {channel: cls(sample_rate_hz=rate, noise=figures) for channel, figures in noise.items()}, notes


def at_rate(config: Config, rate_hz: float) -> tuple[Config, list[str]]:
    """Return the configuration for a rate, and a note if it is not the one that was given: within 2 % the same will do.

    Examples
    --------
    >>> from stillrate import Pt1
    >>> slow = Pt1(sample_rate_hz=50.0)
    >>> at_rate(slow, 50.2) == (slow, [])
    True
    >>> at_rate(slow, 100.0)[1]
    ['the settings are for 50 Hz: rebuilt for 100 Hz']
    """
    if abs(rate_hz / config.sample_rate_hz - 1.0) <= _RATE_TOLERANCE:
        return config, []
    note = f"the settings are for {config.sample_rate_hz:.6g} Hz: rebuilt for {rate_hz:.6g} Hz"
    return config.replace(sample_rate_hz=rate_hz), [note]


def noise_of(log: Log) -> tuple[dict[str, GyroNoise], list[str]]:
    """Measure each channel's noise; one that never rests gets the figures of those that do, if any does."""
    found = noise_from_log(log.rate_dps, log.sample_rate_hz)
    shared = GyroNoise.from_log(log.rate_dps, sample_rate_hz=log.sample_rate_hz)
    resting = any(figures.at_rest and not figures.constant for figures in found)
    noise, notes = {}, []
    for channel, figures in zip(log.channels, found, strict=True):
        if resting and not figures.at_rest:
            noise[channel] = shared
            notes.append(f"{channel}: never at rest, the noise is that of the other channels")
            continue
        noise[channel] = figures.gyro
        if figures.constant:
            notes.append(f"{channel}: {figures.reason}")
        elif not figures.at_rest:
            notes.append(f"{channel}: its noise is an upper bound ({figures.reason})")
        elif figures.motion_dominated:
            span = f"samples {figures.quiet.start} to {figures.quiet.stop}"
            notes.append(f"{channel}: in motion for {figures.moving_fraction:.0%} of the log, its noise is from {span}")
    return noise, notes


def clean(
    log: Log,
    configs: Mapping[str, Config],
    *,
    notes: tuple[str, ...] = (),
    views: bool = False,
    progress: Progress | None = None,
) -> Cleaned:
    """Filter every channel of a log with its configuration.

    Parameters
    ----------
    log : Log
    configs : dict of str to Config
        One a channel, as `settings_for` gives them.
    views : bool
        Keep probabilities and frequency for a picture.
    progress : callable, optional
        Is told how many samples were done since the last call.

    Raises
    ------
    LogError
        If the log holds no samples.

    Examples
    --------
    >>> from stillrate import demo
    >>> log = demo.wave_log(demo.runs())
    >>> done = clean(log, settings_for(log, method="pt1")[0])
    >>> done.clean.rate_dps.shape == log.rate_dps.shape, done.counts
    (True, {'gx_dps': {}})
    """
    if not len(log):
        raise LogError("no samples in it")
    rates = np.empty_like(log.rate_dps)
    seen: dict[str, View] = {}
    bits = np.empty(rates.shape, np.uint32)
    counts: dict[str, dict[str, int]] = {}
    for index, channel in enumerate(log.channels):
        done = _channel(log, index, configs[channel], views, progress)
        rates[:, index] = done.rate
        bits[:, index] = done.flags
        if done.view is not None:
            seen[channel] = done.view
        counts[channel] = done.counts
    made = {
        "version": __version__,
        "configuration": {name: config.to_toml() for name, config in configs.items()},
    }
    meta = {**log.meta, "stillrate": made}
    return Cleaned(log, dataclasses.replace(log, rate_dps=rates, meta=meta), dict(configs), bits, counts, seen, notes)


def _channel(log: Log, index: int, config: Config, views: bool, progress: Progress | None) -> _Channel:
    """Run one channel in chunks."""
    samples = np.ascontiguousarray(log.rate_dps[:, index])
    steps = log.steps_s()
    flt = Filter(config)
    every = max(1, len(log) // VIEW_POINTS)
    result = np.empty_like(samples)
    flags = np.empty(len(samples), np.uint32)
    counts: dict[str, int] = {}
    kept: list[tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]] = []
    for begin in range(0, len(log), CHUNK_ROWS):
        part = slice(begin, min(begin + CHUNK_ROWS, len(log)))
        dt_s = None if steps is None else steps[part]
        trace = flt.run(samples[part], dt_s=dt_s, trace=True)
        result[part] = trace.rate
        _count(trace.flags, counts)
        flags[part] = trace.flags
        if views:
            first = (-begin) % every
            shown = np.arange(begin + first, part.stop, every)
            kept.append((shown, trace.probability[first::every], trace.frequency_hz[first::every]))
        if progress is not None:
            progress(part.stop - part.start)
    view = View(*(np.concatenate(parts) for parts in zip(*kept, strict=True))) if kept else None
    return _Channel(result, flags, counts, view)


def _count(flags: npt.NDArray[np.uint32], counts: dict[str, int]) -> None:
    for flag in Flags:
        if flag.value and flag.name:
            found = int(np.count_nonzero(flags & flag.value))
            if found:
                counts[flag.name] = counts.get(flag.name, 0) + found
