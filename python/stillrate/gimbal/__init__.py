"""Continuous calibration of a gimballed sensor head from its commands and its accelerometers alone.

A platform with three gyros and three accelerometers tumbles under command; `calibrate` finds 30 coefficients (attitude, gyro
drift, g-sensitive terms, mountings, accelerometer bias, scale and mountings) and up to eight optional ones. All numbers are SI: rad, rad/s,
m/s^2. Source: a reconstruction of DOI 10.3873/j.issn.1000-1328.2017.06.009.
"""

from stillrate.gimbal.calibration import Calibration, History, calibrate
from stillrate.gimbal.design import Bound, Plan, bound, plan, trajectory
from stillrate.gimbal.head import NAMES, Floats, Head
from stillrate.gimbal.truth import draw, score, simulate, to_gauge

__all__ = [
    "NAMES",
    "Bound",
    "Calibration",
    "Floats",
    "Head",
    "History",
    "Plan",
    "bound",
    "calibrate",
    "draw",
    "plan",
    "score",
    "simulate",
    "to_gauge",
    "trajectory",
]
