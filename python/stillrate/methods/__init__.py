"""One configuration class a method."""

from stillrate.methods.imm import MsImmIkf, MsImmIkfPaper, SingerImmKf, SingerKf
from stillrate.methods.lowpass import Biquad, FirLowPass, OneEuro, Pt1
from stillrate.methods.recursive import (
    ArKf,
    CusumForgetting,
    LinearPrediction,
    RandomWalkKf,
    RecursiveLeastSquares,
    SageHusaKf,
    VariableForgetting,
)

__all__ = [
    "ArKf",
    "Biquad",
    "CusumForgetting",
    "FirLowPass",
    "LinearPrediction",
    "MsImmIkf",
    "MsImmIkfPaper",
    "OneEuro",
    "Pt1",
    "RandomWalkKf",
    "RecursiveLeastSquares",
    "SageHusaKf",
    "SingerImmKf",
    "SingerKf",
    "VariableForgetting",
]
