"""A gyro signal made still without being made late: denoise and calibrate inertial sensors."""

from stillrate._native import Filter, __version__
from stillrate.config import Config, MsImmIkf, Pt1, load_config
from stillrate.errors import ConfigError, LogError
from stillrate.noise import GyroNoise
from stillrate.results import Estimate, Flags, Trace

__all__ = [
    "Config",
    "ConfigError",
    "Estimate",
    "Filter",
    "Flags",
    "GyroNoise",
    "LogError",
    "MsImmIkf",
    "Pt1",
    "Trace",
    "__version__",
    "load_config",
]
