"""Two interacting models as one writes them for numba: once for two models of two states, once for any number of either."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from others import Filter, Matrices


def unrolled(models: Matrices, r: float, pi: np.ndarray, mu0: np.ndarray, start: Sequence[float]) -> Filter:
    """Everything written out for two models of two states."""
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


def any_size(models: Matrices, r: float, pi: np.ndarray, mu0: np.ndarray, start: Sequence[float]) -> Filter:
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
