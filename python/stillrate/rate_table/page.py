"""The report page of a calibration: error curve, candidates with their held-out scores, residuals; one HTML file."""

from __future__ import annotations

import html
from pathlib import Path

import numpy as np

from stillrate.io.safely import atomic
from stillrate.rate_table.drawing import Line, picture
from stillrate.rate_table.model import ErrorModel
from stillrate.rate_table.parts import Calibration, Floats, told

_STYLE = (
    ":root{color-scheme:light dark}body{font:15px/1.5 system-ui,sans-serif;max-width:56rem;"
    "margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse;margin:.6rem 0;font-variant-numeric:tabular-nums}"
    "th,td{padding:.25rem .7rem;border-bottom:1px solid #8884;text-align:right}"
    "th:first-child,td:first-child,th:last-child,td:last-child{text-align:left}"
    "svg{width:100%;height:auto}.chosen{font-weight:600}"
    ".scroll{overflow-x:auto}"
)


def write_page(path: str | Path, model: ErrorModel, source: str, *, force: bool = False) -> None:
    """Write the page of a model that was just fitted.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    """
    text = render(model, source)
    with atomic(Path(path), force=force) as temporary:
        temporary.write_text(text, encoding="utf-8")


def render(model: ErrorModel, source: str) -> str:
    """Return the page as text."""
    title = html.escape(f"{source}: error over the rate")
    score = model.score()
    parts = [
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{_STYLE}</style></head><body>',
        f"<h1>{title}</h1>",
        f"<p>Chosen: <b>{html.escape(model.kind)}</b>, {model.low_dps:g} .. {model.high_dps:g} deg/s, {model.rates} distinct rates. "
        f"Systematic error {score.raw_dps:.3g} deg/s RMS uncorrected, "
        f"<b>{score.corrected_dps:.3g}</b> at rates left out of the fit. "
        f"Steepest slope {model.steepest_slope():.3g} (limit {model.slope_limit:g}).</p>",
        "<p>Outside the calibrated range the value at the edge is held and flagged. The figures are about the systematic error; "
        "noise and slow drift are a filter's business.</p>",
    ]
    if model.calibration is not None:
        parts += [
            _curve(model, model.calibration),
            _candidates(model, model.calibration),
            _residuals(model.calibration),
        ]
    return "\n".join([*parts, "</body></html>"]) + "\n"


def _temperatures(model: ErrorModel) -> list[tuple[float | None, str]]:
    """Return the temperatures at which the curve is drawn, with a colour each."""
    if model.temperature_range_c is None:
        return [(None, "#1467c8")]
    low, high = model.temperature_range_c
    return list(zip((low, 0.5 * (low + high), high), ("#1467c8", "#2a9d5c", "#c8102e"), strict=True))


def _curve(model: ErrorModel, points: Calibration) -> str:
    room = 0.1 * (model.high_dps - model.low_dps)
    grid = np.linspace(model.low_dps - room, model.high_dps + room, 401)
    lines = []
    for degrees, colour in _temperatures(model):
        name = f"{model.kind}, edges held" + ("" if degrees is None else f", {degrees:.3g} °C")
        lines.append(Line(name, grid, model.predict(grid, degrees), colour))
    lines.append(_marks("segments", points, points.error_dps, "#e0884a"))
    return picture("Error curve", "true rate, deg/s", "measured less true, deg/s", lines)


def _marks(name: str, points: Calibration, values: Floats, colour: str) -> Line:
    """Return a mark a calibration point with a bar of two standard errors."""
    bars = 2.0 * points.standard_error_dps
    return Line(f"{name}, two standard errors", points.rate_dps, values, colour, marks=True, error=bars)


def _candidates(model: ErrorModel, points: Calibration) -> str:
    rows = []
    for found in points.candidates:
        cells = "".join(f"<td>{html.escape(cell)}</td>" for cell in told(found, model.kind))
        rows.append(f'<tr class="{"chosen" if found.name == model.kind else ""}">{cells}</tr>')
    return (
        '<h2>Candidates</h2><div class="scroll"><table><tr><th>curve</th><th>left-out rates, deg/s RMS</th>'
        "<th>fitted rates, deg/s RMS</th><th>steepest slope</th><th></th></tr>" + "".join(rows) + "</table></div>"
        f"<p>Without correction: {model.uncorrected_dps:.4g} deg/s RMS.</p>"
    )


def _residuals(points: Calibration) -> str:
    line = _marks("residual", points, points.residual_dps, "#1467c8")
    zero = Line("zero", np.array([points.rate_dps.min(), points.rate_dps.max()]), np.zeros(2), "#999999")
    rows = "".join(
        f"<tr><td>{rate:.5g}</td><td>{'' if np.isnan(degrees) else f'{degrees:.4g}'}</td>"
        f"<td>{error:.4g}</td><td>{se:.2g}</td><td>{residual:.4g}</td><td>{count:.0f}</td></tr>"
        for rate, degrees, error, se, residual, count in zip(
            points.rate_dps,
            points.temperature_c,
            points.error_dps,
            points.standard_error_dps,
            points.residual_dps,
            points.samples,
            strict=True,
        )
    )
    return (
        picture("Residuals", "true rate, deg/s", "deg/s", [zero, line])
        + '<h2>Segments</h2><div class="scroll"><table><tr><th>rate, deg/s</th><th>°C</th><th>error</th>'
        f"<th>standard error</th><th>residual</th><th>samples</th></tr>{rows}</table></div>"
    )
