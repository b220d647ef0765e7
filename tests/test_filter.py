"""What every filter promises, whatever the method."""

import math
import pickle

import numpy as np
import pytest
import stillrate as sr
from every_method import METHODS, NOISE, build

DTYPES = ["float32", "float64"]


def awkward(rows=600, channels=3, seed=7):
    """Rest, a wave, a step, missing samples, spikes and samples no gyro gives."""
    random = np.random.default_rng(seed)
    t = np.arange(rows) / 100.0
    wave = np.where(t > 3.0, 20.0 * np.sin(2.0 * np.pi * 2.0 * t), 0.0)
    z = wave[:, None] + random.normal(0.0, 0.15, (rows, channels))
    z[50:60, 0] = np.nan
    z[0:3, -1] = np.inf
    z[100, channels // 2] = 1e30
    z[200] = -1e4
    z[450:] += 5.0
    return z


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("method", METHODS)
def test_whole_chunked_streamed_and_restored_runs_have_the_same_bits(method, dtype):
    config, z = build(method), awkward()
    whole = sr.Filter(config, channels=3, dtype=dtype).run(z)
    assert whole.dtype == dtype and whole.shape == z.shape and np.isfinite(whole).all()
    chunked = sr.Filter(config, channels=3, dtype=dtype)
    chunks = np.vstack([chunked.run(part) for part in np.array_split(z, 7)])
    np.testing.assert_array_equal(chunks, whole)
    streamed = sr.Filter(config, channels=3, dtype=dtype)
    rows = []
    for index, row in enumerate(z):
        if index % 100 == 50:
            streamed = sr.Filter.restore(streamed.save())
        rows.append(streamed.update(*row))
    np.testing.assert_array_equal(np.array(rows, dtype=dtype), whole)
    traced = sr.Filter(config, channels=3, dtype=dtype)
    np.testing.assert_array_equal(traced.run(z, trace=True).rate, whole)
    assert repr(traced.estimate) == repr(streamed.estimate)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("method", METHODS)
def test_many_channels_have_the_bits_of_one(method, dtype):
    z = awkward(channels=21)
    config = build(method)
    together = sr.Filter(config, channels=21, dtype=dtype).run(z)
    for channel in range(21):
        alone = sr.Filter(config, dtype=dtype).run(z[:, channel])
        np.testing.assert_array_equal(together[:, channel], alone)


@pytest.mark.parametrize("method", METHODS)
def test_irregular_time_steps_keep_streaming_equal_to_batch(method):
    random = np.random.default_rng(3)
    z, dt = awkward(channels=1)[:, 0], random.uniform(0.005, 0.02, 600)
    dt[[20, 30, 40, 300]] = [0.0, -1.0, math.nan, 3.0]
    config = build(method)
    batch = sr.Filter(config).run(z, dt_s=dt)
    stream = sr.Filter(config)
    np.testing.assert_array_equal([stream.update(v, dt_s=step) for v, step in zip(z, dt, strict=True)], batch)
    assert np.isfinite(batch).all()


@pytest.mark.parametrize("method", METHODS)
def test_missing_samples_are_coasted_over_and_flagged(method):
    z = awkward(channels=1)[:, 0]
    trace = sr.Filter(build(method)).run(z, trace=True)
    missing = (trace.flags & int(sr.Flags.MISSING)) != 0
    np.testing.assert_array_equal(missing, ~np.isfinite(z))
    assert np.isfinite(trace.rate).all() and np.isfinite(trace.variance).all()


def test_scaling_input_and_noise_scales_the_output():
    method = "ms-imm-ikf"
    z = awkward(channels=1)[:, 0]
    z[np.abs(z) > 1e3] = 0.0  # what is out of range does not scale
    loud = sr.GyroNoise(density_dps_sqrt_hz=15.0, rate_random_walk_dps_sqrt_s=3.0)
    plain = sr.Filter(build(method)).run(z)
    scaled = sr.Filter(build(method, noise=loud)).run(1000.0 * z) / 1000.0
    assert np.max(np.abs(scaled - plain)) < 1e-12 * np.max(np.abs(plain))


@pytest.mark.parametrize("method", METHODS)
def test_configuration_survives_toml_and_pickle(method, tmp_path):
    config = build(method)
    config.to_toml(tmp_path / "filter.toml")
    assert sr.load_config(tmp_path / "filter.toml") == config
    assert pickle.loads(pickle.dumps(config)) == config


def test_a_pickled_filter_continues_where_it_stood():
    z = awkward(channels=1)[:, 0]
    flt = sr.Filter(build("ms-imm-ikf"))
    flt.run(z[:300])
    twin = pickle.loads(pickle.dumps(flt))
    np.testing.assert_array_equal(twin.run(z[300:]), flt.run(z[300:]))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"sample_rate_hz": -50.0}, ["sample_rate_hz", "-50", "Hz", "from 1e-3"]),
        ({"sample_rate_hz": math.nan}, ["sample_rate_hz"]),
        ({"sample_rate_hz": 50.0, "dwell_time_s": 0.0}, ["dwell_time_s", "0", "s"]),
        ({"sample_rate_hz": 50.0, "outlier_probability": 0.7}, ["outlier_probability", "0.7"]),
        ({"sample_rate_hz": 50.0, "ladder_hz": ()}, ["ladder_hz"]),
        ({"sample_rate_hz": 50.0, "oscillators": (1.0, -3.0)}, ["oscillators", "-3", "rad/s"]),
        ({"sample_rate_hz": 1e6}, ["sample_rate_hz", "1000000"]),
    ],
)
def test_settings_out_of_range_are_refused_by_name(settings, words):
    with pytest.raises(sr.ConfigError) as error:
        sr.MsImmIkf(noise=NOISE, **settings)
    for word in words:
        assert word in str(error.value)


