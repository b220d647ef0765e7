"""Tune controller and filter together, and measure what came out on seeds the tuner did not see."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stillrate import _native
from stillrate.errors import ConfigError
from stillrate.platform.model import Controller, Link, LoopFilter, Setup, links

TUNING_SEEDS: tuple[int, ...] = tuple(range(201, 207))
"""Seeds that searches see."""
CHECK_SEEDS: tuple[int, ...] = tuple(range(301, 365))
"""Seeds on which every demand must hold before a search's design is kept."""
VALIDATION_SEEDS: tuple[int, ...] = tuple(range(957_401, 957_417))
"""Seeds that only published figures see; fixed before any published tuning was run."""
SEARCH_SEED = 20_263

Open = tuple[int, str, float, float, bool]
"""An open setting: link of the chain, name, lowest and highest value, whether the search is logarithmic."""
Spread = tuple[float, float, float]
"""Mean, smallest and largest over seeds."""


@dataclass(frozen=True)
class Family:
    """A chain of filters with some settings left open for the tuner.

    Parameters
    ----------
    name : str
    chain : tuple of (method, settings)
    open : tuple of (link, setting, low, high, logarithmic)
    linear : bool
    """

    name: str
    chain: tuple[Link, ...]
    open: tuple[Open, ...] = ()
    linear: bool = False

    def links(self) -> list[Link]:
        """Return the chain as a list."""
        return list(self.chain)

    @classmethod
    def of(
        cls,
        name: str,
        filter: LoopFilter | Sequence[LoopFilter] | None,
        *,
        sample_rate_hz: float,
        open: Sequence[Open] = (),
        linear: bool = False,
    ) -> Family:
        """Build a family from configurations."""
        return cls(name, tuple(links(filter, sample_rate_hz)), tuple(open), linear)


def families(setup: Setup | None = None) -> dict[str, Family]:
    """Return the study's families, from no filter to the default bank followed by a PT1."""
    setup = Setup() if setup is None else setup
    walk = setup.noise.rate_random_walk_dps_sqrt_s
    found = _native.servo_families(setup.sample_rate_hz, setup.noise.density_dps_sqrt_hz, walk)
    return {name: Family(name, tuple(chain), tuple(open), linear) for name, chain, open, linear in found}


@dataclass(frozen=True)
class Tuned:
    """A tuned controller and filter.

    Attributes
    ----------
    objective_deg, restarts_deg
        The search's objective (residual rms) and that of each restart: not results, validate for those.
    feasible
        Whether every demand held on the search's seeds and on those of the check.
    tried
        How many of the search's designs were tried on the check seeds until one held.
    """

    family: Family
    controller: Controller
    parameters: tuple[float, ...]
    objective_deg: float
    feasible: bool
    restarts_deg: tuple[float, ...]
    tried: int = 0


@dataclass(frozen=True)
class Row:
    """What a design does, measured on given seeds; spreads are (mean, smallest, largest).

    Jitter is the rms of the voltage less its 0.4 s mean, percent of the supply, 6 to 14 s after a 15 deg tilt.
    """

    rms_deg: Spread
    max_deg: Spread
    jitter_percent: float
    jitter_seeds: Spread
    undisturbed_percent: float
    motion_jitter_percent: float
    gain_margin: float
    delay_margin_ms: float
    voltage_rms_percent: float
    levelling_deg: Spread
    levelling_own_deg: Spread
    """What of the levelling error is the loop's own and not the gyro's bias and noise, integrated."""


def tune(
    family: Family,
    budget_percent: float,
    *,
    setup: Setup | None = None,
    evaluations: int = 1200,
    restarts: int = 2,
    search_seed: int = SEARCH_SEED,
    seeds: Sequence[int] = TUNING_SEEDS,
    check_seeds: Sequence[int] = CHECK_SEEDS,
    starts: Sequence[tuple[Controller, Sequence[float]]] = (),
    progress: Callable[[int], bool | None] | None = None,
) -> Tuned:
    """Find gains and filter settings with the least residual at a budget of rest jitter.

    Rest jitter counts after a tilt and stays, on every seed, below twice the undisturbed one; the loop must stay quiet
    with twice the gain and with 10 ms more delay, and level within 0.05 deg of where the gyro's drift puts the vertical.
    The search sees `seeds` only; of its designs the best that meets every demand on `check_seeds` is returned. The defaults
    are one effort for every family: compare nothing tuned with others.

    Parameters
    ----------
    family : Family
    budget_percent : float
        Rest jitter allowed, percent of the supply voltage.
    evaluations, restarts : int
        Effort of the search (differential evolution): evaluations in total, shared by independent restarts.
    check_seeds : sequence of int
        None: the search's best is returned as it is.
    starts : sequence of (Controller, open settings)
        Earlier designs of this family that every restart begins with.
    progress : callable, optional
        Called with the number of evaluations so far; False stops the search.
    """
    found = _native.servo_tune(
        Setup() if setup is None else setup,
        family,
        float(budget_percent),
        (evaluations, restarts, search_seed),
        list(seeds),
        list(check_seeds),
        [(controller, list(parameters)) for controller, parameters in starts],
        progress,
    )
    return Tuned(
        family=family,
        controller=Controller(**found["controller"]),
        parameters=tuple(found["parameters"]),
        objective_deg=found["objective_deg"],
        feasible=found["feasible"],
        restarts_deg=tuple(found["restarts_deg"]),
        tried=found["tried"],
    )


def validate(
    family: Family,
    controller: Controller,
    parameters: Sequence[float] = (),
    *,
    setup: Setup | None = None,
    seeds: Sequence[int] = VALIDATION_SEEDS,
    margin_seeds: int = 6,
) -> Row:
    """Measure a design on seeds that its tuner did not see (at least two)."""
    if len(seeds) < 2:
        raise ConfigError(f"seeds = {list(seeds)} (must be at least two)")
    bench = Setup() if setup is None else setup
    found = _native.servo_validate(bench, family, controller, list(parameters), list(seeds), margin_seeds)
    return Row(**found)


def tilt_table(
    family: Family,
    controller: Controller,
    parameters: Sequence[float] = (),
    *,
    setup: Setup | None = None,
    tilts_deg: Sequence[float] = (20.0, 15.0, 10.0, 5.0),
    duration_s: float = 0.4,
    seeds: Sequence[int] = VALIDATION_SEEDS[:6],
) -> list[float]:
    """Peak angle of base tilts in degrees, mean over both signs and the seeds."""
    bench = Setup() if setup is None else setup
    found: list[float] = _native.servo_tilt_table(
        bench, family, controller, list(parameters), list(tilts_deg), duration_s, list(seeds)
    )
    return found


def integration_error(
    family: Family,
    parameters: Sequence[float] = (),
    *,
    setup: Setup | None = None,
    amplitude_dps: float = 62.83185307179586,
    frequency_hz: float = 1.0,
    duration_s: float = 70.0,
    seeds: Sequence[int] = VALIDATION_SEEDS[:8],
) -> float:
    """Error in degrees (rms over seeds) that integrating the filter's output adds to integrating the raw rate."""
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
    """Return the describing function: (gain, phase in degrees) at each amplitude of the rate, noise present."""
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
