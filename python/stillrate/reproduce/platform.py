"""The servo section of the MS-IMM-IKF paper: table 1 and figures 12-13 beside our simulation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from rich.table import Table

from stillrate.platform import Constant, Plant, Setup, validate
from stillrate.platform.running import run_links
from stillrate.platform.shipped import SHIPPED
from stillrate.platform.study import (
    BANK,
    PLATFORM,
    TILT_S,
    TILTS_DEG,
    Design,
    Result,
    Study,
    filled_links,
    fixed_test,
    measure,
)
from stillrate.platform.tables import fixed_table
from stillrate.platform.tuning import VALIDATION_SEEDS, families
from stillrate.platform.tuning import Row as Measured
from stillrate.reproduce.progress import Advance, parts, unwatched
from stillrate.reproduce.row import NOT_REPRODUCED, REPRODUCED, Row, around

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
SEEDS, SHORT_SEEDS = 6, 2


@dataclass(frozen=True)
class Found:
    """Everything measured once, for tables and rows."""

    results: list[Result]
    fixed: tuple[tuple[str, Measured], ...]
    finals: dict[str, list[float]]
    seeds: tuple[int, ...]


def study(seeds: int = SEEDS, advance: Advance = unwatched) -> Found:
    """Measure the shipped designs of the paper's filters on validation seeds."""
    setup = Setup()
    chosen = [
        d for d in SHIPPED if d.family in PUBLISHED_TILTS and d.budget_percent == BUDGET_PERCENT and d.plant == PLATFORM
    ]
    used = tuple(VALIDATION_SEEDS[:seeds])
    at_50_hz = [design for design in chosen if design.sample_rate_hz == 50.0]
    results = [measure(design, setup=setup, seeds=used) for design in parts(at_50_hz, advance, end=0.5)]
    fixed = tuple(fixed_test(setup, seeds=used))
    finals = {design.family: _final_errors(design) for design in parts(chosen, advance, begin=0.9)}
    return Found(results, fixed, finals, used)


def rows(short: bool = False, advance: Advance = unwatched) -> list[Row]:
    """Return table 1, figures 12-13 and the claims of the servo section; the short form uses 2 seeds."""
    found = study(SHORT_SEEDS if short else SEEDS, advance)
    return [*_figures(found), *_claims(found)]


def reproduce() -> Iterator[Table | str]:
    """Compute the tables; what is yielded is for a rich console."""
    found = study()
    yield _tilts(found.results)
    yield _swing(found.results)
    yield _final(found.finals)
    yield fixed_table(Study(setup=Setup(), results=(), fixed=found.fixed))
    yield _verdicts(_claims(found))
    yield UNKNOWN


def _verdict(holds: bool) -> str:
    return REPRODUCED if holds else NOT_REPRODUCED


def _row(quantity: str, published: str, ours: float | None, unit: str = "", **more: Any) -> Row:
    return Row(study="platform", quantity=quantity, published=published, ours=ours, unit=unit, **more)


def _figures(found: Found) -> Iterator[Row]:
    """Yield every figure of table 1 and of figures 12-13."""
    effort = f"{len(found.seeds)} seeds"
    tilt = f"taken as the peak of a tilt in {TILT_S:g} s; tilt time and gains are not in the paper"
    for result in found.results:
        name = result.design.family
        for angle, theirs, ours in zip(TILTS_DEG, PUBLISHED_TILTS[name], result.tilt_peaks_deg, strict=True):
            what = f"table 1: error at a tilt of {angle:g} deg, {name}"
            # The peaks are the mean of both directions over the first three seeds.
            yield _row(
                what,
                f"{theirs:.2f}",
                ours,
                "deg",
                **around(theirs, NEAR),
                reason=tilt,
                effort=f"{min(3, len(found.seeds))} seeds",
            )
    for result in found.results:
        name, published = result.design.family, PUBLISHED_SWING[result.design.family]
        limit = published.removeprefix("< ")
        near = around(float(limit), NEAR) if limit == published else {"most": float(limit)}
        stands = "; for the published bank stands the default bank with a low-pass" if "+" in name else ""
        yield _row(
            f"fig. 12-13: largest error at 10 deg and 1 Hz, {name}", published, result.row.max_deg[0], "deg", **near,
            reason=f"tuned at {BUDGET_PERCENT:g} % rest jitter, a budget of ours{stands}", effort=effort,
        )  # fmt: skip


