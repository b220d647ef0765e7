"""Derives the constants of `src/elementary/{double,single}.rs` and the reference points of `tests/elementary.rs`.

Needs mpmath only. `python elementary.py constants` prints the Rust constants, `python elementary.py points` the table
`elementary.txt` beside this file. Each polynomial is the least-squares fit over Chebyshev nodes (within a few
percent of minimax), its coefficients rounded one after the other from the lowest, the rest refitted to what is left.
"""

import random
import struct
import sys

from mpmath import atan, atan2, cos, exp, expm1, floor, linspace, log, lu_solve, matrix, mp, mpf, pi, sin, sqrt, tanh

mp.dps = 80
BITS = {"double": 53, "single": 24}


def rounded(value, bits):
    """The nearest number of `bits` significant bits."""
    if value == 0:
        return mpf(0)
    exponent = int(floor(log(abs(value), 2)))
    unit = mpf(2) ** (exponent - bits + 1)
    return mp.nint(value / unit) * unit


def fit(function, low, high, terms, bits):
    """Rounded coefficients of a near-minimax polynomial."""
    nodes = [(low + high) / 2 + (high - low) / 2 * cos(pi * (2 * k + 1) / 160) for k in range(80)]
    values = [function(node) for node in nodes]
    coefficients = []
    for done in range(terms):
        # Least squares over Chebyshev nodes in the powers that are still free.
        powers = range(done, terms)
        system = matrix(terms - done, terms - done)
        right = matrix(terms - done, 1)
        rest = [v - sum(c * x**k for k, c in enumerate(coefficients)) for x, v in zip(nodes, values, strict=True)]
        for i, p in enumerate(powers):
            right[i] = sum(r * x**p for x, r in zip(nodes, rest, strict=True))
            for j, q in enumerate(powers):
                system[i, j] = sum(x ** (p + q) for x in nodes)
        coefficients.append(rounded(lu_solve(system, right)[0], bits))
    worst = max(abs(function(x) - sum(c * x**k for k, c in enumerate(coefficients))) for x in linspace(low, high, 401) if x != 0)
    return coefficients, worst


def exponential_tail(x):
    return (exp(x) - 1 - x) / x**2 if abs(x) > mpf(10) ** -15 else mpf(1) / 2 + x / 6


def logarithm_tail(z):
    s = sqrt(z)
    return (log((1 + s) / (1 - s)) - 2 * s) / s**3


def sine_tail(z):
    return (sin(sqrt(z)) / sqrt(z) - 1) / z


def cosine_tail(z):
    return (cos(sqrt(z)) - 1 + z / 2) / z**2


def angle_tail(z):
    return (atan(sqrt(z)) / sqrt(z) - 1) / z


def parts(value, bits, count):
    """Leading parts of `bits` bits each."""
    out = []
    for _ in range(count):
        part = mp.floor(value / mpf(2) ** (floor(log(value, 2)) - bits + 1)) * mpf(2) ** (floor(log(value, 2)) - bits + 1)
        out.append(part)
        value -= part
    return out, value


def constants():
    z = mpf(10) ** -18
    for name, counts, ln2_bits, pi_bits, pi_parts in (
        ("double", (12, 7, 6, 6, 9), 42, 33, 3),
        ("single", (6, 4, 4, 4, 4), 16, 12, 4),
    ):
        bits = BITS[name]
        half = log(mpf(2)) / 2 * (1 + mpf(2) ** -20)
        print(f"// {name}")
        for label, function, low, high, terms in (
            ("EXPONENTIAL", exponential_tail, -half, half, counts[0]),
            ("LOGARITHM", logarithm_tail, z, (3 - 2 * sqrt(mpf(2))) ** 2 * mpf("1.0001"), counts[1]),
            ("SINE", sine_tail, z, (pi / 4) ** 2 * mpf("1.0001"), counts[2]),
            ("COSINE", cosine_tail, z, (pi / 4) ** 2 * mpf("1.0001"), counts[3]),
            ("ANGLE", angle_tail, z, mpf("0.0901"), counts[4]),
        ):
            coefficients, worst = fit(function, low, high, terms, bits)
            print(f"// error {mp.nstr(worst, 3)} of the tail")
            print(f"const {label}: &'static [Self] = &[{', '.join(mp.nstr(c, 17 if bits == 53 else 9) for c in coefficients)}];")
        for label, value, size, count in (("LN_2", log(mpf(2)), ln2_bits, 1), ("QUARTER_TURN", pi / 2, pi_bits, pi_parts)):
            pieces, rest = parts(value, size, count)
            digits = 17 if bits == 53 else 9
            print(label, [mp.nstr(p, digits) for p in pieces], mp.nstr(rounded(rest, bits), digits))
        for label, value in (("LOG2_E", 1 / log(mpf(2))), ("INVERSE_QUARTER_TURN", 2 / pi)):
            print(label, mp.nstr(rounded(value, bits), 17))
        for label, value in (("ANGLE_HALF", atan(mpf(1) / 2)), ("EIGHTH_TURN", pi / 4), ("QUARTER", pi / 2), ("HALF_TURN", pi)):
            high = rounded(value, bits)
            print(label, mp.nstr(high, 17), mp.nstr(rounded(value - high, bits), 17))


