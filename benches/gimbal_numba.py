"""The joint gimbal filters as one would write them with numba: covariance form, loops that use the structure, or dense matrices.

The same algorithm as `stillrate.gimbal` ("on-line" and "relinearised", plain windows about the model, unrefined step) for 30 coefficients in
scaled numbers; nothing is allocated per epoch in the "tight" form, the "dense" form multiplies 30 x 30 matrices.
"""

from __future__ import annotations

import math

import numpy as np
from gimbal_numba_model import axes, product, rotation, step, turning, window
from numba import njit

N = 30
FREE = np.array([*range(27), 28, 29, 32])
PASSES_S = (15.0, 30.0, 60.0, 120.0, 240.0, 480.0, 900.0, 900.0)


@njit
def predict_tight(p, phi, gamma, scale, top):
    """P <- F P F^T where only the first three rows of F differ from the identity."""
    for row in range(3):
        for c in range(N):
            top[row, c] = 0.0
        for i in range(3):
            factor = phi[row, i] * scale[i] / scale[row]
            for c in range(N):
                top[row, c] += factor * p[i, c]
        for i in range(18):
            factor = gamma[row, i]
            for c in range(N):
                top[row, c] += factor * p[3 + i, c]
    for row in range(3):
        for c in range(3, N):
            p[row, c] = top[row, c]
            p[c, row] = top[row, c]
    for row in range(3):
        for column in range(3):
            total = 0.0
            for i in range(3):
                total += top[row, i] * phi[column, i] * scale[i] / scale[column]
            for i in range(18):
                total += top[row, 3 + i] * gamma[column, i]
            p[row, column] = total


@njit
def predict_dense(p, phi, gamma, scale, big):
    for row in range(3):
        for i in range(3):
            big[row, i] = phi[row, i] * scale[i] / scale[row]
        for i in range(18):
            big[row, 3 + i] = gamma[row, i]
    p[:] = big @ p @ big.T


@njit
def measure(axis, f, x, force, scale, h):
    """Derivatives of an output by the scaled numbers."""
    a = force[axis, 0]
    slope = 1.0 + x[24 + axis]
    h[:] = 0.0
    h[0] = slope * (a[1] * f[2] - a[2] * f[1]) * scale[0]
    h[1] = slope * (a[2] * f[0] - a[0] * f[2]) * scale[1]
    h[2] = slope * (a[0] * f[1] - a[1] * f[0]) * scale[2]
    h[21 + axis] = scale[21 + axis]
    h[24 + axis] = (a[0] * f[0] + a[1] * f[1] + a[2] * f[2]) * scale[24 + axis]
    pendulous = slope * (force[axis, 1, 0] * f[0] + force[axis, 1, 1] * f[1] + force[axis, 1, 2] * f[2])
    output = slope * (force[axis, 2, 0] * f[0] + force[axis, 2, 1] * f[1] + force[axis, 2, 2] * f[2])
    if axis > 0:
        h[26 + axis] = pendulous * scale[27]
    if axis == 2:
        h[29] = output * scale[27]


@njit
def update_tight(p, h, variance, residual, d, ph):
    """One scalar measurement; P stays symmetric because both halves are written."""
    for i in range(N):
        ph[i] = 0.0
    for c in range(N):
        if h[c] != 0.0:
            for i in range(N):
                ph[i] += h[c] * p[c, i]
    s, innovation = variance, residual
    for i in range(N):
        s += h[i] * ph[i]
        innovation -= h[i] * d[i]
    for i in range(N):
        gain = ph[i] / s
        d[i] += gain * innovation
        for c in range(N):
            p[i, c] -= gain * ph[c]


@njit
def update_dense(p, h, variance, residual, d, ph):
    ph[:] = p @ h
    s = variance + h @ ph
    innovation = residual - h @ d
    d += ph * (innovation / s)
    p -= np.outer(ph, ph) / s


@njit
def on_line(commands, samples, dt, sigma, gravity, earth, scale33, free, second_order, half, dense):
    n, per = len(commands), (len(samples) - 1) // len(commands)
    scale = scale33[free]
    x, r, p, big = np.zeros(33), np.eye(3), np.eye(N), np.eye(N)
    gyro, force = np.zeros((3, 5, 3)), np.zeros((3, 3, 3))
    inverse, sensitive, work = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    phi, new = np.zeros((3, 3)), np.zeros((3, 3))
    gamma, top, h, ph, d = np.zeros((3, 18)), np.zeros((3, N)), np.zeros(N), np.zeros(N), np.zeros(N)
    rate, f, z = np.zeros(3), np.zeros(3), np.zeros(3)
    m0, m1 = np.zeros((3, 3)), np.zeros((3, 3))
    scratch = (m0, m1, np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3), np.zeros(3))
    for k in range(n):
        axes(x, gravity, gyro, force, inverse, sensitive, work)
        step(r, commands[k], x, dt, gravity, earth, inverse, sensitive, new, phi, rate, f, m0, m1)
        turning(gyro, inverse, rate, f, commands[k], dt, gravity, scale, m0, gamma)
        if dense:
            predict_dense(p, phi, gamma, scale, big)
        else:
            predict_tight(p, phi, gamma, scale, top)
        r[:] = new
        sd = window(
            samples, k + 1, per, half, r, commands, x, dt, gravity, earth, inverse, sensitive, force, z, sigma, scratch
        )
        spread = 0.0
        for i in range(3):
            spread += p[i, i] * scale[i] * scale[i]
            f[i] = gravity * r[i, 1]
        inflation = second_order * (gravity * spread) ** 2
        d[:] = 0.0
        for axis in range(3):
            measure(axis, f, x, force, scale, h)
            if dense:
                update_dense(p, h, sd * sd + inflation, z[axis], d, ph)
            else:
                update_tight(p, h, sd * sd + inflation, z[axis], d, ph)
        rotation(-d[0] * scale[0], -d[1] * scale[1], -d[2] * scale[2], m0)
        product(m0, r, new)
        r[:] = new
        for i in range(3, N):
            x[free[i]] += d[i] * scale[i]
    return x


