"""Makes the reference tables beside this file with mpmath at 60 digits and writes 50.

    pip install mpmath && python3 tests/data/make_tables.py

Every input is a number that f32 holds exactly, written so that it reads back as the same f32. Directions and axes are
rounded to f32 first; the reference is that of the rounded vectors' directions, by the angle between them.
"""

import pathlib
import random
import struct
import sys

from mpmath import besseli, cos, coth, exp, expm1, log, log1p, mp, mpf, nstr, pi, quad, sin, sqrt

mp.dps = 60
HERE = pathlib.Path(__file__).parent
SHARPNESS = [0, 1e-30, 1e-8, 1e-4, 1e-2, 0.3, 1, 3, 10, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8]
TINY = mpf(2) ** -126  # smallest normal f32
random.seed(1)


def f32(x):
    """The nearest f32, as an mpf."""
    return mpf(struct.unpack("f", struct.pack("f", float(x)))[0])


def short(x):
    """Shortest text that reads back as the f32."""
    for digits in range(1, 10):
        text = f"{float(x):.{digits}g}"
        if struct.pack("f", float(text)) == struct.pack("f", float(x)):
            return text
    raise ValueError(x)


def write(name, header, rows):
    with open(HERE / name, "w") as file:
        file.write(",".join(header) + "\n")
        for inputs, outputs in rows:
            texts = [short(x) for x in inputs] + [nstr(x, 50) for x in outputs]
            file.write(",".join(texts) + "\n")
    print(name, len(rows), file=sys.stderr)


def unit32(v):
    length = sqrt(sum(x * x for x in v))
    return [f32(x / length) for x in v]


def normalised(v):
    length = sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def half_chord_squared(a, b):
    """1 - cos of the angle between two vectors of any length."""
    return sum((x - y) ** 2 for x, y in zip(normalised(a), normalised(b))) / 2


def towards(axis, theta, phi):
    """The direction at an angle from an axis, rounded to f32."""
    n = normalised(axis)
    helper = [1, 0, 0] if abs(n[0]) < 0.5 else [0, 1, 0]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    t = normalised(cross(helper, n))
    b = cross(n, t)
    return unit32(
        [cos(theta) * n[i] + sin(theta) * (cos(phi) * t[i] + sin(phi) * b[i]) for i in range(3)]
    )


AXES = [unit32(v) for v in [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.36, 0.48, 0.8), (0.6, -0.7, 1e-4), (1e-3, 2e-4, -1), (-0.5, 0.3, -0.4)]]


def sphere_integral(s):
    return 4 * pi if s == 0 else -2 * pi * expm1(-2 * s) / s


def cap_integral(s, w):
    return 2 * pi * w if s == 0 else -2 * pi * expm1(-s * w) / s


def inverse(u, s):
    return 2 * u if s == 0 else -log1p(u * expm1(-2 * s)) / s


def share(w, s):
    return w / 2 if s == 0 else expm1(-s * w) / expm1(-2 * s)


def mean_cosine(s):
    with mp.workdps(160):  # the difference loses twice the digits of a small s
        return coth(s) - 1 / s if s > 0 else mpf(0)


def angles(s):
    """1 - cos of angles in the lobe's own scale, and far out."""
    scale = [mpf(t) / s for t in (1e-3, 0.1, 1, 5, 20, 60, 86)] if s > 0 else []
    return [w for w in scale if w <= 2] + [mpf(w) for w in (0, 1e-12, 5e-3, 0.5, 1.4, 2)]


def scalars():
    rows = {k: [] for k in ("sphere_integral", "cap_integral", "share_within", "one_minus_cos", "mean_cosine", "bessel_i0_scaled")}
    us = [0, 1e-38, 1e-30, 1e-12, 1e-6, 2**-24, 1e-3, 0.1, 0.25, 0.4999, 0.5, 0.5001, 0.75, 0.9, 0.999, 1 - 1e-6]
    us += [1 - 2**-20, 1 - 3 * 2**-24, 1 - 2**-23, 1 - 2**-24, 1] + [random.random() for _ in range(8)]
    more = [10 ** (mpf(k) / 4) for k in range(-20, 34)]
    for s in sorted({f32(s) for s in SHARPNESS + more + [2e8]}):
        rows["sphere_integral"].append(([s], [sphere_integral(s)]))
        rows["mean_cosine"].append(([s], [mean_cosine(s)]))
    for s in map(f32, SHARPNESS + [0.34, 0.35, 40, 50, 60, 2e8]):
        for w in map(f32, angles(s)):
            rows["cap_integral"].append(([s, w], [cap_integral(s, w)]))
            rows["share_within"].append(([s, w], [share(w, s)]))
        for u in map(f32, us):
            rows["one_minus_cos"].append(([u, s], [inverse(u, s)]))
    for k in range(-24, 81):
        x = f32(mpf(10) ** (mpf(k) / 10))
        rows["bessel_i0_scaled"].append(([x], [besseli(0, x) * exp(-x)]))
    for x in (0, 8, 8.000001, 1e12, 4e8):
        x = f32(x)
        value = besseli(0, x) * exp(-x) if x < 1e9 else (1 + 1 / (8 * x) + 9 / (128 * x * x)) / sqrt(2 * pi * x)
        rows["bessel_i0_scaled"].append(([x], [value]))
    for name, table in rows.items():
        inputs = {"cap_integral": ["sharpness", "w"], "share_within": ["sharpness", "w"], "one_minus_cos": ["u", "sharpness"], "bessel_i0_scaled": ["x"]}
        write(f"{name}.csv", inputs.get(name, ["sharpness"]) + ["value"], table)


