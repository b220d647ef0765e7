"""What a filter alone does to amplitude, phase and integral, apart from any loop."""

from __future__ import annotations

import math
from collections.abc import Sequence

from stillrate import _native
from stillrate.platform.model import Link, LoopFilter, Setup, links
from stillrate.platform.tuning import VALIDATION_SEEDS, Family

SWING_DPS = 2.0 * math.pi * 10.0
"""Rate amplitude of the standard motion, 10 deg at 1 Hz."""


def integration_error(
    family: Family,
    parameters: Sequence[float] = (),
    *,
    setup: Setup | None = None,
    amplitude_dps: float = SWING_DPS,
    frequency_hz: float = 1.0,
    duration_s: float = 70.0,
    seeds: Sequence[int] = VALIDATION_SEEDS[:8],
) -> float:
    """Error in degrees (rms over seeds) that integrating the filter's output adds to integrating the raw rate.

    The motion is a sine of `amplitude_dps` for `duration_s` and then 5 s of rest, in which a filter's lag runs out.

    Examples
    --------
    A low-pass hands on all that it is given; the bank takes a slow motion below the noise for none:

    >>> slow = {"amplitude_dps": 0.2, "frequency_hz": 0.05, "duration_s": 25.0, "seeds": (1, 2)}
    >>> from stillrate.platform import families
    >>> known = families()
    >>> by_bank = integration_error(known["ms-imm-ikf+pt1"], (3.6,), **slow)
    >>> by_bank > 10.0 * integration_error(known["pt1"], (3.6,), **slow)
    True
    """
    bench = Setup() if setup is None else setup
    motion = (amplitude_dps, frequency_hz)
    return float(_native.servo_integration_error(bench, family, list(parameters), motion, duration_s, list(seeds)))


def describe(
    filter: LoopFilter | Sequence[LoopFilter] | None,
    *,
    sample_rate_hz: float = 50.0,
    frequency_hz: float = 3.0,
    amplitudes_dps: Sequence[float] = (0.05, 0.3, 2.0, 60.0),
    noise_sigma_dps: float = 0.1074,
    periods: int = 600,
    seed: int = 1,
) -> list[tuple[float, float]]:
    """Return the describing function: (gain, phase in degrees) at each amplitude of the rate, noise present.

    Parameters
    ----------
    filter : configuration, textbook filter or a sequence of them, optional
    sample_rate_hz, frequency_hz : float
        Rate of the samples and frequency of the sine, Hz.
    amplitudes_dps : sequence of float
        Amplitudes of the sine, deg/s.
    noise_sigma_dps : float
        Standard deviation of a sample's noise, deg/s.
    periods, seed : int
        Periods over which the first harmonic is taken, after 10 s of settling, and the noise's seed.

    Examples
    --------
    A linear filter has one gain, an adaptive one another at every amplitude:

    >>> import stillrate as sr
    >>> bank = sr.MsImmIkf(sample_rate_hz=50.0, noise=Setup().noise)
    >>> (quiet, _), (loud, _) = describe(bank, amplitudes_dps=(0.05, 60.0), periods=150)
    >>> quiet < 0.3 and abs(loud - 1.0) < 0.02
    True
    """
    return describe_links(
        links(filter, sample_rate_hz), sample_rate_hz, frequency_hz, amplitudes_dps, noise_sigma_dps, (periods, seed)
    )


def describe_links(
    chain: list[Link],
    sample_rate_hz: float,
    frequency_hz: float,
    amplitudes_dps: Sequence[float],
    noise_sigma_dps: float,
    run: tuple[int, int] = (600, 1),
) -> list[tuple[float, float]]:
    """Return the describing function of a chain of methods and settings; `run` is periods and seed."""
    found: list[tuple[float, float]] = _native.servo_describe(
        chain, sample_rate_hz, frequency_hz, list(amplitudes_dps), noise_sigma_dps, run
    )
    return found
