"""Tuning of the filters of the rate table over records, and the optimisers that do it."""

from __future__ import annotations

import numpy as np
import pytest
import stillrate as sr
from stillrate import _native
from turntable import RATE_HZ, sine

rt = sr.rate_table


def test_innovations_find_the_optimum_of_the_truth_on_moving_records():
    records = [sine(3, 0.8, seed=k) for k in range(3)]
    truths, measured = [r[0] for r in records], [r[1] for r in records]
    for kind in ("random-walk", "rate-acceleration"):
        blind = rt.tune(measured, RATE_HZ, model=kind)
        seen = rt.tune(measured, RATE_HZ, truths, model=kind)
        assert abs(blind.log10_ratio - seen.log10_ratio) < 0.15
        assert blind.moving and not blind.warnings


def test_constant_records_warn_that_they_cannot_tune_for_motion():
    measured = [_native.rate_table_record([w] * 12_000, 0, 3, RATE_HZ) for w in (0.0, 2.0)]
    with pytest.warns(rt.TuningWarning, match="nothing moves"):
        tuned = rt.tune(measured, RATE_HZ)
    assert not tuned.moving and tuned.log10_ratio < -4


@pytest.mark.parametrize("method", ["brent", "qpso", "de"])
def test_all_optimisers_agree_on_the_noise(method):
    pytest.importorskip("scipy")
    truth, measured = sine(3, 0.8)
    options = {} if method == "brent" else {"particles": 20, "iterations": 30}
    tuned = rt.tune(measured, RATE_HZ, truth, method=method, **options)
    assert abs(tuned.log10_ratio - rt.tune(measured, RATE_HZ, truth).log10_ratio) < 0.02


def test_the_published_search_over_q_and_r_finds_the_same_ratio():
    truth, measured = sine(3, 0.8)
    both = rt.tune(measured, RATE_HZ, truth, method="qpso", separate=True, particles=30, iterations=40)
    assert abs(both.log10_ratio - rt.tune(measured, RATE_HZ, truth).log10_ratio) < 0.05


@pytest.mark.parametrize(
    ("record", "why"),
    [
        (np.full(1000, 1.5), "no noise"),
        (np.random.default_rng(1).standard_normal(63), "63 usable samples"),
        (np.r_[np.random.default_rng(1).standard_normal(63), np.full(100, np.nan)], "63 usable samples"),
    ],
)
def test_records_that_cannot_be_tuned_on_are_refused(record, why):
    with pytest.raises(sr.LogError, match=why):
        rt.tune(record, 100.0)


def test_wrong_arguments_of_tune_are_named():
    z = np.random.default_rng(1).standard_normal(200)
    for call, why in [
        (lambda: rt.tune(z, 0.0), "sample_rate_hz"),
        (lambda: rt.tune(z, 100.0, model="other"), "model"),
        (lambda: rt.tune(z, 100.0, method="other"), "method"),
        (lambda: rt.tune(z, 100.0, objective="truth"), "true rate"),
        (lambda: rt.tune(z, 100.0, z[:-1]), "must be as many"),
        (lambda: rt.tune(z, 100.0, method="qpso", particles=1), "particles"),
        (lambda: rt.kalman(z, -1.0, 1.0), "process_noise"),
        (lambda: rt.kalman(z, 0.0, 0.0), "measurement_variance"),
    ]:
        with pytest.raises(sr.LogError, match=why):
            call()


@pytest.mark.parametrize("dimensions", [2, 10])
def test_the_swarm_finds_shifted_minima(dimensions):
    centre = np.linspace(2.0, 4.0, dimensions)
    best = rt.minimise(
        lambda p: ((p - centre) ** 2).sum(axis=1),
        [-10] * dimensions,
        [10] * dimensions,
        "qpso",
        particles=40,
        iterations=300,
        seed=3,
    )
    assert best.value < 1e-4


def test_a_search_with_only_nan_is_an_error_and_a_callback_stops_it():
    with pytest.raises(sr.LogError, match="no finite value"):
        rt.minimise(lambda p: np.full(len(p), np.nan), [0.0], [1.0], "qpso", iterations=3)
    with pytest.raises(sr.LogError, match="stopped"):
        rt.minimise(lambda p: p[:, 0], [0.0], [1.0], "qpso", progress=lambda *_: False)
    with pytest.raises(ZeroDivisionError):
        rt.minimise(lambda p: 1 / 0, [0.0], [1.0], "qpso")


@pytest.mark.parametrize("method", ["qpso", "de"])
def test_a_search_over_no_box_or_stopped_is_an_error_with_every_method(method):
    pytest.importorskip("scipy")
    for lower, upper in ([], []), ([0.0, 0.0], [1.0]), ([1.0], [0.0]), ([0.0], [np.inf]):
        with pytest.raises(sr.LogError, match="bounds"):
            rt.minimise(lambda p: p[:, 0], lower, upper, method)
    with pytest.raises(sr.LogError, match="stopped by the caller"):
        rt.minimise(lambda p: p[:, 0], [0.0], [1.0], method, progress=lambda *_: False)


def test_a_traced_swarm_refuses_what_is_no_box():
    for lower, upper in ([], []), ([0.0, 0.0], [1.0]), ([1.0], [0.0]):
        with pytest.raises(sr.LogError, match="bounds"):
            rt.qpso_trace(lambda p: p[:, 0], lower, upper, rt.uniforms(1, 2000), particles=2, iterations=3)


def test_a_track_needs_a_sample_rate():
    z = np.random.default_rng(1).standard_normal(200)
    with pytest.warns(rt.TuningWarning):
        tuned = rt.tune(z, 100.0, z)
    with pytest.raises(sr.LogError, match="sample_rate_hz = 0"):
        rt.track(z, tuned, 0.0)
