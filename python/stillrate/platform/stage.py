"""The animation: each design's platform against its base, one slider for all."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np

from stillrate.platform.running import Run
from stillrate.platform.svg import colour

FRAME_S = 0.02
"""50 frames a second are plenty, whatever the control rate."""
MOST = 4
"""Platforms side by side."""

Motion = tuple[str, str, Sequence[tuple[str, Run]]]
"""A motion's key, what it is, and the runs of every design in it."""


def stage(motions: Sequence[Motion], inks: Mapping[str, int]) -> str:
    """Return controls, drawings and their data as HTML; `inks` are colours by name."""
    names = [name for name, _ in motions[0][2]][:MOST]
    # "<" cannot occur in JSON outside strings, and must not end the script within one.
    data = json.dumps([_frames(motion) for motion in motions], separators=(",", ":"), allow_nan=False)
    options = "".join(f"<option>{escape(title)}</option>" for _, title, _ in motions)
    choice = f"<select id='choice' aria-label='base motion'>{options}</select>" if len(motions) > 1 else ""
    return (
        f"<div class='controls'><button id='play' type='button'>Play</button>{choice}"
        "<input id='time' type='range' min='0' value='0' aria-label='time'><span id='clock'></span></div>"
        f"<div class='stage'>{''.join(_platform(inks.get(name, index), name) for index, name in enumerate(names))}</div>"
        f"<script id='motion' type='application/json'>{data.replace('<', chr(92) + 'u003c')}</script>"
    )


def _frames(motion: Motion) -> dict[str, object]:
    key, _, runs = motion
    shown = [run for _, run in runs[:MOST]]
    period = float(shown[0].t_s[1]) if len(shown[0].t_s) > 1 else FRAME_S
    skip = max(round(FRAME_S / period), 1)

    def column(values: object) -> list[float]:
        return [float(v) for v in np.nan_to_num(np.round(np.asarray(values, dtype=float)[::skip], 3))]

    longest = max(len(run.t_s) for run in shown)
    held = [np.pad(run.angle_deg, (0, longest - len(run.angle_deg)), mode="edge") for run in shown]
    base = max(shown, key=lambda run: len(run.t_s)).base_deg
    return {"name": key, "dt": period * skip, "base": column(base), "angles": [column(angle) for angle in held]}


def _platform(index: int, name: str) -> str:
    ink = colour(index)
    return (
        f"<figure><svg viewBox='-110 -80 220 152' role='img' aria-label='{escape(name, quote=True)}'>"
        "<line class='level' x1='-105' x2='105' y1='-30' y2='-30'/>"
        "<g class='base'><rect x='-80' y='34' width='160' height='12' rx='3'/>"
        "<rect x='-4' y='-30' width='8' height='66'/></g>"
        f"<g class='top' style='fill:{ink}'><rect x='-70' y='-35' width='140' height='10' rx='3'/>"
        "<rect x='-16' y='-57' width='32' height='22' rx='4'/></g>"
        "<circle class='hub' cx='0' cy='-30' r='5'/>"
        "<text class='read' x='0' y='68' text-anchor='middle' font-size='15'></text></svg>"
        f"<figcaption>{escape(name)}</figcaption></figure>"
    )
