"""Records of the simulated gyro on a turntable."""

from __future__ import annotations

import numpy as np
from stillrate import _native

RATE_HZ = 2000.0


def sine(amplitude, hz, seconds=10.0, unit=0, seed=5):
    """Return the true and the measured rate of a swinging table, deg/s."""
    truth = amplitude * np.sin(2 * np.pi * hz * np.arange(int(seconds * RATE_HZ)) / RATE_HZ)
    return truth, _native.rate_table_record(truth.tolist(), unit, seed, RATE_HZ)
