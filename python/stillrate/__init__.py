"""A gyro signal made still without being made late: denoise and calibrate inertial sensors."""

from typing import TYPE_CHECKING, Any

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
from stillrate.noise import GyroNoise, NoiseFromLog, noise_from_log
from stillrate.results import Estimate, Flags, Trace

if TYPE_CHECKING:
    from stillrate import attitude, closed_forms, fleet, gimbal, metrics, platform, rate_table, simulate
    from stillrate.allan_deviation import Allan, allan
    from stillrate.bias import ReferenceBias, reference_bias
    from stillrate.denoising import denoise
    from stillrate.io import Log, read, write
    from stillrate.observe import Observability, bench_imu, observability
    from stillrate.singer import SingerCoefficients, singer_coefficients
    from stillrate.tuning import tune
    from stillrate.vector_rls import VectorRls

# What filtering does not need, by the module it lives in; a name that is its own module stands for the module.
_LATER = {
    "Allan": "allan_deviation",
    "Log": "io",
    "Observability": "observe",
    "ReferenceBias": "bias",
    "SingerCoefficients": "singer",
    "VectorRls": "vector_rls",
    "allan": "allan_deviation",
    "attitude": "attitude",
    "bench_imu": "observe",
    "closed_forms": "closed_forms",
    "denoise": "denoising",
    "fleet": "fleet",
    "gimbal": "gimbal",
    "metrics": "metrics",
    "observability": "observe",
    "platform": "platform",
    "rate_table": "rate_table",
    "read": "io",
    "reference_bias": "bias",
    "simulate": "simulate",
    "singer_coefficients": "singer",
    "tune": "tuning",
    "write": "io",
}

__all__ = [
    "Allan",
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
    "Log",
    "LogError",
    "MsImmIkf",
    "MsImmIkfPaper",
    "NoiseFromLog",
    "Observability",
    "OneEuro",
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
    "allan",
    "attitude",
    "bench_imu",
    "closed_forms",
    "denoise",
    "fleet",
    "gimbal",
    "load_config",
    "metrics",
    "noise_from_log",
    "observability",
    "platform",
    "rate_table",
    "read",
    "reference_bias",
    "simulate",
    "singer_coefficients",
    "tune",
    "write",
]


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__") and name.endswith("__"))})


# Not for type checkers: they would take every misspelt name for one that comes later.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Import what is not needed for filtering when it is first asked for."""
        if name not in _LATER:
            from stillrate.errors import nearest

            raise AttributeError(f"stillrate has no {name!r}{nearest(name, __all__)}", name=name)
        import importlib

        module = importlib.import_module(f"stillrate.{_LATER[name]}")
        found = module if _LATER[name] == name else getattr(module, name)
        globals()[name] = found
        return found
