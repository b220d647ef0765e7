"""A memory in seconds or as a factor a sample: one of the two, or both in agreement."""

import math

import pytest
import stillrate as sr

METHODS = (sr.RecursiveLeastSquares, sr.CusumForgetting)


@pytest.mark.parametrize("method", METHODS)
def test_either_gives_the_other(method):
    by_factor = method(sample_rate_hz=1000.0, forgetting_factor=0.9)
    assert by_factor.tau_s == pytest.approx(-1.0 / (math.log(0.9) * 1000.0))
    by_tau = method(sample_rate_hz=1000.0, tau_s=2.0)
    assert by_tau.forgetting_factor == pytest.approx(math.exp(-1.0 / 2000.0))
    both = method(sample_rate_hz=1000.0, tau_s=by_factor.tau_s, forgetting_factor=0.9)
    assert both.forgetting_factor == 0.9


@pytest.mark.parametrize("method", METHODS)
def test_two_that_contradict_are_refused_even_if_one_is_the_default(method):
    default = method(sample_rate_hz=1000.0)
    for tau_s, factor in ((2.0, 0.9), (default.tau_s, 0.9), (3.0, default.forgetting_factor)):
        with pytest.raises(sr.ConfigError, match=r"forgetting_factor = 0.*: give one of the two, or both in agreement"):
            method(sample_rate_hz=1000.0, tau_s=tau_s, forgetting_factor=factor)


@pytest.mark.parametrize("method", METHODS)
def test_a_copy_follows_what_is_changed_and_keeps_seconds_at_another_rate(method):
    config = method(sample_rate_hz=1000.0, tau_s=2.0)
    slower = config.replace(sample_rate_hz=500.0)
    assert slower.tau_s == 2.0 and slower.forgetting_factor == pytest.approx(math.exp(-1.0 / 1000.0))
    assert config.replace(tau_s=3.0).forgetting_factor == pytest.approx(math.exp(-1.0 / 3000.0))
    assert config.replace(forgetting_factor=0.9).tau_s == pytest.approx(-1.0 / (math.log(0.9) * 1000.0))
    default = method(sample_rate_hz=1000.0)
    assert default.replace(sample_rate_hz=500.0).tau_s == default.tau_s
