"""How the base moves under the platform."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stillrate.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class Tilt:
    """The base tilts from 0 to `amplitude_deg` in `duration_s`, along half a cosine.

    Examples
    --------
    >>> from stillrate.platform import run
    >>> run(Tilt(amplitude_deg=15.0), duration_s=1.0).base_deg[[0, -1]].round(3).tolist()
    [0.0, 15.0]
    """

    kind: ClassVar[str] = "tilt"
    amplitude_deg: float
    duration_s: float = 0.5


@dataclass(frozen=True, kw_only=True)
class Sine:
    """The base swings by `amplitude_deg` at `frequency_hz`, faded in over `ramp_s`.

    Examples
    --------
    10 deg at 1 Hz take a drive of 63 deg/s; a spindle of 10 mm lead has 34:

    >>> from stillrate.platform import Plant, PlatformDesign, Setup, run
    >>> short = Setup(plant=Plant.from_design(PlatformDesign(lead_m=0.01)))
    >>> run(Sine(amplitude_deg=10.0, frequency_hz=1.0), setup=short, duration_s=1.0).warnings[0][:51]
    'unreachable: the base needs 62.8 deg/s, the drive h'
    """

    kind: ClassVar[str] = "sine"
    amplitude_deg: float = 10.0
    frequency_hz: float = 1.0
    ramp_s: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Constant:
    """The base stands still at `angle_deg`.

    Examples
    --------
    A platform that starts upright stays so, whatever its base leans:

    >>> from stillrate.platform import GyroErrors, run
    >>> leaning = run(Constant(angle_deg=10.0), gyro=GyroErrors())
    >>> bool(abs(leaning.angle_deg).max() < 0.1)
    True
    """

    kind: ClassVar[str] = "constant"
    angle_deg: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Recorded:
    """The base follows a recorded rate.

    The mean rate is taken out, the integral is centred, and the whole is scaled down (never up) to `range_deg`.

    Examples
    --------
    >>> from stillrate.platform import run
    >>> rolling = 40.0 * np.sin(np.arange(800) / 100.0)  # 40 deg to either side, in deg/s at 100 Hz
    >>> motion = Recorded(rate_dps=rolling, sample_rate_hz=100.0, range_deg=5.0)
    >>> float(abs(run(motion).base_deg).max().round(2))
    5.0
    """

    kind: ClassVar[str] = "recorded"
    rate_dps: NDArray[np.float64]
    sample_rate_hz: float
    range_deg: float = 20.0

    def __post_init__(self) -> None:
        rate = np.ascontiguousarray(np.ma.filled(np.ma.asarray(self.rate_dps, dtype=float), np.nan), dtype=np.float64)
        if rate.ndim != 1:
            raise ConfigError(f"rate_dps has shape {rate.shape} (must be one axis: (n,))")
        object.__setattr__(self, "rate_dps", rate)


Base = Tilt | Sine | Constant | Recorded
