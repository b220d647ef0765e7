"""Real recordings, where they are at hand: never worse than raw, and sane without any settings."""

import warnings

import numpy as np
import pytest
import real_logs
import stillrate as sr

RECORDINGS = sorted(real_logs.RECORDINGS.glob("*.npz"))
STATIC = [path for path in RECORDINGS if "static" in path.stem]
MOVING = [path for path in RECORDINGS if "static" not in path.stem]
AXES = ("gx_dps", "gy_dps", "gz_dps")

pytestmark = real_logs.needed


def load(path):
    with np.load(path) as archive:
        rates = np.column_stack([archive[axis] for axis in AXES])
        return archive["t_s"], rates


def nominal_rate(t):
    return 1.0 / float(np.median(np.diff(t)))


@pytest.mark.parametrize("path", RECORDINGS, ids=lambda path: path.stem)
def test_denoise_without_settings_is_sane(path):
    t, rates = load(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        clean = sr.denoise(rates, sample_rate_hz=nominal_rate(t))
    assert clean.shape == rates.shape and np.isfinite(clean).all()
    for raw, out in zip(rates.T, clean.T, strict=True):
        difference = np.sqrt(np.mean((out - raw) ** 2))
        # It takes noise away and no motion: what it removes is within a few quiet levels of the log.
        quiet = np.median(np.abs(np.diff(raw))) / 0.95 + 1e-3 * np.std(raw)
        assert difference <= 3.0 * quiet + 0.3, (path.stem, difference, quiet)


@pytest.mark.parametrize("mistake", [1.0, 1.2, 0.8])
@pytest.mark.parametrize("path", MOVING, ids=lambda path: path.stem)
def test_known_noise_on_real_motion_is_never_made_worse(path, mistake):
    t, rates = load(path)
    rate = nominal_rate(t)
    limit = 1.02 if mistake == 1.0 else 1.05
    for index, truth in enumerate(rates.T):
        own = sr.noise_from_log(truth, rate)[0]
        sigma = 10.0 * own.density_dps_sqrt_hz * np.sqrt(rate)
        random = np.random.default_rng([2026, index])
        noisy = truth + random.normal(0.0, sigma, truth.shape)
        density = mistake * np.hypot(10.0, 1.0) * own.density_dps_sqrt_hz
        noise = sr.GyroNoise(density_dps_sqrt_hz=density, rate_random_walk_dps_sqrt_s=own.rate_random_walk_dps_sqrt_s)
        clean = sr.Filter(sr.MsImmIkf(sample_rate_hz=rate, noise=noise)).run(noisy)
        ratio = np.sqrt(np.mean((clean - truth) ** 2)) / np.sqrt(np.mean((noisy - truth) ** 2))
        assert ratio <= limit, (path.stem, AXES[index], ratio)


@pytest.mark.parametrize("path", STATIC, ids=lambda path: path.stem)
def test_static_recordings_become_far_quieter(path):
    t, rates = load(path)
    clean = sr.denoise(rates, sample_rate_hz=nominal_rate(t))
    assert (rates.std(axis=0) > 8.0 * clean[200:].std(axis=0)).all()
