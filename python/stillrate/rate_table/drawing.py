"""Line drawings as SVG text: small enough to stand inside a page, no library needed to look at them."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stillrate.rate_table.parts import Floats

WIDTH, HEIGHT = 760, 380
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 16, 34, 46


@dataclass(frozen=True)
class Line:
    """One curve: its name, x and y of equal length, its colour; `marks` draws points, `error` adds bars."""

    name: str
    x: Floats
    y: Floats
    colour: str
    marks: bool = False
    error: Floats | None = None


def draw(path: Path, title: str, x_label: str, y_label: str, lines: Sequence[Line], **options: object) -> None:
    """Write a drawing to a file."""
    path.write_text(picture(title, x_label, y_label, lines, **options), encoding="utf-8")  # type: ignore[arg-type]


def picture(
    title: str,
    x_label: str,
    y_label: str,
    lines: Sequence[Line],
    *,
    ticks: Sequence[str] = (),
    logarithmic: bool = False,
) -> str:
    """Return a drawing as SVG text; `ticks` names whole numbers on the x axis."""
    bottom = _BOTTOM + (110 if ticks else 0)
    height = HEIGHT + (110 if ticks else 0)

    def scaled(y: Floats) -> Floats:
        return np.log10(np.maximum(y, 1e-12)) if logarithmic else np.asarray(y)

    xs = np.concatenate([line.x for line in lines])
    ys = np.concatenate([scaled(line.y) for line in lines])
    ys = ys[np.isfinite(ys)]
    (x0, x1), (y0, y1) = _span(xs), _span(ys, 0.06)

    def px(x: float) -> float:
        return _LEFT + (x - x0) / (x1 - x0) * (WIDTH - _LEFT - _RIGHT)

    def py(y: float) -> float:
        return _TOP + (y1 - y) / (y1 - y0) * (height - _TOP - bottom)

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        'font-family="system-ui, sans-serif" font-size="12" fill="currentColor">',
        f"<title>{html.escape(title)}</title>",
        f'<text x="{_LEFT}" y="16" font-size="14" font-weight="600">{html.escape(title)}</text>',
    ]
    for value in _nice(y0, y1):
        label = f"{10**value:.3g}" if logarithmic else f"{value:.4g}"
        out.append(
            f'<line x1="{_LEFT}" x2="{WIDTH - _RIGHT}" y1="{py(value):.1f}" y2="{py(value):.1f}" '
            'stroke="currentColor" stroke-opacity="0.15"/>'
            f'<text x="{_LEFT - 6}" y="{py(value) + 4:.1f}" text-anchor="end">{label}</text>'
        )
    if ticks:
        for k, name in enumerate(ticks):
            x, y = px(float(k)), height - bottom + 12
            out.append(
                f'<text x="{x:.1f}" y="{y}" text-anchor="end" transform="rotate(-40 {x:.1f} '
                f'{y})">{html.escape(name)}</text>'
            )
    else:
        out += [
            f'<text x="{px(v):.1f}" y="{height - bottom + 16}" text-anchor="middle">{v:.4g}</text>'
            for v in _nice(x0, x1)
        ]
        out.append(f'<text x="{WIDTH / 2}" y="{height - 8}" text-anchor="middle">{html.escape(x_label)}</text>')
    out.append(
        f'<text transform="translate(14 {height / 2}) rotate(-90)" text-anchor="middle">{html.escape(y_label)}</text>'
    )
    for k, line in enumerate(lines):
        heights = scaled(line.y)
        points = [(px(float(a)), py(float(b))) for a, b in zip(line.x, heights, strict=True) if math.isfinite(b)]
        if not line.marks:
            path = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
            out.append(f'<polyline fill="none" stroke="{line.colour}" stroke-width="1.6" points="{path}"/>')
        if line.marks or ticks:
            out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{line.colour}"/>' for a, b in points]
        if line.error is not None:
            for a, b, e in zip(line.x, line.y, line.error, strict=True):
                x = px(float(a))
                out.append(
                    f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{py(float(b - e)):.1f}" '
                    f'y2="{py(float(b + e)):.1f}" stroke="{line.colour}"/>'
                )
        out.append(
            f'<rect x="{_LEFT + 8}" y="{_TOP + 4 + 16 * k}" width="10" height="10" fill="{line.colour}"/>'
            f'<text x="{_LEFT + 24}" y="{_TOP + 13 + 16 * k}">{html.escape(line.name)}</text>'
        )
    return "\n".join([*out, "</svg>"])


def _span(values: Floats, margin: float = 0.02) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    room = (high - low) * margin or 1.0
    return low - room, high + room


def _nice(low: float, high: float) -> list[float]:
    """Return about six round numbers in a range."""
    raw = (high - low) / 6
    size = 10 ** math.floor(math.log10(raw))
    step = next(f * size for f in (1, 2, 5, 10) if f * size >= raw)
    first = math.ceil(low / step)
    return [round(k * step, 12) for k in range(first, math.floor(high / step) + 1)]
