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
    from stillrate import gimbal, metrics, platform, simulate
    from stillrate.allan_deviation import Allan, allan
    from stillrate.cleaning import denoise
    from stillrate.io import Log, read, write
    from stillrate.singer import SingerCoefficients, singer_coefficients
    from stillrate.tuning import tune

# What filtering does not need, by the module it lives in; a name that is its own module stands for the module.
_LATER = {
    "Allan": "allan_deviation",
    "Log": "io",
    "SingerCoefficients": "singer",
    "allan": "allan_deviation",
    "denoise": "cleaning",
    "gimbal": "gimbal",
    "metrics": "metrics",
    "platform": "platform",
    "read": "io",
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
    "allan",
    "denoise",
    "gimbal",
    "load_config",
    "metrics",
    "noise_from_log",
    "platform",
    "read",
    "simulate",
    "singer_coefficients",
    "tune",
    "write",
]


def __getattr__(name: str) -> Any:
    """Import what is not needed for filtering when it is first asked for."""
    if name not in _LATER:
        import difflib

        near = difflib.get_close_matches(name, __all__, n=1)
        raise AttributeError(f"stillrate has no {name!r}" + (f": did you mean {near[0]!r}?" if near else ""))
    import importlib

    module = importlib.import_module(f"stillrate.{_LATER[name]}")
    found = module if _LATER[name] == name else getattr(module, name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
