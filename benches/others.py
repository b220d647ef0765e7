"""What people use instead of stillrate, each set up to do the same work. Missing packages are reported, not hidden."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

PACKAGES = [
    *("numba", "filterpy", "stonesoup", "simdkalman", "pykalman", "kalbee", "fast-kalman", "scipy", "pandas"),
    *("padasip", "vqf", "imufusion", "AllanTools"),
]
Filter = Callable[[np.ndarray], np.ndarray]
Matrices = Sequence[tuple[np.ndarray, np.ndarray]]
H = np.array([[1.0, 0.0]])


def numba_imm(models: Matrices, r: float, pi: np.ndarray, mu0: np.ndarray, start: Sequence[float]) -> Filter:
    import numba

    fs, qs = np.array([m[0] for m in models]), np.array([m[1] for m in models])

    @numba.njit
    def run(z, fs, qs, r, pi, mu0, start):
        n = len(z)
        out = np.empty(n)
        mu = mu0.copy()
        x, p = np.zeros((2, 2)), np.zeros((2, 2, 2))
        x0, p0, a = np.zeros((2, 2)), np.zeros((2, 2, 2)), np.zeros((2, 2))
        c, weight = np.zeros(2), np.zeros(2)
        for m in range(2):
            x[m, 0], p[m, 0, 0], p[m, 1, 1] = z[0], r, start[m]
        for t in range(n):
            for j in range(2):
                c[j] = pi[0, j] * mu[0] + pi[1, j] * mu[1]
            for j in range(2):
                w0, w1 = pi[0, j] * mu[0] / c[j], pi[1, j] * mu[1] / c[j]
                for i in range(2):
                    x0[j, i] = w0 * x[0, i] + w1 * x[1, i]
                for i in range(2):
                    for k in range(2):
                        d0 = (x[0, i] - x0[j, i]) * (x[0, k] - x0[j, k])
                        d1 = (x[1, i] - x0[j, i]) * (x[1, k] - x0[j, k])
                        p0[j, i, k] = w0 * (p[0, i, k] + d0) + w1 * (p[1, i, k] + d1)
            for j in range(2):
                f, q = fs[j], qs[j]
                m0 = f[0, 0] * x0[j, 0] + f[0, 1] * x0[j, 1]
                m1 = f[1, 0] * x0[j, 0] + f[1, 1] * x0[j, 1]
                for i in range(2):
                    for k in range(2):
                        a[i, k] = f[i, 0] * p0[j, 0, k] + f[i, 1] * p0[j, 1, k]
                for i in range(2):
                    for k in range(2):
                        p[j, i, k] = a[i, 0] * f[k, 0] + a[i, 1] * f[k, 1] + q[i, k]
                s, nu = p[j, 0, 0] + r, z[t] - m0
                k0, k1 = p[j, 0, 0] / s, p[j, 1, 0] / s
                x[j, 0], x[j, 1] = m0 + k0 * nu, m1 + k1 * nu
                p00, p01 = p[j, 0, 0], p[j, 0, 1]
                p[j, 0, 0], p[j, 0, 1] = (1 - k0) * p00, (1 - k0) * p01
                p[j, 1, 0], p[j, 1, 1] = p[j, 1, 0] - k1 * p00, p[j, 1, 1] - k1 * p01
                weight[j] = c[j] * math.exp(-0.5 * nu * nu / s) / math.sqrt(2 * math.pi * s)
            total = weight[0] + weight[1]
            mu[0], mu[1] = weight[0] / total, weight[1] / total
            out[t] = mu[0] * x[0, 0] + mu[1] * x[1, 0]
        return out

    return lambda z: run(z, fs, qs, r, pi, mu0, np.array(start))


def numba_imm_of_any_size(
    models: Matrices, r: float, pi: np.ndarray, mu0: np.ndarray, start: Sequence[float]
) -> Filter:
    """Matrix products as one writes them with numpy, compiled."""
    import numba

    fs, qs = np.array([m[0] for m in models]), np.array([m[1] for m in models])
    covariances = np.array([np.diag([r, variance]) for variance in start])

    @numba.njit
    def run(z, fs, qs, r, pi, mu0, covariances):
        m, n = fs.shape[0], fs.shape[1]
        x, p, mu = np.zeros((m, n)), covariances.copy(), mu0.copy()
        x[:, 0] = z[0]
        x0, p0 = np.zeros((m, n)), np.zeros((m, n, n))
        a, b, k, weight, c = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n), np.zeros(m), np.zeros(m)
        out = np.empty(len(z))
        for t in range(len(z)):
            for j in range(m):
                c[j] = 0.0
                for i in range(m):
                    c[j] += pi[i, j] * mu[i]
            for j in range(m):
                x0[j], p0[j] = 0.0, 0.0
                for i in range(m):
                    for u in range(n):
                        x0[j, u] += pi[i, j] * mu[i] / c[j] * x[i, u]
                for i in range(m):
                    for u in range(n):
                        for v in range(n):
                            spread = (x[i, u] - x0[j, u]) * (x[i, v] - x0[j, v])
                            p0[j, u, v] += pi[i, j] * mu[i] / c[j] * (p[i, u, v] + spread)
            for j in range(m):
                for u in range(n):
                    x[j, u] = 0.0
                    for v in range(n):
                        x[j, u] += fs[j, u, v] * x0[j, v]
                        a[u, v] = 0.0
                        for w in range(n):
                            a[u, v] += fs[j, u, w] * p0[j, w, v]
                for u in range(n):
                    for v in range(n):
                        b[u, v] = qs[j, u, v]
                        for w in range(n):
                            b[u, v] += a[u, w] * fs[j, v, w]
                s, nu = b[0, 0] + r, z[t] - x[j, 0]
                for u in range(n):
                    k[u] = b[u, 0] / s
                    x[j, u] += k[u] * nu
                for u in range(n):
                    for v in range(n):
                        p[j, u, v] = b[u, v] - k[u] * b[0, v]
                weight[j] = c[j] * math.exp(-0.5 * nu * nu / s) / math.sqrt(2 * math.pi * s)
            total = weight.sum()
            out[t] = 0.0
            for j in range(m):
                mu[j] = weight[j] / total
                out[t] += mu[j] * x[j, 0]
        return out

    return lambda z: run(z, fs, qs, r, pi, mu0, covariances)


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
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=folder, check=True)
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


def streaming(period_s: float) -> dict[str, Callable[[float], object]]:
    """Calls of one sample, for their overhead."""
    calls: dict[str, Callable[[float], object]] = {}
    try:
        from vqf import VQF

        attitude, rates = VQF(period_s), np.zeros(3)
        calls["vqf updateGyr"] = lambda _: attitude.updateGyr(rates)
    except ImportError:
        pass
    try:
        import imufusion

        ahrs, gyro, accel = imufusion.Ahrs(), np.zeros(3), np.array([0.0, 0.0, 1.0])
        calls["imufusion update_no_magnetometer"] = lambda _: ahrs.update_no_magnetometer(gyro, accel)
    except (ImportError, AttributeError):
        pass
    return calls


def allantools_octave(z: np.ndarray, rate_hz: float) -> np.ndarray:
    import allantools

    return allantools.oadev(z, rate=rate_hz, data_type="freq", taus="octave")[1]
