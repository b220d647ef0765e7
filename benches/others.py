"""What people use instead of stillrate, each set up to do the same work. Missing packages are reported, not hidden."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

PACKAGES = [
    *("numba", "filterpy", "stonesoup", "simdkalman", "pykalman", "kalbee", "fast-kalman", "scipy", "pandas"),
    *("padasip", "vqf", "imufusion", "AllanTools"),
]
Filter = Callable[[np.ndarray], np.ndarray]
Matrices = Sequence[tuple[np.ndarray, np.ndarray]]
H = np.array([[1.0, 0.0]])


def filterpy_imm(models: Matrices, r: float, pi: np.ndarray, mu0: np.ndarray, start: Sequence[float]) -> Filter:
    from filterpy.kalman import IMMEstimator, KalmanFilter

    def run(z: np.ndarray) -> np.ndarray:
        filters = []
        for (f, q), variance in zip(models, start, strict=True):
            one = KalmanFilter(dim_x=2, dim_z=1)
            one.F, one.Q, one.H, one.R = f, q, H, np.array([[r]])
            one.x, one.P = np.array([[z[0]], [0.0]]), np.diag([r, variance])
            filters.append(one)
        imm = IMMEstimator(filters, mu0.copy(), pi)
        out = np.empty(len(z))
        for t, value in enumerate(z):
            imm.predict()
            imm.update(np.array([[value]]))
            out[t] = imm.x[0, 0]
        return out

    return run


def filterpy_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    from filterpy.kalman import KalmanFilter

    def run(z: np.ndarray) -> np.ndarray:
        one = KalmanFilter(dim_x=2, dim_z=1)
        one.F, one.Q, one.H, one.R = f, q, H, np.array([[r]])
        one.x, one.P = np.array([[z[0]], [0.0]]), start.copy()
        out = np.empty(len(z))
        for t, value in enumerate(z):
            one.predict()
            one.update(value)
            out[t] = one.x[0, 0]
        return out

    return run


def stonesoup_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    from datetime import datetime, timedelta

    from stonesoup.models.measurement.linear import LinearGaussian
    from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
    from stonesoup.predictor.kalman import KalmanPredictor
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import KalmanUpdater

    predictor = KalmanPredictor(
        LinearGaussianTimeInvariantTransitionModel(transition_matrix=f, control_matrix=None, covariance_matrix=q)
    )
    updater = KalmanUpdater(LinearGaussian(ndim_state=2, mapping=[0], noise_covar=np.array([[r]])))
    begin, step = datetime(2026, 1, 1), timedelta(milliseconds=1)

    def run(z: np.ndarray) -> np.ndarray:
        state = GaussianState([[z[0]], [0.0]], start, timestamp=begin)
        out = np.empty(len(z))
        for t, value in enumerate(z):
            detection = Detection(np.array([[value]]), timestamp=begin + (t + 1) * step)
            prediction = predictor.predict(state, timestamp=detection.timestamp)
            state = updater.update(SingleHypothesis(prediction, detection))
            out[t] = state.state_vector[0, 0]
        return out

    return run


def simdkalman_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    import simdkalman

    one = simdkalman.KalmanFilter(state_transition=f, process_noise=q, observation_model=H, observation_noise=r)

    def run(z: np.ndarray) -> np.ndarray:
        # It updates first: the first prediction is made here.
        mean, covariance = f @ np.array([z[0], 0.0]), f @ start @ f.T + q
        found = one.compute(z, 0, initial_value=mean, initial_covariance=covariance, filtered=True, smoothed=False)
        return found.filtered.states.mean[:, 0]

    return run


def pykalman_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    from pykalman import KalmanFilter

    def run(z: np.ndarray) -> np.ndarray:
        one = KalmanFilter(
            transition_matrices=f,
            observation_matrices=H,
            transition_covariance=q,
            observation_covariance=[[r]],
            initial_state_mean=f @ np.array([z[0], 0.0]),
            initial_state_covariance=f @ start @ f.T + q,
        )
        return one.filter(z)[0][:, 0]

    return run


def kalbee_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    from kalbee import KalmanFilter

    def run(z: np.ndarray) -> np.ndarray:
        one = KalmanFilter(np.array([z[0], 0.0]), start.copy(), f, q, H, np.array([[r]]))
        out = np.empty(len(z))
        for t, value in enumerate(z):
            one.predict()
            one.update(np.array([value]))
            out[t] = np.ravel(one.x)[0]
        return out

    return run


def fast_kalman_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    import kalman

    def run(z: np.ndarray) -> np.ndarray:
        first, (p, transition, noise, h) = [z[0], 0.0], (m.ravel().tolist() for m in (start, f, q, H))
        one = kalman.LinearKalmanFilter(2, 1, x=first, P=p, F=transition, Q=noise, H=h, R=[r])
        out = np.empty(len(z))
        for t, value in enumerate(z):
            one.predict()
            one.correct([value])
            out[t] = one.x[0]
        return out

    return run


def kfilter_kalman(f: np.ndarray, q: np.ndarray, r: float, start: np.ndarray) -> Filter:
    """The Rust crate, compiled beside the benches."""
    import ctypes
    import subprocess
    from pathlib import Path

    folder = Path(__file__).parent / "kfilter"
    subprocess.run(["cargo", "build", "--release", "--quiet", "--target-dir", "target"], cwd=folder, check=True)
    library = ctypes.CDLL(str(folder / "target" / "release" / "libkfilter_peer.so"))

    def run(z: np.ndarray) -> np.ndarray:
        out = np.empty_like(z)
        at = [ctypes.c_void_p(array.ctypes.data) for array in (z, out, f, q)]
        library.kalman(ctypes.c_size_t(len(z)), *at, ctypes.c_double(r), ctypes.c_void_p(start.ctypes.data))
        return out

    return run


KALMAN: dict[str, Callable[[np.ndarray, np.ndarray, float, np.ndarray], Filter]] = {
    "filterpy": filterpy_kalman,
    "Stone Soup": stonesoup_kalman,
    "simdkalman": simdkalman_kalman,
    "pykalman": pykalman_kalman,
    "kalbee": kalbee_kalman,
    "fast-kalman": fast_kalman_kalman,
    "kfilter (Rust)": kfilter_kalman,
}


def vqf_call(period_s: float) -> Callable[[float], object]:
    from vqf import VQF

    attitude, rates = VQF(period_s), np.zeros(3)
    return lambda _: attitude.updateGyr(rates)


def imufusion_call(_: float) -> Callable[[float], object]:
    import imufusion

    ahrs, gyro, accel = imufusion.Ahrs(), np.zeros(3), np.array([0.0, 0.0, 1.0])
    return lambda _: ahrs.update_no_magnetometer(gyro, accel)


CALLS: dict[str, Callable[[float], Callable[[float], object]]] = {
    "vqf updateGyr": vqf_call,
    "imufusion update_no_magnetometer": imufusion_call,
}
"""Calls of one sample, for their overhead: from the sample period to the call."""


def allantools_octave() -> Callable[[np.ndarray, float], np.ndarray]:
    import allantools

    return lambda z, rate_hz: allantools.oadev(z, rate=rate_hz, data_type="freq", taus="octave")[1]
