"""The page of a gimbal calibration: coefficients, what is wrong with them, and how each grew. One HTML file, no network."""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any

import numpy as np

from stillrate.gimbal import Calibration
from stillrate.io.safely import write_text
from stillrate.report.shell import still_page

UNITS = {
    "phi": ("urad", 1e6), "kg0": ("deg/h", 206264.80624709636), "kgI": ("deg/h/g", 206264.80624709636),
    "kgO": ("deg/h/g", 206264.80624709636), "kgS": ("deg/h/g", 206264.80624709636), "do_": ("urad", 1e6), "ds_": ("urad", 1e6),
    "thp": ("urad", 1e6), "tho": ("urad", 1e6), "ka0": ("ug", 1e6 / 9.80665), "ka1": ("ppm", 1e6), "tq_": ("ppm", 1e6),
    "ka2": ("ug/g^2", 9.80665e6), "lat": ("", 1.0),
}  # fmt: skip
"""First three letters of a name -> the unit people read it in, and its factor from SI."""

_POINTS = 240
_HELD = "held"
_OFF = 40.0
"""Curves leave the frame instead of running along its edge; so far outside they are cut."""


def unit(name: str) -> tuple[str, float]:
    """Return the unit a coefficient is shown in and the factor from SI."""
    if name == "latency":
        return "us", 1e6
    if name == "latitude":
        return "urad", 1e6
    return UNITS[name[:3]]


def render(found: Calibration, source: str, method: str) -> str:
    """Return the page as text."""
    title = f"Gimbal calibration of {source}"
    sigma = found.details["sigma_m_s2"]
    lead = f"Method {method}; noise of one sample {sigma:.3g} m/s²; {_tests(found)}"
    body = [
        f"<h1>{html.escape(title)}</h1><p>{html.escape(lead)}</p>",
        _flags(found),
        "<h2>Coefficients</h2><p>phi: attitude of the true against the commanded frame, at the start for the recommended and the batch "
        "method. bound: Cramer-Rao bound of this run.</p>",
        _table(found),
    ]
    if len(found.history.time_s) > 1:
        body += ["<h2>How each grew</h2><p>Line: estimate less its last value. Band: two standard deviations, where the method keeps "
                 "them. The vertical scale is set by the second half of the run.</p>", _pictures(found)]  # fmt: skip
    if found.weakest:
        body += ["<h2>Weakest directions</h2>", _weakest(found)]
    return still_page(title, "\n".join(body))


def write_page(path: Path, found: Calibration, source: str, method: str, *, force: bool = False) -> None:
    """Write the page.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    """
    write_text(path, render(found, source, method), force=force)


def _tests(found: Calibration) -> str:
    if not found.tests:
        return "this method has no residual tests."
    t = found.tests
    verdict = "the residual tests FAIL" if t["alarm"] else "the residual tests pass"
    return (
        f"{verdict}: mean square {t['mean_square']:.4f} ({t['mean_square_sigma']:+.1f} sigma from 1), "
        f"neighbour correlation {t['correlation_sigma']:.1f} sigma, {100 * t['skipped']:.2g} % of the measurements left out."
    )


def _flags(found: Calibration) -> str:
    """List what is wrong, worst first; what the gauge holds is a convention, not a fault."""
    held = [name for name, text in found.flags.items() if text.startswith(_HELD)]
    order = ("diverged", "residuals", "hidden")
    wrong = sorted(
        ((name, text) for name, text in found.flags.items() if name not in held),
        key=lambda flag: next((i for i, word in enumerate(order) if flag[0].startswith(word)), len(order)),
    )
    rows = "".join(f"<li><b class='bad'>{html.escape(k)}</b>: {html.escape(v)}</li>" for k, v in wrong)
    listed = f"<ul>{rows}</ul>" if rows else "<p>Nothing is flagged.</p>"
    convention = f"<p>Held at zero by the gauge: {', '.join(map(html.escape, held))}.</p>" if held else ""
    return f"<h2>Flags</h2>{listed}{convention}"


def _table(found: Calibration) -> str:
    head = "<tr><th>name</th><th>value</th><th>1 sigma</th><th>bound</th><th>unit</th><th></th></tr>"
    rows = []
    columns = zip(found.names, found.coefficients, found.standard_deviation, found.bound, strict=True)
    for name, value, deviation, limit in columns:
        label, factor = unit(name)
        flag = found.flags.get(name, "")
        if flag.startswith(_HELD):
            rows.append(
                f"<tr><td>{name}</td><td>{value * factor:.6g}</td><td>held</td><td></td><td>{label}</td><td></td></tr>"
            )
            continue
        bound = f"{limit * factor:.3g}" if np.isfinite(limit) else ""
        numbers = f"<td>{value * factor:.6g}</td><td>{deviation * factor:.3g}</td><td>{bound}</td>"
        rows.append(f"<tr><td>{name}</td>{numbers}<td>{label}</td><td class='text bad'>{html.escape(flag)}</td></tr>")
    return f"<div class='scroll'><table>{head}{''.join(rows)}</table></div>"


def _weakest(found: Calibration) -> str:
    rows = "".join(
        f"<tr><td>{value:.4g}</td><td class='text'>{html.escape(words)}</td></tr>" for value, words in found.weakest
    )
    return f"<p>Singular value: prior deviations over noise; below 2 the run says nothing.</p><table>{rows}</table>"


def _pictures(found: Calibration) -> str:
    parts = []
    for index, name in enumerate(found.names):
        if found.standard_deviation[index] == 0.0 or name.startswith("phi"):
            continue
        label, factor = unit(name)
        parts.append(f"<div><h3>{name} / {label}</h3>{_picture(found, index, factor)}</div>")
    return f"<div class='grid'>{''.join(parts)}</div>"


def _picture(found: Calibration, index: int, factor: float) -> str:
    """One curve with its band as SVG."""
    time = found.history.time_s
    step = max(1, len(time) // _POINTS)
    pick = slice(len(time) - 1, None, -step)
    t = time[pick][::-1]
    y = (found.history.coefficients[pick, index][::-1] - found.history.coefficients[-1, index]) * factor
    s = 2.0 * found.history.standard_deviation[pick, index][::-1] * factor
    half = len(t) // 2
    top = float(max(abs(y[half:]).max(), s[half:].max(), 1e-300)) * 1.1
    x_of = 300.0 * t / t[-1]

    def place(values: Any) -> str:
        return " ".join(
            f"{a:.1f},{60 - 55 * max(-_OFF, min(_OFF, b / top)):.1f}" for a, b in zip(x_of, values, strict=True)
        )

    band = f"{place(s)} {' '.join(reversed(place(-s).split()))}"
    return (
        f"<svg viewBox='0 0 300 120' preserveAspectRatio='none' role='img'><polygon class='band' points='{band}'/>"
        f"<line class='axis' x1='0' x2='300' y1='60' y2='60'/><polyline class='line' points='{place(y)}'/>"
        f"<text x='2' y='10'>{top / 1.1:.3g}</text><text x='2' y='117'>{-top / 1.1:.3g}</text>"
        f"<text x='298' y='117' text-anchor='end'>{t[-1]:.0f} s</text></svg>"
    )
