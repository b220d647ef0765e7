"""A gyro signal made still without being made late: denoise and calibrate inertial sensors."""

from stillrate import gimbal
from stillrate import platform
from stillrate._native import Filter, __version__
from stillrate.config import Config, load_config
from stillrate.errors import ConfigError, LogError
from stillrate.methods import (
    ArKf,
    Biquad,
    CusumForgetting,
    FirLowPass,
    LinearPrediction,
    MsImmIkf,
    MsImmIkfPaper,
    OneEuro,
    Pt1,
    RandomWalkKf,
    RecursiveLeastSquares,
    SageHusaKf,
    SingerImmKf,
    SingerKf,
    VariableForgetting,
)
from stillrate.noise import GyroNoise
from stillrate.results import Estimate, Flags, Trace
from stillrate.singer import SingerCoefficients, singer_coefficients

__all__ = [
    "ArKf",
    "Biquad",
    "Config",
    "ConfigError",
    "CusumForgetting",
    "Estimate",
    "Filter",
    "FirLowPass",
    "Flags",
    "GyroNoise",
    "LinearPrediction",
    "LogError",
    "MsImmIkf",
    "MsImmIkfPaper",
    "OneEuro",
    "Pt1",
    "RandomWalkKf",
    "RecursiveLeastSquares",
    "SageHusaKf",
    "SingerCoefficients",
    "SingerImmKf",
    "SingerKf",
    "Trace",
    "VariableForgetting",
    "__version__",
    "gimbal",
    "load_config",
    "platform",
    "singer_coefficients",
]
