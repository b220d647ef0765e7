"""The servo section of the MS-IMM-IKF paper: table 1 and figures 12-13 beside our simulation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.table import Table

from stillrate.platform import Constant, Plant, Setup, validate
from stillrate.platform.running import run_links
from stillrate.platform.shipped import SHIPPED
from stillrate.platform.study import (
    BANK,
    PLATFORM,
    TILTS_DEG,
    Design,
    Result,
    Study,
    filled_links,
    fixed_test,
    measure,
)
from stillrate.platform.tables import fixed_table
from stillrate.platform.tuning import VALIDATION_SEEDS, Row, families

PUBLISHED_TILTS: dict[str, tuple[float, ...]] = {
    "none": (6.53, 5.36, 3.97, 2.26),
    "kalman-5.3hz": (5.94, 4.76, 3.59, 1.93),
    "singer-imm-kf": (5.14, 3.62, 2.88, 1.61),
    "ms-imm-ikf+pt1": (4.78, 3.51, 2.31, 1.29),
}
"""Table 1, deg: mean of both directions at tilts of 20, 15, 10 and 5 deg."""
PUBLISHED_SWING: dict[str, str] = {
    "none": "5.17",
    "kalman-5.3hz": "4.86",
    "singer-imm-kf": "< 3",
    "ms-imm-ikf+pt1": "< 2.5",
}
"""Figures 12-13: largest error at 10 deg and 1 Hz, deg."""
BUDGET_PERCENT = 0.05

NEAR = 0.25
"""How near a published figure ours must be to count as reproduced: the tilt's duration and the gains are not in the
paper, so a magnitude can only agree roughly."""
UNKNOWN = (
    "PID, delay, spindle lead, tilt time and number of runs are not in the paper, so no figure can be reproduced exactly; the jitter "
    "budget of 0.05 % is ours, chosen because no filter lands near 5 deg there: only the ordering is a result."
)
YES, NO, CANNOT = "reproduced", "not reproduced", "not reproducible"
Claim = tuple[str, str, str, str]
"""What is claimed, what the paper has, what we have, the verdict."""


def reproduce() -> Iterator[Table | str]:
    """Compute the tables; what is yielded is for a rich console."""
    setup = Setup()
    chosen = [
        d for d in SHIPPED if d.family in PUBLISHED_TILTS and d.budget_percent == BUDGET_PERCENT and d.plant == PLATFORM
    ]
    seeds = VALIDATION_SEEDS[:6]
    results = [measure(design, setup=setup, seeds=seeds) for design in chosen if design.sample_rate_hz == 50.0]
    fixed = tuple(fixed_test(setup, seeds=seeds))
    finals = {design.family: _final_errors(design) for design in chosen}
    yield _tilts(results)
    yield _swing(results)
    yield _final(finals)
    yield fixed_table(Study(setup=setup, results=(), fixed=fixed))
    yield _verdicts(_claims(results, fixed, finals, seeds))
    yield UNKNOWN


def _verdict(holds: bool) -> str:
    return YES if holds else NO


def _claims(
    results: list[Result],
    fixed: tuple[tuple[str, Row], ...],
    finals: dict[str, list[float]],
    seeds: Sequence[int],
) -> Iterator[Claim]:
    """Judge every claim of the servo section by figures of this run."""
    rows = {result.design.family: result.row for result in results}
    peaks = {result.design.family: result.tilt_peaks_deg for result in results}
    largest = {name: row.max_deg[0] for name, row in rows.items()}
    order = sorted(largest, key=lambda name: -largest[name])
    published_order = list(PUBLISHED_SWING)
    yield (
        "fig. 12-13: order at 10 deg, 1 Hz",
        " > ".join(published_order),
        " > ".join(order),
        _verdict(order == published_order),
    )
    small = 100.0 * (1.0 - largest["kalman-5.3hz"] / largest["none"])
    yield "fig. 12: the Kalman filter alone changes little", "-6 %", f"{-small:+.0f} %", _verdict(0.0 < small < 15.0)
    yield (
        "table 1: error grows with the tilt (20 deg over 5 deg)",
        ", ".join(f"{v[0] / v[-1]:.1f}" for v in PUBLISHED_TILTS.values()),
        ", ".join(f"{peaks[name][0] / peaks[name][-1]:.1f}" for name in PUBLISHED_TILTS),
        _verdict(all(v[0] > v[1] > v[2] > v[3] for v in peaks.values())),
    )
    worst = max(abs(final) for finals_of in finals.values() for final in finals_of)
    text = f"at most {worst:.2f} deg"
    yield "table 1 as the FINAL error at 20 deg", "4.8 to 6.5 deg", text, _verdict(worst > 0.5 * 4.78)
    raw, bank = dict(fixed)["none"], dict(fixed)[BANK]
    change = 100.0 * (bank.max_deg[0] / raw.max_deg[0] - 1.0)
    yield "a better filter at the same PID", "-50 %", f"{change:+.1f} %", _verdict(change < -25.0)
    yield _play_and_friction(results, seeds)
    yield "PID, delay, lead, tilt time", "not stated", "assumed", CANNOT


def _play_and_friction(results: list[Result], seeds: Sequence[int]) -> Claim:
    """Put the blame to the test: the residual without a filter, with more play and with twice the friction."""
    result = next(r for r in results if r.design.family == "none")
    plant = Plant.platform_30kg()
    changed = (
        plant.replace(half_backlash_rad=4.0 * plant.half_backlash_rad),
        plant.replace(coulomb_n_m=2.0 * plant.coulomb_n_m, stiction_n_m=2.0 * plant.stiction_n_m),
    )
    family = families(Setup())["none"]
    found = [
        validate(family, result.design.controller, setup=Setup(plant=p), seeds=seeds, margin_seeds=0) for p in changed
    ]
    change = [100.0 * (row.max_deg[0] / result.row.max_deg[0] - 1.0) for row in found]
    ours = f"play x4 {change[0]:+.0f} %, friction x2 {change[1]:+.0f} %"
    return "play and friction cause the error", "main cause", ours, _verdict(max(change) > 25.0)


def _verdicts(claims: Iterator[Claim]) -> Table:
    table = Table(title="what is and what is not reproduced")
    for head in ("claim", "paper", "ours", "verdict"):
        table.add_column(head, overflow="fold")
    for claim in claims:
        table.add_row(*claim)
    return table


def _tilts(results: list[Result]) -> Table:
    table = Table(title="table 1: error at a tilt of the base, deg; published / ours (peak, base tilts in 0.4 s)")
    table.add_column("filter")
    for tilt in TILTS_DEG:
        table.add_column(f"{tilt:g} deg", justify="right")
    table.add_column(f"within {100 * NEAR:.0f} %")
    for result in results:
        pairs = list(zip(PUBLISHED_TILTS[result.design.family], result.tilt_peaks_deg, strict=True))
        near = sum(abs(ours / theirs - 1.0) <= NEAR for theirs, ours in pairs)
        table.add_row(
            result.design.family,
            *(f"{theirs:.2f} / {ours:.2f}" for theirs, ours in pairs),
            f"{_verdict(near == len(pairs))} ({near} of {len(pairs)})",
        )
    return table


def _swing(results: list[Result]) -> Table:
    table = Table(title=f"figures 12-13: 10 deg at 1 Hz, tuned at {BUDGET_PERCENT:g} % rest jitter")
    table.add_column("filter")
    for head in ("published max", "our max", "our rms", "rest jitter %", "verdict"):
        table.add_column(head, justify="right")
    for result in results:
        row, name = result.row, result.design.family
        table.add_row(
            name,
            PUBLISHED_SWING[name],
            f"{row.max_deg[0]:.2f} [{row.max_deg[1]:.2f} - {row.max_deg[2]:.2f}]",
            f"{row.rms_deg[0]:.2f}",
            f"{row.jitter_percent:.4f}",
            _verdict(_agrees(PUBLISHED_SWING[name], row.max_deg[0])),
        )
    return table


def _agrees(published: str, ours: float) -> bool:
    """Return whether ours is below a published bound, or near a published figure."""
    if published.startswith("< "):
        return ours < float(published.removeprefix("< "))
    return abs(ours / float(published) - 1.0) <= NEAR


def _final_errors(design: Design) -> list[float]:
    """Level from each tilt for 25 s: the error that stays, deg."""
    setup = Setup()
    chain = filled_links(families(setup)[design.family], design.parameters)
    return [
        float(
            run_links(
                Constant(angle_deg=tilt),
                chain,
                setup=setup,
                controller=design.controller,
                seed=VALIDATION_SEEDS[0],
                start_deg=tilt,
                duration_s=25.0,
            ).angle_deg[-1]
        )
        for tilt in TILTS_DEG
    ]


def _final(finals: dict[str, list[float]]) -> Table:
    table = Table(title="final error after levelling for 25 s, deg (one seed)")
    table.add_column("filter")
    for tilt in TILTS_DEG:
        table.add_column(f"{tilt:g} deg", justify="right")
    for family, errors in finals.items():
        table.add_row(family, *(f"{angle:+.2f}" for angle in errors))
    return table


__all__ = ["reproduce"]
