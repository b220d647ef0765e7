"""Two plain pictures as SVG text: curves over time, and points on logarithmic axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

COLOURS = 8
"""Colours `--m0` to `--m7` of the page's style sheet, one for light and one for dark paper."""
_WIDTH, _HEIGHT = 760, 330
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 16, 12, 44
_MOST_POINTS = 1500


def colour(index: int) -> str:
    """Return a colour of the style sheet."""
    return f"var(--m{index % COLOURS})"


def _ticks(low: float, high: float) -> list[float]:
    step = 10.0 ** math.floor(math.log10(max(high - low, 1e-12) / 4.0))
    for factor in (1.0, 2.0, 5.0, 10.0):
        if (high - low) / (step * factor) <= 7.0:
            step *= factor
            break
    first = math.ceil(low / step)
    return [step * k for k in range(first, math.floor(high / step) + 1)]


def _frame(body: str, legend: Sequence[tuple[str, int]], x_label: str, y_label: str) -> str:
    entries = "".join(
        f"<span><i style='background:{colour(index)}'></i>{escape(name)}</span>" for name, index in legend
    )
    middle_x, middle_y = (_LEFT + _WIDTH - _RIGHT) / 2, (_TOP + _HEIGHT - _BOTTOM) / 2
    return (
        f"<div class='legend'>{entries}</div><div class='plot scroll'>"
        f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' role='img' aria-label='{escape(y_label)} over {escape(x_label)}'>"
        f"{body}"
        f"<text x='{middle_x:.0f}' y='{_HEIGHT - 6}' font-size='13' text-anchor='middle'>{escape(x_label)}</text>"
        f"<text x='14' y='{middle_y:.0f}' font-size='13' text-anchor='middle' "
        f"transform='rotate(-90 14 {middle_y:.0f})'>"
        f"{escape(y_label)}</text></svg></div>"
    )


def _grid(xs: list[tuple[float, str]], ys: list[tuple[float, str]]) -> str:
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    across = "".join(
        f"<line x1='{_LEFT}' x2='{right}' y1='{y:.1f}' y2='{y:.1f}' class='grid'/>"
        f"<text x='{_LEFT - 6}' y='{y + 4:.1f}' font-size='12' text-anchor='end'>{text}</text>"
        for y, text in ys
    )
    up = "".join(
        f"<line x1='{x:.1f}' x2='{x:.1f}' y1='{_TOP}' y2='{bottom}' class='grid'/>"
        f"<text x='{x:.1f}' y='{bottom + 16}' font-size='12' text-anchor='middle'>{text}</text>"
        for x, text in xs
    )
    return across + up


Curve = tuple[str, int, NDArray[np.float64], NDArray[np.float64]]
"""Name, colour, x, y."""


def lines(series: Sequence[Curve], *, x_label: str, y_label: str, motion: str = "") -> str:
    """Draw curves; a `motion` by name gets a cursor that the page's slider moves."""
    x_high = max((float(x[-1]) for _, _, x, _ in series if len(x)), default=1.0)
    finite = [y[np.isfinite(y)] for _, _, _, y in series]
    reach = max((float(np.abs(y).max()) for y in finite if len(y)), default=1.0) * 1.05 or 1.0
    width = _WIDTH - _RIGHT - _LEFT

    def px(x: float) -> float:
        return _LEFT + x / x_high * width

    def py(y: float) -> float:
        return _TOP + (reach - y) / (2.0 * reach) * (_HEIGHT - _BOTTOM - _TOP)

    body = _grid(
        [(px(x), f"{x:g}") for x in _ticks(0.0, x_high)],
        [(py(y), f"{y:.3g}") for y in _ticks(-reach, reach)],
    )
    for _, index, x, y in series:
        skip = max(len(x) // _MOST_POINTS, 1)
        points = " ".join(
            f"{px(float(a)):.1f},{py(float(b)):.1f}"
            for a, b in zip(x[::skip], y[::skip], strict=True)
            if math.isfinite(b)
        )
        body += f"<polyline points='{points}' fill='none' style='stroke:{colour(index)}' stroke-width='1.6'/>"
    if motion:
        body += (
            f"<line class='cursor' data-motion='{escape(motion, quote=True)}' data-seconds='{x_high:g}' "
            f"data-left='{_LEFT}' data-width='{width}' x1='{_LEFT}' x2='{_LEFT}' y1='{_TOP}' y2='{_HEIGHT - _BOTTOM}'/>"
        )
    return _frame(body, [(name, index) for name, index, _, _ in series], x_label, y_label)


Cloud = tuple[str, int, list[tuple[float, float]]]
"""Name, colour, points."""


def scatter(series: Sequence[Cloud], *, x_label: str, y_label: str) -> str:
    """Draw points joined in order, both axes logarithmic."""
    every = [point for _, _, points in series for point in points if point[0] > 0.0 and point[1] > 0.0]
    if not every:
        return "<p class='note'>Nothing to draw.</p>"
    (left, right), (low, high) = (_span([p[i] for p in every]) for i in (0, 1))

    def px(x: float) -> float:
        return _LEFT + (math.log10(x) - left) / (right - left) * (_WIDTH - _RIGHT - _LEFT)

    def py(y: float) -> float:
        return _TOP + (high - math.log10(y)) / (high - low) * (_HEIGHT - _BOTTOM - _TOP)

    body = _grid([(px(x), f"{x:g}") for x in _decades(left, right)], [(py(y), f"{y:g}") for y in _decades(low, high)])
    for _, index, points in series:
        path = " ".join(f"{px(x):.1f},{py(y):.1f}" for x, y in points)
        ink = colour(index)
        body += (
            f"<polyline points='{path}' fill='none' style='stroke:{ink}' stroke-width='1.2' stroke-dasharray='4 3'/>"
        )
        body += "".join(f"<circle cx='{px(x):.1f}' cy='{py(y):.1f}' r='5' style='fill:{ink}'/>" for x, y in points)
    return _frame(body, [(name, index) for name, index, _ in series], x_label, y_label)


def _span(values: Sequence[float]) -> tuple[float, float]:
    """Return decimal logarithms that hold all values, with a little room."""
    low, high = math.log10(min(values)), math.log10(max(values))
    room = 0.06 * max(high - low, 0.5)
    return low - room, max(high, low + 0.4) + room


def _decades(low: float, high: float) -> list[float]:
    marks = [m * 10.0**e for e in range(math.floor(low), math.ceil(high) + 1) for m in (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)]
    return [x for x in marks if low <= math.log10(x) <= high]