@njit
def one_pass(
    commands, samples, dt, sigma, gravity, earth, scale, free, half, dense, x, r0, prior_phi, until, d, phi_sum, b_sum
):
    """A linear filter about the trajectory from `r0` with `x`; leaves deviation and accumulated transition."""
    per = (len(samples) - 1) // len(commands)
    r, p, big = r0.copy(), np.eye(N), np.eye(N)
    gyro, force = np.zeros((3, 5, 3)), np.zeros((3, 3, 3))
    inverse, sensitive, work = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    phi, new = np.zeros((3, 3)), np.zeros((3, 3))
    gamma, top, h, ph = np.zeros((3, 18)), np.zeros((3, N)), np.zeros(N), np.zeros(N)
    rate, f, z = np.zeros(3), np.zeros(3), np.zeros(3)
    m0, m1 = np.zeros((3, 3)), np.zeros((3, 3))
    turned, top_b = np.zeros(3), np.zeros((3, 18))
    scratch = (m0, m1, np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3), np.zeros(3))
    for i in range(3):
        d[i] = prior_phi[i] / scale[i]
    for i in range(3, N):
        d[i] = -x[free[i]] / scale[i]
    phi_sum[:] = np.eye(3)
    b_sum[:] = 0.0
    axes(x, gravity, gyro, force, inverse, sensitive, work)
    for k in range(until):
        step(r, commands[k], x, dt, gravity, earth, inverse, sensitive, new, phi, rate, f, m0, m1)
        turning(gyro, inverse, rate, f, commands[k], dt, gravity, scale, m0, gamma)
        if dense:
            predict_dense(p, phi, gamma, scale, big)
        else:
            predict_tight(p, phi, gamma, scale, top)
        for row in range(3):
            turned[row] = 0.0
            for i in range(3):
                turned[row] += phi[row, i] * scale[i] / scale[row] * d[i]
            for i in range(18):
                turned[row] += gamma[row, i] * d[3 + i]
                top_b[row, i] = gamma[row, i]
                for c in range(3):
                    top_b[row, i] += phi[row, c] * scale[c] / scale[row] * b_sum[c, i]
        d[:3] = turned
        b_sum[:] = top_b
        product(phi, phi_sum, m0)
        phi_sum[:] = m0
        r[:] = new
        sd = window(
            samples, k + 1, per, half, r, commands, x, dt, gravity, earth, inverse, sensitive, force, z, sigma, scratch
        )
        for i in range(3):
            f[i] = gravity * r[i, 1]
        for axis in range(3):
            measure(axis, f, x, force, scale, h)
            if dense:
                update_dense(p, h, sd * sd, z[axis], d, ph)
            else:
                update_tight(p, h, sd * sd, z[axis], d, ph)


def logarithm(r: np.ndarray) -> np.ndarray:
    """Rotation vector of a small rotation."""
    twice = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    sine = 0.5 * float(np.linalg.norm(twice))
    return twice * (0.5 * math.asin(sine) / sine if sine > 1e-8 else 0.5)


def relinearised(commands, samples, dt, sigma, gravity, earth, scale33, dense=False, half=2):
    """All passes; returns the coefficients (attitude at the start first)."""
    scale = scale33[FREE]
    x, r0 = np.zeros(33), np.eye(3)
    d, phi_sum, b_sum, m = np.zeros(N), np.zeros((3, 3)), np.zeros((3, 18)), np.zeros((3, 3))
    for until_s in PASSES_S:
        until = min(len(commands), round(until_s / dt))
        phi = -logarithm(r0.T.copy())
        one_pass(
            commands, samples, dt, sigma, gravity, earth, scale, FREE, half, dense, x, r0, phi, until, d, phi_sum, b_sum
        )
        start = phi_sum.T @ ((d[:3] - b_sum @ d[3:21]) * scale[:3])
        rotation(-start[0], -start[1], -start[2], m)
        r0 = m @ r0
        x = x.copy()
        x[FREE[3:]] += d[3:] * scale[3:]
    x[:3] = -logarithm(r0)
    return x
