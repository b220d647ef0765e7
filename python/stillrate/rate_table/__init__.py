"""What is wrong with a gyro's rate as a function of the rate, fitted so that it holds on rates not seen.

`fit` turns a rate-table log into an `ErrorModel`; `tune` finds the noise of the filters that go with it. The published
1-10-1 network can be built with `Network` to see what it does; `ErrorModel.check` refuses it.
"""

from stillrate.rate_table.fitting import fit, fit_points, plateaus
from stillrate.rate_table.model import ErrorModel
from stillrate.rate_table.network import Network, train
from stillrate.rate_table.optimise import Minimum, minimise, qpso_trace, uniforms
from stillrate.rate_table.parts import Calibration, Candidate, Score
from stillrate.rate_table.tuning import Errors, KalmanRun, TunedNoise, TuningWarning, compare, kalman, track, tune

__all__ = [
    "Calibration",
    "Candidate",
    "ErrorModel",
    "Errors",
    "KalmanRun",
    "Minimum",
    "Network",
    "Score",
    "TunedNoise",
    "TuningWarning",
    "compare",
    "fit",
    "fit_points",
    "kalman",
    "minimise",
    "plateaus",
    "qpso_trace",
    "track",
    "train",
    "tune",
    "uniforms",
]
