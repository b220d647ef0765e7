"""The calm-after-waves run, by every filter one would think of: what each gains and what it costs.

A simulated gyro rests, then rides on 2 Hz waves that die down. The truth is known, and so is the least error any causal
filter could have on these very samples (a Kalman filter that knows the wave model and its parameters).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from stillrate import methods, metrics, simulate
from stillrate._native import Filter
from stillrate.config import Config
from stillrate.io.log import Floats, Log
from stillrate.noise import GyroNoise

SEED = 20_251
"""Used nowhere else."""

SETTLED_AFTER_S = 12.0
"""From here on after the waves' end the calm is scored."""

STEP_S, STEP_UNTIL_S, STEP_DPS = 16.0, 22.0, 40.0
"""The step of the steps run whose settling is timed: from -10 to 30 deg/s."""


@dataclass(frozen=True)
class Row:
    """How one filter did.

    Attributes
    ----------
    name : str
    static_dps : float
        RMS error at rest.
    waves_dps, calm_dps : float
        RMS error in the waves and in the calm after them.
    lag_ms : float
        Delay in the waves; positive is late.
    settling_s : float
        Time until a step of 40 deg/s is followed within 1 %.
    """

    name: str
    static_dps: float
    waves_dps: float
    calm_dps: float
    lag_ms: float
    settling_s: float


@dataclass(frozen=True)
class Runs:
    """The simulated runs of the demonstration."""

    static: simulate.Bed
    waves: simulate.Bed
    steps: simulate.Bed
    noise: GyroNoise

    @property
    def calm(self) -> slice:
        """Samples of the calm that are scored."""
        calm = self.waves.calm or slice(0, 0)
        # The bed itself waits 5 s.
        waited = round((SETTLED_AFTER_S - 5.0) * self.waves.sample_rate_hz)
        return slice(calm.start + waited, calm.stop)


def runs(sample_rate_hz: float = 50.0, seed: int = SEED) -> Runs:
    """Simulate the runs."""
    gyro = simulate.GyroModel()
    noise = GyroNoise(
        density_dps_sqrt_hz=gyro.density_dps_sqrt_hz,
        rate_random_walk_dps_sqrt_s=gyro.rate_random_walk_dps_sqrt_s,
        bias_sigma_dps=gyro.bias_sigma_dps,
        bias_time_s=gyro.bias_time_s,
    )
    return Runs(
        static=simulate.static(sample_rate_hz, seed, bound=True),
        waves=simulate.waves(sample_rate_hz, seed, bound=True),
        steps=simulate.steps(sample_rate_hz, seed),
        noise=noise,
    )


def contestants(found: Runs) -> dict[str, Config | None]:
    """Return the filters by name, with the settings their users would give them; None is no filter."""
    given: Any = {"sample_rate_hz": found.static.sample_rate_hz, "noise": found.noise}
    return {
        "raw": None,
        "PT1, 20 Hz": methods.Pt1(
            sample_rate_hz=found.static.sample_rate_hz, cutoff_hz=min(20.0, 0.25 * found.static.sample_rate_hz)
        ),
        "one-euro": methods.OneEuro(**given),
        "AR-KF": methods.ArKf(**given),
        "Singer-IMM-KF": methods.SingerImmKf(**given),
        "MS-IMM-IKF, as published": methods.MsImmIkfPaper(**given),
        "MS-IMM-IKF (default)": methods.MsImmIkf(**given),
    }


def score(found: Runs) -> list[Row]:
    """Run every filter and the bound; return one row each, the bound last."""
    rows = []
    for name, config in contestants(found).items():
        estimates = [
            bed.measured_dps if config is None else Filter(config).run(bed.measured_dps)
            for bed in (found.static, found.waves, found.steps)
        ]
        rows.append(score_one(name, found, *estimates))
    bound = (found.static.bound_dps, found.waves.bound_dps)
    if bound[0] is not None and bound[1] is not None:
        rows.append(score_one("the best that is possible", found, bound[0], bound[1], None))
    return rows


def score_one(name: str, found: Runs, static: Floats, waves: Floats, steps: Floats | None) -> Row:
    """Return the figures of one filter from its outputs on the three runs."""
    rate = found.static.sample_rate_hz
    settled = slice(found.static.scored.start, found.static.scored.stop)
    scored, calm = found.waves.scored, found.calm
    return Row(
        name=name,
        static_dps=metrics.rmse(static[settled], found.static.truth_dps[settled]),
        waves_dps=metrics.rmse(waves[scored], found.waves.truth_dps[scored]),
        calm_dps=metrics.rmse(waves[calm], found.waves.truth_dps[calm]),
        lag_ms=metrics.lag_ms(waves[scored], found.waves.truth_dps[scored], rate),
        settling_s=math.nan if steps is None else step_settling_s(steps, found.steps, found.noise),
    )


def step_settling_s(estimate: Floats, bed: simulate.Bed, noise: GyroNoise) -> float:
    """Return the time until the step of a steps run is followed within 1 %, or within the noise where that is wider."""
    rate = bed.sample_rate_hz
    start, stop = round(STEP_S * rate), round(STEP_UNTIL_S * rate)
    band = max(0.01 * STEP_DPS, 4.0 * noise.density_dps_sqrt_hz * math.sqrt(rate))
    return metrics.settling(estimate, bed.truth_dps, rate, start=start, stop=stop, band=band).time_s


def wave_log(found: Runs) -> Log:
    """Return the waves as a log with its truth."""
    bed = found.waves
    return Log(
        t_s=bed.t_s,
        rate_dps=bed.measured_dps,
        channels=("gx_dps",),
        sample_rate_hz=bed.sample_rate_hz,
        columns={"gx_true_dps": bed.truth_dps},
        meta={"source": "simulated waves, then calm"},
    )


def markdown(rows: list[Row]) -> str:
    """Return the result as the table of the README."""
    head = "| filter | at rest, deg/s | in 2 Hz waves, deg/s | calm after, deg/s | lag, ms |\n|---|---|---|---|---|\n"
    lines = []
    for row in rows:
        name = f"**{row.name}**" if "default" in row.name else row.name
        # Adding zero takes the sign off a rounded one.
        lag = f"{round(row.lag_ms, 2) + 0.0:+.2f}"
        figures = (f"{row.static_dps:.4f}", f"{row.waves_dps:.4f}", f"{row.calm_dps:.4f}", lag)
        lines.append(f"| {name} | {' | '.join(figures)} |\n")
    return head + "".join(lines)