def _claims(found: Found) -> Iterator[Row]:
    """Judge every claim of the servo section by figures of this run."""
    effort = f"{len(found.seeds)} seeds"
    peaks = {result.design.family: result.tilt_peaks_deg for result in found.results}
    largest = {result.design.family: result.row.max_deg[0] for result in found.results}
    order = sorted(largest, key=lambda name: -largest[name])
    published_order = list(PUBLISHED_SWING)
    pairs = [(a, b) for i, a in enumerate(published_order) for b in published_order[i + 1 :]]
    yield _row(
        "fig. 12-13: order at 10 deg, 1 Hz, pairs of filters in the published order", f"{len(pairs)} of {len(pairs)}",
        float(sum(largest[a] > largest[b] for a, b in pairs)), least=len(pairs), most=len(pairs),
        reason=f"ours: {' > '.join(order)}", effort=effort,
    )  # fmt: skip
    small = 100.0 * (largest["kalman-5.3hz"] / largest["none"] - 1.0)
    yield _row(
        "fig. 12: the Kalman filter alone changes little", "-6", small, "%", least=-15.0, most=0.0, effort=effort
    )
    growth = min(v[i] / v[i + 1] for v in peaks.values() for i in range(len(TILTS_DEG) - 1))
    ratios = ", ".join(f"{v[0] / v[-1]:.1f}" for v in PUBLISHED_TILTS.values())
    yield _row(
        "table 1: error grows with the tilt, least ratio of neighbours", "above 1", growth, least=1.0, effort=effort,
        reason=f"20 deg over 5 deg: published {ratios}, ours {', '.join(f'{peaks[n][0] / peaks[n][-1]:.1f}' for n in PUBLISHED_TILTS)}",
    )  # fmt: skip
    worst = max(abs(final) for finals_of in found.finals.values() for final in finals_of)
    first = [v[0] for v in PUBLISHED_TILTS.values()]
    yield _row(
        "table 1 as the error that stays, at 20 deg", f"{min(first)} to {max(first)}", worst, "deg", effort="1 seed",
        least=(1.0 - NEAR) * min(first), most=(1.0 + NEAR) * max(first),
        reason="the loop levels: after 25 s hardly anything stays, with any filter",
    )  # fmt: skip
    raw, bank = dict(found.fixed)["none"], dict(found.fixed)[BANK]
    change = 100.0 * (bank.max_deg[0] / raw.max_deg[0] - 1.0)
    yield _row(
        "a better filter at the same PID: change of the error", "-50", change, "%", **around(-50.0, 0.5), effort=effort,
        reason="with the same gains the filter changes the actuator's noise, hardly the error",
    )  # fmt: skip
    yield _play_and_friction(found)
    yield _row("PID, delay, spindle lead, tilt time, number of runs", "not stated", None, reason=UNKNOWN)


def _play_and_friction(found: Found) -> Row:
    """Put the blame to the test: the residual without a filter, with more play and with twice the friction."""
    result = next(r for r in found.results if r.design.family == "none")
    plant = Plant.platform_30kg()
    changed = (
        plant.replace(half_backlash_rad=4.0 * plant.half_backlash_rad),
        plant.replace(coulomb_n_m=2.0 * plant.coulomb_n_m, stiction_n_m=2.0 * plant.stiction_n_m),
    )
    family = families(Setup())["none"]
    measured = [
        validate(family, result.design.controller, setup=Setup(plant=p), seeds=found.seeds, margin_seeds=0)
        for p in changed
    ]
    change = [100.0 * (row.max_deg[0] / result.row.max_deg[0] - 1.0) for row in measured]
    return _row(
        "play and friction cause the error: the larger change by play x4 or friction x2", "main cause", max(change), "%",
        least=25.0, reason=f"play x4 {change[0]:+.0f} %, friction x2 {change[1]:+.0f} %", effort=f"{len(found.seeds)} seeds",
    )  # fmt: skip


def _verdicts(claims: Iterator[Row]) -> Table:
    table = Table(title="what is and what is not reproduced")
    for head in ("claim", "paper", "ours", "verdict", "why"):
        table.add_column(head, overflow="fold")
    for claim in claims:
        ours = "" if claim.ours is None else f"{claim.ours:.2f} {claim.unit}"
        table.add_row(claim.quantity, claim.published, ours, claim.verdict, claim.reason)
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


__all__ = ["Found", "reproduce", "rows", "study"]
