#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes triangle_reference.inc: fields of triangles, right to the last digit of a double.

F comes from the planar divergence theorem, one quadrature with 64 digits per edge; gradient and Hessian from
differences of F with step 1e-18 of the distances, so they share no formula with the library. Needs mpmath; takes two
minutes."""
import random
from mpmath import mp, mpf, sqrt, log, exp, pi, quad

mp.dps = 64


def tail(kernel, k, z2):
    """H(rho2) = int_0^rho h(sqrt(rho'^2 + z2)) rho' drho', and the radius^2 of the support."""
    if kernel == "cauchy":
        return lambda t: t / (2 * (1 + k * k * z2) * (1 + k * k * (z2 + t))), None
    if kernel == "gaussian":
        return lambda t: (exp(-k * k * z2) - exp(-k * k * (z2 + t))) / (2 * k * k), None
    if kernel == "inverse":
        return lambda t: sqrt(z2 + t) - sqrt(z2), None
    if kernel == "inverse-squared":
        return lambda t: log(1 + t / z2) / 2, None
    R2 = k * k
    if kernel == "quartic":
        poly = lambda w: w / 2 - w**2 / (2 * R2) + w**3 / (6 * R2**2)
        return lambda t: poly(z2 + t) - poly(z2), R2
    if kernel == "soft-object":
        poly = lambda w: w / 2 - mpf(11) / 18 * w**2 / R2 + mpf(17) / 54 * w**3 / R2**2 - w**4 / (18 * R2**3)
        return lambda t: poly(z2 + t) - poly(z2), R2
    def cone(w):  # metaball, r^2 = w <= R^2
        inner = lambda w: w / 2 - 3 * w * w / (4 * R2)
        outer = lambda w: mpf(3) / 2 * (w / 2 - 2 * w * sqrt(w) / (3 * k) + w * w / (4 * R2))
        return inner(w) if 9 * w <= R2 else inner(R2 / 9) + outer(w) - outer(R2 / 9)
    return lambda t: cone(z2 + t) - cone(z2), R2


def dot(a, b): return sum(x * y for x, y in zip(a, b))
def sub(a, b): return [x - y for x, y in zip(a, b)]
def cross(a, b): return [a[1]*b[2] - a[2]*b[1], a[2]*b[0] - a[0]*b[2], a[0]*b[1] - a[1]*b[0]]


def field(kernel, k, V, p):
    N = cross(sub(V[1], V[0]), sub(V[2], V[0]))
    n = [x / sqrt(dot(N, N)) for x in N]
    z2 = dot(n, sub(p, V[0])) ** 2
    H, R2 = tail(kernel, k, z2)
    if R2 is not None and z2 >= R2: return mpf(0)
    total = mpf(0)
    for i in range(3):
        a, b = sub(V[i], p), sub(V[(i + 1) % 3], p)
        e = sub(b, a); L = sqrt(dot(e, e)); t = [x / L for x in e]
        d = dot(cross(t, n), a); l1 = dot(t, a); l2 = dot(t, b)
        if d == 0: continue
        rims = [] if R2 is None else [R2 - z2] + ([R2 / 9 - z2] if kernel == "metaball" else [])
        cuts = {l1, l2, mpf(0)} | {s * sqrt(q - d * d) for q in rims if q > d * d for s in (1, -1)}
        scale = sqrt(d * d + z2) if kernel != "gaussian" and kernel != "cauchy" else min(abs(d), 1 / k)
        x = abs(d) / 4
        while x < max(abs(l1), abs(l2)): cuts |= {x, -x}; x *= 4
        x = scale
        while x < max(abs(l1), abs(l2)): cuts |= {x, -x}; x *= 4
        cuts = sorted(c for c in cuts if l1 <= c <= l2)
        m = None if R2 is None else R2 - z2
        Hm = None if m is None else H(m)
        def f(l):
            t = d * d + l * l
            return d * (H(t) if m is None or t < m else Hm) / t
        total += sum(quad(f, [u, v], method="gauss-legendre", maxdegree=8) for u, v in zip(cuts[:-1], cuts[1:]))
    return total


def row(kernel, k, V, p):
    V = [[mpf(x) for x in v] for v in V]; p = [mpf(x) for x in p]; k = mpf(k)
    h = min(sqrt(dot(sub(v, p), sub(v, p))) for v in V) * mpf(10) ** -18
    def at(*s): return field(kernel, k, V, [x + h * c for x, c in zip(p, s)])
    F = at(0, 0, 0)
    E = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]; neg = lambda a: tuple(-x for x in a)
    P = [at(*e) for e in E]; M = [at(*neg(e)) for e in E]
    g = [(a - b) / (2 * h) for a, b in zip(P, M)]
    hess = []
    for i in range(3):
        for j in range(i, 3):
            if i == j: hess.append((P[i] - 2 * F + M[i]) / h**2); continue
            u = tuple(a + b for a, b in zip(E[i], E[j])); w = tuple(a - b for a, b in zip(E[i], E[j]))
            hess.append((at(*u) + at(*neg(u)) - at(*w) - at(*neg(w))) / (4 * h * h))
    return F, g, hess


def reach(A, B, C, p):
    """About the distance of p from the triangle."""
    s = [i / 20 for i in range(21)]
    return min(float(sqrt(sum((a + u * (1 - v) * (b - a) + u * v * (c - a) - x) ** 2
                              for a, b, c, x in zip(A, B, C, p)))) for u in s for v in s)


def cases():
    rng = random.Random(20260101)
    dyad = lambda lo, hi: rng.randint(int(lo * 64), int(hi * 64)) / 64
    for kernel in ("cauchy", "gaussian", "inverse", "inverse-squared", "metaball", "soft-object", "quartic"):
        for kind in ("above", "beside", "low beside", "near face", "near edge", "mid", "sliver above", "sliver beside",
                     "needle"):
            thin = {"sliver above": 1e-2, "sliver beside": 1e-3, "needle": 1e-6}.get(kind)
            A = [dyad(-1, 1) for _ in range(3)]
            u = [dyad(0.5, 1.5), dyad(-0.5, 0.5), dyad(-0.5, 0.5)]
            w = [dyad(-0.3, 0.3), dyad(0.6, 1.5), dyad(-0.5, 0.5)]
            B = [a + x for a, x in zip(A, u)]
            C = [a + 0.4 * x + y for a, x, y in zip(A, u, w)] if not thin else \
                [a + 0.4 * x + thin * y for a, x, y in zip(A, u, w)]
            N = cross(sub(B, A), sub(C, A)); s = float(sqrt(dot(N, N))); n = [float(x) / s for x in N]
            bary, z = {"above": ((.3, .4), .6), "beside": ((1.2, -.4), .3), "low beside": ((-.3, .6), .01),
                       "near face": ((.3, .3), 1e-6), "near edge": ((.5, -1e-5), 1e-5), "mid": ((1.1, 1.3), -1.2),
                       "sliver above": ((.4, .2), .2), "sliver beside": ((1.3, .2), .1),
                       "needle": ((.5, .3), -.3)}[kind]
            p = [a + bary[0] * (b - a) + bary[1] * (c - a) + z * m for a, b, c, m in zip(A, B, C, n)]
            k = {"cauchy": rng.choice((.4, 2.5, 20)), "gaussian": rng.choice((.4, 1.5, 4)), "inverse": 1,
                 "inverse-squared": 1}.get(kernel, reach(A, B, C, p) + rng.choice((.2, .5, 1.5)))
            yield kind, kernel, k, [A, B, C], [float(x) for x in p]
        if kernel in ("metaball", "soft-object", "quartic"):  # the rim of a large support through the triangle
            A, B, C = [.125, 0, .25], [1.125, .25, .125], [.375, .875, .5]
            for k, far, way in ((500, 499.75, (.36, .48, .8)), (2e4, 19999.6, (.6, -.8, 0)), (50, 49.5, (0, .28, -.96))):
                q = [.5 * a + .2 * b + .3 * c for a, b, c in zip(A, B, C)]
                yield "rim", kernel, k, [A, B, C], [float(x + far * w) for x, w in zip(q, way)]


def main():
    out = ["/* SPDX-License-Identifier: MIT */", "/* Written by triangle_reference.py: kernel, parameter, vertices, point, F,"
           " gradient, Hessian. */"]
    for kind, kernel, k, V, p in cases():
        F, g, h = row(kernel, k, V, p)
        enum = "SKF_" + kernel.upper().replace("-", "_")
        vec = lambda v: "{" + ", ".join(repr(float(x)) for x in v) + "}"
        out += ["/* %s */" % kind, "{{{%s, %r}, {{%s}}, %s}, %r, %s, %s}," %
                (enum, k, ", ".join(vec(v) for v in V), vec(p), float(F), vec(g), vec(h))]
        print(kind, kernel, k, float(F), float(h[0] + h[3] + h[5]), flush=True)
    open(__file__.rsplit("/", 1)[0] + "/triangle_reference.inc", "w").write("\n".join(out) + "\n")


main()
