#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes profile_reference.inc: fields of weighted segments and arcs to 17 digits, by Gauss's rule with 40 nodes in 36
digits on panels that shrink by four towards the closest approach and end at every knot and every kink. Needs mpmath.
usage: profile_reference.py > profile_reference.inc"""
import random
from mpmath import mp, mpf, sqrt, exp, sin, cos, pi, acos, atan2

mp.dps = 36
NODES = None


def gauss(n=40):
    global NODES
    if NODES is None:
        NODES = []
        for i in range(n):
            x = cos(pi * (i + mpf(3) / 4) / (n + mpf(1) / 2))
            for _ in range(100):
                p0, p1 = mpf(1), x
                for k in range(2, n + 1):
                    p0, p1 = p1, ((2 * k - 1) * x * p1 - (k - 1) * p0) / k
                d = n * (x * p1 - p0) / (x * x - 1)
                step = p1 / d
                x -= step
                if abs(step) < mpf(10) ** -34:
                    break
            NODES.append((x, 2 / ((1 - x * x) * d * d)))
    return NODES


def kernel(name, s, w):
    """h and its first two derivatives by w = r^2"""
    if name == "CAUCHY":
        q = 1 / (1 + s * s * w)
        return q**2, -2 * s**2 * q**3, 6 * s**4 * q**4
    if name == "GAUSSIAN":
        h = exp(-s * s * w)
        return h, -(s**2) * h, s**4 * h
    if name == "INVERSE":
        return w ** mpf(-0.5), -(w ** mpf(-1.5)) / 2, 3 * w ** mpf(-2.5) / 4
    if name == "INVERSE_SQUARED":
        return 1 / w, -1 / w**2, 2 / w**3
    R, y = s, w / (s * s)
    if w >= R * R:
        return mpf(0), mpf(0), mpf(0)
    if name == "QUARTIC":
        return (1 - y) ** 2, -2 * (1 - y) / R**2, 2 / R**4
    if name == "SOFT_OBJECT":
        m = 1 - y
        return m * m * (5 + 4 * m) / 9, -(10 * m + 12 * m * m) / 9 / R**2, (10 + 24 * m) / 9 / R**4
    r = sqrt(w)
    if 3 * r <= R:
        return 1 - 3 * y, -3 / R**2, mpf(0)
    return mpf(1.5) * (1 - r / R) ** 2, -mpf(1.5) * (1 - r / R) / (R * r), mpf(0.75) / (R * r * w)


CUBIC = [(0, 0, 1), (mpf(0.25), mpf(1.25), mpf(-0.5)), (mpf(0.625), mpf(0.375), 2), (1, mpf(-0.5), 0)]
PROFILES = [  # type, ends, from, to
    ("LINEAR", (1, 0), 0, 0), ("LINEAR", (-0.5, 2), 0, 0), ("HAT", (0, 0), 0, 0), ("SINE", (0, 0), 0, 0),
    ("CUBIC", (0, 0), 0, 0), ("LINEAR", (0, 1), 0.25, 0.75), ("HAT", (0, 0), 0.125, 0.875), ("SINE", (0, 0), 0.625, 1),
    ("CUBIC", (0, 0), 0.0625, 0.5)]


def profile(p, u):
    kind, ends, a, b = p
    a, b = mpf(a), mpf(b) if b else mpf(1)
    t = a + (b - a) * u
    if kind == "LINEAR":
        return ends[0] * (1 - t) + ends[1] * t
    if kind == "HAT":
        return 2 * t if t < mpf(0.5) else 2 - 2 * t
    if kind == "SINE":
        return sin(pi * t) ** 2
    for (t0, v0, m0), (t1, v1, m1) in zip(CUBIC, CUBIC[1:]):
        if t <= t1:
            h, u = t1 - t0, (t - t0) / (t1 - t0)
            return (v0 * (1 + 2 * u) * (1 - u) ** 2 + h * m0 * u * (1 - u) ** 2 + v1 * u * u * (3 - 2 * u)
                    + h * m1 * u * u * (u - 1))


def knots(p):
    kind, _, a, b = p
    a, b = mpf(a), mpf(b) if b else mpf(1)
    inner = {"HAT": [mpf(0.5)], "CUBIC": [k[0] for k in CUBIC[1:-1]]}.get(kind, [])
    return [(t - a) / (b - a) for t in inner if a < t < b]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    n = sqrt(dot(a, a))
    return [x / n for x in a]


class Segment:
    def __init__(self, v):
        v = [mpf(x) for x in v]
        self.a, self.e = v[:3], [q - p for p, q in zip(v[:3], v[3:6])]
        self.length = sqrt(dot(self.e, self.e))

    def at(self, u):
        return [p + u * e for p, e in zip(self.a, self.e)]

    def feet(self, x):
        return [dot([p - q for p, q in zip(x, self.a)], self.e) / self.length**2]

    def crossings(self, x, R):
        f = self.feet(x)[0]
        d = [p - q for p, q in zip(x, self.at(f))]
        T2 = R * R - dot(d, d)
        return [f - sqrt(T2) / self.length, f + sqrt(T2) / self.length] if T2 > 0 else []


class Arc:
    def __init__(self, v):
        v, sweep = [mpf(x) for x in v], v[10]
        self.c, n = v[:3], unit(v[3:6])
        s = v[6:9]
        self.e = unit([p - dot(s, n) * q for p, q in zip(s, n)])
        self.f, self.n, self.rho = cross(n, self.e), n, v[9]
        self.sweep = 2 * pi if sweep == float(2 * pi) else mpf(sweep)
        self.length = self.rho * self.sweep

    def at(self, u):
        c, s = self.rho * cos(u * self.sweep), self.rho * sin(u * self.sweep)
        return [o + c * p + s * q for o, p, q in zip(self.c, self.e, self.f)]

    def turn(self, a):
        return [(a + 2 * pi * k) / self.sweep for k in (-1, 0, 1, 2)]

    def place(self, x):
        d = [p - q for p, q in zip(x, self.c)]
        u, v = dot(d, self.e), dot(d, self.f)
        return sqrt(u * u + v * v), dot(d, self.n), atan2(v, u) if u or v else mpf(0)

    def feet(self, x):
        return self.turn(self.place(x)[2])

    def crossings(self, x, R):
        k, z, phi = self.place(x)
        if k == 0:
            return []
        c = (k * k + self.rho**2 + z * z - R * R) / (2 * self.rho * k)
        return self.turn(phi - acos(c)) + self.turn(phi + acos(c)) if abs(c) < 1 else []


def breaks(shape, x, name, s, p):
    feet = [f for f in shape.feet(x) if 0 < f < 1]
    b = {mpf(0), mpf(1)} | set(feet) | set(knots(p))
    if name in ("QUARTIC", "SOFT_OBJECT", "METABALL"):
        for R in (s, s / 3) if name == "METABALL" else (s,):
            b |= {t for t in shape.crossings(x, R) if 0 < t < 1}
    # shrinking towards the closest approach on both sides, and towards the ends for what is just beyond them
    for f in list(feet) + [mpf(0), mpf(1)]:
        step = mpf(1)
        while step > mpf(10) ** -8:
            step /= 4
            b |= {t for t in (f - step, f + step) if 0 < t < 1}
    if name == "GAUSSIAN" and s * shape.length > 2:
        n = int(s * shape.length) + 1
        b |= {mpf(i) / n for i in range(n)} if n < 400 else set()
    return sorted(b)


def field(shape, x, name, s, p):
    x, s = [mpf(c) for c in x], mpf(s)
    out = [mpf(0)] * 10
    b = breaks(shape, x, name, s, p)
    for lo, hi in zip(b, b[1:]):
        mid, half = (lo + hi) / 2, (hi - lo) / 2
        for node, weight in gauss():
            u = mid + half * node
            r = [a - c for a, c in zip(x, shape.at(u))]
            h, d1, d2 = kernel(name, s, dot(r, r))
            w = weight * half * shape.length * profile(p, u)
            out[0] += w * h
            for i in range(3):
                out[1 + i] += w * 2 * d1 * r[i]
            i = 4
            for j in range(3):
                for k in range(j, 3):
                    out[i] += w * (4 * d2 * r[j] * r[k] + (2 * d1 if j == k else 0))
                    i += 1
    return out


def place(rng, shape, regime):
    u = rng.random()
    q = [float(c) for c in shape.at(mpf(u))]
    size = float(shape.length)
    d = {"near": 10 ** rng.uniform(-6, -2), "beside": 10 ** rng.uniform(-1.5, 0.3), "far": 10 ** rng.uniform(0.5, 3)}
    if regime in d:
        v = [rng.gauss(0, 1) for _ in range(3)]
        n = sum(c * c for c in v) ** 0.5
        return [a + d[regime] * size * c / n for a, c in zip(q, v)]
    end, other = [float(c) for c in shape.at(mpf(rng.choice([0, 1])))], [float(c) for c in shape.at(mpf(0.5))]
    return [e + 10 ** rng.uniform(-5, 0.5) * (e - o) for e, o in zip(end, other)]  # beyond an end


def main():
    rng = random.Random(4)
    names = ["CAUCHY", "GAUSSIAN", "INVERSE", "INVERSE_SQUARED", "METABALL", "SOFT_OBJECT", "QUARTIC"]
    for name in names:
        for kind in ("SEGMENT", "ARC"):
            for i in range(18):
                p = PROFILES[i % len(PROFILES)]
                scale = 10 ** rng.uniform(-2, 2)
                if kind == "SEGMENT":
                    v = [scale * rng.uniform(-1, 1) for _ in range(6)] + [0] * 5
                    shape = Segment(v)
                else:
                    sweep = float(2 * pi) if rng.random() < 0.3 else 10 ** rng.uniform(-4, 0.79)
                    v = [scale * rng.uniform(-1, 1) for _ in range(3)] + [rng.gauss(0, 1) for _ in range(6)]
                    v += [scale * rng.uniform(0.2, 1), sweep]
                    shape = Arc(v)
                size = float(shape.length)
                x = place(rng, shape, ["near", "beside", "beyond", "far", "beside"][i % 5])
                d = min(float(sqrt(sum((mpf(a) - c) ** 2 for a, c in zip(x, shape.at(mpf(k) / 64))))) for k in range(65))
                if name in ("CAUCHY", "GAUSSIAN"):
                    s = min(10 ** rng.uniform(-1, 1.3) / size, 6 / d)
                elif name.startswith("INVERSE"):
                    s = 0
                else:
                    s = max(size * 10 ** rng.uniform(-0.5, 1), d * rng.uniform(1.1, 2))
                f = field(shape, x, name, s, p)
                kind_, ends, a, b = p
                number = lambda c: mp.nstr(c, 17, min_fixed=1, max_fixed=0) if c else "0"
                print("{SKF_%s, %r, SKF_%s, {%s}, {SKF_PROFILE_%s, {%r, %r}, %s, %r, %r}, {%s}, {%s}}," % (
                    name, s, kind, ", ".join(repr(c) for c in v), kind_, ends[0], ends[1],
                    "knots, 4" if kind_ == "CUBIC" else "NULL, 0", a, b, ", ".join(repr(c) for c in x),
                    ", ".join(number(c) for c in f)), flush=True)


if __name__ == "__main__":
    main()
