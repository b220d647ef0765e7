"""A gyro signal made still without being made late: denoise and calibrate inertial sensors."""

from stillrate import platform
from stillrate._native import Filter, __version__
from stillrate.config import Config, MsImmIkf, MsImmIkfPaper, Pt1, SingerImmKf, SingerKf, load_config
from stillrate.errors import ConfigError, LogError
from stillrate.noise import GyroNoise
from stillrate.results import Estimate, Flags, Trace
from stillrate.singer import SingerCoefficients, singer_coefficients

__all__ = [
    "Config",
    "ConfigError",
    "Estimate",
    "Filter",
    "Flags",
    "GyroNoise",
    "LogError",
    "MsImmIkf",
    "MsImmIkfPaper",
    "Pt1",
    "SingerCoefficients",
    "SingerImmKf",
    "SingerKf",
    "Trace",
    "__version__",
    "load_config",
    "platform",
    "singer_coefficients",
]
