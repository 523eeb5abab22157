/* SPDX-License-Identifier: MIT */
/* Textbook formulas of F and its gradient, written once for every library of functions that bench_batch.c compares.
   Included with NAME(x); REAL, a type of numbers; V, REAL or a vector of doubles; LOAD(p) and STORE(p, v); SELECT(m, a,
   b); SQRT, LOG, LOG1P, EXP, ERF, SIN, COS, ACOS, ATAN and ATAN2 on V; OUT, four arrays. Bodies are in general
   position; arcs, where the support ends along them, are less than a half of their circle. Some lose digits next to the
   body or at the rim of the support: those are there a second time, carefully, with what keeps them. Of transcendental
   functions there are none in the fields of points but Gauss's, of segments of the quartic and the soft object, of
   Cauchy's, 1 / r and 1 / r^2 circles, and of 1 / r arcs by Carlson's integrals. */

typedef struct NAME(body) {
  V a[3], b[3], u[3], L, s;          /* a point, or a segment's ends, direction, length; the kernel's parameter */
  V v[3][3], m[3][3], t[3][3], l[3]; /* triangle: corners; outward normals, directions, lengths of edges */
  V n[3], twice;                     /* its normal, 2 area */
  V R, half, cos, sin, tan;          /* arc: radius; half the sweep, its cosine and sine, tangent of a quarter */
  V at[3], axis[3][3];               /* its centre, the directions of its middle, along it there, across */
  V node[FORMULA_NODES][3], w[FORMULA_NODES]; /* points of it and their weights in Gauss's rule */
  REAL turn[FORMULA_NODES];                   /* circle: cosines of points on half of it */
} NAME(body);

enum { NAME(CIRCLE_NODES) = sizeof(REAL) > 8 ? 24 : 16 }; /* on half of it */
static NAME(body) NAME(c);

