"""A self-contained page on the platform: tables, pictures drawn as SVG, and an animation with a scrubber."""

from __future__ import annotations

from html import escape
from importlib import resources
from pathlib import Path

import numpy as np

from stillrate.io.safely import atomic
from stillrate.platform.findings import findings
from stillrate.platform.goals import goals
from stillrate.platform.running import Run
from stillrate.platform.stage import stage
from stillrate.platform.study import AMPLITUDES_DPS, BANK, DESCRIBED_HZ, GIMBAL, TILT_S, TILTS_DEG, Result, Study
from stillrate.platform.svg import lines, scatter

SWING, RECORDED = "swing", "recorded"
"""Motions that the animation shows, by the names that join it with its curves."""


def page(study: Study) -> str:
    """Return the page as HTML."""
    setup = study.setup
    swing = f"{setup.amplitude_deg:g} deg at {setup.frequency_hz:g} Hz"
    motions = [(SWING, f"base swings by {swing}", study.runs)]
    if study.recorded:
        motions.append((RECORDED, "recorded base motion", study.recorded))
    parts = [
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' content='width=device-width, initial-scale=1'><title>Stabilised platform</title>",
        f"<style>{_resource('page.css')}</style></head><body><h1>Does the filter help where it is used?</h1>",
        f"<p>One axis of {_plant(study)} at {setup.sample_rate_hz:g} Hz. Its base swings by {swing}; controller and "
        f"filter were tuned together, {study.effort}, at a budget of actuator jitter at rest (rms of the voltage "
        "less its 0.4 s mean, percent of the supply, measured 6 to 14 s after a 15 deg tilt), with a gain margin of 2, "
        "a delay margin of 10 ms, a jitter after the tilt below twice the undisturbed one and a levelling error of 0.2 deg "
        f"demanded. All figures come from {study.seeds} noise seeds that no search and no choice saw. The bank is ms-imm-ikf with its "
        "defaults; +pt1 is the low-pass behind it, whose cut-off was tuned like the others'.</p>",
        ("<h2>Watch it</h2>" + stage(motions, _inks(study))) if study.runs else "",
        _results(study),
        _goals(study),
        "<h2>Residual against jitter</h2>" + _pareto(study),
        f"<h2>Angle of the platform, {swing}</h2>" + _traces(study, study.runs, SWING),
        "<h2>A recorded base motion</h2>" + _traces(study, study.recorded, RECORDED) if study.recorded else "",
        _tilts(study.results),
        _fixed(study),
        _describing(study),
    ]
    if study.notes:
        parts.append("<h2>Notes</h2><ul>" + "".join(f"<li>{escape(note)}</li>" for note in study.notes) + "</ul>")
    parts.append(f"<script>{_resource('page.js')}</script></body></html>" if study.runs else "</body></html>")
    return "\n".join(parts)


def _plant(study: Study) -> str:
    gimbal = any(result.design.plant == GIMBAL for result in study.results)
    return "a small camera gimbal" if gimbal else "a stabilised platform of 30 kg"


def _resource(name: str) -> str:
    return (resources.files("stillrate.platform") / name).read_text(encoding="utf-8")


def write(study: Study, path: Path, *, force: bool = False) -> None:
    """Write the page, whole or not at all.

    Raises
    ------
    FileExistsError
        If the file exists and `force` is not set.
    """
    text = page(study)
    with atomic(path, force=force) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _table(head: list[str], rows: list[list[str]], *, prose: bool = False) -> str:
    cells = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    kind = " class='prose'" if prose else ""
    return f"<div class='scroll'><table{kind}><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table></div>"


def _results(study: Study) -> str:
    rows = []
    for result in study.results:
        row = result.row
        rows.append(
            [
                result.design.label + ("" if result.design.feasible else " *"),
                f"{row.rms_deg[0]:.2f}",
                f"{row.max_deg[0]:.2f} ({row.max_deg[1]:.2f}-{row.max_deg[2]:.2f})",
                f"{row.jitter_percent:.4f} ({row.jitter_seeds[1]:.4f}-{row.jitter_seeds[2]:.4f})",
                f"{result.recovery:.2f}",
                f"{row.motion_jitter_percent:.2f}",
                f"{row.gain_margin:g}",
                f"{row.delay_margin_ms:g}",
                f"{row.levelling_deg[0]:.2f} / {row.levelling_own_deg[0]:.2f}",
                f"{result.added_deg[0]:.3f} / {result.added_deg[1]:.3f}",
                result.reached,
            ]
        )
    head = ["filter (budget)", "rms deg", "max deg (seeds)", "rest jitter % (seeds)", "worst after tilt / undisturbed"]
    head += ["motion jitter %", "gain margin", "delay margin ms", "level deg / own", "added deg", "restarts rms deg"]
    star = any(not result.design.feasible for result in study.results)
    return (
        "<h2>The table</h2>"
        + "".join(f"<p class='finding'>{escape(text)}</p>" for text in findings(study.results))
        + _table(head, rows)
        + "<p class='note'>Added: the error (rms, 70 s) that integrating the filter's output would add to "
        "integrating the raw rate: during the base motion, and during a slow swing of 0.2 deg/s. The "
        "controller integrates the raw rate for this reason. Level: the error 25 s after a start at 20 deg, most of which "
        "is the gyro's bias and noise, integrated, and what of it is the loop's own. Restarts: what each restart of the search "
        "reached on its own seeds; where they differ much, the design is not the best there is.</p>"
        + (
            "<p class='note'>* the tuner found nothing that meets every demand; its least bad design is shown.</p>"
            if star
            else ""
        )
    )


