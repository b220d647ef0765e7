"""The gimbal calibration: reference outputs, gauges, flags, files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import stillrate as sr
from reference import replay
from stillrate.cli import main

FILES = Path(__file__).parent / "reference" / "self_calibration"
PARAMETERS = slice(3, 33)  # the attitude entries follow other conventions (see the README of the vectors)


@pytest.fixture(scope="module")
def run() -> dict[str, np.ndarray]:
    command = sr.gimbal.trajectory()
    truth = sr.gimbal.draw(seed=41)
    samples = sr.gimbal.simulate(truth, command, sigma_m_s2=1e-6, seed=42)
    return {"command": command, "truth": truth, "samples": samples}


def answer(document: object, key: str) -> np.ndarray:
    for part in key.split("/"):
        document = document[int(part)] if isinstance(document, list) else document[part]  # type: ignore[index]
    return np.array(document, dtype=float)


def test_single_steps_equal_the_unit_vectors() -> None:
    document = json.loads((FILES / "unit_vectors.json").read_text())
    found = replay(FILES / "unit_vectors.json")
    # Every part of the file is answered, "x" being the coefficients that all of it is asked of.
    assert {key.split("/")[0] for key in found} == document.keys() - {"x"}
    for key, value in found.items():
        wanted = answer(document, key)
        if key.endswith("/J"):
            scale = np.maximum(abs(wanted).max(axis=0), 1e-300)
            assert (abs(value - wanted) / scale).max() < 1e-9, key
        elif key.startswith(("truth", "sens")):
            assert abs(value - wanted).max() < 1e-9, key
        else:
            assert abs(value - wanted).max() <= 1e-12 * max(abs(wanted).max(), 1e-300), key


def test_every_method_equals_its_reference_run() -> None:
    document = json.loads((FILES / "expected.json").read_text())
    found = replay(FILES / "expected.json")
    scale = np.array(document["scale"])
    compared = 0
    for case, entry in document["cases"].items():
        bound = np.array([0.0 if x is None else x for x in entry["crlb_1sigma"]])
        assert (abs(found[f"{case}/crlb_1sigma"] - bound) / scale).max() < 1e-9
        for method, wanted in entry["methods"].items():
            tolerance = wanted["tol_abs_over_scale"]
            if tolerance is None or f"{case}/{method}/final" not in found:
                continue
            tolerance = max(tolerance, 1e-5) if method.endswith("_avg") else tolerance
            error = abs(found[f"{case}/{method}/final"] - np.array(wanted["final"])) / scale
            assert error[PARAMETERS].max() < tolerance, (case, method)
            if wanted["checkpoints"] is not None:
                error = abs(found[f"{case}/{method}/checkpoints"] - np.array(wanted["checkpoints"])) / scale
                assert error[:, PARAMETERS].max() < tolerance, (case, method)
            compared += 1
    assert compared == 36


def test_finds_the_truth_within_its_own_deviations(run: dict[str, np.ndarray]) -> None:
    found = sr.gimbal.calibrate(run["command"], run["samples"], 0.25)
    free = found.standard_deviation > 0
    ratio = (found.coefficients - run["truth"][:33])[free] / found.standard_deviation[free]
    assert abs(ratio).max() < 4.5
    assert not found.tests["alarm"]
    assert found.details["sigma_m_s2"] == pytest.approx(1e-6, rel=0.03)
    assert set(found.flags) == {"thp_x", "tho_x", "tho_y"}


def test_commands_at_the_sample_rate_say_the_same(run: dict[str, np.ndarray]) -> None:
    part = run["samples"][: 5 * 400 + 1]
    once = sr.gimbal.calibrate(run["command"][:400], part, 0.25, sigma_m_s2=1e-6)
    repeated = np.vstack([np.repeat(run["command"][:400], 5, axis=0), run["command"][:1]])
    again = sr.gimbal.calibrate(repeated, part, 0.05, sigma_m_s2=1e-6)
    assert again.details["interval_s"] == pytest.approx(0.25)
    np.testing.assert_allclose(again.coefficients, once.coefficients, rtol=0, atol=1e-12)


def test_spikes_and_losses_cost_little_and_plain_lines_cost_much(run: dict[str, np.ndarray]) -> None:
    spoilt = sr.gimbal.simulate(
        run["truth"], run["command"], sigma_m_s2=1e-6, seed=42, spike_probability=0.005, loss_probability=0.02
    )
    clean, robust, plain = (
        sr.gimbal.calibrate(run["command"], samples, 0.25, sigma_m_s2=1e-6, robust=robust)
        for samples, robust in ((run["samples"], True), (spoilt, True), (spoilt, False))
    )
    free = clean.standard_deviation > 0
    assert abs((robust.coefficients - clean.coefficients)[free][3:] / clean.standard_deviation[free][3:]).max() < 1.0
    assert abs((plain.coefficients - clean.coefficients)[free][3:] / clean.standard_deviation[free][3:]).max() > 10.0
    assert plain.tests["alarm"]


def test_an_unmodelled_latency_is_noticed_and_named(run: dict[str, np.ndarray]) -> None:
    truth = run["truth"].copy()
    truth[39] = 1e-3
    late = sr.gimbal.simulate(truth, run["command"], sigma_m_s2=1e-6, seed=42)
    blind = sr.gimbal.calibrate(run["command"], late, 0.25, sigma_m_s2=1e-6, diagnose=True)
    assert "residuals" in blind.flags
    assert "hidden latency" in blind.flags
    knowing = sr.gimbal.calibrate(run["command"], late, 0.25, sigma_m_s2=1e-6, latency=True)
    assert knowing["latency"] == pytest.approx(1e-3, abs=5e-7)
    assert "residuals" not in knowing.flags


@pytest.mark.parametrize(("method", "limit"), [("on-line", 1e-4), ("relinearised", 1e-6), ("two-stage", 1e-5)])
def test_single_precision_square_root_stays_close(run: dict[str, np.ndarray], method: str, limit: float) -> None:
    double, single = (
        sr.gimbal.calibrate(run["command"], run["samples"], 0.25, method, sigma_m_s2=1e-6, single=single, bounds=False)
        for single in (False, True)
    )
    scale = np.array(json.loads((FILES / "expected.json").read_text())["scale"])
    assert (abs(single.coefficients - double.coefficients) / scale)[PARAMETERS].max() < limit


def test_gauges_describe_the_same_head(run: dict[str, np.ndarray]) -> None:
    other = sr.gimbal.to_gauge(run["truth"], "gyro")
    assert other[[15, 18, 19]] == pytest.approx(0.0, abs=1e-15)
    a = sr.gimbal.simulate(run["truth"], run["command"][:600])
    b = sr.gimbal.simulate(other, run["command"][:600])
    # The roll of a g-sensitive term about its own input axis is of third order.
    assert abs(a - b).max() < 2e-9
    back = sr.gimbal.to_gauge(other, "accelerometer")
    np.testing.assert_allclose(back, run["truth"], rtol=0, atol=1e-10)


def test_a_platform_at_rest_leaves_most_unobservable() -> None:
    still = np.zeros((2400, 3))
    report = sr.gimbal.bound(still)
    assert len(report.unobservable) > 15
    assert len(sr.gimbal.bound(sr.gimbal.trajectory()).unobservable) == 0
    assert sr.gimbal.bound(sr.gimbal.trajectory(), gauge="none").singular_values[-3:].max() < 1.0


def test_a_plan_is_never_worse_and_keeps_the_limits() -> None:
    plan = sr.gimbal.plan(segment_s=25.0, moves=12, climbs=1, seed=3)
    assert max(plan.after["drift"], plan.after["g_sensitive"]) <= max(plan.before["drift"], plan.before["g_sensitive"])
    assert abs(plan.segments_deg_s).max() <= 1.0


@pytest.mark.parametrize(
    ("command", "samples", "dt", "words"),
    [
        (np.zeros((10, 3)), np.zeros((50, 3)), 0.25, "do not fit"),
        (np.zeros((10, 3)), np.full((51, 3), np.nan), 0.25, "missing"),
        (np.full((10, 3), np.inf), np.zeros((51, 3)), 0.25, "command 0"),
        (np.zeros((10, 3)), np.zeros((51, 3)), -1.0, "dt_s"),
        (np.zeros((0, 3)), np.zeros((0, 3)), 0.25, "not a run"),
    ],
)
def test_bad_data_is_refused_in_words(command: np.ndarray, samples: np.ndarray, dt: float, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sr.gimbal.calibrate(command, samples, dt)


def test_the_command_line_writes_coefficients_and_a_page(run: dict[str, np.ndarray], tmp_path: Path) -> None:
    log, out, page = tmp_path / "run.npz", tmp_path / "out.json", tmp_path / "page.html"
    np.savez(log, command_rad_s=run["command"], specific_force_m_s2=run["samples"], dt_s=0.25)
    arguments = ["calibrate", "gimbal", str(log), "-o", str(out), "--report", str(page), "--quiet"]
    assert main(arguments) == 0
    assert json.loads(out.read_text())["coefficients"]["ka0x"]["value"] == pytest.approx(run["truth"][21], rel=1e-3)
    text = page.read_text()
    assert "http" not in text.replace("http-equiv", "")
    assert "kgIx" in text
    assert main(arguments) == 2  # nothing is overwritten unasked
    assert main(["calibrate", "gimbal", str(tmp_path / "none.npz")]) == 1


def test_a_damaged_file_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, command_rad_s=np.ones((50, 3)), specific_force_m_s2=np.ones((51, 3)), dt_s=1.0)
    whole = path.read_bytes()
    for content in (whole[: len(whole) // 2], bytes(range(256)), whole[:100] + b"\0" * 60 + whole[160:]):
        path.write_bytes(content)
        assert main(["calibrate", "gimbal", str(path)]) == 1
        said = capsys.readouterr().err
        assert said.startswith(f"stillrate: {path}: ") and said.count("\n") == 1 and "allow_pickle" not in said


@pytest.mark.long
def test_the_study_meets_its_figures() -> None:
    from stillrate.reproduce.gimbal import study

    found = study(draws=20, seed=3001)
    of = {(line.case, line.method): line for line in found.lines}
    best = of["(1) zero", "recursive Gauss-Newton"]
    assert 0.85 <= best.normalised_error <= 1.15
    assert best.over_bound <= 1.1
    assert found.start_spread_sigma <= 0.02
    assert best.other <= 0.06
    assert best.other_max <= 0.13
    large = of["(1) drifts x10", "recursive Gauss-Newton"]
    assert large.other_max <= 0.02
    assert large.settled == found.draws
    assert large.settling_s[2] <= 500
    assert of["(4) 100x noise", "recursive Gauss-Newton"].other <= 5.5
    assert of["(1) zero", "on-line, second order"].other <= 0.12
    assert of["(1) zero", "first-order single loop"].other >= 40 * best.other
    assert best.kappa_max <= 0.9
    assert large.kappa_max <= 0.1


def test_without_bounds_the_coefficients_are_the_same(run: dict[str, np.ndarray]) -> None:
    part = (run["command"][:400], run["samples"][:2001], 0.25, "on-line")
    full, quick = (sr.gimbal.calibrate(*part, sigma_m_s2=1e-6, bounds=bounds) for bounds in (True, False))
    np.testing.assert_array_equal(full.coefficients, quick.coefficients)
    assert np.isfinite(full.bound).sum() == 30
    assert np.isnan(quick.bound).all()
    assert not quick.weakest


@pytest.mark.long
def test_disturbances_are_noticed_or_estimated_or_named() -> None:
    from stillrate.reproduce.gimbal_disturbances import remarks, study

    rows = {(row.disturbance, row.method, row.handling): row for row in study(6, seed=7001)}
    nominal = rows["none", "relinearised", ""]
    assert rows["0.5 % spikes, 2 % lost", "relinearised", "robust lines"].other <= 1.3 * nominal.other
    for row in rows.values():
        if row.handling == "nothing" and row.disturbance not in ("ARW 1e-05 deg/sqrt(h)", "gravity 1e-6 g"):
            assert row.noticed == row.draws, row
        if row.handling.endswith(("state", "states")):
            assert row.noticed == 0, row
            assert row.other <= 3 * nominal.other, row
        if row.handling == "process noise":
            # The on-line filter inflates its noise by design and may be too modest, never too sure.
            assert row.own <= 1.25, row
            assert row.method == "on-line" or row.own >= 0.75, row
    assert any(text.startswith("not noticed") and "gravity" in text for text in remarks(list(rows.values())))