static inline V NAME(dot)(const V a[3], const V b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* r0 r1 + d0 d1; between the ends, where that cancels, |d0 x d1|^2 / (r0 r1 - d0 d1) */
static inline V NAME(near)(const V d[3], const V e[3], V rr, V dot, bool careful) {
  V n[3];
  if (!careful) return rr + dot;
  for (int k = 0; k < 3; k++) n[k] = d[(k + 1) % 3] * e[(k + 2) % 3] - d[(k + 2) % 3] * e[(k + 1) % 3];
  return SELECT(dot < 0, NAME(dot)(n, n) / (rr - dot), rr + dot);
}

/* log((S + L) / (S - L)), S = r0 + r1, S^2 - L^2 = 2 (r0 r1 + d0 d1) */
static inline V NAME(edge)(V r0, V r1, V near, V L) { return LOG1P(L * (r0 + r1 + L) / near); }

static inline void NAME(segment)(const NAME(body) * c, const V x[3], V out[4], bool careful) {
  V d[3], e[3];
  for (int k = 0; k < 3; k++) d[k] = x[k] - c->a[k], e[k] = x[k] - c->b[k];
  V r0 = SQRT(NAME(dot)(d, d)), r1 = SQRT(NAME(dot)(e, e)), dot = NAME(dot)(d, e);
  V rr = r0 * r1, near = NAME(near)(d, e, rr, dot, careful), w = -c->L / (near * rr), w0 = w * r1, w1 = w * r0;
  out[0] = NAME(edge)(r0, r1, near, c->L);
  for (int k = 0; k < 3; k++) out[1 + k] = w0 * d[k] + w1 * e[k];
}

static inline void NAME(cauchy_segment)(const NAME(body) * c, const V x[3], V out[4]) {
  V d[3], e[3], s2 = c->s * c->s;
  for (int k = 0; k < 3; k++) d[k] = x[k] - c->a[k];
  V t = NAME(dot)(d, c->u), rest = c->L - t;
  for (int k = 0; k < 3; k++) e[k] = d[k] - t * c->u[k];
  V P = 1 + s2 * NAME(dot)(e, e), A = P + s2 * t * t, B = P + s2 * rest * rest, root = SQRT(P);
  V all = 1 / (A * B * P), per_P = all * A * B, per_A = all * B * P, per_B = all * A * P;
  V angle = (ATAN(c->s * t / root) + ATAN(c->s * rest / root)) * root * per_P / c->s;
  V tA = t * per_A, tB = rest * per_B, ends = per_A * per_A - per_B * per_B;
  V dP = per_P * (tA * (per_A + per_P) + tB * (per_B + per_P) + (tA + tB + 3 * angle) * per_P / 2) / -2;
  out[0] = per_P * (tA + tB + angle) / 2;
  for (int k = 0; k < 3; k++) out[1 + k] = ends * c->u[k] + 2 * s2 * dP * e[k];
}

/* From the segment's direction: abscissae of x, from both ends, and what is across. */
static inline void NAME(along)(const NAME(body) * c, const V x[3], V *t, V *rest, V e[3]) {
  V d[3];
  for (int k = 0; k < 3; k++) d[k] = x[k] - c->a[k];
  *t = NAME(dot)(d, c->u), *rest = c->L - *t;
  for (int k = 0; k < 3; k++) e[k] = d[k] - *t * c->u[k];
}

static inline void NAME(gaussian_segment)(const NAME(body) * c, const V x[3], V out[4]) {
  V t, rest, e[3], s2 = c->s * c->s;
  NAME(along)(c, x, &t, &rest, e);
  V h = EXP(-(s2 * NAME(dot)(e, e))),
    value = h * (ERF(c->s * t) + ERF(c->s * rest)) * (REAL)0.88622692545275801365L / c->s;
  V ends = h * (EXP(-(s2 * t * t)) - EXP(-(s2 * rest * rest)));
  out[0] = value;
  for (int k = 0; k < 3; k++) out[1 + k] = ends * c->u[k] - 2 * s2 * value * e[k];
}

static inline void NAME(squared_segment)(const NAME(body) * c, const V x[3], V out[4]) {
  V t, rest, e[3];
  NAME(along)(c, x, &t, &rest, e);
  V hh = NAME(dot)(e, e), h = SQRT(hh), A = 1 / (hh + t * t), B = 1 / (hh + rest * rest);
  V value = ATAN2(h * c->L, hh - t * rest) / h, J = (t * A + rest * B + value) / hh, ends = A - B;
  out[0] = value;
  for (int k = 0; k < 3; k++) out[1 + k] = ends * c->u[k] - J * e[k];
}

/* int h and -int g over a part of the segment in the shell, its ends at abscissas a and b, distances ra and rb */
static inline void NAME(metaball_shell)(V R, V hh, V a, V ra, V b, V rb, V *h, V *J) {
  V len = b - a, E = SELECT(a > 0, ra + a, hh / (ra - a)) + SELECT(b < 0, rb - b, hh / (rb + b));
  V L = LOG1P(2 * len / E), I1 = len * (ra + rb + (a + b) * (a + b) / (ra + rb)) / 4 + hh * L / 2;
  V I2 = len * (hh + (a * a + a * b + b * b) / 3);
  *h += 3 * (len - 2 * I1 / R + I2 / (R * R)) / 2;
  *J += 3 * (L - len / R) / R;
}

static inline V NAME(metaball_end)(V R, V r) {
  V m = 1 - r / R, core = 1 - 3 * r * r / (R * R);
  return SELECT(r > R, R - R, SELECT(3 * r > R, 3 * m * m / 2, core));
}

/* The part in the support, its core, 1 - 3 r^2 / R^2, and the shell on both sides of it */
static inline void NAME(metaball_segment)(const NAME(body) * c, const V x[3], V out[4]) {
  V t, rest, e[3], R = c->s, zero = R - R, R3 = R / 3;
  NAME(along)(c, x, &t, &rest, e);
  V hh = NAME(dot)(e, e), TT = R * R - hh, T = SQRT(SELECT(TT > 0, TT, zero));
  V TT3 = R3 * R3 - hh, T3 = SQRT(SELECT(TT3 > 0, TT3, zero)), r0 = SQRT(hh + t * t), r1 = SQRT(hh + rest * rest);
  V lo = SELECT(t < T, -t, -T), hi = SELECT(rest < T, rest, T), some = hi - lo;
  V r_lo = SELECT(t < T, SQRT(hh + lo * lo), R), r_hi = SELECT(rest < T, SQRT(hh + hi * hi), R);
  V a = SELECT(lo > -T3, lo, -T3), b = SELECT(hi < T3, hi, T3);
  a = SELECT(a < hi, a, hi), b = SELECT(b > lo, b, lo);
  V ra = SQRT(hh + a * a), rb = SQRT(hh + b * b), len = b - a;
  V h = len * (1 - 3 * (hh + (a * a + a * b + b * b) / 3) / (R * R)), J = 6 * len / (R * R);
  NAME(metaball_shell)(R, hh, lo, r_lo, a, ra, &h, &J);
  NAME(metaball_shell)(R, hh, b, rb, hi, r_hi, &h, &J);
  V ends = NAME(metaball_end)(R, r0) - NAME(metaball_end)(R, r1);
  out[0] = SELECT(some > 0, h, zero), J = SELECT(some > 0, J, zero), ends = SELECT(some > 0, ends, zero);
  for (int k = 0; k < 3; k++) out[1 + k] = ends * c->u[k] - J * e[k];
}

/* [Wilson 1994; van Oosterom and Strackee 1983] */
static inline void NAME(triangle)(const NAME(body) * c, const V x[3], V out[4], bool careful) {
  V a[3][3], r[3], dot[3], J[3];
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) a[i][k] = c->v[i][k] - x[k];
  for (int i = 0; i < 3; i++) r[i] = SQRT(NAME(dot)(a[i], a[i])), dot[i] = NAME(dot)(a[i], a[(i + 1) % 3]);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    J[i] = NAME(edge)(r[i], r[j], NAME(near)(a[i], a[j], r[i] * r[j], dot[i], careful), c->l[i]);
  }
  V h = NAME(dot)(a[0], c->n), den = r[0] * r[1] * r[2] + dot[0] * r[2] + dot[1] * r[0] + dot[2] * r[1];
  V solid = 2 * ATAN2(h * c->twice, den);
  out[0] =
      NAME(dot)(a[0], c->m[0]) * J[0] + NAME(dot)(a[1], c->m[1]) * J[1] + NAME(dot)(a[2], c->m[2]) * J[2] - h * solid;
  for (int k = 0; k < 3; k++)
    out[1 + k] = solid * c->n[k] - (c->m[0][k] * J[0] + c->m[1][k] * J[1] + c->m[2][k] * J[2]);
}

