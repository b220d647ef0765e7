"""Two plain pictures as SVG text: curves over time, and points on a logarithmic axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

PALETTE = ("#7a8794", "#c2571a", "#1f6f8b", "#6b4c9a", "#3d8b40", "#b0285f", "#8a6d1f", "#22313f")
_WIDTH, _HEIGHT = 900, 340
_LEFT, _RIGHT, _TOP, _BOTTOM = 60, 190, 12, 44
_MOST_POINTS = 1500


def _ticks(low: float, high: float) -> list[float]:
    step = 10.0 ** math.floor(math.log10(max(high - low, 1e-12) / 4.0))
    for factor in (1.0, 2.0, 5.0, 10.0):
        if (high - low) / (step * factor) <= 7.0:
            step *= factor
            break
    first = math.ceil(low / step)
    return [step * k for k in range(first, math.floor(high / step) + 1)]


def _frame(body: str, names: Sequence[str], x_label: str, y_label: str) -> str:
    legend = "".join(
        f"<rect x='{_WIDTH - _RIGHT + 14}' y='{_TOP + 18 * i + 4}' width='12' height='4' "
        f"fill='{PALETTE[i % len(PALETTE)]}'/>"
        f"<text x='{_WIDTH - _RIGHT + 32}' y='{_TOP + 18 * i + 11}' font-size='12'>{escape(name)}</text>"
        for i, name in enumerate(names)
    )
    middle_x, middle_y = (_LEFT + _WIDTH - _RIGHT) / 2, (_TOP + _HEIGHT - _BOTTOM) / 2
    return (
        f"<svg viewBox='0 0 {_WIDTH} {_HEIGHT}' role='img' aria-label='{escape(y_label)} over {escape(x_label)}'>"
        f"{body}{legend}"
        f"<text x='{middle_x:.0f}' y='{_HEIGHT - 6}' font-size='13' text-anchor='middle'>{escape(x_label)}</text>"
        f"<text x='14' y='{middle_y:.0f}' font-size='13' text-anchor='middle' "
        f"transform='rotate(-90 14 {middle_y:.0f})'>"
        f"{escape(y_label)}</text></svg>"
    )


def _grid(xs: list[tuple[float, str]], ys: list[tuple[float, str]]) -> str:
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    across = "".join(
        f"<line x1='{_LEFT}' x2='{right}' y1='{y:.1f}' y2='{y:.1f}' stroke='#e3e8ed'/>"
        f"<text x='{_LEFT - 6}' y='{y + 4:.1f}' font-size='12' text-anchor='end'>{text}</text>"
        for y, text in ys
    )
    up = "".join(
        f"<line x1='{x:.1f}' x2='{x:.1f}' y1='{_TOP}' y2='{bottom}' stroke='#e3e8ed'/>"
        f"<text x='{x:.1f}' y='{bottom + 16}' font-size='12' text-anchor='middle'>{text}</text>"
        for x, text in xs
    )
    return across + up


def lines(series: Sequence[tuple[str, NDArray[np.float64], NDArray[np.float64]]], *, x_label: str, y_label: str) -> str:
    """Draw curves (name, x, y)."""
    x_high = max((float(x[-1]) for _, x, _ in series if len(x)), default=1.0)
    finite = [y[np.isfinite(y)] for _, _, y in series]
    reach = max((float(np.abs(y).max()) for y in finite if len(y)), default=1.0) * 1.05 or 1.0

    def px(x: float) -> float:
        return _LEFT + x / x_high * (_WIDTH - _RIGHT - _LEFT)

    def py(y: float) -> float:
        return _TOP + (reach - y) / (2.0 * reach) * (_HEIGHT - _BOTTOM - _TOP)

    body = _grid(
        [(px(x), f"{x:g}") for x in _ticks(0.0, x_high)],
        [(py(y), f"{y:.3g}") for y in _ticks(-reach, reach)],
    )
    for index, (_, x, y) in enumerate(series):
        skip = max(len(x) // _MOST_POINTS, 1)
        points = " ".join(
            f"{px(float(a)):.1f},{py(float(b)):.1f}"
            for a, b in zip(x[::skip], y[::skip], strict=True)
            if math.isfinite(b)
        )
        colour = PALETTE[index % len(PALETTE)]
        body += f"<polyline points='{points}' fill='none' stroke='{colour}' stroke-width='1.6'/>"
    return _frame(body, [name for name, _, _ in series], x_label, y_label)


def scatter(series: Sequence[tuple[str, list[tuple[float, float]]]], *, x_label: str, y_label: str) -> str:
    """Draw points (name, [(x, y), ...]) joined in order, x logarithmic."""
    every = [point for _, points in series for point in points if point[0] > 0.0]
    if not every:
        return "<p class='note'>Nothing to draw.</p>"
    low = math.floor(math.log10(min(x for x, _ in every)) * 2) / 2
    high = math.ceil(math.log10(max(x for x, _ in every)) * 2) / 2
    high = max(high, low + 0.5)
    top = max(y for _, y in every) * 1.1

    def px(x: float) -> float:
        return _LEFT + (math.log10(x) - low) / (high - low) * (_WIDTH - _RIGHT - _LEFT)

    def py(y: float) -> float:
        return _TOP + (top - y) / top * (_HEIGHT - _BOTTOM - _TOP)

    decades = [m * 10.0**e for e in range(math.floor(low), math.ceil(high) + 1) for m in (1.0, 2.0, 5.0)]
    marks = [(px(x), f"{x:g}") for x in decades if low <= math.log10(x) <= high]
    body = _grid(marks, [(py(y), f"{y:g}") for y in _ticks(0.0, top)])
    for index, (_, points) in enumerate(series):
        colour = PALETTE[index % len(PALETTE)]
        path = " ".join(f"{px(x):.1f},{py(y):.1f}" for x, y in points)
        body += f"<polyline points='{path}' fill='none' stroke='{colour}' stroke-width='1.2' stroke-dasharray='4 3'/>"
        body += "".join(f"<circle cx='{px(x):.1f}' cy='{py(y):.1f}' r='5' fill='{colour}'/>" for x, y in points)
    return _frame(body, [name for name, _ in series], x_label, y_label)