def gaussian():
    rows = []
    for s in map(f32, SHARPNESS):
        for axis in AXES:
            for w in angles(s):
                d = towards(axis, 2 * mp.asin(sqrt(w / 2)), random.random() * 6.28)
                t = s * half_chord_squared(axis, d)
                if t < 5000:
                    rows.append(([s, *axis, *d], [t, exp(-t), log(exp(-t) / sphere_integral(s))]))
    write("gaussian.csv", ["sharpness", "ax", "ay", "az", "dx", "dy", "dz", "exponent", "value", "log_pdf"], rows)


def squeezed(s, c, axis, d):
    """Value of the folded lobe, squeezed by c, and the exponent of its larger part."""
    c = 1 / f32(1 / c)  # the library holds the reciprocal of c, rounded to f32
    m = [d[0], d[1] / c, d[2]]
    length = sqrt(sum(x * x for x in d))
    r = sqrt(sum(x * x for x in m)) / length
    t = s * half_chord_squared(m, axis)
    tm = s * half_chord_squared([m[0], m[1], -m[2]], axis)
    return min(t, tm), (exp(-t) + exp(-tm)) / (c * r**3)


def folded():
    rows = []
    axes = [unit32(v) for v in [(0, 0, 1), (0.36, 0.48, 0.8), (0.6, -0.7, 1e-4), (1e-3, 2e-4, -1), (0.96, 0, 0.28)]]
    for s in map(f32, SHARPNESS):
        for c in map(f32, [1, 0.01, 0.1, 0.37, 2]):
            for axis in axes:
                for w in random.sample(angles(s), 4):
                    u = towards(axis, 2 * mp.asin(sqrt(w / 2)), random.random() * 6.28)
                    d = unit32([u[0], u[1] * c, abs(u[2])])
                    t, value = squeezed(s, c, axis, d)
                    if t < 85:
                        rows.append(([s, c, *axis, *d], [t, value, value / sphere_integral(s)]))
    write("folded.csv", ["sharpness", "c", "ax", "ay", "az", "dx", "dy", "dz", "exponent", "value", "pdf"], rows)


def product():
    rows = []
    levels = [0, 1e-30, 1e-4, 1, 30, 1e3, 1e5, 1e6, 1e8]
    for i, s1 in enumerate(map(f32, levels)):
        for s2 in map(f32, [levels[j] for j in range(i + 1)] + [s1 * mpf("0.999"), s1 / 3]):
            scale = sqrt(1 / max(s1, s2, mpf(1)))
            for k, angle in enumerate([0, 1e-7, scale, 3 * scale, 10 * scale, pi - 1e-3, pi - 3e-7, pi, 1.0]):
                a = AXES[(3 + k) % len(AXES)]
                b = towards(a, min(angle, pi), 1 + k)
                if angle == pi:
                    b = [-x for x in a]
                na, nb = normalised(a), normalised(b)
                r = [s1 * x + s2 * y for x, y in zip(na, nb)]
                length = sqrt(sum(x * x for x in r))
                e = s1 * s2 * 2 * half_chord_squared(a, b) / (s1 + s2 + length) if s1 + s2 > 0 else mpf(0)
                peak = unit32(r) if length > 1e-40 else a
                width = sqrt(mpf(2) / max(length, mpf(1)))
                for theta in (0, width, 4 * width):
                    d = towards(peak, min(theta, 3), 2 + k + theta)
                    t = s1 * half_chord_squared(a, d) + s2 * half_chord_squared(b, d)
                    if t < 87:
                        rows.append(([s1, *a, s2, *b, *d], [e, length, t, exp(-t), exp(-e) * sphere_integral(length)]))
    header = ["s1", "ax", "ay", "az", "s2", "bx", "by", "bz", "dx", "dy", "dz"]
    write("product.csv", header + ["exponent", "sharpness", "value_exponent", "value", "integral"], rows)


