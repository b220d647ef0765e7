"""The joint gimbal filters as one would write them with numba: covariance form, loops that use the structure, or dense matrices.

The same algorithm as `stillrate.gimbal` ("on-line" and "relinearised", plain windows about the model, unrefined step) for 30 coefficients in
scaled numbers; nothing is allocated per epoch in the "tight" form, the "dense" form multiplies 30 x 30 matrices.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

N = 30
FREE = np.array([*range(27), 28, 29, 32])
PASSES_S = (15.0, 30.0, 60.0, 120.0, 240.0, 480.0, 900.0, 900.0)


@njit
def rotation(x, y, z, out):
    """exp(+[v x])."""
    t2 = x * x + y * y + z * z
    if t2 > 1e-6:
        t = math.sqrt(t2)
        a, b = math.sin(t) / t, (1.0 - math.cos(t)) / t2
        if t2 < 1e-2:
            a = 1.0 - t2 / 6.0 * (1.0 - t2 / 20.0 * (1.0 - t2 / 42.0 * (1.0 - t2 / 72.0)))
            b = 0.5 - t2 / 24.0 * (1.0 - t2 / 30.0 * (1.0 - t2 / 56.0 * (1.0 - t2 / 90.0)))
    else:
        a, b = 1.0 - t2 / 6.0, 0.5 - t2 / 24.0
    out[0, 0], out[0, 1], out[0, 2] = 1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    out[1, 0], out[1, 1], out[1, 2] = b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x
    out[2, 0], out[2, 1], out[2, 2] = b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)


@njit
def product(a, b, out):
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@njit
def axes(x, gravity, gyro, force, inverse, sensitive, work):
    """Axes of the instruments, A_g^-1 and d(rate)/d(specific force)."""
    for i in range(3):
        o, s = (i + 1) % 3, (i + 2) % 3
        so, co, ss, cs = math.sin(x[15 + i]), math.cos(x[15 + i]), math.sin(x[18 + i]), math.cos(x[18 + i])
        for row, values in enumerate(
            (
                (cs * co, ss, -cs * so),
                (-ss * co, cs, ss * so),
                (so, 0.0, co),
                (-cs * so, 0.0, -cs * co),
                (-ss * co, cs, ss * so),
            )
        ):
            gyro[i, row, i], gyro[i, row, o], gyro[i, row, s] = values
        sp, cp, so, co = math.sin(x[27 + i]), math.cos(x[27 + i]), math.sin(x[30 + i]), math.cos(x[30 + i])
        for row, values in enumerate(((cp * co, cp * so, -sp), (-sp * co, -sp * so, -cp), (-cp * so, cp * co, 0.0))):
            force[i, row, i], force[i, row, o], force[i, row, s] = values
    a = gyro[:, 0]
    determinant = 0.0
    for i in range(3):
        o, s = (i + 1) % 3, (i + 2) % 3
        for c in range(3):
            p, q = (c + 1) % 3, (c + 2) % 3
            inverse[c, i] = a[o, p] * a[s, q] - a[o, q] * a[s, p]
        determinant = a[i, 0] * inverse[0, i] + a[i, 1] * inverse[1, i] + a[i, 2] * inverse[2, i]
    for i in range(3):
        for j in range(3):
            inverse[i, j] /= determinant
            work[i, j] = (x[6 + i] * gyro[i, 0, j] + x[9 + i] * gyro[i, 1, j] + x[12 + i] * gyro[i, 2, j]) / gravity
    product(inverse, work, sensitive)


@njit
def step(r, w, x, dt, gravity, earth, inverse, sensitive, out, phi, rate, f, m0, m1):
    """One step: attitude, transition, rate and specific force at its middle."""
    relative = np.empty(3)
    for i in range(3):
        first, turning = 0.0, 0.0
        for j in range(3):
            first += inverse[i, j] * (w[j] + x[3 + j]) + sensitive[i, j] * r[j, 1] * gravity
            turning += r[i, j] * earth[j]
        relative[i] = (first - turning) * (-0.5 * dt)
    rotation(relative[0], relative[1], relative[2], m0)
    for i in range(3):
        f[i] = gravity * (m0[i, 0] * r[0, 1] + m0[i, 1] * r[1, 1] + m0[i, 2] * r[2, 1])
    for i in range(3):
        rate[i] = 0.0
        for j in range(3):
            rate[i] += inverse[i, j] * (w[j] + x[3 + j]) + sensitive[i, j] * f[j]
    rotation(-dt * rate[0], -dt * rate[1], -dt * rate[2], phi)
    product(phi, r, m0)
    rotation(dt * earth[0], dt * earth[1], dt * earth[2], m1)
    product(m0, m1, out)


@njit
def window(samples, k, per, half, r, commands, x, dt, gravity, earth, inverse, sensitive, force, z, sd, sigma, scratch):
    """Intercept of samples minus model outputs around an epoch, and its deviation."""
    m0, m1, m2, m3, rate, f = scratch
    n = len(commands)
    s0 = s1 = s2 = 0.0
    t0, t1 = np.zeros(3), np.zeros(3)
    for j in range(-half, half + 1):
        at = k * per + j
        if at < 0 or at >= len(samples):
            continue
        there = r
        if j != 0:
            w = commands[k - 1] if j < 0 else commands[min(k, n - 1)]
            step(r, w, x, j * dt / per, gravity, earth, inverse, sensitive, m2, m3, rate, f, m0, m1)
            there = m2
        s0 += 1.0
        s1 += j
        s2 += j * j
        for axis in range(3):
            u = 0.0
            for i in range(3):
                u += force[axis, 0, i] * there[i, 1] * gravity
            y = samples[at, axis] - x[21 + axis] - (1.0 + x[24 + axis]) * u
            t0[axis] += y
            t1[axis] += j * y
    determinant = s0 * s2 - s1 * s1
    for axis in range(3):
        z[axis] = (s2 * t0[axis] - s1 * t1[axis]) / determinant
    return sigma * math.sqrt(s2 / determinant)


@njit
def turning(gyro, inverse, rate, f, w, dt, gravity, scale, m0, gamma):
    """d(attitude error)/d(gyro coefficients) of a step, scaled: 3 rows of 18."""
    half = np.empty((3, 3))
    rotation(-0.5 * dt * rate[0], -0.5 * dt * rate[1], -0.5 * dt * rate[2], m0)
    product(m0, inverse, half)
    for i in range(3):
        factors = np.empty(6)
        factors[0] = 1.0
        for part in range(3):
            factors[1 + part] = 0.0
            for c in range(3):
                factors[1 + part] += gyro[i, part, c] * f[c] / gravity
        for part in range(2):
            factors[4 + part] = 0.0
            for c in range(3):
                factors[4 + part] -= gyro[i, 3 + part, c] * rate[c]
        for group in range(6):
            at = 3 * group + i
            for row in range(3):
                gamma[row, at] = dt * half[row, i] * factors[group] * scale[3 + at] / scale[row]


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
            samples,
            k + 1,
            per,
            half,
            r,
            commands,
            x,
            dt,
            gravity,
            earth,
            inverse,
            sensitive,
            force,
            z,
            0.0,
            sigma,
            scratch,
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
            samples,
            k + 1,
            per,
            half,
            r,
            commands,
            x,
            dt,
            gravity,
            earth,
            inverse,
            sensitive,
            force,
            z,
            0.0,
            sigma,
            scratch,
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
