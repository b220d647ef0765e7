"""The servo platform that a gyro serves: run it, tune it, and propagate its gyro's noise.

`run` simulates one axis (drive, friction, play, delay, limits) with any filter of the library in the loop; `tune` finds
controller and filter together at a budget of actuator jitter; `drift` and `variance` give the angle error
of linear loops in closed form.
"""

from stillrate.platform.describing import describe, integration_error
from stillrate.platform.drift import Drift, LoopNoise, drift, variance
from stillrate.platform.model import (
    Controller,
    GyroErrors,
    LoopButterworth,
    LoopKalman,
    LoopPt1,
    Plant,
    PlatformDesign,
    Setup,
)
from stillrate.platform.motion import Base, Constant, Recorded, Sine, Tilt
from stillrate.platform.running import Run, open_loop, run
from stillrate.platform.tuning import (
    Family,
    Row,
    Tuned,
    families,
    tilt_table,
    tune,
    validate,
)

__all__ = [
    "Base",
    "Constant",
    "Controller",
    "Drift",
    "Family",
    "GyroErrors",
    "LoopButterworth",
    "LoopKalman",
    "LoopNoise",
    "LoopPt1",
    "Plant",
    "PlatformDesign",
    "Recorded",
    "Row",
    "Run",
    "Setup",
    "Sine",
    "Tilt",
    "Tuned",
    "describe",
    "drift",
    "families",
    "integration_error",
    "open_loop",
    "run",
    "tilt_table",
    "tune",
    "validate",
    "variance",
]
