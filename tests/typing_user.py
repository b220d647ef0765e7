"""What a user with a strict type checker writes; checked by mypy and never run."""

from pathlib import Path
from typing import Any, assert_type

import numpy as np
import numpy.typing as npt
import stillrate as sr
from stillrate.config import load_config, methods
from stillrate.results import Trace


def settings() -> sr.MsImmIkf:
    noise = sr.GyroNoise.from_datasheet(angle_random_walk_deg_sqrt_h=0.9)
    config = sr.MsImmIkf(sample_rate_hz=50.0, noise=noise, oscillators=())
    assert_type(config.replace(dwell_time_s=3.0), sr.MsImmIkf)
    assert_type(config.to_toml(), str)
    return config


def stream(samples: list[float]) -> list[float]:
    flt = sr.Filter(settings())
    assert_type(flt.update(0.12), float)
    assert_type(flt.update(0.12, dt_s=0.02), float)
    estimate: sr.Estimate = flt.estimate
    if sr.Flags.MISSING in estimate.flags:
        flt.reset()
    assert_type(estimate.probability, tuple[float, ...])
    return [flt.update(sample) for sample in samples]


def three_axes(x: float, y: float, z: float) -> tuple[float, ...]:
    flt = sr.Filter(settings(), channels=3, dtype="float32")
    assert_type(flt.update([x, y, z]), tuple[float, ...])
    assert_type(sr.Filter.restore(flt.save()), sr.Filter)
    return flt.update(x, y, z)


def batch(z: npt.NDArray[np.float64]) -> Trace:
    flt = sr.Filter(sr.load_config("filter.toml"), channels=z.shape[1])
    clean = flt.run(z)
    clean.mean(axis=0)
    trace = flt.run(z, dt_s=0.02, trace=True)
    assert_type(trace, sr.Trace)
    print(flt.channels, flt.dtype, flt.models, flt.config.method)
    return trace


def logs(path: Path) -> sr.Log:
    log = sr.read(path, columns=["gx", "gy"])
    tuned = sr.tune(log, "pt1")
    assert_type(tuned, sr.Config)
    tuned.to_toml(path.with_suffix(".toml"))
    found = sr.noise_from_log(log.rate_dps, log.sample_rate_hz)
    print(found[0].density_dps_sqrt_hz, sr.allan(log.rate_dps[:, 0], log.sample_rate_hz).tau_s)
    sr.write(path.with_name("clean.csv"), log, force=True)
    return log


def more() -> None:
    run = sr.simulate.static(50.0, 1)
    clean = sr.denoise(run.measured_dps, sample_rate_hz=50.0, method="ms-imm-ikf")
    assert_type(clean, npt.NDArray[Any])
    print(sr.metrics.rmse(clean, run.measured_dps), sorted(methods()), load_config("a.toml"))
    rls = sr.VectorRls(2)
    rls.update([1.0, 0.5], 0.3)
    sr.observability(np.eye(2), np.eye(2), duration_s=1.0, interval_s=0.1, measurement_sigma=1.0, prior_sigma=1.0)
    try:
        sr.Pt1(sample_rate_hz=-1.0)
    except sr.ConfigError as error:
        print(error)


def refused() -> None:
    print(sr.Filtr)  # type: ignore[attr-defined]
    sr.Pt1(sample_rate_hz=50.0, cutof_hz=3.0)  # type: ignore[call-arg]
    sr.Filter(settings()).update("0.1")  # type: ignore[arg-type]
