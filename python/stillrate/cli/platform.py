"""``stillrate platform``: what a filter does to a stabilised platform, in tables and on a page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from stillrate.cli.options import Force, refuse_taken
from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from stillrate.platform import Recorded, Run, Setup
    from stillrate.platform.study import Design, Result, Study

EFFORTS = {"quick": (120, 1), "normal": (600, 2), "thorough": (2400, 3)}
"""Evaluations and restarts of the search: one effort for every filter of a table; the shipped designs had the last."""
BUDGETS = {"platform": (0.05, 0.02), "gimbal": (0.002,)}
"""Rest jitter allowed where none is given, percent of the supply."""


def command(
    *,
    rate: float = 50.0,
    budget: Annotated[list[float] | None, Parameter(negative="")] = None,
    filters: str | None = None,
    tune: Annotated[bool, Parameter(negative="")] = False,
    effort: str = "normal",
    gimbal: Annotated[bool, Parameter(negative="")] = False,
    recording: Path | None = None,
    column: str | None = None,
    seeds: int = 16,
    report: Path | None = None,
    quiet: Annotated[bool, Parameter(negative="")] = False,
    force: Force = False,
) -> int:
    """Compare filters in the loop of a stabilised platform.

    Shows the shipped designs (30 kg platform, 50 Hz) on noise seeds their tuner did not see, or tunes new ones.

    Parameters
    ----------
    rate
        Control rate in Hz.
    budget
        Rest jitter allowed, percent of the supply voltage; may be repeated. Default 0.05 and 0.02 (gimbal: 0.002).
    filters
        Names separated by commas; default all.
    tune
        Tune controller and filter anew, with the same effort for every filter; none begins with a design of its own.
    effort
        quick, normal or thorough (120, 600 or 2400 evaluations a filter and budget).
    gimbal
        A small camera gimbal at 200 Hz in place of the 30 kg platform.
    recording
        A log whose rate moves the base as well.
    column
        Its column; default the first rate.
    seeds
        Validation seeds, 2 to 16.
    report
        Write a page with pictures and an animation (HTML).
    quiet
        No progress bar.
    """
    from rich.console import Console

    from stillrate.platform import Setup
    from stillrate.platform.study import GIMBAL, PLATFORM

    if effort not in EFFORTS:
        raise UsageError(f"--effort {effort} (must be one of {', '.join(EFFORTS)})")
    if not 2 <= seeds <= 16:
        raise UsageError(f"--seeds {seeds} (must be from 2 to 16)")
    refuse_taken([report] if report else [], force=force)
    setup = Setup.camera_gimbal() if gimbal else Setup(sample_rate_hz=rate)
    motion = _recorded(recording, column, setup) if recording is not None else None
    console = Console(stderr=True, quiet=quiet)
    designs = _designs(setup, budget, filters, GIMBAL if gimbal else PLATFORM, effort if tune else None, console)
    found = _measured(setup, designs, seeds, motion, console)
    _show(found)
    if report is not None:
        from stillrate.platform.page import write

        write(found, report, force=force)
        console.print(f"wrote {report}", highlight=False, markup=False, soft_wrap=True)
    return 0


def _recorded(path: Path, column: str | None, setup: Setup) -> Recorded:
    from stillrate.io import read
    from stillrate.platform import Recorded

    log = read(path)
    if column is not None and column not in log.channels:
        raise UsageError(f"--column {column} (the log has {', '.join(log.channels)})")
    index = 0 if column is None else list(log.channels).index(column)
    return Recorded(rate_dps=log.rate_dps[:, index], sample_rate_hz=log.sample_rate_hz, range_deg=setup.range_deg)


def _designs(
    setup: Setup, budgets: list[float] | None, names: str | None, plant: str, effort: str | None, console: Console
) -> list[Design]:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from stillrate.platform import families
    from stillrate.platform.shipped import SHIPPED
    from stillrate.platform.study import carried_over, tune_all

    wanted = [name.strip() for name in names.split(",")] if names else list(families(setup))
    unknown = [name for name in wanted if name not in families(setup)]
    if unknown:
        raise UsageError(f"--filters {unknown[0]} (must be among {', '.join(families(setup))})")
    known = [d for d in SHIPPED if d.plant == plant and d.sample_rate_hz == setup.sample_rate_hz]
    if effort is None:
        chosen = [d for d in known if d.family in wanted and (budgets is None or d.budget_percent in budgets)]
        if not chosen:
            raise UsageError("no shipped design for this rate, budget and filter: add --tune")
        return chosen
    budgets = budgets or list(BUDGETS[plant])
    each = EFFORTS[effort][0]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    found: list[Design] = []
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("tuning", total=each * len(wanted) * len(budgets))
        for budget in budgets:
            for name in wanted:
                before = bar.tasks[0].completed

                def step(family: str, done: int, before: float = before, budget: float = budget) -> None:
                    bar.update(task, completed=before + done, description=f"tuning {family} at {budget:g} %")

                found += tune_all([name], budget, setup=setup, effort=EFFORTS[effort], progress=step, plant=plant)
    return carried_over(found)


def _measured(setup: Setup, designs: list[Design], seeds: int, motion: Recorded | None, console: Console) -> Study:
    from rich.progress import track

    from stillrate.platform import Sine
    from stillrate.platform.study import Study, describing_test, fixed_test, measure, show
    from stillrate.platform.tuning import VALIDATION_SEEDS

    chosen = VALIDATION_SEEDS[:seeds]
    results = tuple(
        measure(design, setup=setup, seeds=chosen) for design in track(designs, "validating", console=console)
    )
    base = Sine(amplitude_deg=setup.amplitude_deg, frequency_hz=setup.frequency_hz)
    looked_at = _worth_showing(results)
    runs = tuple((design.label, show(design, base, setup=setup, duration_s=8.0)) for design in looked_at)
    recorded: tuple[tuple[str, Run], ...] = ()
    if motion is not None:
        length = min(60.0, len(motion.rate_dps) / motion.sample_rate_hz)
        recorded = tuple((design.label, show(design, motion, setup=setup, duration_s=length)) for design in looked_at)
    fixed = tuple(fixed_test(setup, seeds=chosen)) if setup.sample_rate_hz == 50.0 else ()
    described = tuple(describing_test(setup)) if setup.sample_rate_hz == 50.0 else ()
    notes = tuple(dict.fromkeys(f"{name}: {text}" for name, run in (*runs, *recorded) for text in run.warnings))
    return Study(
        setup=setup,
        results=results,
        fixed=fixed,
        describing=described,
        runs=runs,
        recorded=recorded,
        notes=notes,
        seeds=seeds,
    )


def _worth_showing(results: tuple[Result, ...]) -> list[Design]:
    """At most four designs: one a filter, no filter first, then by residual."""
    by_name: dict[str, Result] = {}
    for result in results:
        held = by_name.get(result.design.family)
        if held is None or result.design.budget_percent > held.design.budget_percent:
            by_name[result.design.family] = result
    ordered = sorted(by_name.values(), key=lambda r: (r.design.family != "none", r.row.max_deg[0]))
    return [result.design for result in ordered[:4]]


def _show(study: Study) -> None:
    from rich.console import Console

    from stillrate.platform.findings import findings
    from stillrate.platform.tables import fixed_table, goals_table, results_table, tilts_table

    out = Console(width=165, soft_wrap=True)
    out.print(results_table(study))
    out.print(tilts_table(study))
    if study.fixed:
        out.print(fixed_table(study))
    judged = goals_table(study)
    if judged.row_count:
        out.print(judged)
    for text in findings(study.results):
        out.print(text, highlight=False, markup=False)
    for name, run in study.recorded:
        out.print(
            f"recorded base, {name}: rms {run.residual_deg[0]:.3f}, max {run.residual_deg[1]:.2f} deg",
            highlight=False,
            markup=False,
        )
    for note in study.notes:
        out.print(f"note: {note}", highlight=False, markup=False)