def horizon():
    rows = []
    for s in map(f32, [0, 1e-8, 1e-2, 0.5, 1, 3, 10, 30, 100, 1e3, 1e4, 1e6, 1e8]):
        width = 1 / sqrt(max(s, mpf(1)))
        elevations = [0, 1e-6 * width, width / 3, width, 3 * width, 5.5 * width, 8 * width, 0.2, 0.8, 1.3, pi / 2]
        for a in sorted({mpf(e) for e in elevations if e <= pi / 2}):
            for sign in (1, -1):
                axis = unit32([cos(a) * mpf("0.6"), cos(a) * mpf("-0.8"), sign * sin(a)])
                n = normalised(axis)
                c, sb = n[2], sqrt(n[0] ** 2 + n[1] ** 2)
                t = s * (1 - sb) if c < 0 else mpf(0)
                if t > 85:
                    continue

                def ring(z, power):
                    q = sqrt(1 - z * z)
                    x = s * q * sb
                    return 2 * pi * z**power * exp(s * (z * c + q * sb - 1)) * (besseli(0, x) * exp(-x))

                spread = sb / sqrt(max(s, mpf(1))) + 1 / max(s, mpf(1))
                points = {mpf(0), mpf(1)}
                points |= {c + k * spread for k in (-24, -12, -6, -3, 0, 3, 6, 12, 24)}
                if c <= 0:
                    slope = min(spread, 1 / max(-s * c, mpf(1e-9)))
                    points |= {slope * k for k in (2, 8, 20, 50, 120, 250)}
                points = sorted(p for p in points if 0 <= p <= 1)
                with mp.workdps(40):
                    values = [quad(lambda z: ring(z, power), points) for power in (0, 1)]
                rows.append(([s, *axis], [t, *values]))
    write("horizon.csv", ["sharpness", "ax", "ay", "az", "exponent", "hemisphere", "cosine"], rows)


def abel_poisson():
    values, inverses, pairs = [], [], []
    for eps in map(f32, [1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.9, 0.9999, 1]):
        h = 1 - eps
        scale = [w for w in [mpf(k) * eps**2 for k in (1e-3, 0.1, 1, 10, 1e3, 1e6)] if w <= 2]
        for w in map(f32, scale + [0, 1e-12, 5e-3, 0.5, 1.4, 2]):
            root = sqrt(eps**2 + 2 * h * w)
            values.append(([eps, w], [eps * (2 - eps) / root**3, (2 - eps) * w / (root * (root + eps))]))
        for u in map(f32, [0, 1e-30, 1e-6, 0.01, 0.3, 0.5, 0.7, 0.99, 1 - 1e-6, 1 - 2**-24, 1]):
            d = eps + 2 * h * (1 - u)
            inverses.append(([eps, u], [eps * u * (eps * (2 - eps) / d + eps) / d]))
        for eps2 in map(f32, [1e-8, 1e-3, 0.3, 1]):
            for angle in (0, 1e-4, 0.1, 1, pi):
                a = AXES[3]
                b = towards(a, angle, 1)
                e = eps + eps2 - eps * eps2
                w = half_chord_squared(a, b)
                pairs.append(([eps, *a, eps2, *b], [4 * pi * e * (2 - e) / sqrt(e**2 + 2 * (1 - e) * w) ** 3]))
    write("abel_poisson.csv", ["epsilon", "w", "value", "share"], values)
    write("abel_poisson_inverse.csv", ["epsilon", "u", "w"], inverses)
    write("abel_poisson_product.csv", ["e1", "ax", "ay", "az", "e2", "bx", "by", "bz", "integral"], pairs)


def legendre():
    rows = []
    for s in map(f32, [0, 1e-8, 1e-2, 1, 10, 100, 1e4, 1e6, 1e8]):
        for l in (0, 1, 2, 3, 5, 10, 20, 40, 63, 127, 255):
            if s == 0:
                value = mpf(l == 0)
            else:
                with mp.workdps(80 + 2 * l):
                    value = (2 * l + 1) * sqrt(pi / (2 * s)) * besseli(l + mpf("0.5"), s) * exp(-s)
            if value == 0 or value > TINY:
                rows.append(([s, mpf(l)], [value]))
    write("gaussian_coefficients.csv", ["sharpness", "l", "value"], rows)
    rows = []
    for eps in map(f32, [1e-8, 1e-4, 0.01, 0.3, 0.9, 1]):
        for l in (0, 1, 2, 5, 20, 63, 255):
            value = (2 * l + 1) * (1 - eps) ** l
            if value == 0 or value > TINY:
                rows.append(([eps, mpf(l)], [value]))
    write("abel_poisson_coefficients.csv", ["epsilon", "l", "value"], rows)


if __name__ == "__main__":
    wanted = sys.argv[1:]
    for make in (scalars, gaussian, folded, product, abel_poisson, legendre, horizon):
        if not wanted or make.__name__ in wanted:
            make()
