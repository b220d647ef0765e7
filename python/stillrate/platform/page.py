"""A self-contained page on the platform: tables, pictures drawn as SVG, and an animation with a scrubber."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path

import numpy as np

from stillrate.platform.running import Run
from stillrate.platform.study import AMPLITUDES_DPS, DESCRIBED_HZ, TILT_S, TILTS_DEG, Result, Study
from stillrate.platform.svg import PALETTE, lines, scatter

_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:64rem;padding:0 1rem;color:#1b2733;background:#fff}
h1{font-size:1.7rem}h2{font-size:1.2rem;margin-top:2.2rem}table{border-collapse:collapse;font-size:.9rem}
td,th{padding:.25rem .7rem;border-bottom:1px solid #d8dee4;text-align:right}
td:first-child,th:first-child{text-align:left}
svg{max-width:100%;height:auto}.stage{display:flex;gap:1rem;flex-wrap:wrap}
.stage figure{margin:0;flex:1 1 14rem;text-align:center}
.controls{display:flex;gap:1rem;align-items:center;margin:.6rem 0}.controls input{flex:1}.note{color:#57636f}
button{font:inherit;padding:.3rem 1rem}
"""

_SCRIPT = """
const data=JSON.parse(document.getElementById('motion').textContent);
const slider=document.getElementById('time');
const play=document.getElementById('play'),clock=document.getElementById('clock');
let running=false,last=0,at=0;
function draw(){
  const k=Math.min(Math.round(at/data.dt),data.base.length-1);
  clock.textContent=(k*data.dt).toFixed(2)+' s';slider.value=k;
  data.runs.forEach((run,i)=>{
    const g=document.getElementById('stage'+i);
    g.querySelector('.base').setAttribute('transform','rotate('+(-data.base[k])+')');
    g.querySelector('.top').setAttribute('transform','rotate('+(-run.angle[k])+')');
    g.querySelector('.read').textContent=run.angle[k].toFixed(2)+' deg';
  });
}
function tick(now){if(!running)return;at+=(now-last)/1000;last=now;
  if(at>data.dt*(data.base.length-1))at=0;draw();requestAnimationFrame(tick);}
play.onclick=()=>{running=!running;play.textContent=running?'Pause':'Play';last=performance.now();if(running)requestAnimationFrame(tick);};
slider.oninput=()=>{at=slider.value*data.dt;draw();};
slider.max=data.base.length-1;draw();
"""


def label(result: Result) -> str:
    """Return a design's name with its budget."""
    return f"{result.design.family} ({result.design.budget_percent:g} %)"


def page(study: Study) -> str:
    """Return the page as HTML."""
    setup = study.setup
    parts = [
        "<!doctype html><html lang='en'><meta charset='utf-8'><title>Stabilised platform</title>",
        f"<style>{_STYLE}</style><h1>Does the filter help where it is used?</h1>",
        f"<p>One axis of a stabilised platform at {setup.sample_rate_hz:g} Hz. Its base swings by "
        f"{setup.amplitude_deg:g} deg at {setup.frequency_hz:g} Hz; controller and filter were tuned together, with "
        "the same search effort for every filter, at a budget of actuator jitter at rest (rms of the voltage less its "
        "0.4 s mean, percent of the supply, measured 6 to 14 s after a 15 deg tilt), gain margin 2 and delay margin "
        "10 ms demanded. All figures come from noise seeds that the tuner did not see.</p>",
        _stage(study.runs, "Watch it"),
        _results(study),
        "<h2>Residual against jitter</h2>" + _pareto(study.results),
        "<h2>Angle of the platform in motion</h2>" + _traces(study.runs),
        _tilts(study.results),
        _fixed(study),
        _describing(study),
    ]
    if study.recorded:
        parts.append("<h2>A recorded base motion</h2>" + _traces(study.recorded, base=True))
    if study.notes:
        parts.append("<h2>Notes</h2><ul>" + "".join(f"<li>{escape(note)}</li>" for note in study.notes) + "</ul>")
    parts.append(f"<script>{_SCRIPT}</script></html>" if study.runs else "</html>")
    return "\n".join(parts)


def write(study: Study, path: Path, *, force: bool = False) -> None:
    """Write the page, whole or not at all.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    """
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists (--force overwrites)")
    part = path.with_name(path.name + ".part")
    part.write_text(page(study), encoding="utf-8")
    part.replace(path)


def _table(head: list[str], rows: list[list[str]]) -> str:
    cells = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


def _results(study: Study) -> str:
    rows = []
    for result in study.results:
        row = result.row
        rows.append(
            [
                label(result) + ("" if result.design.feasible else " *"),
                f"{row.rms_deg[0]:.2f}",
                f"{row.max_deg[0]:.2f} ({row.max_deg[1]:.2f}-{row.max_deg[2]:.2f})",
                f"{row.jitter_percent:.4f} ({row.jitter_seeds[1]:.4f}-{row.jitter_seeds[2]:.4f})",
                f"{row.jitter_percent / max(row.undisturbed_percent, 1e-12):.2f}",
                f"{row.motion_jitter_percent:.2f}",
                f"{row.gain_margin:g}",
                f"{row.delay_margin_ms:g}",
                f"{row.levelling_deg[0]:.2f}",
                f"{result.added_deg[0]:.3f} / {result.added_deg[1]:.3f}",
            ]
        )
    head = ["filter (budget)", "rms deg", "max deg (seeds)", "rest jitter % (seeds)", "after tilt / undisturbed"]
    head += ["motion jitter %", "gain margin", "delay margin ms", "levelling deg", "added if integrated, deg"]
    star = any(not result.design.feasible for result in study.results)
    return (
        "<h2>The table</h2>"
        + _table(head, rows)
        + "<p class='note'>The last column is the error (rms, 70 s) that integrating the filter's output would add to "
        "integrating the raw rate: during the base motion, and during a slow swing of 0.2 deg/s. The "
        "controller integrates the raw rate for this reason.</p>"
        + (
            "<p class='note'>* the tuner found nothing that meets every constraint; its least bad design is shown.</p>"
            if star
            else ""
        )
    )


