"""The servo section of the MS-IMM-IKF paper: table 1 and figures 12-13 beside our simulation."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from stillrate.platform import Constant, Setup
from stillrate.platform.shipped import SHIPPED
from stillrate.platform.study import TILTS_DEG, Design, Result, fixed_test, measure
from stillrate.platform.tables import fixed_table
from stillrate.platform.tuning import VALIDATION_SEEDS

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

REPRODUCED = (
    "error nearly proportional to the tilt, the same in both directions",
    "at 10 deg and 1 Hz: no filter > Kalman filter > Singer-IMM > MS-IMM-IKF; the Kalman filter alone changes little "
    "(and nothing in tilts)",
    "the magnitudes, with a base that tilts in 0.3 to 0.4 s (not stated in the paper)",
)
NOT_REPRODUCED = (
    "Singer-IMM below 3 deg at 10 deg and 1 Hz: our search ended at 3.4 deg at this budget",
    "the errors of table 1 as FINAL errors: ours are below 0.3 deg at every tilt for every filter. A third of the tilt "
    "cannot come from gyro noise (0.12 deg in 60 s), scale factor or filtering; it is the peak of a transient",
    "an improvement with the same PID: the residual does not move (last table); it needs the gains that a quieter "
    "filter permits",
    "'backlash and friction accumulate': play and friction change the residual by a few percent, it is loop bandwidth",
    "MS-IMM-IKF behind Singer at +15 deg (3.78 against 3.59): inside the paper's own scatter",
)
UNKNOWN = (
    "PID, delay, spindle lead and tilt time are not in the paper; the jitter budget of 0.05 % is ours, chosen as raw "
    "lands near 5 deg there: only the ordering is a result."
)


def reproduce() -> Iterator[Table | str]:
    """Compute the tables; what is yielded is for a rich console."""
    setup = Setup()
    chosen = [d for d in SHIPPED if d.family in PUBLISHED_TILTS and d.budget_percent == BUDGET_PERCENT]
    seeds = VALIDATION_SEEDS[:6]
    results = [measure(design, setup=setup, seeds=seeds) for design in chosen if design.sample_rate_hz == 50.0]
    yield _tilts(results)
    yield _swing(results)
    yield _final(chosen)
    yield "Reproducible:\n" + "\n".join(f"  - {line}" for line in REPRODUCED)
    yield "Not reproduced:\n" + "\n".join(f"  - {line}" for line in NOT_REPRODUCED)
    yield "Unknown: " + UNKNOWN
    from stillrate.platform.study import Study

    yield fixed_table(Study(setup=setup, results=(), fixed=tuple(fixed_test(setup, seeds=seeds))))


def _tilts(results: list[Result]) -> Table:
    table = Table(title="table 1: error at a tilt of the base, deg; published / ours (peak, base tilts in 0.4 s)")
    table.add_column("filter")
    for tilt in TILTS_DEG:
        table.add_column(f"{tilt:g} deg", justify="right")
    for result in results:
        published = PUBLISHED_TILTS[result.design.family]
        pairs = zip(published, result.tilt_peaks_deg, strict=True)
        table.add_row(result.design.family, *(f"{theirs:.2f} / {ours:.2f}" for theirs, ours in pairs))
    return table


def _swing(results: list[Result]) -> Table:
    table = Table(title=f"figures 12-13: 10 deg at 1 Hz, tuned at {BUDGET_PERCENT:g} % rest jitter")
    table.add_column("filter")
    for head in ("published max", "our max", "our rms", "rest jitter %"):
        table.add_column(head, justify="right")
    for result in results:
        row, name = result.row, result.design.family
        table.add_row(
            name,
            PUBLISHED_SWING[name],
            f"{row.max_deg[0]:.2f} [{row.max_deg[1]:.2f} - {row.max_deg[2]:.2f}]",
            f"{row.rms_deg[0]:.2f}",
            f"{row.jitter_percent:.4f}",
        )
    return table


def _final(designs: list[Design]) -> Table:
    """Level from each tilt: the error that stays."""
    from stillrate.platform.running import run_links
    from stillrate.platform.study import filled_links
    from stillrate.platform.tuning import families

    setup = Setup()
    table = Table(title="final error after levelling for 25 s, deg (one seed)")
    table.add_column("filter")
    for tilt in TILTS_DEG:
        table.add_column(f"{tilt:g} deg", justify="right")
    for design in designs:
        chain = filled_links(families(setup)[design.family], design.parameters)
        finals = [
            run_links(
                Constant(angle_deg=tilt),
                chain,
                setup=setup,
                controller=design.controller,
                seed=VALIDATION_SEEDS[0],
                start_deg=tilt,
                duration_s=25.0,
            ).angle_deg[-1]
            for tilt in TILTS_DEG
        ]
        table.add_row(design.family, *(f"{angle:+.2f}" for angle in finals))
    return table


__all__ = ["reproduce"]