/* By edges, with z over the plane, q = 1 + s^2 z^2 and E^2 = q + s^2 d^2 at the distance d from an edge's line: the
   integrals A of 1 / (E^2 + s^2 l^2) and J of its square along the edge */
static inline void NAME(cauchy_triangle)(const NAME(body) * c, const V x[3], V out[4]) {
  V a[3][3], J[3], s2 = c->s * c->s, sum = s2 - s2, Z = sum;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) a[i][k] = c->v[i][k] - x[k];
  V h = NAME(dot)(a[0], c->n), q = 1 + s2 * h * h;
  for (int i = 0; i < 3; i++) {
    V d = NAME(dot)(a[i], c->m[i]), from = NAME(dot)(a[i], c->t[i]), to = from + c->l[i], EE = q + s2 * d * d;
    V E = SQRT(EE), slope = c->s / E, A = (ATAN(slope * to) - ATAN(slope * from)) / (c->s * E);
    J[i] = (to / (EE + s2 * to * to) - from / (EE + s2 * from * from) + A) / (2 * EE);
    sum += d * A, Z += d * (A / q + J[i]);
  }
  out[0] = sum / (2 * q), Z = Z * h * s2 / q;
  for (int k = 0; k < 3; k++) out[1 + k] = Z * c->n[k] - (c->m[0][k] * J[0] + c->m[1][k] * J[1] + c->m[2][k] * J[2]);
}

/* What an edge integral needs of a triangle: abscissae of an edge's ends, the distance of its line from the foot of x,
   > 0 inside; the squared distance of the foot from the triangle, the height */
typedef struct NAME(seen) {
  V d[3], from[3], to[3], lat2, h;
} NAME(seen);

static inline NAME(seen) NAME(see)(const NAME(body) * c, const V x[3]) {
  NAME(seen) f;
  V a[3][3], zero = c->s - c->s;
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) a[i][k] = c->v[i][k] - x[k];
    f.d[i] = NAME(dot)(a[i], c->m[i]), f.from[i] = NAME(dot)(a[i], c->t[i]), f.to[i] = f.from[i] + c->l[i];
    V off = SELECT(f.from[i] > 0, f.from[i], SELECT(f.to[i] < 0, f.to[i], zero)), far = off * off + f.d[i] * f.d[i];
    f.lat2 = i == 0 ? far : SELECT(far < f.lat2, far, f.lat2);
  }
  f.lat2 = SELECT((f.d[0] > 0) & (f.d[1] > 0) & (f.d[2] > 0), zero, f.lat2);
  f.h = NAME(dot)(a[0], c->n);
  return f;
}

