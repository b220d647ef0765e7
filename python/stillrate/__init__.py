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
from stillrate.noise import GyroNoise
from stillrate.results import Estimate, Flags, Trace
from stillrate.singer import SingerCoefficients, singer_coefficients

if TYPE_CHECKING:
    from stillrate import gimbal, platform
    from stillrate.io import Log, read, write

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
    "Log",
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
from typing import TYPE_CHECKING, Any

    "singer_coefficients",
    "write",
]

# What filtering does not need, by the module it lives in; a name that is its own module stands for the module.
_LATER = {"Log": "io", "gimbal": "gimbal", "platform": "platform", "read": "io", "write": "io"}


def __getattr__(name: str) -> Any:
    """Import what is not needed for filtering when it is first asked for."""
    if name not in _LATER:
        import difflib

        near = difflib.get_close_matches(name, __all__, n=1)
        raise AttributeError(f"stillrate has no {name!r}" + (f": did you mean {near[0]!r}?" if near else ""))
    import importlib

    module = importlib.import_module(f"stillrate.{_LATER[name]}")
    return module if _LATER[name] == name else getattr(module, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