def number(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def pattern(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def reference(value):
    """Nearest f64 and what is missing to the true value."""
    mp.prec = 400
    high = float(value)
    low = float(value - mpf(high)) if high - high == 0 else 0.0
    return f"{pattern(high):016x} {pattern(low):016x}"


def any_number(source, low, high):
    """Log-uniform magnitude, random sign."""
    return source.choice((-1.0, 1.0)) * 2.0 ** source.uniform(low, high)


def inputs(source, count):
    """Arguments of every function: random ones of every size and the awkward ones."""
    near = [float(k * pi / 2) for k in (1, 2, 3, 4, 5, 11, 33, 355, 710, 104348, 312689, 600000)]
    yield "exponential", [source.uniform(-745.1, 709.7) for _ in range(count)] + [any_number(source, -60, 3) for _ in range(count)] + [
        709.782712893384, -745.1332191019411, -708.3964185322641, 1e-300, 0.34657359027997264, -0.34657359027997264, 1.0]
    yield "exponential_less_one", [any_number(source, -60, 5) for _ in range(count)] + [source.uniform(-1.5, 1.5) for _ in range(count)] + [
        709.782712893384, -37.5, -80.0, 1e-300, -1e-300, 5e-324, 0.34657359027997264, -0.34657359027997264]
    yield "logarithm", [abs(any_number(source, -1074, 1023.9)) for _ in range(count)] + [source.uniform(0.5, 2.0) for _ in range(count)] + [
        5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, 1.0 + 2**-52, 1.0 - 2**-53, 0.7071067811865475, 0.7071067811865476, 1.4142135623730951]
    yield "sine", [any_number(source, -40, 20) for _ in range(count)] + [source.uniform(-7, 7) for _ in range(count)] + near + [
        -1e-310, 5e-324, 1048576.0, 0.7853981633974483, 0.7853981633974484]
    yield "cosine", [any_number(source, -40, 20) for _ in range(count)] + [source.uniform(-7, 7) for _ in range(count)] + near + [
        1048576.0, 0.7853981633974483, 0.7853981633974484]
    yield "tangent_hyperbolic", [any_number(source, -60, 4.5) for _ in range(count)] + [source.uniform(-2, 2) for _ in range(count)] + [
        5e-324, 1e-300, 19.0, 22.0, 300.0]
    ratio = [0.3, 0.72, 0.5, 1.0, 0.25, 0.29999999999999993, 0.7199999999999999]
    yield "angle_over", [(any_number(source, -30, 30), any_number(source, -30, 30)) for _ in range(count)] + [
        (source.uniform(-1, 1), source.uniform(-1, 1)) for _ in range(count)] + [(sign * t, 1.0) for t in ratio for sign in (1, -1)] + [
        (1.0, -t) for t in ratio] + [(1e308, 1e308), (1e308, -1.7e308), (1e-320, 3e-320), (5e-324, 1e-10), (1e-300, 1e300), (1e300, -1e-300)]


FUNCTIONS = {"exponential": exp, "exponential_less_one": expm1, "logarithm": log, "sine": sin, "cosine": cos,
             "tangent_hyperbolic": tanh, "angle_over": lambda pair: atan2(mpf(pair[0]), mpf(pair[1]))}


def points(seed, count):
    source = random.Random(seed)
    for name, arguments in inputs(source, count):
        for argument in arguments:
            mp.prec = 1300 if name in ("sine", "cosine", "exponential_less_one", "tangent_hyperbolic") and abs(argument) < 1e-20 else 400
            pair = argument if isinstance(argument, tuple) else (argument, 0.0)
            value = FUNCTIONS[name](argument if isinstance(argument, tuple) else mpf(argument))
            yield f"{name} {pattern(pair[0]):016x} {pattern(pair[1]):016x} {reference(value)}"


if __name__ == "__main__":
    if sys.argv[1] == "constants":
        constants()
    else:
        seed, count = (int(sys.argv[2]), int(sys.argv[3])) if len(sys.argv) > 3 else (20, 150)
        print("# function, argument (twice for y and x), nearest f64 of the true value, remainder; bit patterns")
        print("\n".join(points(seed, count)))
