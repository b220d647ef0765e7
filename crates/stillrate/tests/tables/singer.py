"""Writes `singer.txt` beside it: Singer's closed forms at 80 digits.

Needs mpmath only: `python singer.py [SEED COUNT] > singer.txt`.
A line: alpha, T, then r, s, q11, q12, q22, r', s', each as the bits of the nearest double and the rest in thousandths of its
last place. Every second line has alpha and T that are exact in single precision too.
"""

import random
import struct
import sys

from mpmath import exp, mp, mpf, nint

# 80 digits are left where q11 loses 36 at alpha T = 1e-12.
mp.dps = 120


def bits(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def forms(alpha, step):
    """Return r, s, q11, q12, q22 and the derivatives of r and s as printed, at so many digits that nothing cancels."""
    a, t = mpf(alpha), mpf(step)
    x, e = a * t, exp(-a * t)
    return (
        (1 - e) / a,
        e,
        (4 * e - e * e + 2 * x - 3) / (2 * a**3),
        (1 - e) ** 2 / (2 * a * a),
        (1 - e * e) / (2 * a),
        (x * e - (1 - e)) / (a * a),
        -t * e,
    )


def cell(value):
    near = float(value)
    unit = mpf(2) ** (mp.frexp(mpf(near))[1] - 53)
    return f"{bits(near):016x} {int(nint((value - mpf(near)) / unit * 1000))}"


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


seed, count = (int(sys.argv[1]), int(sys.argv[2])) if len(sys.argv) > 2 else (5, 600)
source = random.Random(seed)
print("# alpha, T, then r s q11 q12 q22 r' s' as nearest double and thousandths of its last place")
for k in range(count):
    # Half over all sizes, half where the two forms meet and cancel most.
    x = 10 ** (source.uniform(-12, 1.69897) if k % 4 < 2 else source.uniform(-1, 1))
    step = 10 ** source.uniform(-4, 0.5)
    alpha = x / step
    if k % 2 == 0:
        step, alpha = single(step), single(alpha)
    print(f"{bits(alpha):016x} {bits(step):016x} " + " ".join(cell(v) for v in forms(alpha, step)))
