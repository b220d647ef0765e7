"""What stands on the bench: plant, controller, gyro, filter; frozen, checked by the numerics when they run."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stillrate.config import Config
from stillrate.errors import ConfigError
from stillrate.noise import GyroNoise
from stillrate.platform.plant import Plant, PlatformDesign

Link = tuple[str, dict[str, float | str | list[float]]]
"""A method and its settings, as the numerics take them."""


@dataclass(frozen=True, kw_only=True)
class Controller:
    """Rate controller with an angle loop around it.

    Parameters
    ----------
    kappa : float
        Gain of the rate loop relative to the motor constant.
    ko_per_s : float
        Angle gain, 1/s.
    kvi_per_s : float
        Gain of the rate integral, 1/s.
    kd_s : float
        Rate derivative, s.
    rate_demand_max_dps : float
        Largest rate the angle loop may ask for, deg/s.
    angle_from_filtered : bool
        Integrate the filtered rate instead of the raw one; adaptive filters then lose slow motion.
    inclinometer_time_s : float
        Time constant of the correction by an inclinometer, s; 0 is none.

    Examples
    --------
    A biased gyro lets the platform drift away; an inclinometer holds what a gyro alone cannot know:

    >>> from stillrate.platform import Constant, run
    >>> biased = GyroErrors(bias_dps=0.05)
    >>> drifted = run(Constant(), gyro=biased, duration_s=60.0).angle_deg[-1]
    >>> levelled = Controller(inclinometer_time_s=5.0)
    >>> held = run(Constant(), gyro=biased, controller=levelled, duration_s=60.0).angle_deg[-1]
    >>> bool(abs(drifted) > 2.5 and abs(held) < 0.5)
    True
    """

    kappa: float = 0.179
    ko_per_s: float = 0.3
    kvi_per_s: float = 72.7
    kd_s: float = 0.65e-3
    rate_demand_max_dps: float = math.degrees(1.2)
    angle_from_filtered: bool = False
    inclinometer_time_s: float = 0.0


__all__ = [
    "Controller",
    "GyroErrors",
    "Link",
    "LoopButterworth",
    "LoopFilter",
    "LoopKalman",
    "LoopPt1",
    "Plant",
    "PlatformDesign",
    "Setup",
    "links",
]


@dataclass(frozen=True, kw_only=True, eq=False)
class GyroErrors:
    """What the gyro adds to the true rate; `samples_dps` are added as they are, one a control tick.

    Examples
    --------
    >>> from stillrate.platform import Constant, run
    >>> coarse = GyroErrors(bias_dps=0.11, lsb_dps=0.0625)
    >>> float(np.degrees(run(Constant(), gyro=coarse, duration_s=0.02).column("y")[0]).round(4))
    0.125
    """

    white_sigma_dps: float = 0.0
    bias_dps: float = 0.0
    scale_error: float = 0.0
    lsb_dps: float = 0.0
    seed: int = 0
    samples_dps: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        samples = np.ascontiguousarray(self.samples_dps, dtype=np.float64)
        if samples.ndim != 1:
            raise ConfigError(f"samples_dps has shape {samples.shape} (must be (n,))")
        object.__setattr__(self, "samples_dps", samples)


@dataclass(frozen=True, kw_only=True)
class LoopPt1:
    """First-order low-pass by exact discretisation, started at the first sample.

    Examples
    --------
    >>> LoopPt1(cutoff_hz=5.3).link(50.0)
    ('loop-pt1', {'sample_rate_hz': 50.0, 'cutoff_hz': 5.3})
    """

    cutoff_hz: float

    def link(self, sample_rate_hz: float) -> Link:
        """Return method and settings."""
        return "loop-pt1", {"sample_rate_hz": sample_rate_hz, "cutoff_hz": self.cutoff_hz}


@dataclass(frozen=True, kw_only=True)
class LoopButterworth:
    """Second-order Butterworth low-pass, bilinear with prewarping, started in the first sample's steady state.

    Examples
    --------
    At its cut-off it is 90 deg late and passes half the power, like its continuous model:

    >>> from stillrate.platform import describe
    >>> ((gain, phase),) = describe(LoopButterworth(cutoff_hz=8.0), frequency_hz=8.0, amplitudes_dps=(60.0,))
    >>> round(gain, 2), round(phase)
    (0.71, -90)
    >>> LoopButterworth(cutoff_hz=8.0).link(50.0)[0]
    'loop-butterworth'
    """

    cutoff_hz: float

    def link(self, sample_rate_hz: float) -> Link:
        """Return method and settings."""
        return "loop-butterworth", {"sample_rate_hz": sample_rate_hz, "cutoff_hz": self.cutoff_hz}


@dataclass(frozen=True, kw_only=True)
class LoopKalman:
    """Scalar Kalman filter x <- phi x with noise ratio q/R, P0/R = 1.

    Examples
    --------
    With phi below 1 it believes that every motion ends, and passes less than all of a steady one:

    >>> from stillrate.platform import describe
    >>> ((gain, _),) = describe(LoopKalman(phi=0.9, ratio=0.1), frequency_hz=0.01, amplitudes_dps=(60.0,), periods=1)
    >>> gain < 0.8
    True
    >>> LoopKalman(phi=0.9, ratio=0.1).link(50.0)
    ('loop-kalman', {'phi': 0.9, 'ratio': 0.1})
    """

    phi: float = 1.0
    ratio: float = 0.1

    def link(self, sample_rate_hz: float) -> Link:
        """Return method and settings."""
        return "loop-kalman", {"phi": self.phi, "ratio": self.ratio}


LoopFilter = Config | LoopPt1 | LoopButterworth | LoopKalman
"""What may stand in the loop: any configuration of the library, or a textbook filter."""


def links(chosen: LoopFilter | Sequence[LoopFilter] | None, sample_rate_hz: float) -> list[Link]:
    """Return the chain of methods and settings that a filter argument stands for."""
    if chosen is None:
        return []
    if isinstance(chosen, Sequence):
        return [link for item in chosen for link in links(item, sample_rate_hz)]
    if isinstance(chosen, Config):
        if chosen.sample_rate_hz != sample_rate_hz:
            raise ConfigError(
                f"sample_rate_hz = {chosen.sample_rate_hz:g} of the filter (must be the loop's {sample_rate_hz:g} Hz)"
            )
        return [(chosen.method, chosen.settings())]
    return [chosen.link(sample_rate_hz)]


def _paper_noise() -> GyroNoise:
    # Taken as white.
    density = 0.1074 / math.sqrt(50.0)
    return GyroNoise(density_dps_sqrt_hz=density, rate_random_walk_dps_sqrt_s=0.2184 * density)


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A plant with its timing, its gyro and its standard motion.

    Parameters
    ----------
    plant : Plant
    sample_rate_hz : float
        Control rate in Hz.
    dt_s : float
        Integration step in s.
    delay_s : float
        Delay from gyro to voltage in s.
    noise : GyroNoise
        The gyro's noise; white samples of N sqrt(rate) are simulated, filters are told N and K.
    bias_dps : float
        Constant bias of the gyro, deg/s.
    amplitude_deg, frequency_hz : float
        The base motion that residuals are measured in: degrees and Hz.
    drive_range_deg : float
        Where the drive is at its end (flagged), deg.
    range_deg : float
        Base angle from which there is a warning, deg.

    Examples
    --------
    >>> faster = Setup().replace(sample_rate_hz=200.0, delay_s=2e-3)
    >>> faster.noise == Setup().noise  # a density: the samples get noisier, the gyro does not
    True
    >>> Setup.camera_gimbal().plant.gear_ratio
    1.0
    """

    plant: Plant = field(default_factory=Plant.platform_30kg)
    sample_rate_hz: float = 50.0
    dt_s: float = 1e-3
    delay_s: float = 5e-3
    noise: GyroNoise = field(default_factory=_paper_noise)
    bias_dps: float = 0.005
    amplitude_deg: float = 10.0
    frequency_hz: float = 1.0
    drive_range_deg: float = math.degrees(0.5)
    range_deg: float = 20.0

    @classmethod
    def camera_gimbal(cls) -> Setup:
        """Return a small camera gimbal at 200 Hz with a typical MEMS gyro."""
        return cls(
            plant=Plant.camera_gimbal(),
            sample_rate_hz=200.0,
            dt_s=0.25e-3,
            delay_s=2e-3,
            noise=GyroNoise(density_dps_sqrt_hz=0.005, rate_random_walk_dps_sqrt_s=0.001),
            drive_range_deg=45.0,
            range_deg=35.0,
        )

    def replace(self, **changes: object) -> Setup:
        """Return a copy with some entries changed."""
        return dataclasses.replace(self, **changes)  # type: ignore[arg-type]