def test_exact_jacobian_with_private_alpha_is_refused():
    with pytest.raises(sr.ConfigError, match="jacobian"):
        sr.MsImmIkfPaper(sample_rate_hz=50.0, noise=NOISE, jacobian="exact")


def test_printed_mode_reports_its_divergence_and_stays_finite():
    random = np.random.default_rng(1)
    z = random.normal(0.0, 0.1068, 6000)
    trace = sr.Filter(sr.MsImmIkfPaper(sample_rate_hz=50.0, noise=NOISE, mode="printed")).run(z, trace=True)
    assert np.isfinite(trace.rate).all()
    diverged = np.flatnonzero(trace.flags & int(sr.Flags.DIVERGED))
    assert diverged.size > 0 and diverged[0] > 200


def test_masked_arrays_and_integers_are_samples_too():
    config = build("pt1")
    masked = np.ma.masked_array([1.0, 2.0, 3.0], mask=[False, True, False])
    np.testing.assert_array_equal(sr.Filter(config).run(masked), sr.Filter(config).run([1.0, math.nan, 3.0]))
    np.testing.assert_array_equal(sr.Filter(config).run([1, 2]), sr.Filter(config).run([1.0, 2.0]))


@pytest.mark.parametrize("shape", [(4, 2), (2, 2, 2), ()])
def test_wrong_shapes_are_refused(shape):
    with pytest.raises(ValueError):
        sr.Filter(build("pt1")).run(np.zeros(shape))


def test_strided_input_is_read_in_place_and_out_is_filled():
    config, z = build("singer-kf"), awkward(channels=4)
    expected = sr.Filter(config, channels=2).run(np.ascontiguousarray(z[::3, 1:3]))
    out = np.empty_like(expected)
    assert sr.Filter(config, channels=2).run(z[::3, 1:3], out=out) is out
    np.testing.assert_array_equal(out, expected)
    np.testing.assert_array_equal(sr.Filter(config, channels=2).run(np.asfortranarray(z[::3, 1:3])), expected)
