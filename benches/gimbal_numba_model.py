"""The model of the gimballed head for the numba port: rotations, axes, one step, a window of samples, derivatives.

Arrays are handed in and filled: numba allocates nothing in the loop over epochs.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit


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
def window(samples, k, per, half, r, commands, x, dt, gravity, earth, inverse, sensitive, force, z, sigma, scratch):
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
