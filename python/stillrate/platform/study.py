"""The comparison on the platform: same plant, same jitter budget, same margins; residual by filter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from stillrate.errors import ConfigError
from stillrate.platform.describing import SWING_DPS, describe_links, integration_error
from stillrate.platform.model import Controller, Link, Setup
from stillrate.platform.motion import Base
from stillrate.platform.running import Run, run_links
from stillrate.platform.tuning import (
    VALIDATION_SEEDS,
    Family,
    Row,
    families,
    tilt_table,
    tune,
    validate,
)

FIXED_CONTROLLER = Controller(kappa=0.17, ko_per_s=0.3, kvi_per_s=74.0, kd_s=0.65e-3)
"""The controller that every filter gets in the test with the controller fixed."""
BANK = "ms-imm-ikf"
"""The default bank's name in that test."""
TILTS_DEG = (20.0, 15.0, 10.0, 5.0)
TILT_S = 0.4
PLATFORM, GIMBAL = "platform", "gimbal"
"""Plants that designs are shipped for: the paper's 30 kg platform, and a small camera gimbal."""
DESCRIBED_HZ = 3.0
AMPLITUDES_DPS = (0.05, 0.3, 2.0, 60.0)


@dataclass(frozen=True)
class Design:
    """A tuned controller and filter: a family by name, gains, open settings, and the budget it was tuned at."""

    family: str
    budget_percent: float
    controller: Controller
    parameters: tuple[float, ...] = ()
    sample_rate_hz: float = 50.0
    feasible: bool = True
    evaluations: int = 0
    """Search effort that found it; compare only designs of like effort closely."""
    restarts_deg: tuple[float, ...] = ()
    """What each restart of that search reached, rms deg: their spread says how far it can be trusted."""
    plant: str = PLATFORM
    """`PLATFORM` or `GIMBAL`."""
    objective_deg: float = float("inf")
    """Residual (rms) on the search's seeds: by it designs are chosen, nothing else."""

    @property
    def label(self) -> str:
        """The filter's name with the budget."""
        return f"{self.family} ({self.budget_percent:g} %)"


def setup_of(design: Design) -> Setup:
    """Return the setup that a design was tuned on."""
    return Setup.camera_gimbal() if design.plant == GIMBAL else Setup(sample_rate_hz=design.sample_rate_hz)


@dataclass(frozen=True)
class Result:
    """A design and what was measured on the validation seeds."""

    design: Design
    row: Row
    tilt_peaks_deg: tuple[float, ...]
    added_deg: tuple[float, float]
    """Error (rms) added by integrating the filter's output over 70 s: base motion, and a slow 0.2 deg/s swing."""

    @property
    def recovery(self) -> float:
        """Rest jitter after a tilt on the worst seed over the undisturbed one of all."""
        return self.row.jitter_seeds[2] / max(self.row.undisturbed_percent, 1e-12)

    @property
    def reached(self) -> str:
        """What each restart of the search reached, rms deg, as text."""
        return " ".join(f"{value:.2f}" if value < float("inf") else "none" for value in self.design.restarts_deg)


@dataclass(frozen=True)
class Swapped:
    """What a filter does where the controller stays as it is."""

    name: str
    row: Row
    change_percent: float
    """Change of the residual (rms) against no filter."""
    quieter: float
    """How many times less rest jitter than without a filter."""


@dataclass(frozen=True)
class Study:
    """Everything a page shows."""

    setup: Setup
    results: tuple[Result, ...]
    fixed: tuple[tuple[str, Row], ...]
    describing: tuple[tuple[str, tuple[tuple[float, float], ...]], ...] = ()
    """Gain and phase of each filter at `AMPLITUDES_DPS`."""
    runs: tuple[tuple[str, Run], ...] = ()
    recorded: tuple[tuple[str, Run], ...] = ()
    notes: tuple[str, ...] = field(default=())
    seeds: int = len(VALIDATION_SEEDS)

    @property
    def swapped(self) -> tuple[Swapped, ...]:
        """Every filter of the test with the controller fixed against its first, no filter."""
        if not self.fixed:
            return ()
        raw = self.fixed[0][1]
        return tuple(
            Swapped(
                name,
                row,
                100.0 * (row.rms_deg[0] / raw.rms_deg[0] - 1.0),
                raw.jitter_percent / max(row.jitter_percent, 1e-12),
            )
            for name, row in self.fixed
        )

    @property
    def effort(self) -> str:
        """How hard each design was searched for: equal effort is a claim, so it is checked."""
        each = sorted({result.design.evaluations for result in self.results})
        if len(each) > 1:
            return f"with searches of {each[0]} to {each[-1]} evaluations"
        return f"every one with a search of {each[0] if each else 0} evaluations"


def tune_all(
    names: Sequence[str],
    budget_percent: float,
    *,
    setup: Setup,
    effort: tuple[int, int],
    progress: Callable[[str, int], None],
    plant: str = PLATFORM,
) -> list[Design]:
    """Tune families with one effort (evaluations, restarts), none of them beginning with a design of its own."""
    known = families(setup)
    designs = []
    for name in names:
        found = tune(
            _family(known, name),
            budget_percent,
            setup=setup,
            evaluations=effort[0],
            restarts=effort[1],
            progress=lambda done, name=name: progress(name, done),  # type: ignore[misc]
        )
        designs.append(
            Design(
                name,
                budget_percent,
                found.controller,
                found.parameters,
                setup.sample_rate_hz,
                found.feasible,
                effort[0],
                found.restarts_deg,
                plant,
                found.objective_deg,
            )
        )
    return designs


