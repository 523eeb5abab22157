/* SPDX-License-Identifier: MIT */
/* formula.h: kernels of finite support along arcs and over triangles */

static inline V NAME(min)(V a, V b) { return SELECT(a < b, a, b); }
static inline V NAME(max)(V a, V b) { return SELECT(a > b, a, b); }

/* An arc from x: at the angle t from it, R^2 - r^2 = A + B cos t with the radius R of the support, > 0 for |t| < cut;
   the arc is from lo to hi > |lo|, their cosines and sines; x mirrored so, its direction and distances */
typedef struct NAME(view) {
  V R, A, B, cut, lo, hi, c[2], s[2];
  V u, v, side, k, z;
} NAME(view);

static inline V NAME(arccos)(V x) { return ACOS(NAME(max)(NAME(min)(x, x - x + 1), x - x - 1)); }

static inline NAME(view) NAME(view_arc)(const NAME(body) * c, const V at[3]) {
  NAME(view) f = {.R = c->s};
  V d[3], x[3];
  for (int k = 0; k < 3; k++) d[k] = at[k] - c->at[k];
  for (int k = 0; k < 3; k++) x[k] = NAME(dot)(d, c->axis[k]);
  V kk = x[0] * x[0] + x[1] * x[1];
  f.k = SQRT(kk), f.z = x[2], f.side = SELECT(x[1] < 0, f.R - f.R - 1, f.R - f.R + 1);
  f.u = x[0] / f.k, f.v = f.side * x[1] / f.k;
  f.A = f.R * f.R - kk - x[2] * x[2] - c->R * c->R, f.B = 2 * c->R * f.k;
  V phi = ATAN2(f.side * x[1], x[0]);
  f.lo = phi - c->half, f.c[0] = f.u * c->cos + f.v * c->sin, f.s[0] = f.v * c->cos - f.u * c->sin;
  f.hi = phi + c->half, f.c[1] = f.u * c->cos - f.v * c->sin, f.s[1] = f.v * c->cos + f.u * c->sin;
  f.cut = NAME(arccos)(-f.A / f.B);
  return f;
}

/* From the integrals over t of h, g and g cos t and h at the ends */
static inline void NAME(view_out)(const NAME(body) * c, const NAME(view) * f, V h, V g, V g_cos, V lo, V hi, V out[4]) {
  V along = c->R * (f->k * g - c->R * g_cos), side = c->R * (hi - lo) / f->k;
  out[0] = c->R * h;
  NAME(turn)(c, along * f->u - side * f->v, f->side * (along * f->v + side * f->u), c->R * f->z * g, out);
}

/* h = m^2 or m^2 (5 + 4 m) / 9, m = 1 - r^2 / R^2 = a + b cos t: the integrals of powers of the cosine over what is
   seen on both sides */
static inline V NAME(compact_h)(bool soft, V m) { return soft ? m * m * (5 + 4 * m) / 9 : m * m; }
static inline V NAME(compact_g)(bool soft, V m) { return soft ? m * (20 + 24 * m) / -9 : -4 * m; }

static inline void NAME(compact_arc)(bool soft, const NAME(body) * c, const V x[3], V out[4]) {
  NAME(view) f = NAME(view_arc)(c, x);
  V zero = f.R - f.R, per = 1 / (f.R * f.R), a = f.A * per, b = f.B * per, C[4] = {zero, zero, zero, zero};
  V cosine = NAME(max)(NAME(min)(-f.A / f.B, zero + 1), zero - 1), sine = SQRT(1 - cosine * cosine);
  for (int far = 0; far < 2; far++) {
    V around = zero + far * (REAL)6.2831853071795864769L, left = around - f.cut, right = around + f.cut;
    V lo = NAME(max)(f.lo, left), hi = NAME(min)(f.hi, right), T = hi - lo;
    V c0 = SELECT(f.lo > left, f.c[0], cosine), s0 = SELECT(f.lo > left, f.s[0], -sine);
    V c1 = SELECT(f.hi < right, f.c[1], cosine), s1 = SELECT(f.hi < right, f.s[1], sine), S = s1 - s0;
    V each[4] = {T, S, (T + s1 * c1 - s0 * c0) / 2, S * (1 - (s1 * s1 + s1 * s0 + s0 * s0) / 3)};
    for (int k = 0; k < 4; k++) C[k] += SELECT(T > 0, each[k], zero);
  }
  V m = a * C[0] + b * C[1], mc = a * C[1] + b * C[2], mm = a * m + b * mc, g = -4 * m, gc = -4 * mc, h = mm;
  if (soft) {
    V mmc = a * mc + b * (a * C[2] + b * C[3]), mmm = a * mm + b * mmc;
    h = (5 * mm + 4 * mmm) / 9, g = (20 * m + 24 * mm) / -9, gc = (20 * mc + 24 * mmc) / -9;
  }
  V m0 = NAME(max)(a + b * f.c[0], zero), m1 = NAME(max)(a + b * f.c[1], zero);
  NAME(view_out)(c, &f, h, per * g, per * gc, NAME(compact_h)(soft, m0), NAME(compact_h)(soft, m1), out);
}