def _goals(study: Study) -> str:
    """Say what was hoped for and whether it came out."""
    judged = goals(study)
    if not judged:
        return ""
    rows = [[goal.what, goal.asked, goal.found, "holds" if goal.holds else "does not hold"] for goal in judged]
    return "<h2>What was hoped for</h2>" + _table(["goal", "asked", "found", ""], rows, prose=True)


def _inks(study: Study) -> dict[str, int]:
    """Return one colour a filter, for designs by label and filters by name alike."""
    order = list(dict.fromkeys(result.design.family for result in study.results))
    labels = {result.design.label: order.index(result.design.family) for result in study.results}
    return {name: index for index, name in enumerate(order)} | labels


def _pareto(study: Study) -> str:
    series = []
    for index, name in enumerate(dict.fromkeys(result.design.family for result in study.results)):
        own = [result.row for result in study.results if result.design.family == name]
        points = [(row.jitter_percent, row.max_deg[0]) for row in own if np.isfinite(row.max_deg[0])]
        series.append((name, index, sorted(points)))
    return scatter(series, x_label="rest jitter, % of the supply", y_label="largest angle, deg")


def _traces(study: Study, runs: tuple[tuple[str, Run], ...], motion: str) -> str:
    if not runs:
        return ""
    inks = _inks(study)
    series = [(name, inks.get(name, i), run.t_s, run.angle_deg) for i, (name, run) in enumerate(runs)]
    above = ""
    if motion == RECORDED:
        first = runs[0][1]
        above = lines([("base", 7, first.t_s, first.base_deg)], x_label="time, s", y_label="base, deg", motion=motion)
        head = ["filter (budget)", "rms deg", "max deg"]
        rows = [[name, *(f"{value:.3f}" for value in run.residual_deg)] for name, run in runs]
        above = _table(head, rows) + "<p class='note'>From 3 s on; one noise seed.</p>" + above
    return above + lines(series, x_label="time, s", y_label="angle, deg", motion=motion)


def _tilts(results: tuple[Result, ...]) -> str:
    head = ["filter (budget)", *(f"{tilt:g} deg" for tilt in TILTS_DEG)]
    rows = [[result.design.label, *(f"{peak:.2f}" for peak in result.tilt_peaks_deg)] for result in results]
    text = f"<h2>Peak angle while the base tilts in {TILT_S:g} s</h2>"
    return text + _table(head, rows) + "<p class='note'>Mean over both directions and three seeds, deg.</p>"


def _fixed(study: Study) -> str:
    if not study.fixed:
        return ""
    rows = [
        [
            swapped.name,
            f"{swapped.row.rms_deg[0]:.2f}",
            f"{swapped.row.max_deg[0]:.2f}",
            f"{swapped.change_percent:+.1f} %",
            f"{swapped.row.jitter_percent:.4f}",
            f"{swapped.quieter:.1f}x",
        ]
        for swapped in study.swapped
    ]
    head = ["filter", "rms deg", "max deg", "residual against none", "rest jitter %", "quieter"]
    return (
        "<h2>With the controller fixed</h2>"
        + _table(head, rows)
        + f"<p class='finding'>{escape(_fixed_finding(study))}</p>"
    )


def _fixed_finding(study: Study) -> str:
    """Say what swapping the filter does, in figures of this run."""
    text = "With the controller fixed a filter does not make the platform stiller. "
    for bank in (swapped for swapped in study.swapped if swapped.name == BANK):
        text += (
            f"The bank changes the residual by {bank.change_percent:+.1f} % and makes the actuator "
            f"{bank.quieter:.0f} times quieter at rest. "
        )
    worse = [f"{s.name} {s.change_percent:+.0f} %" for s in study.swapped if s.change_percent > 2.0]
    if worse:
        text += f"Lag costs residual: {', '.join(worse)}. "
    return text + "What a filter gains in motion comes from the gains that it permits."


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
