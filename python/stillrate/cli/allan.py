"""``stillrate allan``: Allan deviation and the noise figures it shows."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, refuse_taken
from stillrate.cli.problems import UsageError, naming

if TYPE_CHECKING:
    from stillrate.allan_deviation import Allan

_NO_READING = ReadOptions()
_FIGURES = {
    "angle_random_walk": "angle random walk\n(deg/s)/√Hz",
    "bias_instability": "bias instability\ndeg/s",
    "rate_random_walk": "rate random walk\n(deg/s)/√s",
}


def command(
    source: Annotated[Path, Parameter(name="IN")],
    /,
    *,
    json: Path | None = None,
    picture: Path | None = None,
    confidence: float = 0.9,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Show the Allan deviation of a log at rest and the noise figures fitted to it.

    Parameters
    ----------
    source
        The log, at rest throughout.
    json
        Write curves and figures as JSON.
    picture
        Write a picture (PNG).
    confidence
        Probability inside each interval.
    """
    from rich.console import Console

    from stillrate.tables import plain_table
    from stillrate.tuning import allan_of

    if not 0 < confidence < 1:
        raise UsageError(f"--confidence {confidence} (must be between 0 and 1)")
    refuse_taken([path for path in (json, picture) if path], force=force)
    log = reading.read(source)
    with naming(source):
        found = {name: allan_of(log, index, confidence=confidence) for index, name in enumerate(log.channels)}
    title = f"{source.name}: {100 * confidence:g} % intervals"
    table = plain_table(title, ("channel", *_FIGURES.values()), words=("channel",))
    for name, curve in found.items():
        figures = [getattr(curve, figure) for figure in _FIGURES]
        table.add_row(name, *(f"{figure.value:.3g}\n[{figure.lower:.3g}, {figure.upper:.3g}]" for figure in figures))
    console = Console()
    console.print(table)
    for remark in log.timing.remarks():
        console.print(f"  {remark}", highlight=False)
    if json:
        _write_json(json, found, log.sample_rate_hz, force=force)
    if picture:
        _write_picture(picture, found, force=force)
    return 0


def _numbers(values: Any) -> list[float | None]:
    return [value if value == value and abs(value) != float("inf") else None for value in map(float, values)]


def _write_json(path: Path, found: dict[str, Allan], rate: float, *, force: bool) -> None:
    import json

    from stillrate.io.safely import write_text

    channels = {}
    for name, curve in found.items():
        entry: dict[str, Any] = {
            field: _numbers(getattr(curve, field)) for field in ("tau_s", "deviation", "lower", "upper")
        }
        for figure in _FIGURES:
            value = getattr(curve, figure)
            entry[figure] = dict(
                zip(("value", "lower", "upper"), _numbers((value.value, value.lower, value.upper)), strict=True)
            )
        channels[name] = entry
    write_text(path, json.dumps({"sample_rate_hz": rate, "channels": channels}, indent=1), force=force)


def _write_picture(path: Path, found: dict[str, Allan], *, force: bool) -> None:
    from stillrate.io.safely import atomic, needs

    figure: Any = needs("matplotlib.figure", "report", "a picture").Figure(
        figsize=(8, 5), dpi=110, layout="constrained"
    )
    axes = figure.add_subplot()
    for name, curve in found.items():
        (line,) = axes.loglog(curve.tau_s, curve.deviation, label=name)
        axes.fill_between(curve.tau_s, curve.lower, curve.upper, alpha=0.2, color=line.get_color(), linewidth=0)
    axes.set(xlabel="averaging time, s", ylabel="Allan deviation, deg/s")
    axes.grid(visible=True, which="both", alpha=0.25)
    axes.legend(frameon=False)
    with atomic(path, force=force) as temporary:
        figure.savefig(temporary, format="png")
