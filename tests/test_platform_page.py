"""The platform's page in a browser: it draws, plays, fits a phone, and says nothing on the console."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stillrate import platform as pf
from stillrate.platform.page import page
from stillrate.platform.study import BANK, Design, Study, measure, show

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)
PHONE = 360

HARNESS = """<!doctype html><meta charset="utf-8"><script>window.errors = [];</script>
<iframe id="inner" width="%d" height="800" srcdoc="%s"></iframe>
<script>
inner.onload = async () => {
  const page = inner.contentDocument, view = inner.contentWindow, probe = {};
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const state = () => ({
    base: page.querySelector(".base").getAttribute("transform"),
    top: page.querySelector(".top").getAttribute("transform"),
    read: page.querySelector(".read").textContent,
    clock: page.getElementById("clock").textContent,
    cursors: [...page.querySelectorAll(".cursor")].map((c) => [c.getAttribute("visibility"), +c.getAttribute("x1")]),
  });
  try {
    probe.width = page.documentElement.scrollWidth;
    probe.start = state();
    const slider = page.getElementById("time");
    slider.value = 65;
    slider.dispatchEvent(new view.Event("input"));
    probe.scrubbed = state();
    // Headless pages are hardly ever drawn, so their frames come from a timer here.
    view.requestAnimationFrame = (frame) => view.setTimeout(() => frame(view.performance.now()), 20);
    page.getElementById("play").click();
    await wait(600);
    page.getElementById("play").click();
    probe.played = state();
    const choice = page.getElementById("choice");
    choice.selectedIndex = 1;
    choice.dispatchEvent(new view.Event("change"));
    probe.other = state();
    probe.drawn = page.querySelectorAll("polyline").length;
    probe.ink = view.getComputedStyle(page.querySelector("polyline")).stroke;
  } catch (error) { window.errors.push(String(error)); }
  probe.errors = window.errors;
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify(probe);
  document.body.append(out);
};
</script>"""


def study() -> Study:
    """Return a small study with two designs and two motions."""
    setup = pf.Setup()
    designs = [Design("none", 0.05, pf.Controller()), Design("pt1", 0.05, pf.Controller(), (5.3,))]
    drift = 10.0 * np.sin(np.arange(400) / 20.0)
    recorded = pf.Recorded(rate_dps=drift, sample_rate_hz=100.0)

    def runs(base: pf.Base, duration_s: float) -> Any:
        return tuple((d.family, show(d, base, setup=setup, duration_s=duration_s)) for d in designs)

    results = tuple(measure(d, setup=setup, seeds=(1, 2)) for d in designs)
    return Study(
        setup=setup,
        results=results,
        fixed=(("none", results[0].row), ("pt1", results[1].row), (BANK, results[0].row)),
        runs=runs(pf.Sine(), 4.0),
        recorded=runs(recorded, 3.5),
        seeds=2,
    )


def looked_at(text: str, folder: Path) -> tuple[dict[str, Any], str]:
    """Open a page at phone width, handle it, and return what was seen and what the console said."""
    assert CHROMIUM is not None
    # Errors inside the frame end on the harness's list.
    hooked = text.replace("<head>", "<head><script>onerror = (m) => parent.errors.push(m);</script>", 1)
    path = folder / "harness.html"
    path.write_text(HARNESS % (PHONE, html.escape(hooked, quote=True)), encoding="utf-8")
    command = [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}"]
    command += ["--enable-logging=stderr", "--virtual-time-budget=5000", "--dump-dom", path.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stdout[-500:]
    said = "\n".join(line for line in done.stderr.splitlines() if "CONSOLE" in line)
    return json.loads(html.unescape(found.group(1))), said


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_the_page_plays_and_scrubs_on_a_phone_without_a_word_on_the_console(tmp_path: Path) -> None:
    shown = study()
    seen, said = looked_at(page(shown), tmp_path)
    assert seen["errors"] == [] and said == ""
    assert seen["width"] <= PHONE, "the page scrolls sideways"
    swing = shown.runs[0][1]
    assert seen["start"]["clock"] == "0.00 s"
    assert seen["scrubbed"]["clock"] == "1.30 s"
    assert seen["scrubbed"]["read"] == f"{swing.angle_deg[65]:.2f} deg"
    turned = float(re.findall(r"rotate\((-?[\d.]+)", seen["scrubbed"]["base"])[0])
    assert turned == pytest.approx(-swing.base_deg[65], abs=1e-3)
    (on, x), (off, _) = seen["scrubbed"]["cursors"][0], seen["scrubbed"]["cursors"][1]
    assert (on, off) == ("visible", "hidden") and x > seen["start"]["cursors"][0][1]
    assert float(seen["played"]["clock"].split()[0]) > 1.5
    assert [c[0] for c in seen["other"]["cursors"]] == ["hidden", "visible", "visible"]
    assert seen["drawn"] >= 7 and seen["ink"].startswith("rgb")


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_a_broken_page_would_be_noticed(tmp_path: Path) -> None:
    broken = page(study()).replace('find("motion").textContent', '"not json"')
    seen, _ = looked_at(broken, tmp_path)
    assert seen["errors"]


def test_the_page_says_in_figures_what_swapping_the_filter_does() -> None:
    text = page(study())
    assert "The bank changes the residual by +0.0 % and makes the actuator 1 times quieter" in text
    assert "Lag costs residual: pt1 +" in text
    assert "2 noise seeds" in text


def test_goals_are_judged_by_the_figures_beside_them() -> None:
    from dataclasses import replace

    from stillrate.platform.goals import goals

    shown = study()
    pt1 = next(result for result in shown.results if result.design.family == "pt1")
    row = replace(pt1.row, jitter_percent=0.01, max_deg=(1.0,) * 3, rms_deg=(0.7,) * 3)

    def named(family: str, largest: float) -> Any:
        design = replace(pt1.design, family=family)
        return replace(pt1, design=design, row=replace(row, max_deg=(largest,) * 3, rms_deg=(0.7 * largest,) * 3))

    bank, rival, biquad = named("ms-imm-ikf+pt1", 1.0), named("one-euro", 1.5), named("biquad", 2.5)
    judged = {goal.what: goal for goal in goals(replace(shown, results=(bank, rival, biquad), fixed=()))}
    (linear,) = (goal for what, goal in judged.items() if "best linear" in what)
    (against,) = (goal for what, goal in judged.items() if what.endswith("largest angle against one-euro"))
    assert linear.holds and linear.found.startswith("0.40") and not against.holds and against.found.startswith("0.67")
    assert judged["at 0.05 %: the bank's rms angle against one-euro"].holds
    # Too loud a design is no rival at the small budget.
    loud = replace(rival, row=replace(rival.row, jitter_percent=0.03))
    assert not any(
        "largest angle against one-euro" in goal.what for goal in goals(replace(shown, results=(bank, loud)))
    )
    assert goals(replace(shown, results=(), fixed=())) == []


def test_the_findings_are_said_whichever_way_they_come_out() -> None:
    from dataclasses import replace

    from stillrate.platform.findings import findings

    pt1 = next(result for result in study().results if result.design.family == "pt1")
    bank = replace(pt1, design=replace(pt1.design, family="ms-imm-ikf+pt1"))
    worse = replace(bank, row=replace(bank.row, max_deg=(2.0 * pt1.row.max_deg[0],) * 3))
    assert "1.00 of pt1's" in findings([pt1, bank])[0]
    assert "2.00 of pt1's" in findings([pt1, worse])[0]
    assert findings([pt1]) == []