def _pareto(results: tuple[Result, ...]) -> str:
    names = sorted({result.design.family for result in results})
    series = []
    for name in names:
        own = [result.row for result in results if result.design.family == name]
        points = [(row.jitter_percent, row.max_deg[0]) for row in own if np.isfinite(row.max_deg[0])]
        series.append((name, sorted(points)))
    return scatter(series, x_label="rest jitter, % of the supply", y_label="largest angle, deg")


def _traces(runs: tuple[tuple[str, Run], ...], *, base: bool = False) -> str:
    if not runs:
        return ""
    series = [(name, run.t_s, run.angle_deg) for name, run in runs]
    if base:
        series.insert(0, ("base", runs[0][1].t_s, runs[0][1].base_deg))
    return lines(series, x_label="time, s", y_label="angle, deg")


def _tilts(results: tuple[Result, ...]) -> str:
    head = ["filter (budget)", *(f"{tilt:g} deg" for tilt in TILTS_DEG)]
    rows = [[label(result), *(f"{peak:.2f}" for peak in result.tilt_peaks_deg)] for result in results]
    text = f"<h2>Peak angle while the base tilts in {TILT_S:g} s</h2>"
    return text + _table(head, rows) + "<p class='note'>Mean over both directions and three seeds, deg.</p>"


def _fixed(study: Study) -> str:
    if not study.fixed:
        return ""
    raw = study.fixed[0][1]
    rows = [
        [
            name,
            f"{row.rms_deg[0]:.2f}",
            f"{row.max_deg[0]:.2f}",
            f"{100.0 * (row.rms_deg[0] / raw.rms_deg[0] - 1.0):+.1f} %",
            f"{row.jitter_percent:.4f}",
            f"{raw.jitter_percent / max(row.jitter_percent, 1e-12):.1f}x",
        ]
        for name, row in study.fixed
    ]
    head = ["filter", "rms deg", "max deg", "residual against none", "rest jitter %", "quieter"]
    return (
        "<h2>With the controller fixed</h2>"
        + _table(head, rows)
        + "<p>With a fixed PID a good filter does not change the residual: it only makes the actuator quieter at rest. "
        "What it gains in motion comes from the gains it permits.</p>"
    )


def _describing(study: Study) -> str:
    if not study.describing:
        return ""
    head = ["filter", *(f"{amplitude:g} deg/s" for amplitude in AMPLITUDES_DPS)]
    rows = [[name, *(f"{gain:.2f} / {phase:+.0f} deg" for gain, phase in found)] for name, found in study.describing]
    return (
        f"<h2>Gain and phase at {DESCRIBED_HZ:g} Hz against amplitude</h2>"
        + _table(head, rows)
        + "<p>An adaptive filter passes little of what is below its noise and everything above: a single phase margin "
        "says nothing about it. At rest it hides the loop behind it, so jitter is measured after an excitation.</p>"
    )


def _stage(runs: tuple[tuple[str, Run], ...], title: str) -> str:
    if not runs:
        return ""
    shown = runs[:4]
    # 50 frames a second are plenty, whatever the control rate.
    skip = max(round(0.02 / float(shown[0][1].t_s[1])), 1)
    base = np.round(shown[0][1].base_deg[::skip], 3)
    motion = {
        "dt": float(shown[0][1].t_s[1]) * skip,
        "base": base.tolist(),
        "runs": [{"angle": np.round(run.angle_deg[::skip], 3).tolist()} for _, run in shown],
    }
    figures = "".join(_platform(index, name) for index, (name, _) in enumerate(shown))
    return (
        f"<h2>{title}</h2><div class='controls'><button id='play'>Play</button>"
        "<input id='time' type='range' min='0' value='0' aria-label='time'><span id='clock'></span></div>"
        f"<div class='stage'>{figures}</div>"
        f"<script id='motion' type='application/json'>{json.dumps(motion)}</script>"
    )


def _platform(index: int, name: str) -> str:
    colour = PALETTE[index % len(PALETTE)]
    return (
        f"<figure><svg id='stage{index}' viewBox='-110 -80 220 150' role='img' aria-label='{escape(name)}'>"
        "<line x1='-105' x2='105' y1='-30' y2='-30' stroke='#c8d0d8' stroke-dasharray='3 4'/>"
        "<g class='base'><rect x='-80' y='34' width='160' height='12' rx='3' fill='#8a97a5'/>"
        "<rect x='-4' y='-26' width='8' height='62' fill='#8a97a5'/></g>"
        f"<g transform='translate(0,-30)'><g class='top'>"
        f"<rect x='-70' y='-5' width='140' height='10' rx='3' fill='{colour}'/>"
        f"<rect x='-16' y='-27' width='32' height='22' rx='4' fill='{colour}'/></g></g>"
        "<circle cx='0' cy='-30' r='5' fill='#1b2733'/>"
        "<text class='read' x='0' y='66' text-anchor='middle' font-size='13'></text></svg>"
        f"<figcaption>{escape(name)}</figcaption></figure>"
    )
