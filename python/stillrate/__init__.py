"""A gyro signal made still without being made late: denoise and calibrate inertial sensors."""

from stillrate import gimbal
from stillrate import platform
from stillrate import attitude, closed_forms
from stillrate._native import Filter, __version__
from stillrate.bias import ReferenceBias, reference_bias
from stillrate import gimbal, metrics, platform, rate_table, simulate
from stillrate.allan_deviation import Allan, allan
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
from stillrate.noise import GyroNoise, NoiseFromLog, noise_from_log
from stillrate.observe import Observability, bench_imu, observability
from stillrate.results import Estimate, Flags, Trace
from stillrate.singer import SingerCoefficients, singer_coefficients
from stillrate.vector_rls import VectorRls

__all__ = [
    "ArKf",
    "Biquad",
    "Allan",
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
    "Observability",
    "OneEuro",
    "NoiseFromLog",
    "Pt1",
    "RandomWalkKf",
    "RecursiveLeastSquares",
    "ReferenceBias",
    "SageHusaKf",
    "SingerCoefficients",
    "SingerImmKf",
    "SingerKf",
    "Trace",
    "VariableForgetting",
    "VectorRls",
    "__version__",
    "gimbal",
    "load_config",
    "platform",
    "allan",
    "metrics",
    "noise_from_log",
    "simulate",
    "attitude",
    "bench_imu",
    "closed_forms",
    "observability",
    "reference_bias",
    "rate_table",
    "singer_coefficients",
]
