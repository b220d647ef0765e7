"""Gyro bias from a reference attitude: interface, refusals, real recordings, observability."""

from __future__ import annotations

import math

import numpy as np
import pytest
import real_logs
import stillrate as sr
from stillrate import attitude

DEG_H = math.pi / 180 / 3600


def still(n: int = 200) -> dict[str, object]:
    return {
        "rate_rad_s": np.full((n, 3), 1e-3),
        "dt_s": 0.005,
        "fix_index": [0, n],
        "c_b_n": np.tile(np.eye(3), (2, 1, 1)),
        "latitude_rad": 0.9,
    }


def test_takes_matrices_and_quaternions_alike() -> None:
    by_matrix = sr.reference_bias(**still())
    by_quaternion = sr.reference_bias(**{**still(), "c_b_n": [[1, 0, 0, 0], [1, 0, 0, 0]]})
    np.testing.assert_array_equal(by_matrix.bias_rad_s, by_quaternion.bias_rad_s)
    assert by_matrix.observable and by_matrix.converged and by_matrix.unobservable == ()
    # At rest on the turning Earth the gyro shows bias and Earth rate together.
    earth = attitude.position(0.9, 0.0).T @ [0, 0, 7.292115e-5]
    np.testing.assert_allclose(by_matrix.bias_rad_s, 1e-3 - earth, atol=1e-14)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"fix_index": [0]}, "c_b_n has shape"),
        ({"fix_index": [0], "c_b_n": [np.eye(3)]}, "at least 2"),
        ({"fix_index": [200, 0]}, "t1 > t0"),
        ({"fix_index": [5, 5]}, "t1 > t0"),
        ({"fix_index": [0, 201]}, "at most 200"),
        ({"fix_index": [0.5, 200]}, "whole numbers"),
        ({"c_b_n": np.stack([np.eye(3), np.diag([1, 1, 1.01])])}, r"c_b_n\[1\]"),
        ({"c_b_n": np.stack([np.eye(3), np.diag([1.0, 1, -1])])}, "reflection"),
        ({"c_b_n": np.full((2, 3, 3), np.nan)}, r"c_b_n\[0\]"),
        ({"dt_s": 0.0}, r"dt_s\[0\]"),
        ({"dt_s": -0.01}, r"dt_s\[0\]"),
        ({"dt_s": [0.005] * 199}, "dt_s has shape"),
        ({"latitude_rad": 2.0}, "latitude"),
        ({"method": "guess"}, "mean-rate"),
        ({"reference_sigma_rad": -1.0}, "reference_sigma_rad"),
    ],
)
def test_what_makes_no_sense_is_refused(change: dict[str, object], text: str) -> None:
    with pytest.raises(sr.ConfigError, match=text):
        sr.reference_bias(**{**still(), **change})


def test_a_missing_rate_is_named() -> None:
    arguments = still()
    rates = np.full((200, 3), 1e-3)
    rates[17, 1] = np.nan
    with pytest.raises(sr.ConfigError, match=r"rate_rad_s\[17\]"):
        sr.reference_bias(**{**arguments, "rate_rad_s": rates})


def test_rounded_matrices_are_projected_on_request() -> None:
    exact = attitude.from_euler(0.3, -0.2, 1.1)
    rounded = np.round(exact, 4)
    arguments = {**still(), "c_b_n": [rounded, rounded]}
    with pytest.raises(sr.ConfigError, match="project"):
        sr.reference_bias(**arguments)
    found = sr.reference_bias(**arguments, project=True)
    reference = sr.reference_bias(**{**arguments, "c_b_n": [exact, exact]})
    assert np.abs(found.bias_rad_s - reference.bias_rad_s).max() < 0.02 * DEG_H


def test_logarithm_is_accurate_to_pi_and_past_it() -> None:
    axis = np.array([0.6, -0.64, 0.48])
    for angle in (1e-9, 1e-3, 3.0, math.pi - 1e-7, math.pi - 1e-12):
        np.testing.assert_allclose(attitude.log(attitude.exp(axis * angle)), axis * angle, atol=4e-15)
    past = math.pi + 0.1
    np.testing.assert_allclose(attitude.log(attitude.exp(axis * past)), axis * (past - 2 * math.pi), atol=4e-15)


def test_observability_names_the_weak_direction() -> None:
    dynamics, measurement, states = sr.bench_imu(latitude_rad=0.9)
    prior = np.repeat([0.1, 0.02, 5e-4, 0.05], 3)
    report = sr.observability(
        dynamics,
        measurement,
        duration_s=60.0,
        interval_s=0.1,
        measurement_sigma=0.01,
        prior_sigma=prior,
        process_density=np.repeat([1e-3, 1e-4, 0.0, 0.0], 3),
        states=states,
    )
    assert report.stacked_ranks == (9,)
    assert any("bgz" in weak.components for weak in report.weak_directions)
    with pytest.raises(sr.ConfigError, match="prior_sigma"):
        sr.observability(dynamics, measurement, duration_s=1, interval_s=0.1, measurement_sigma=1, prior_sigma=[1, 2])


@real_logs.needed
@pytest.mark.parametrize("name", ["broad_02_undisturbed_slow_rotation_B", "broad_07_undisturbed_fast_rotation_B"])
def test_bias_of_a_real_gyro_agrees_with_its_rest(name: str) -> None:
    from stillrate.reproduce.broad import broad_gap

    gap = broad_gap(real_logs.RECORDINGS / f"{name}.npz")
    # An independent correlation of the two rates found 4.1 to 4.2 ms; a quarter of the 3.5 ms sample period either way.
    assert gap.lag_s == pytest.approx(0.00415, abs=0.0009)
    # The estimate is far outside its own sigmas from the mean at rest ...
    assert np.abs(gap.gap_sigmas).max() > 10
    # ... because the logger truncates towards zero: with half a step put back every axis comes closer, to within one
    # step (0.061 deg/s).
    raw = np.abs(gap.plain_deg_h - gap.rest_deg_h)
    corrected = np.abs(gap.plain_deg_h - gap.rest_untruncated_deg_h)
    assert (corrected < raw).all() and corrected.max() < 0.061 * 3600
