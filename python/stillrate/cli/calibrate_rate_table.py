"""``stillrate calibrate rate-table``: a turntable log in, an error model out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, refuse_taken
from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    import numpy.typing as npt
    from rich.table import Table

    from stillrate.io import Log
    from stillrate.rate_table import ErrorModel

_NO_READING = ReadOptions()


def command(
    source: Annotated[Path, Parameter(name="IN")],
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    true: str | None = None,
    table_rates: str | None = None,
    channel: str | None = None,
    temperature: str | None = None,
    slope_limit: float = 0.1,
    report: Path | None = None,
    quiet: Annotated[bool, Parameter(negative="")] = False,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Fit the error of a gyro over its rate (and temperature) from a turntable log.

    The curve is chosen by predicting rates that were left out; outside the calibrated range its edge value is held.

    Parameters
    ----------
    source
        The log: CSV, TSV, Parquet, npz, ...
    output
        Where the model goes (JSON).
    true
        Column with the true rate in deg/s.
    table_rates
        Instead of it, the rates the table was set to, separated by commas; the segments are found in the log.
    channel
        The gyro's column, where the log has several.
    temperature
        Column with the temperature; give it if the unit drifts with temperature.
    slope_limit
        Curves steeper than this are refused.
    report
        Write a page with the curve, the scores and the residuals as well (HTML).
    quiet
        No table.
    """
    from stillrate import rate_table
    from stillrate.errors import LogError

    if (true is None) == (table_rates is None):
        raise UsageError("give either --true COLUMN or --table-rates RATE,RATE,...")
    refuse_taken([output, *([report] if report else [])], force=force)
    log = reading.read(source)
    try:
        measured = _measured(log, channel, {true, temperature})
        truth = _column(log, true) if true is not None else _rates(table_rates or "")
        degrees = None if temperature is None else _column(log, temperature)
        model = rate_table.fit(measured, truth, degrees, sample_rate_hz=log.sample_rate_hz, slope_limit=slope_limit)
    except LogError as error:
        raise LogError(f"{source}: {error}") from None
    model.save(output, force=force)
    if report is not None:
        from stillrate.rate_table.page import write_page

        write_page(report, model, source.name, force=force)
    if not quiet:
        from rich.console import Console

        console = Console(stderr=True)
        console.print(_summary(model))
        console.print(_verdict(model), highlight=False, markup=False, soft_wrap=True)
        console.print(
            f"wrote {output}" + (f" and {report}" if report else ""), highlight=False, markup=False, soft_wrap=True
        )
    return 0


def _rates(text: str) -> npt.NDArray[np.float64]:
    try:
        return np.array([float(part) for part in text.split(",")])
    except ValueError:
        raise UsageError(f"--table-rates {text}: must be numbers separated by commas") from None


def _column(log: Log, name: str) -> npt.NDArray[np.float64]:
    """Return a column by name, be it a channel or one of the rest."""
    from stillrate.errors import LogError

    if name in log.channels:
        return np.ascontiguousarray(log.rate_dps[:, log.channels.index(name)])
    if name not in log.columns:
        raise LogError(f"no column {name!r} (there are {', '.join([*log.channels, *log.columns])})")
    try:
        return np.asarray(log.columns[name], dtype=np.float64)
    except ValueError:
        raise LogError(f"column {name!r} does not hold numbers") from None


def _measured(log: Log, channel: str | None, others: set[str | None]) -> npt.NDArray[np.float64]:
    from stillrate.errors import LogError

    if channel is not None:
        return _column(log, channel)
    candidates = [name for name in log.channels if name not in others]
    if len(candidates) != 1:
        raise LogError(
            f"the log has {len(candidates)} rate columns ({', '.join(candidates)}): choose one with --channel"
        )
    return _column(log, candidates[0])


def _summary(model: ErrorModel) -> Table:
    from rich import box
    from rich.table import Table

    from stillrate.rate_table.parts import told

    table = Table(title="Candidates, deg/s RMS", box=box.SIMPLE_HEAD, title_justify="left")
    for name in ("curve", "left-out rates", "fitted rates", "steepest slope", ""):
        table.add_column(name, justify="left" if name in ("curve", "") else "right")
    for found in model.calibration.candidates if model.calibration else ():
        table.add_row(*told(found, model.kind))
    return table


def _verdict(model: ErrorModel) -> str:
    score = model.score()
    return (
        f"{model.kind} over {model.low_dps:g} .. {model.high_dps:g} deg/s from {model.rates} rates: systematic error "
        f"{score.raw_dps:.3g} deg/s RMS without, {score.corrected_dps:.3g} with the model at rates it had not seen"
    )