/* The same by Gauss's rule, m = 2 b sin (cut - t) / 2 sin (cut + t) / 2, more without a cut */
static inline void NAME(careful_compact_arc)(bool soft, const NAME(body) * c, const V x[3], V out[4]) {
  enum { NODES = sizeof(REAL) > 8 ? 24 : 10 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  NAME(view) f = NAME(view_arc)(c, x);
  V zero = f.R - f.R, per = 1 / (f.R * f.R), a = f.A * per, b = f.B * per, h = zero, g = zero, gc = zero;
  V rim = NAME(max)(a - b, zero);
  for (int far = 0; far < 2; far++) {
    V around = zero + far * (REAL)6.2831853071795864769L;
    V lo = NAME(max)(f.lo - around, -f.cut), hi = NAME(min)(f.hi - around, f.cut), T = NAME(max)(hi - lo, zero);
    for (int j = 0; j < NODES; j++) {
      V t = (lo + hi) / 2 + T / 2 * (REAL)node[j].x, w = T / 2 * (REAL)node[j].w;
      V m = rim + 2 * b * SIN((f.cut - t) / 2) * SIN((f.cut + t) / 2);
      V slope = w * NAME(compact_g)(soft, m);
      h += w * NAME(compact_h)(soft, m), g += slope, gc += slope * (m - a) / b;
    }
  }
  V m0 = NAME(max)(a + b * f.c[0], zero), m1 = NAME(max)(a + b * f.c[1], zero);
  NAME(view_out)(c, &f, h, per * g, per * gc, NAME(compact_h)(soft, m0), NAME(compact_h)(soft, m1), out);
}

/* Two pieces of an arc, where r grows all along: the core is integrated in closed form, the shell by Gauss's rule, with
   as many nodes as in lib/field/batch_arc_metaball.h. */
static inline void NAME(metaball_arc)(const NAME(body) * c, const V x[3], V out[4]) {
  enum { PANELS = sizeof(REAL) > 8 ? 4 : 1, NODES = 24 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  NAME(view) f = NAME(view_arc)(c, x);
  V zero = f.R - f.R, pi = zero + (REAL)3.1415926535897932385L, RR = f.R * f.R, per = 1 / f.R, h = zero, g = zero,
    gc = zero;
  V core = NAME(arccos)((8 * RR / 9 - f.A) / f.B), past = 2 * pi - f.hi;
  V from[2] = {SELECT(f.lo < 0, zero, NAME(min)(past, pi)), NAME(max)(f.lo, zero)};
  V to[2] = {SELECT(f.lo < 0, -f.lo, pi), NAME(min)(f.hi, pi)};
  for (int i = 0; i < 2; i++) {
    V end = NAME(max)(from[i], NAME(min)(to[i], core)), T = end - from[i], S = SIN(end) - SIN(from[i]);
    h += T + 3 * ((f.A - RR) * T + f.B * S) / RR, g -= 6 * T / RR, gc -= 6 * S / RR;
    V rim = NAME(max)(end, NAME(min)(to[i], f.cut)), half = (rim - end) / (2 * PANELS);
    for (int j = 0; j < PANELS * NODES; j++) {
      V t = end + half * (REAL)(2 * (j / NODES) + 1 + node[j % NODES].x);
      V cosine = COS(t), r = SQRT(RR - f.A - f.B * cosine), m = 1 - r * per;
      V w = half * (3 * (REAL)node[j % NODES].w) * m, slope = w * per / r;
      h += w * m / 2, g -= slope, gc -= slope * cosine;
    }
  }
  V r0 = SQRT(RR - f.A - f.B * f.c[0]), r1 = SQRT(RR - f.A - f.B * f.c[1]);
  NAME(view_out)(c, &f, h, g, gc, NAME(metaball_end)(f.R, r0), NAME(metaball_end)(f.R, r1), out);
}

/* The disc that the support of radius R cuts from a triangle's plane: its squared radius, half an edge's chord and the
   edge's part in it, the angle under which the foot of x sees the rest */
typedef struct NAME(chord) {
  V half, from, to, len, out;
} NAME(chord);

static inline NAME(chord) NAME(cut)(const NAME(seen) * f, int i, V rr) {
  V d = f->d[i], dd = d * d, l1 = f->from[i], l2 = f->to[i], zero = dd - dd;
  NAME(chord) e = {.half = SQRT(NAME(max)(rr - dd, zero))};
  e.from = NAME(max)(l1, -e.half), e.to = NAME(min)(l2, e.half), e.len = NAME(max)(e.to - e.from, zero);
  V below = NAME(max)(l1, NAME(min)(l2, -e.half)), above = NAME(min)(l2, NAME(max)(l1, e.half));
  V c0 = dd + l1 * below, s0 = d * (below - l1), c1 = dd + l2 * above, s1 = d * (l2 - above);
  e.out = ATAN2(c0 * s1 + c1 * s0, c0 * c1 - s0 * s1);
  return e;
}

/* The gradient from J and Z; 0 out of the support */
static inline void NAME(edges_out)(const NAME(body) * c, const NAME(seen) * f, V RR, V Z, const V J[3], V out[4]) {
  V zero = RR - RR;
  Z = Z * f->h;
  for (int k = 0; k < 3; k++) out[1 + k] = Z * c->n[k] - (c->m[0][k] * J[0] + c->m[1][k] * J[1] + c->m[2][k] * J[2]);
  for (int k = 0; k < 4; k++) out[k] = SELECT(f->h * f->h + f->lat2 < RR, out[k], zero);
}

/* H-form, exact Gauss rules on edges; carefully, where the disc is seen from far beside, the G-form, whose terms have
   one sign */
static inline void NAME(compact_triangle)(bool soft, bool careful, const NAME(body) * c, const V x[3], V out[4]) {
  enum { BESIDE = sizeof(REAL) > 8 ? 32 : 20 };
  const int nodes = soft ? 4 : 3;
  const skf_gauss_node *node = skf_gauss_rule(nodes), *beside = skf_gauss_rule(BESIDE);
  NAME(seen) f = NAME(see)(c, x);
  V RR = c->s * c->s, zero = RR - RR, rr = NAME(max)(RR - f.h * f.h, zero), per = 1 / RR, y0 = rr * per, y00 = y0 * y0;
  V h0 = NAME(compact_h)(soft, y0), G0 = soft ? rr * y00 * (5 + 3 * y0) / 54 : rr * y00 / 6, Z = zero, J[3];
  out[0] = zero;
  for (int i = 0; i < 3; i++) {
    NAME(chord) e = NAME(cut)(&f, i, rr);
    V half = e.len / 2, mid = (e.from + e.to) / 2, edge = f.d[i] * half, H = zero, D = zero, h = zero;
    for (int j = 0; j < nodes; j++) {
      V l = mid + half * (REAL)node[j].x, y = (e.half - l) * (e.half + l) * per, s1 = y0 + y, s2 = y00 + y * s1;
      REAL w = (REAL)node[j].w;
      H += w * (soft ? (5 * s2 + 3 * s1 * (y00 + y * y)) / 54 : s2 / 6);
      D += w * (soft ? (5 * s1 + 4 * s2) / 9 : s1), h += w * NAME(compact_h)(soft, y);
    }
    V all = edge * H + G0 * e.out, n = edge * per * D + h0 * e.out, G = zero, g = zero;
    for (int j = 0; careful && j < BESIDE; j++) {
      V l = mid + half * (REAL)beside[j].x, y = (e.half - l) * (e.half + l) * per;
      V by = (REAL)beside[j].w / (f.d[i] * f.d[i] + l * l);
      G += by * y * y * y * (soft ? (5 + 3 * y) / 54 : zero + (REAL)(1 / 6.L)), g += by * NAME(compact_h)(soft, y);
    }
    J[i] = half * h;
    out[0] += careful ? SELECT(2 * f.lat2 > rr, -(edge * RR * G), all) : all;
    Z += careful ? SELECT(2 * f.lat2 > rr, -(edge * g), n) : n;
  }
  NAME(edges_out)(c, &f, RR, Z, J, out);
}

/* By edges in closed form, k = (1 - r / R)^2: adds by times F, J and the gradient along the height. Carefully, near the
   rim the H-form by Gauss's rule, where the disc is seen from far beside the G-form. */
static inline void NAME(cone)(bool careful, const NAME(seen) * f, V R, REAL by, V *to, V J[3], V *Z) {
  enum { NODES = sizeof(REAL) > 8 ? 32 : 28 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  V zero = R - R, z = SELECT(f->h < 0, -f->h, f->h), zz = z * z, RR = R * R, rr = NAME(max)((R - z) * (R + z), zero);
  V w = z / R, p0 = NAME(max)(1 - w, zero), G0 = RR * p0 * p0 * p0 * (4 - 3 * p0) / 12, far = 3 * f->lat2 - rr;
  for (int i = 0; i < 3; i++) {
    NAME(chord) e = NAME(cut)(f, i, rr);
    V d = f->d[i], a = e.from, b = e.to, len = e.len, cc = d * d + zz, ra = SQRT(cc + a * a), rb = SQRT(cc + b * b);
    V L = LOG1P(len * (ra + rb + len) / (ra * rb + cc + a * b)), Da = cc + z * ra, Db = cc + z * rb;
    V solid = ATAN2(d * (b * Da - a * Db), Da * Db + d * d * a * b), T = d * L - z * solid;
    V ll = len * (a * a + a * b + b * b) / 3, I = (b * rb - a * ra + cc * L) / 2;
    V h = (d * (6 * len + 3 * ((cc + zz) * len + ll) / RR - 8 * I / R) - 8 * zz * T / R) / 12;
    V D = (2 * R * T - d * len) / RR, j = len + (cc * len + ll) / RR - 2 * I / R;
    V out = e.out, H = zero, n = zero, v = zero, half = len / 2, size = d * half;
    for (int k = 0; careful && k < NODES; k++) {
      V l = (a + b) / 2 + half * (REAL)node[k].x, qq = d * d + l * l, u = SQRT(zz + qq) / R;
      V q = SELECT(far > 0, qq, u + w), per = 1 / (q * (1 + u)), y = (e.half - l) * (e.half + l) / RR * (q * per);
      V yy = y * y, s = y + p0, weight = (REAL)node[k].w * (1 + u) * per;
      H += weight * SELECT(far > 0, yy * y * (4 - 3 * y), 4 * (p0 * s + yy) - 3 * s * (p0 * p0 + yy));
      n += weight * SELECT(far > 0, yy, s), v += (REAL)node[k].w * yy;
    }
    if (careful) {
      V rim = 7 * z - 4 * R;
      h = SELECT(far > 0, -(size * RR / 12 * H), SELECT(rim > 0, size / 12 * H, h));
      D = SELECT(far > 0, -(size * n), SELECT(rim > 0, size * n / RR, D));
      j = SELECT(far > 0, half * v, SELECT(rim > 0, half * v, j)), out = SELECT(far > 0, zero, out);
    }
    *to += by * (SELECT(len > 0, h, zero) + G0 * out), *Z += by * (SELECT(len > 0, D, zero) + p0 * p0 * out);
    J[i] += by * SELECT(len > 0, j, zero);
  }
}

/* 3/2 k of R and -1/2 k of R / 3 */
static inline void NAME(metaball_triangle)(bool careful, const NAME(body) * c, const V x[3], V out[4]) {
  NAME(seen) f = NAME(see)(c, x);
  V zero = c->s - c->s, J[3] = {zero, zero, zero}, Z = zero;
  out[0] = zero;
  NAME(cone)(careful, &f, c->s, (REAL)1.5, &out[0], J, &Z);
  NAME(cone)(false, &f, c->s / 3, (REAL)-0.5, &out[0], J, &Z);
  NAME(edges_out)(c, &f, c->s * c->s, Z, J, out);
}

static V NAME(all)(REAL a) { return a - (V){0}; }
static void NAME(vector)(V to[3], skf_vec3 a) {
  for (int k = 0; k < 3; k++) to[k] = NAME(all)((REAL)v3_get(a, k));
}
static V NAME(unit)(V a[3]) {
  V length = SQRT(NAME(dot)(a, a));
  for (int k = 0; k < 3; k++) a[k] = a[k] / length;
  return length;
}
static void NAME(cross)(const V a[3], const V b[3], V out[3]) {
  for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}
