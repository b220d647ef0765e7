"""A gyro signal made still without being made late: denoise and calibrate inertial sensors."""

from stillrate import metrics, simulate
from stillrate._native import Filter, __version__
from stillrate.allan_deviation import Allan, allan
from stillrate.config import Config, MsImmIkf, MsImmIkfPaper, Pt1, SingerImmKf, SingerKf, load_config
from stillrate.errors import ConfigError, LogError
from stillrate.noise import GyroNoise, NoiseFromLog, noise_from_log
from stillrate.results import Estimate, Flags, Trace
from stillrate.singer import SingerCoefficients, singer_coefficients

__all__ = [
    "Allan",
    "Config",
    "ConfigError",
    "Estimate",
    "Filter",
    "Flags",
    "GyroNoise",
    "LogError",
    "MsImmIkf",
    "MsImmIkfPaper",
    "NoiseFromLog",
    "Pt1",
    "SingerCoefficients",
    "SingerImmKf",
    "SingerKf",
    "Trace",
    "__version__",
    "allan",
    "load_config",
    "metrics",
    "noise_from_log",
    "simulate",
    "singer_coefficients",
]
