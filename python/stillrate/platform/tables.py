"""The study as tables for the terminal."""

from __future__ import annotations

from rich.table import Table

from stillrate.platform.goals import goals
from stillrate.platform.study import TILT_S, TILTS_DEG, Study


def _numbers(table: Table, heads: tuple[str, ...]) -> None:
    for head in heads:
        table.add_column(head, justify="right")


def results_table(study: Study) -> Table:
    """Return residual, jitter and margins by design."""
    setup = study.setup
    table = Table(
        title=f"{setup.amplitude_deg:g} deg at {setup.frequency_hz:g} Hz, control at {setup.sample_rate_hz:g} Hz; "
        "validation seeds, smallest - largest in brackets",
        caption="rest jitter: % of the supply, 6 to 14 s after a 15 deg tilt; after/undist.: the worst seed against undisturbed rest; "
        "level: error after 25 s, and the loop's own share; restarts: rms deg that each restart of the search reached; "
        f"* not every demand met; {study.effort}",
    )
    table.add_column("filter (budget %)")
    heads = (
        "rms deg",
        "max deg",
        "rest jitter %",
        "after/undist.",
        "motion %",
        "GM",
        "DM ms",
        "level deg",
        "added deg",
        "restarts",
    )
    _numbers(table, heads)
    for result in study.results:
        design, row = result.design, result.row
        table.add_row(
            f"{design.family} ({design.budget_percent:g}){'' if design.feasible else ' *'}",
            f"{row.rms_deg[0]:.2f}",
            f"{row.max_deg[0]:.2f} [{row.max_deg[1]:.2f} - {row.max_deg[2]:.2f}]",
            f"{row.jitter_percent:.4f} [{row.jitter_seeds[1]:.4f} - {row.jitter_seeds[2]:.4f}]",
            f"{result.recovery:.2f}",
            f"{row.motion_jitter_percent:.2f}",
            f"{row.gain_margin:g}",
            f"{row.delay_margin_ms:g}",
            f"{row.levelling_deg[0]:.2f}/{row.levelling_own_deg[0]:.2f}",
            f"{result.added_deg[0]:.3f}/{result.added_deg[1]:.3f}",
            result.reached,
        )
    return table


def goals_table(study: Study) -> Table:
    """Return what was hoped for beside what was found."""
    table = Table(title="what was hoped for, and what this run found")
    for head in ("goal", "asked", "found", ""):
        table.add_column(head, overflow="fold")
    for goal in goals(study):
        table.add_row(goal.what, goal.asked, goal.found, "holds" if goal.holds else "DOES NOT HOLD")
    return table


def tilts_table(study: Study) -> Table:
    """Return the peak angle of base tilts by design."""
    table = Table(title=f"peak angle while the base tilts in {TILT_S:g} s, deg (mean over both directions and seeds)")
    table.add_column("filter (budget %)")
    _numbers(table, tuple(f"{tilt:g} deg" for tilt in TILTS_DEG))
    for result in study.results:
        peaks = (f"{peak:.2f}" for peak in result.tilt_peaks_deg)
        table.add_row(f"{result.design.family} ({result.design.budget_percent:g})", *peaks)
    return table


def fixed_table(study: Study) -> Table:
    """Return what filters do when the controller stays the same."""
    table = Table(title="the same controller for every filter: the residual hardly moves, the actuator gets quieter")
    table.add_column("filter")
    _numbers(table, ("rms deg", "max deg", "residual", "rest jitter %", "quieter"))
    for swapped in study.swapped:
        table.add_row(
            swapped.name,
            f"{swapped.row.rms_deg[0]:.3f}",
            f"{swapped.row.max_deg[0]:.2f}",
            f"{swapped.change_percent:+.1f} %",
            f"{swapped.row.jitter_percent:.4f}",
            f"{swapped.quieter:.1f}x",
        )
    return table
