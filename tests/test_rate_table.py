"""The rate-table error model: honest fits, refusals, files, tuning, command line."""

from __future__ import annotations

import json

import numpy as np
import pytest
import stillrate as sr
from hypothesis import given, settings
from hypothesis import strategies as st
from stillrate import _native
from stillrate.cli import main
from turntable import RATE_HZ, sine

rt = sr.rate_table


@pytest.fixture(scope="module")
def calibration():
    return _native.rate_table_calibration(0, 11, 13, 5.0)


@pytest.fixture(scope="module")
def model(calibration):
    truth, measured = calibration
    return rt.fit(measured, truth, sample_rate_hz=RATE_HZ)


def test_an_honest_fit_follows_the_true_error_curve(model):
    _, (a, b, c, d), _, _ = _native.rate_table_unit(0)
    w = np.linspace(-6, 6, 101)
    left = model.predict(w) - (a + b * w + c * w**2 + d * w**3)
    # 13 segments of 5 s with drift 0.016 of 2 s: each mean is good to about 0.012, the curve to less.
    assert np.sqrt(np.mean(left**2)) < 0.5 * np.sqrt(np.mean((a + b * w + c * w**2 + d * w**3) ** 2))
    assert model.score().ratio < 1.0
    assert model.steepest_slope() <= 0.1


def test_correction_after_a_tuned_filter_helps_on_motion_not_seen(model):
    tuned = rt.tune([sine(3, 0.8, seed=1)[1], sine(3, 0.2, seed=2)[1]], RATE_HZ, model="rate-acceleration")
    truth, measured = sine(4, 0.5)
    filtered = model.correct(rt.track(measured, tuned, RATE_HZ))
    assert rt.compare(filtered, truth).rmse < 0.29 * rt.compare(measured, truth).rmse


def test_the_edge_is_held_and_flagged_outside(model):
    np.testing.assert_array_equal(model.predict([6.0, 9.0, 600.0]), np.repeat(model.predict([6.0]), 3))
    assert model.outside([0.0, 9.0, -7.0]).tolist() == [False, True, True]


def test_a_missing_measurement_stays_missing(model):
    corrected = model.correct([1.0, np.nan, np.inf, 2.0])
    assert np.isnan(corrected).tolist() == [False, True, True, False]


def test_a_model_file_is_read_back_exactly_and_not_overwritten(model, tmp_path):
    path = tmp_path / "model.json"
    model.save(path)
    again = rt.ErrorModel.load(path)
    w = np.linspace(-8, 8, 999)
    np.testing.assert_array_equal(model.predict(w), again.predict(w))
    assert again == model
    with pytest.raises(FileExistsError):
        model.save(path)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda d: d.update(version=2), "version 2"),
        (lambda d: d.update(held_out_dps=0.0), "checksum"),
        (lambda d: d.pop("polynomial"), "missing"),
        (lambda d: d.update(extra=1), "unknown field"),
        (lambda d: d["polynomial"].append(0.0), "polynomial"),
        (lambda d: d.update(output_scale=None), "finite"),
        (lambda d: d.update(format="other"), "not a model file"),
        (lambda d: d.update(trained_high=[-7.0]), "range"),
        (lambda d: d.update(unit="rad/s"), "unit"),
    ],
)
def test_a_model_file_that_does_not_fit_is_refused_with_the_reason(model, tmp_path, change, why):
    path = tmp_path / "model.json"
    data = json.loads(model.native.to_text())
    change(data)
    path.write_text(json.dumps(data))
    with pytest.raises(sr.LogError, match=why):
        rt.ErrorModel.load(path)


def test_trailing_bytes_and_huge_files_are_refused_and_reformatting_is_not(model, tmp_path):
    path = tmp_path / "model.json"
    text = model.native.to_text()
    path.write_text(text + "{}")
    with pytest.raises(sr.LogError, match="trailing"):
        rt.ErrorModel.load(path)
    path.write_text(text + " " * 70_000)
    with pytest.raises(sr.LogError, match="at most"):
        rt.ErrorModel.load(path)
    path.write_text(json.dumps(json.loads(text)))
    assert rt.ErrorModel.load(path) == model