def carried_over(designs: Sequence[Design]) -> list[Design]:
    """Let a filter's better design of a smaller budget stand for a larger one as well: it is within that too."""
    chosen = []
    for design in designs:
        own = [d for d in designs if d.family == design.family and d.budget_percent <= design.budget_percent]
        best = min((d for d in own if d.feasible), key=lambda d: d.objective_deg, default=design)
        better = best.objective_deg < design.objective_deg or not design.feasible
        chosen.append(replace(best, budget_percent=design.budget_percent) if better else design)
    return chosen


def _family(known: dict[str, Family], name: str) -> Family:
    if name not in known:
        raise ConfigError(f"filter = {name} (must be one of {', '.join(known)})")
    return known[name]


def measure(design: Design, *, setup: Setup, seeds: Sequence[int] = VALIDATION_SEEDS) -> Result:
    """Measure one design."""
    family = _family(families(setup), design.family)
    row = validate(family, design.controller, design.parameters, setup=setup, seeds=seeds, margin_seeds=len(seeds))
    peaks = tilt_table(
        family,
        design.controller,
        design.parameters,
        setup=setup,
        tilts_deg=TILTS_DEG,
        duration_s=TILT_S,
        seeds=seeds[:3],
    )
    added = tuple(
        integration_error(family, design.parameters, setup=setup, amplitude_dps=a, frequency_hz=f, seeds=seeds[:8])
        for a, f in ((SWING_DPS, 1.0), (0.2, 0.05))
    )
    return Result(design, row, tuple(peaks), (added[0], added[1]))


def fixed_families(setup: Setup) -> list[Family]:
    """Return the filters of the test with the controller fixed, each with its own default settings."""
    rate = setup.sample_rate_hz
    walk = setup.noise.rate_random_walk_dps_sqrt_s
    common: dict[str, float | str | list[float]] = {
        "sample_rate_hz": rate,
        "noise.density_dps_sqrt_hz": setup.noise.density_dps_sqrt_hz,
        "noise.rate_random_walk_dps_sqrt_s": float(walk or 0.0),
    }

    def one(name: str, method: str, **settings: float | list[float]) -> Family:
        link: Link = (method, {**common, **settings})
        return Family(name, (link,))

    preset: dict[str, float | list[float]] = {
        "accel_max_dps2": [1.5, 300.0],
        "transition": [0.99, 0.01, 0.05, 0.95],
    }
    # AR(1) with phi = 0.9 and the noise ratio that gives the specification's gain of 0.82 at DC.
    variance = setup.noise.density_dps_sqrt_hz**2 * rate
    ar1: dict[str, float | list[float]] = {
        "coefficients": [0.9],
        "process_variance_dps2": 0.145 * variance,
        "measurement_variance_dps2": variance,
    }
    return [
        Family("none", ()),
        one("pt1 5.3 Hz (the paper's KF)", "pt1", cutoff_hz=5.3),
        one("AR(1)-KF", "ar-kf", **ar1),
        one("singer-imm-kf", "singer-imm-kf", **preset),
        one("one-euro", "one-euro"),
        one(BANK, "ms-imm-ikf"),
    ]


def fixed_test(setup: Setup, *, seeds: Sequence[int] = VALIDATION_SEEDS) -> list[tuple[str, Row]]:
    """Measure every filter with the same controller."""
    return [
        (family.name, validate(family, FIXED_CONTROLLER, setup=setup, seeds=seeds, margin_seeds=1))
        for family in fixed_families(setup)
    ]


def describing_test(setup: Setup) -> list[tuple[str, tuple[tuple[float, float], ...]]]:
    """Measure every filter's describing function: what it passes depends on how much there is."""
    sigma = setup.noise.density_dps_sqrt_hz * setup.sample_rate_hz**0.5
    return [
        (
            family.name,
            tuple(describe_links(family.links(), setup.sample_rate_hz, DESCRIBED_HZ, AMPLITUDES_DPS, sigma)),
        )
        for family in fixed_families(setup)
    ]


def show(design: Design, base: Base, *, setup: Setup, duration_s: float, seed: int = VALIDATION_SEEDS[0]) -> Run:
    """Run a design once, to be looked at."""
    family = _family(families(setup), design.family)
    filled = filled_links(family, design.parameters)
    return run_links(base, filled, setup=setup, controller=design.controller, seed=seed, duration_s=duration_s)


def filled_links(family: Family, parameters: Sequence[float]) -> list[Link]:
    """Return a family's chain with its open settings filled in."""
    chain: list[Link] = [(method, dict(settings)) for method, settings in family.chain]
    for (link, name, *_), value in zip(family.open, parameters, strict=True):
        settings = chain[link][1]
        stem, _, index = name.rpartition(".")
        listed = settings.get(stem)
        if isinstance(listed, list):
            settings[stem] = [value if str(i) == index else x for i, x in enumerate(listed)]
        else:
            settings[name] = value
    return chain