/* int d (1 - exp(-s^2 rho^2)) / rho^2 along the edges; from beyond 1 / s beside, where that would cancel, without the
   1, whose integrals add up to 0. Two panels: one leaves 1e-7 at bodies of this size. */
static inline void NAME(gaussian_triangle)(const NAME(body) * c, const V x[3], V out[4]) {
  enum { PANELS = sizeof(REAL) > 8 ? 8 : 2, NODES = 16 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  NAME(seen) f = NAME(see)(c, x);
  V s2 = c->s * c->s, zero = s2 - s2, over = EXP(-(s2 * f.h * f.h)), sum = zero, J[3];
  V all = SELECT(s2 * f.lat2 > 1, zero, zero + 1);
  for (int i = 0; i < 3; i++) {
    V half = c->l[i] / (2 * PANELS), dd = f.d[i] * f.d[i], part = zero;
    for (int k = 0; k < PANELS; k++)
      for (int j = 0; j < NODES; j++) {
        V l = f.from[i] + half * (REAL)(2 * k + 1 + node[j].x), w = l * l + dd;
        part += (REAL)node[j].w * (all - EXP(-(s2 * w))) / w;
      }
    sum += f.d[i] * half * part;
    J[i] =
        over * EXP(-(s2 * dd)) * (ERF(c->s * f.to[i]) - ERF(c->s * f.from[i])) * (REAL)0.88622692545275801365L / c->s;
  }
  out[0] = over * sum / (2 * s2);
  V Z = 2 * s2 * f.h * out[0]; /* f.h is below the plane */
  for (int k = 0; k < 3; k++) out[1 + k] = Z * c->n[k] - (c->m[0][k] * J[0] + c->m[1][k] * J[1] + c->m[2][k] * J[2]);
}

static inline V NAME(arsinh)(V l, V scale) {
  V size = SELECT(l < 0, -l, l), t = LOG1P((size + l * l / (scale + SQRT(l * l + scale * scale))) / scale);
  return SELECT(l < 0, -t, t);
}

/* int d log(1 + rho^2 / z^2) / 2 rho^2 along the edges, over the triangle and higher than beside it; else less the
   logarithm's least value there. After l = scale sinh t: with two panels 1e-9,
   with three 2e-13. */
static inline void NAME(squared_triangle)(const NAME(body) * c, const V x[3], V out[4]) {
  enum { PANELS = sizeof(REAL) > 8 ? 8 : 3, NODES = sizeof(REAL) > 8 ? 32 : 14 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  NAME(seen) f = NAME(see)(c, x);
  V zz = f.h * f.h, zero = zz - zz, low = SELECT(zz >= f.lat2, zero, f.lat2), per = 1 / (zz + low), J[3], Z = zero;
  out[0] = zero;
  for (int i = 0; i < 3; i++) {
    V d = f.d[i], dd = d * d, cc = dd + zz, h = SQRT(cc), part = zero, slope = zero;
    V scale = SELECT(zz >= f.lat2, h, SELECT(d < 0, -d, d));
    V from = NAME(arsinh)(f.from[i], scale), half = (NAME(arsinh)(f.to[i], scale) - from) / (2 * PANELS);
    for (int k = 0; k < PANELS; k++)
      for (int j = 0; j < NODES; j++) {
        V e = EXP(from + half * (REAL)(2 * k + 1 + node[j].x)), inv = 1 / e, l = scale * (e - inv) / 2;
        V rr = l * l + dd, w = (REAL)node[j].w * (e + inv) / rr;
        part += w * LOG1P((rr - low) * per), slope += w / (rr + zz);
      }
    V by = d * half * scale / 2;
    J[i] = ATAN2(h * c->l[i], cc + f.from[i] * f.to[i]) / h;
    out[0] += by * part / 2, Z += SELECT(zz >= f.lat2, d * J[i] / f.h, -(f.h * by * slope));
  }
  for (int k = 0; k < 3; k++) out[1 + k] = Z * c->n[k] - (c->m[0][k] * J[0] + c->m[1][k] * J[1] + c->m[2][k] * J[2]);
}

/* From an arc's axes back */
static inline void NAME(turn)(const NAME(body) * c, V gx, V gy, V gz, V out[4]) {
  for (int k = 0; k < 3; k++) out[1 + k] = gx * c->axis[0][k] + gy * c->axis[1][k] + gz * c->axis[2][k];
}

/* R times the integral of (a - b cos - c sin)^-2 over the angle, by the tangent of its half, and its derivatives. */
static inline void NAME(cauchy_arc)(const NAME(body) * c, const V at[3], V out[4]) {
  V s2 = c->s * c->s, R = c->R, b2 = 2 * R * s2, T = c->tan, co = c->cos, si = c->sin, d[3], x[3];
  for (int k = 0; k < 3; k++) d[k] = at[k] - c->at[k];
  for (int k = 0; k < 3; k++) x[k] = NAME(dot)(d, c->axis[k]);
  V a = 1 + s2 * (NAME(dot)(x, x) + R * R), bx = b2 * x[0], by = b2 * x[1], C = a * a - bx * bx - by * by;
  V root = SQRT(C), m = a + bx, W2 = m * T - by, W1 = -(m * T) - by, D2 = a - bx * co - by * si, D1 = D2 + 2 * by * si;
  V angle = ATAN2(root * (W2 - W1), C + W1 * W2), DD = D1 * D2, all = 1 / (root * DD * m);
  V i1 = all * root * m * D2, i2 = all * root * m * D1, ic = all * DD * m, iC = ic * ic, im = all * root * DD;
  V I = 2 * angle * ic, n2 = bx * si - by * co, n1 = -(bx * si) - by * co, G = (n2 * i2 - n1 * i1 + a * I) * iC;
  V cq = 1 / (1 + T * T), k2 = root * im * cq * i2, k1 = root * im * cq * i1;
  V P = k2 * W2 - k1 * W1, kd = (k2 + k1) * T, km = k2 - k1, PT = (P + angle) * iC;
  V Ia = 2 * ic * (kd - a * PT), Ix = 2 * ic * (kd + bx * PT), Iy = 2 * ic * (by * PT - km);
  V Ea = n1 * i1 * i1 - n2 * i2 * i2, Ex = si * (i2 + i1) + co * (n2 * i2 * i2 - n1 * i1 * i1);
  V Ey = co * (i1 - i2) + si * (n2 * i2 * i2 + n1 * i1 * i1);
  V fa = 2 * s2 * R * (Ea + I + a * Ia - 2 * a * G) * iC, fb = R * b2 * iC;
  out[0] = R * G;
  V gx = fa * x[0] + fb * (Ex + a * Ix + 2 * bx * G), gy = fa * x[1] + fb * (Ey + a * Iy + 2 * by * G);
  NAME(turn)(c, gx, gy, fa * x[2], out);
}

/* The same of 1 / r^2, its derivatives by the two integrals of cos and sin that make it up and vanish with W */
static inline void NAME(squared_arc)(const NAME(body) * c, const V at[3], V out[4]) {
  V R = c->R, T = c->tan, co = c->cos, si = c->sin, d[3], x[3];
  for (int k = 0; k < 3; k++) d[k] = at[k] - c->at[k];
  for (int k = 0; k < 3; k++) x[k] = NAME(dot)(d, c->axis[k]);
  V a = NAME(dot)(x, x) + R * R, bx = 2 * R * x[0], by = 2 * R * x[1], bb = bx * bx + by * by, C = a * a - bb;
  V root = SQRT(C), m = a + bx, W2 = m * T - by, W1 = -(m * T) - by, D2 = a - bx * co - by * si, D1 = D2 + 2 * by * si;
  V I = 2 * ATAN2(root * (W2 - W1), C + W1 * W2) / root, i1 = 1 / D1, i2 = 1 / D2;
  V n2 = bx * si - by * co, n1 = -(bx * si) - by * co, G = (n2 * i2 - n1 * i1 + a * I) / C;
  V along = (a * G - I) / bb, across = (i1 - i2) / bb, Gx = bx * along - by * across, Gy = by * along + bx * across;
  out[0] = R * I;
  NAME(turn)(c, -2 * R * (x[0] * G - R * Gx), -2 * R * (x[1] * G - R * Gy), -2 * R * x[2] * G, out);
}

/* lib/field/batch_arc.h's */
static inline void NAME(careful_arc)(const NAME(body) * c, const V at[3], V out[4]) {
  V R = c->s * c->R, d[3], x[3];
  for (int k = 0; k < 3; k++) d[k] = c->s * (at[k] - c->at[k]);
  for (int k = 0; k < 3; k++) x[k] = NAME(dot)(d, c->axis[k]);
  V u = x[0], v = x[1], kk = u * u + v * v, q = 1 + x[2] * x[2], w = kk - R * R, a = q + kk + R * R, two = 2 * R;
  V DD = w * w + q * (a + kk + R * R), D = SQRT(DD), dot = a * c->cos - two * u, cross = D * c->sin;
  V per_W = 1 / (dot * dot + cross * cross), per_D = 1 / DD, I1 = ATAN2(cross, dot) / D;
  V pS = two * c->sin * u, tS = two * c->sin * v, tC = two * c->cos * v, g = a - two * c->cos * u, bb = two * two * kk;
  V E1 = (pS * g - tC * tS) * per_W, I2 = (a * I1 + E1) * per_D, gt = 2 * g * tS;
  V E2 = (pS * (g * g + tS * tS) - tC * gt) * per_W * per_W, I3 = (E2 - I1 + 3 * a * I2) * per_D;
  V X3 = (a * (E2 + (a * E1 + bb * I1) * per_D) + 2 * bb * I2) * per_D;
  V G = -2 * c->R * c->s / kk, P = G * (2 * kk * I3 - X3), Q = G * gt * per_W * per_W;
  out[0] = 2 * c->R * I2;
  NAME(turn)(c, P * u - Q * v, P * v + Q * u, -4 * c->R * c->s * x[2] * I3, out);
}

/* There is no closed form: Gauss's rule, with as many nodes as lib/field/batch_arc_gaussian.h has for this arc */
static inline void NAME(gaussian_arc)(const NAME(body) * c, const V x[3], V out[4]) {
  V s2 = c->s * c->s, sum[4] = {s2 - s2, s2 - s2, s2 - s2, s2 - s2};
  for (int j = 0; j < FORMULA_NODES; j++) {
    V d[3], h;
    for (int k = 0; k < 3; k++) d[k] = x[k] - c->node[j][k];
    h = c->w[j] * EXP(-(s2 * NAME(dot)(d, d)));
    sum[0] += h;
    for (int k = 0; k < 3; k++) sum[1 + k] += h * d[k];
  }
  out[0] = sum[0];
  for (int k = 0; k < 3; k++) out[1 + k] = -2 * s2 * sum[1 + k];
}

static inline void NAME(gaussian_point)(const NAME(body) * c, const V x[3], V out[4]) {
  V d[3], s2 = c->s * c->s;
  for (int k = 0; k < 3; k++) d[k] = x[k] - c->a[k];
  out[0] = EXP(-(s2 * NAME(dot)(d, d)));
  for (int k = 0; k < 3; k++) out[1 + k] = -2 * s2 * out[0] * d[k];
}

static inline V NAME(height)(const NAME(body) * c, const V x[3]) {
  V d[3];
  for (int k = 0; k < 3; k++) d[k] = x[k] - c->a[k];
  return NAME(dot)(d, c->n);
}

static inline void NAME(gaussian_plane)(const NAME(body) * c, const V x[3], V out[4]) {
  V z = NAME(height)(c, x), s2 = c->s * c->s, h = EXP(-(s2 * z * z)), slope = (REAL)-6.2831853071795864769L * z * h;
  out[0] = (REAL)3.1415926535897932385L / s2 * h;
  for (int k = 0; k < 3; k++) out[1 + k] = slope * c->n[k];
}

static inline void NAME(squared_plane)(const NAME(body) * c, const V x[3], V out[4]) {
  V z = NAME(height)(c, x), slope = (REAL)-6.2831853071795864769L / z;
  out[0] = (REAL)-3.1415926535897932385L * LOG(z * z);
  for (int k = 0; k < 3; k++) out[1 + k] = slope * c->n[k];
}

/* There are no Bessel functions in these libraries: by the trapezoidal rule, exact to 1e-17 for circles of this size.
 */
static inline void NAME(gaussian_circle)(const NAME(body) * c, const V at[3], V out[4]) {
  enum { NODES = NAME(CIRCLE_NODES) };
  V d[3], x[3], s2 = c->s * c->s, h = s2 - s2, hc = h;
  for (int k = 0; k < 3; k++) d[k] = at[k] - c->at[k];
  for (int k = 0; k < 3; k++) x[k] = NAME(dot)(d, c->axis[k]);
  V kk = x[0] * x[0] + x[1] * x[1], k = SQRT(kk), a = s2 * (kk + x[2] * x[2] + c->R * c->R), b = 2 * s2 * c->R * k;
  for (int j = 0; j < NODES; j++) {
    V e = EXP(b * c->turn[j] - a);
    h += e, hc += e * c->turn[j];
  }
  V by = (REAL)(6.2831853071795864769L / NODES) * c->R, along = -2 * s2 * by * (h - c->R / k * hc);
  out[0] = by * h;
  NAME(turn)(c, along * x[0], along * x[1], -2 * s2 * out[0] * x[2], out);
}

#include "formula_compact.h"

/* The constants of a body, for what follows */
static void NAME(prepare)(const skf_element *e) {
  const skf_primitive *q = &e->primitive;
  NAME(body) *c = &NAME(c);
  c->s = NAME(all)((REAL)e->kernel.param);
  if (q->shape == SKF_POINT) NAME(vector)(c->a, q->point.at);
  if (q->shape == SKF_PLANE) NAME(vector)(c->a, q->plane.through), NAME(vector)(c->n, q->plane.normal);
  if (q->shape == SKF_SEGMENT) {
    NAME(vector)(c->a, q->segment.from), NAME(vector)(c->b, q->segment.to);
    for (int k = 0; k < 3; k++) c->u[k] = c->b[k] - c->a[k];
    c->L = NAME(unit)(c->u);
  }
  if (q->shape == SKF_ARC) {
    REAL half = (REAL)q->arc.sweep / 2, cosine = (REAL)cosl(half), sine = (REAL)sinl(half);
    c->R = NAME(all)((REAL)q->arc.radius), c->half = NAME(all)(half);
    c->cos = NAME(all)(cosine), c->sin = NAME(all)(sine), c->tan = NAME(all)(sine / (1 + cosine));
    V side[3], start[3];
    NAME(vector)(c->at, q->arc.center), NAME(vector)(c->axis[2], q->arc.normal), NAME(vector)(start, q->arc.start);
    NAME(cross)(c->axis[2], start, side);
    for (int k = 0; k < 3; k++) c->axis[0][k] = c->cos * start[k] + c->sin * side[k];
    NAME(cross)(c->axis[2], c->axis[0], c->axis[1]);
    for (int j = 0; j < NAME(CIRCLE_NODES); j++)
      c->turn[j] = (REAL)cosl((2 * j + 1) * 3.1415926535897932385L / (2 * NAME(CIRCLE_NODES)));
    for (int j = 0; j < FORMULA_NODES; j++) {
      const skf_gauss_node *node = skf_gauss_rule(FORMULA_NODES) + j;
      V along = c->R * (REAL)sinl(half * (REAL)node->x), out = c->R * (REAL)cosl(half * (REAL)node->x);
      c->w[j] = c->R * half * (REAL)node->w;
      for (int k = 0; k < 3; k++) c->node[j][k] = c->at[k] + out * c->axis[0][k] + along * c->axis[1][k];
    }
  }
  if (q->shape != SKF_TRIANGLE) return;
  for (int i = 0; i < 3; i++) NAME(vector)(c->v[i], q->triangle.vertices[i]);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) c->t[i][k] = c->v[(i + 1) % 3][k] - c->v[i][k];
  NAME(cross)(c->t[0], c->t[1], c->n);
  c->twice = NAME(unit)(c->n);
  for (int i = 0; i < 3; i++) {
    c->l[i] = NAME(unit)(c->t[i]);
    NAME(cross)(c->t[i], c->n, c->m[i]);
  }
}

#define FORMULA_RUN(formula, call)                                                                                     \
  static void NAME(run_##formula)(size_t n) {                                                                          \
    const NAME(body) copy = NAME(c), *const c = &copy;                                                                 \
    for (size_t i = 0; i < n; i += sizeof(V) == 32 ? 4 : 1) {                                                          \
      V x[3] = {LOAD(p[0] + i), LOAD(p[1] + i), LOAD(p[2] + i)}, v[4];                                                 \
      call;                                                                                                            \
      for (int k = 0; k < 4; k++) STORE(OUT[k] + i, v[k]);                                                             \
    }                                                                                                                  \
  }
FORMULA_RUN(inverse_segment, NAME(segment)(c, x, v, false))
FORMULA_RUN(careful_segment, NAME(segment)(c, x, v, true))
FORMULA_RUN(cauchy_segment, NAME(cauchy_segment)(c, x, v))
FORMULA_RUN(inverse_triangle, NAME(triangle)(c, x, v, false))
FORMULA_RUN(careful_triangle, NAME(triangle)(c, x, v, true))
FORMULA_RUN(cauchy_triangle, NAME(cauchy_triangle)(c, x, v))
FORMULA_RUN(gaussian_triangle, NAME(gaussian_triangle)(c, x, v))
FORMULA_RUN(squared_triangle, NAME(squared_triangle)(c, x, v))
FORMULA_RUN(cauchy_arc, NAME(cauchy_arc)(c, x, v))
FORMULA_RUN(careful_arc, NAME(careful_arc)(c, x, v))
FORMULA_RUN(gaussian_arc, NAME(gaussian_arc)(c, x, v))
FORMULA_RUN(gaussian_point, NAME(gaussian_point)(c, x, v))
FORMULA_RUN(gaussian_segment, NAME(gaussian_segment)(c, x, v))
FORMULA_RUN(squared_segment, NAME(squared_segment)(c, x, v))
FORMULA_RUN(squared_arc, NAME(squared_arc)(c, x, v))
FORMULA_RUN(metaball_segment, NAME(metaball_segment)(c, x, v))
FORMULA_RUN(metaball_arc, NAME(metaball_arc)(c, x, v))
FORMULA_RUN(quartic_arc, (sizeof(REAL) > 8 ? NAME(careful_compact_arc) : NAME(compact_arc))(false, c, x, v))
FORMULA_RUN(careful_quartic_arc, NAME(careful_compact_arc)(false, c, x, v))
FORMULA_RUN(soft_object_arc, (sizeof(REAL) > 8 ? NAME(careful_compact_arc) : NAME(compact_arc))(true, c, x, v))
FORMULA_RUN(careful_soft_object_arc, NAME(careful_compact_arc)(true, c, x, v))
FORMULA_RUN(gaussian_circle, NAME(gaussian_circle)(c, x, v))
FORMULA_RUN(metaball_triangle, NAME(metaball_triangle)(sizeof(REAL) > 8, c, x, v))
FORMULA_RUN(careful_metaball_triangle, NAME(metaball_triangle)(true, c, x, v))
FORMULA_RUN(quartic_triangle, NAME(compact_triangle)(false, sizeof(REAL) > 8, c, x, v))
FORMULA_RUN(careful_quartic_triangle, NAME(compact_triangle)(false, true, c, x, v))
FORMULA_RUN(soft_object_triangle, NAME(compact_triangle)(true, sizeof(REAL) > 8, c, x, v))
FORMULA_RUN(careful_soft_object_triangle, NAME(compact_triangle)(true, true, c, x, v))
FORMULA_RUN(gaussian_plane, NAME(gaussian_plane)(c, x, v))
FORMULA_RUN(squared_plane, NAME(squared_plane)(c, x, v))
#undef FORMULA_RUN

static const library NAME(library) = {NAME(prepare),
                                      {{NAME(run_inverse_segment), NAME(run_careful_segment)},
                                       {NAME(run_cauchy_segment), NULL},
                                       {NAME(run_inverse_triangle), NAME(run_careful_triangle)},
                                       {NAME(run_cauchy_arc), NAME(run_careful_arc)},
                                       {NAME(run_gaussian_point), NULL},
                                       {NAME(run_gaussian_segment), NULL},
                                       {NAME(run_squared_segment), NULL},
                                       {NAME(run_squared_arc), NULL},
                                       {NAME(run_gaussian_plane), NULL},
                                       {NAME(run_squared_plane), NULL},
                                       {NAME(run_cauchy_triangle), NULL},
                                       {NAME(run_gaussian_triangle), NULL},
                                       {NAME(run_squared_triangle), NULL},
                                       {NAME(run_metaball_segment), NULL},
                                       {NAME(run_gaussian_arc), NULL},
                                       {NAME(run_metaball_arc), NULL},
                                       {NAME(run_quartic_arc), NAME(run_careful_quartic_arc)},
                                       {NAME(run_soft_object_arc), NAME(run_careful_soft_object_arc)},
                                       {NAME(run_gaussian_circle), NULL},
                                       {NAME(run_metaball_triangle), NAME(run_careful_metaball_triangle)},
                                       {NAME(run_quartic_triangle), NAME(run_careful_quartic_triangle)},
                                       {NAME(run_soft_object_triangle), NAME(run_careful_soft_object_triangle)}}};
#undef V
#undef REAL
#undef NAME
#undef LOAD
#undef STORE
#undef OUT
#undef SELECT
#undef SQRT
#undef LOG
#undef LOG1P
#undef EXP
#undef ERF
#undef ACOS
#undef ATAN
#undef ATAN2
#undef SIN
#undef COS