@settings(max_examples=50, deadline=None)
@given(st.text(max_size=200))
def test_no_text_makes_the_reader_fail_otherwise(text):
    with pytest.raises(ValueError):
        _native.RateTableModel.from_text(text)


def log_of(rates, samples=200, seed=1, noise=0.1, scale=1.0):
    truth = np.repeat(np.asarray(rates, float), samples)
    return truth, scale * truth + 0.05 + noise * np.random.default_rng(seed).standard_normal(truth.size)


@pytest.mark.parametrize(
    ("measured", "truth", "why"),
    [
        (np.full(1000, 2.0), np.repeat([1.0, 2.0], 500), "no noise"),
        (log_of([1, 2], 20)[1], log_of([1, 2], 20)[0], "40 usable samples"),
        (np.full(1000, np.nan), np.repeat([1.0, 2.0], 500), "0 usable samples"),
        (log_of([2, 2, 2])[1], log_of([2, 2, 2])[0], "at least two different rates"),
        (
            log_of([-3, 0, 3], scale=np.pi / 180, noise=0.001)[1],
            log_of([-3, 0, 3])[0],
            "measured rate seems to be in rad/s",
        ),
        (log_of([-3, 0, 3], scale=180 / np.pi)[1], log_of([-3, 0, 3])[0], "true rate seems to be in rad/s"),
        (log_of([-3, 0, 3], scale=-1)[1], log_of([-3, 0, 3])[0], "wrong sign"),
        (log_of([-3, 0, 3])[0], log_of([-3, 0, 3])[0], "same numbers"),
        (log_of([-3, 0, 3])[1], log_of([-3, 0])[0], "must be as many"),
    ],
)
def test_logs_that_support_no_model_are_refused_with_the_reason(measured, truth, why):
    with pytest.raises(sr.LogError, match=why):
        rt.fit(measured, truth)


def test_nan_bursts_are_left_out(calibration, model):
    truth, measured = calibration
    holed = measured.copy()
    for start in range(100, holed.size, 5000):
        holed[start : start + 700] = [np.nan, np.inf] * 350
    other = rt.fit(holed, truth)
    assert np.abs(other.predict([0.0, 3.0]) - model.predict([0.0, 3.0])).max() < 0.01


def test_duplicate_rates_count_once_and_few_rates_allow_no_more_than_a_line():
    truth, measured = log_of([-3, 0, 3, -3, 0, 3, -3, 0, 3], 400)
    fitted = rt.fit(measured, truth)
    assert fitted.rates == 3
    assert fitted.kind in ("offset", "line")
    refused = {c.name: c.refused for c in fitted.calibration.candidates}
    assert refused["cubic"] and "3 distinct rates" in refused["cubic"]
    with pytest.raises(sr.LogError, match="distinct rates"):
        rt.fit(measured, truth, candidates=["network", "cubic"])


def test_five_samples_do_not_train_thirty_one_parameters():
    with pytest.raises(sr.LogError, match="5 samples for 31 parameters"):
        rt.train(np.linspace(-1, 1, 5), np.zeros(5))
    with pytest.raises(sr.LogError, match="not finite"):
        rt.train(np.r_[np.nan, np.linspace(-1, 1, 400)], np.zeros(401))


def test_networks_that_cannot_be_trained_are_refused():
    x = np.linspace(-1, 1, 70_000)
    for rows, options, why in [
        (x, {"hidden": 1025}, "1025 units"),
        (np.zeros((400, 17)), {"hidden": 1}, "17 inputs"),
        (x, {"decay": np.nan}, "decay = NaN"),
        (x, {"decay": -1.0}, "decay = -1"),
    ]:
        with pytest.raises(sr.LogError, match=why):
            rt.train(rows, np.zeros(len(rows)), **options)


