"""The report page: data and viewer in one HTML file.

The viewer is a few hundred lines of our own (`plot.js`, `touch.js`, `unpack.js`, `page.js`) rather than a plot library of megabytes:
the page of a short log stays small enough for a phone, and a long log is embedded whole, so that zooming ends at the
sample.
"""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any

import numpy as np

from stillrate.cleaning import Cleaned, View
from stillrate.io.safely import write_text
from stillrate.report import figures
from stillrate.report.packing import pack
from stillrate.report.shell import as_json, assemble, table
from stillrate.results import Flags

MAX_PAGE_BYTES = 7_500_000
"""Samples are packed more coarsely until the page is smaller."""

_MARKS = 2000
_FINEST = 32


def write_page(path: str | Path, done: Cleaned, *, force: bool = False) -> None:
    """Write the page of a filtered log.

    Parameters
    ----------
    path : str or Path
    done : Cleaned
        What `stillrate.cleaning.clean` returned; with ``views=True`` the page shows the models' probabilities too.
    force : bool
        Overwrite an existing file.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.

    Examples
    --------
    >>> import tempfile
    >>> from stillrate import demo
    >>> from stillrate.cleaning import clean, settings_for
    >>> log = demo.wave_log(demo.runs())
    >>> path = Path(tempfile.mkdtemp()) / "page.html"
    >>> write_page(path, clean(log, settings_for(log)[0], views=True))
    >>> "https://" in path.read_text(encoding="utf-8")  # nothing is fetched from elsewhere
    False
    """
    write_text(Path(path), render(done), force=force)


def render(done: Cleaned) -> str:
    """Return the page as text."""
    found = figures.axis_figures(done)
    coarse = 1.0
    while True:
        data = as_json(_data(done, found, coarse))
        if len(data) < MAX_PAGE_BYTES or coarse > 1e6:
            break
        coarse *= 2.0
    log = done.raw
    step = max(figure.before_dps for figure in found) * coarse / _FINEST
    return assemble(
        title=f"{log.meta.get('source', 'log')}: before and after",
        lead=f"{len(log):,} samples over {log.t_s[-1] - log.t_s[0]:.6g} s at {log.sample_rate_hz:.6g} Hz, "
        f"filtered with {next(iter(done.configs.values())).method}.",
        body="page.html",
        parts={
            "table": _table(found),
            "notes": _notes(done),
            "precision": f"Raw values are shown to {step:.2g} deg/s." if np.isfinite(step) else "",
        },
        data=data,
        scripts=("plot.js", "touch.js", "unpack.js", "page.js"),
    )


def _data(done: Cleaned, found: list[figures.AxisFigures], coarse: float) -> dict[str, Any]:
    log = done.raw
    channels = []
    for index, figure in enumerate(found):
        raw = figures.column(log.rate_dps, index)
        clean = figures.column(done.clean.rate_dps, index)
        config = done.configs[figure.channel]
        entry: dict[str, Any] = {
            "name": figure.channel,
            "raw": pack(raw, _step(figure.before_dps, coarse)),
            "clean": pack(clean, min(_step(figure.after_dps, coarse), _step(figure.before_dps, coarse))),
            "flags": _flags(done, index),
            "view": _view(done.views.get(figure.channel), config),
            "settings": config.to_toml(),
            "spectrum": figures.spectra(raw, clean, log),
            "allan": figures.allan_curves(raw, clean, log),
        }
        channels.append(entry)
    return {"count": len(log), "unit": "deg/s", "time": _time(done), "channels": channels}


def _step(scatter: float, coarse: float) -> float:
    return scatter / _FINEST * coarse if np.isfinite(scatter) and scatter > 0 else 1e-6 * coarse


def _time(done: Cleaned) -> dict[str, Any]:
    log = done.raw
    if log.timing.backward or log.timing.missing:
        # Stamps that jump back have no place on an axis: count samples instead.
        return {"start": 0.0, "step": 1.0 / log.sample_rate_hz}
    if log.timing.regular:
        return {"start": float(log.t_s[0]), "step": float(log.t_s[-1] - log.t_s[0]) / max(1, len(log) - 1)}
    return {"packed": pack(log.t_s, 1e-6, wide=True)}


def _flags(done: Cleaned, index: int) -> list[dict[str, Any]]:
    found = []
    for name, count in done.counts[done.raw.channels[index]].items():
        at = np.flatnonzero(done.flags[:, index] & Flags[name].value)
        found.append(
            {
                "name": name.lower().replace("_", " "),
                "count": count,
                "at": at[:: max(1, len(at) // _MARKS)].tolist(),
            }
        )
    return found


def _view(view: View | None, config: Any) -> dict[str, Any] | None:
    if view is None:
        return None
    names = model_names(config, view.probability.shape[1])
    models = [
        {"name": name, "probability": pack(np.asarray(view.probability[:, k], float), 1e-3)}
        for k, name in enumerate(names)
    ]
    frequency = None if not np.isfinite(view.frequency_hz).any() else pack(view.frequency_hz, 1e-3)
    return {
        "index": [int(view.index[0]), int(np.diff(view.index[:2])[0]) if len(view.index) > 1 else 1],
        "models": models,
        "frequency": frequency,
    }


def model_names(config: Any, count: int) -> list[str]:
    """Return a name for each model of a bank."""
    names: list[str] = []
    if config.method == "ms-imm-ikf":
        names = ["rest", *(f"moving, to {f:g} Hz" for f in config.ladder_hz or ())]
        names += [f"oscillation ± {width:g} rad/s" for width in config.oscillators or ()]
    elif count == 2:
        names = ["rest", "moving"]
    return names if len(names) == count else [f"model {k + 1}" for k in range(count)]


def _table(found: list[figures.AxisFigures]) -> str:
    head = (
        "channel",
        "noise density (deg/s)/√Hz",
        "quiet noise before, deg/s",
        "after, deg/s",
        "ratio",
        "taken away, deg/s RMS",
    )
    rows = []
    for figure in found:
        cells = [html.escape(cell) for cell in figure.cells()]
        cells[4] = f"<strong>{cells[4]}</strong>"
        rows.append(cells)
    return table(head, rows)


def _notes(done: Cleaned) -> str:
    found = figures.remarks(done)
    return "<ul class=small>" + "".join(f"<li>{html.escape(note)}</li>" for note in found) + "</ul>" if found else ""