def test_a_score_without_an_error_to_correct_is_no_division_by_zero():
    nothing = rt.fit_points([-3.0, 0.0, 3.0], [0.0, 0.0, 0.0], [0.001] * 3, candidates=["offset"])
    assert np.isnan(nothing.score().ratio)
    assert np.isnan(nothing.score([1.0], [1.0]).ratio)
    offset = rt.fit_points([-3.0, 0.0, 3.0], [0.1, 0.1, 0.1], [0.001] * 3, candidates=["offset"])
    assert offset.score([1.0], [1.0]).ratio == np.inf


def test_segments_are_found_from_the_table_rates_alone(calibration):
    truth, measured = calibration
    steps = np.repeat(truth[::10_000], 10_000)
    found = rt.plateaus(measured, np.unique(steps).tolist(), RATE_HZ)
    assert len(found) == 13
    assert all((truth[a:b] == rate).all() for a, b, rate in found)
    fitted = rt.fit(measured, np.unique(steps), sample_rate_hz=RATE_HZ)
    assert fitted.rates == 13 and fitted.sample_rate_hz == RATE_HZ


def test_a_truth_that_never_stands_still_is_averaged_in_cells():
    truth, measured = sine(5, 0.05, seconds=60)
    fitted = rt.fit(measured, truth)
    assert fitted.calibration.rate_dps.size == 13
    assert abs(fitted.predict([0.0])[0] - 0.03) < 0.03


def test_temperature_is_an_input_where_it_is_given():
    rng = np.random.default_rng(2)
    rates, degrees = np.meshgrid(np.linspace(-6, 6, 7), np.linspace(0, 40, 5))
    truth, celsius = np.repeat(rates.ravel(), 300), np.repeat(degrees.ravel(), 300)
    error = 0.03 + 0.004 * (celsius - 20) + 1e-4 * truth * (celsius - 20)
    measured = truth + error + 0.05 * rng.standard_normal(truth.size)
    with_it, without = rt.fit(measured, truth, celsius), rt.fit(measured, truth)
    assert with_it.held_out_dps < 0.2 * without.held_out_dps
    assert with_it.temperature_range_c == (0.0, 40.0)
    with pytest.raises(sr.LogError, match="temperature"):
        with_it.predict([1.0])


def test_the_command_line_writes_a_model_and_a_page(calibration, tmp_path, capsys):
    truth, measured = calibration
    source, out, page = tmp_path / "log.csv", tmp_path / "model.json", tmp_path / "page.html"
    table = np.c_[np.arange(truth.size) / RATE_HZ, measured, truth]
    np.savetxt(source, table, delimiter=",", header="t_s,gz_dps,table_rate", comments="", fmt="%.9g")
    arguments = ["calibrate", "rate-table", str(source), "-o", str(out), "--true", "table_rate", "--report", str(page)]
    assert main(arguments) == 0, capsys.readouterr().err
    assert rt.ErrorModel.load(out).rates == 13
    text = page.read_text()
    assert "<svg" in text and "http://" not in text.replace("http://www.w3.org/2000/svg", "") and "src=" not in text
    assert main(arguments) == 2
    assert "exists" in capsys.readouterr().err
    assert main([*arguments, "--force", "--true", "nothing"]) in (1, 2)


@pytest.mark.long
def test_the_study_holds_on_ten_units():
    ratios, worst = [], 0.0
    for unit in range(101, 111):
        study = _native.rate_table_study(unit, unit, 0)
        rows = {row[0]: row for row in study["rows"]}
        raw = rows["raw"]
        for name, limit in (
            ("calibration + KF, innovations on motion", 0.40),
            ("two-state KF, innovations, then calibration", 0.29),
        ):
            ratios.append((rows[name][1] / raw[1], limit))
            worst = max(worst, *(a / b for a, b in zip(rows[name][2], raw[2], strict=True)))
        assert study["warned"]
        assert all(abs(b - s) < 0.15 for b, s in zip(study["blind"], study["seen"], strict=True))
    assert all(ratio <= limit for ratio, limit in ratios)
    assert worst < 1.0
