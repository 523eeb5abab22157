/* SPDX-License-Identifier: MIT */
/* Vector forms: 1 / r over a triangle. */
#ifndef SKF_FIELD_BATCH_TRIANGLE_H
#define SKF_FIELD_BATCH_TRIANGLE_H

#include "field/batch_loop.h"
#include "num/gauss.h"

/* The edges' sums lose (distance / diameter)^2: from here on a product rule, with 7 nodes exact to 5e-18,
   and from three halves of the diameter on with 13. */
#define FAR_DIAMETERS 5
enum { FAR_NODES = SKF_COUNT(7, 4), MIDDLE_NODES = SKF_COUNT(13, 7) };

/* As skf_triangle_plan; t, n1 the direction and outward normal of the longest edge */
typedef struct triangle_row {
  skf_v3d v[3], m[3], side, base, n, t, n1;
  skf_vd L[3], c[3], s[3], twice, half_area, far, limit, strength;
#ifdef SKF_VEC_FLOAT
  skf_vd longest, width; /* the longest edge's number, the height over it */
#endif
} triangle_row;

static double *triangle_pack(const skf_prepared *e, double *k) {
  const skf_triangle_plan *T = &e->plan.triangle;
  for (int i = 0; i < 3; i++) k = pack3(k, T->v[i]);
  for (int i = 0; i < 3; i++) k = pack3(k, T->m[i]);
  k = pack3(pack3(k, v3_sub(T->v[1], T->v[0])), v3_sub(T->v[2], T->v[1]));
  k = pack3(pack3(pack3(k, T->n), T->t[T->longest]), T->m[T->longest]);
  for (int i = 0; i < 3; i++) k = pack1(k, T->L[i]);
  for (int i = 0; i < 3; i++) k = pack1(k, T->c[i]);
  for (int i = 0; i < 3; i++) k = pack1(k, T->s[i]);
  k = pack1(pack1(pack1(k, T->twice), 0.5 * T->area), FAR_DIAMETERS * T->diam);
  k = pack1(pack1(k, SKF_COUNT(128, 192) * T->area / (T->L[0] + T->L[1] + T->L[2])), e->strength);
#ifdef SKF_VEC_FLOAT
  k = pack1(pack1(k, T->longest), T->twice / T->L[T->longest]);
#endif
  return k;
}

SKF_INLINE skf_vvalue far_triangle(const triangle_row *T, skf_v3d to_first) {
  const skf_gauss_node *node = skf_gauss_rule(FAR_NODES);
  skf_vvalue v = {.good = vi_set(-1)};
  for (int i = 0; i < FAR_NODES; i++)
    for (int j = 0; j < FAR_NODES; j++) {
      double xi = 0.5 * (1 + node[i].x), eta = 0.5 * xi * (1 + node[j].x);
      skf_v3d X = vd3_mad(vd3_mad(to_first, vd_set(xi), T->side), vd_set(eta), T->base);
      skf_vd per_r = vd_set(1) / vd_sqrt(vd3_dot(X, X)), h = vd_set(node[i].w * xi * node[j].w) * T->half_area * per_r;
      v.F += h;
      v.g = vd3_mad(v.g, h * (per_r * per_r), X);
    }
  return v;
}

#ifdef SKF_VEC_FLOAT
/* int t / r dt along a segment from p to q, of a direction u and a length, t from p; its gradient added to g */
SKF_INLINE skf_vd rising_segment(skf_v3d p, skf_v3d q, skf_v3d u, skf_vd length, skf_vd by, skf_v3d *g) {
  const skf_vd r1 = vd_sqrt(vd3_dot(p, p)), r2 = vd_sqrt(vd3_dot(q, q)), rr = r1 * r2, dot = vd3_dot(p, q),
               sum = r1 + r2;
  const skf_v3d n = vd3_cross(p, q);
  const skf_vd near = vd_select(dot < vd_set(0), vd3_dot(n, n) / (rr - dot), rr + dot), far = sum + length;
  const skf_vd J = vd_log_ratio(far * far, near + near, (length + length) * far), t0 = -vd3_dot(p, u);
  const skf_vd rise = length * vd3_dot(u, vd3_add(p, q)) / sum; /* r2 - r1 */
  const skf_vd per = by / rr, across = per * vd_fma(t0, length * sum / near, rise);
  const skf_vd along = vd_fnma(length, per * r1, by * J);
  *g = vd3_mad(vd3_mad(*g, across, p), vd_fma(across, t0, along), u);
  return vd_fma(t0, J, rise);
}

/* Slivers, whose edges' sums cancel all around: lines from the longest edge's ends to the height over it, of linear
   weight, by a Gauss rule across. Twice the width from that edge 4 nodes are exact to 1e-6. */
SKF_INLINE skf_vvalue sliver_triangle(const triangle_row *T, const skf_v3d a[3]) {
  enum { NODES = 4 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  const skf_vd zero = vd_set(0), one = vd_set(1), two = vd_set(2), half = vd_set(0.5);
  const skf_vi second = T->longest == one, third = T->longest == two;
#define PICKED(of, i) vd3_select(third, (of)[((i) + 2) % 3], vd3_select(second, (of)[((i) + 1) % 3], (of)[i]))
  const skf_v3d from = PICKED(a, 0), to = PICKED(a, 1), top = PICKED(T->v, 2);
  const skf_v3d left = vd3_sub(top, PICKED(T->v, 0)), right = vd3_sub(top, PICKED(T->v, 1));
#undef PICKED
  const skf_vd L1 = vd3_dot(left, T->t), L2 = -vd3_dot(right, T->t), l1 = vd3_dot(from, T->t);
  const skf_vd past = vd_max(vd_max(l1, -vd3_dot(to, T->t)), zero), out = T->width + T->width;
  const skf_v3d off = vd3_less(from, l1, T->t), up1 = vd3_less(left, L1, T->t), up2 = vd3_mad(right, L2, T->t);
  /* nor where powers of the distance underflow */
  const skf_vd least = vd_max(vd_max(out, vd_set(1e-4) * (L1 + L2)), vd_set(1e-7));
  const skf_vi good = vd_fma(past, past, vd3_dot(off, off)) > least * least;
  skf_vvalue v = {zero, {zero, zero, zero}, good};
  if (!vi_any(good)) return v;
  for (int i = 0; i < NODES; i++) {
    const skf_vd s = vd_set(0.5 * (1 + node[i].x)), weight = vd_set(node[i].w) * half * T->width, rise = s * T->width;
    const skf_v3d side1 = vd3_mad(vd3_scale(s, up1), L1, T->t), side2 = vd3_less(vd3_scale(s, up2), L2, T->t);
    const skf_vd w2 = rise * rise, square1 = vd_fma(L1, L1, w2), square2 = vd_fma(L2, L2, w2);
    const skf_vd length1 = vd_sqrt(square1), length2 = vd_sqrt(square2);
    const skf_v3d u1 = vd3_scale(one / length1, side1);
    const skf_v3d u2 = vd3_scale(one / length2, side2);
    const skf_vd by1 = weight * L1 / square1, by2 = weight * L2 / square2;
    v.F = vd_fma(by1, rising_segment(from, vd3_add(from, side1), u1, length1, by1, &v.g), v.F);
    v.F = vd_fma(by2, rising_segment(to, vd3_add(to, side2), u2, length2, by2, &v.g), v.F);
  }
  return v;
}
#endif

/* As triangle_inverse.c; the solid angle from its tangent [van Oosterom and Strackee 1983]. Next to an edge r0 r1 + d0
   d1 = |d0 x d1|^2 / (r0 r1 - d0 d1). Where an edge is so near that the rounded d count or this tangent cancels, and
   where the sums do, the closed form decides. */
SKF_INLINE skf_vvalue near_triangle(const triangle_row *T, const skf_v3d a[3], const skf_vd r[3]) {
  skf_vd two = vd_set(2), zero = vd_set(0), F = zero, gt = F, gm = F, abs_F = F, abs_g = F, den = r[0] * r[1] * r[2],
         cube = den;
  skf_vi good = vd_sane(den);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    skf_v3d n = vd3_cross(a[i], a[j]);
    skf_vd dot = vd3_dot(a[i], a[j]), rr = r[i] * r[j], L = T->L[i], far = r[i] + r[j] + L;
    skf_vd near = vd_select(dot < zero, vd3_dot(n, n) / (rr - dot), rr + dot);
    skf_vd J = vd_log_ratio(far * far, two * near, two * L * far), part = vd3_dot(a[i], T->m[i]) * J;
    good &= vd_set(SKF_PICK(0x1p14, 0x1p20)) * near > rr;
    den = vd_fma(dot, r[(i + 2) % 3], den);
    F += part;
    abs_F += vd_abs(part);
    gt = vd_fma(T->s[i], J, gt);
    gm = vd_fnma(T->c[i], J, gm);
    abs_g += J;
  }
  skf_vi first = r[0] < vd_min(r[1], r[2]);
  skf_v3d nearest = vd3_select(first, a[0], vd3_select(r[1] < r[2], a[1], a[2]));
  skf_vd z = -vd3_dot(nearest, T->n), az = vd_abs(z), num = az * T->twice;
  skf_vd solid = two * vd_atan2(num, den), Z = vd_select(z > zero, -solid, vd_select(z < zero, solid, zero));
  F = vd_fnma(az, solid, F);
  abs_F = vd_fma(az, solid, abs_F);
  skf_vd size = vd_max(vd_max(vd_abs(gt), vd_abs(gm)), solid);
  good &= (vd_set(256) * vd_max(num, vd_abs(den)) > cube) & (abs_F < vd_set(64) * F);
  good &= (den > zero) | (vd_set(0x1p40) * az > r[0]); /* on the face the sign of z decides */
  good &= abs_g + solid < vd_set(128) * size;
#ifdef SKF_VEC_FLOAT /* the edges' lines are known to an ulp of their distance */
  good &= abs_g * vd_max(r[0], vd_max(r[1], r[2])) < vd_set(256) * F;
#endif
  skf_v3d g = vd3_mad(vd3_scale(gt, T->t), gm, T->n1);
  return (skf_vvalue){F, vd3_mad(g, Z, T->n), good};
}

/* The same without the care: not near an edge, and not where the edges' sums lose more than 128 (in floats 192),
   which the distances tell: far away, or anywhere for slivers. */
typedef struct inverse_triangle_state {
#ifndef SKF_VEC_FLOAT
  skf_vd dot[3];
#endif
  skf_vd r[3], d[3], z;                   /* r: squares at first */
  skf_vd count[3], t[3], offset, tangent; /* set in the middle; then the logarithms, the angle */
  skf_vi good;
} inverse_triangle_state;

SKF_INLINE void inverse_triangle_begin(const triangle_row *T, skf_v3d x, inverse_triangle_state *s) {
  skf_v3d a[3];
  for (int i = 0; i < 3; i++) a[i] = vd3_sub(T->v[i], x), s->r[i] = vd3_dot(a[i], a[i]);
  for (int i = 0; i < 3; i++) s->d[i] = vd3_dot(a[i], T->m[i]);
#ifndef SKF_VEC_FLOAT
  for (int i = 0; i < 3; i++) s->dot[i] = vd3_dot(a[i], a[(i + 1) % 3]);
#endif
  s->z = vd3_dot(a[0], T->n);
}

SKF_INLINE void inverse_triangle_roots(const triangle_row *T, inverse_triangle_state *s) {
  (void)T;
  for (int i = 0; i < 3; i++) s->r[i] = vd_sqrt(s->r[i]);
}

#ifdef SKF_VEC_FLOAT
/* In floats r0 r1 + d0 d1 = ((r0 + r1)^2 - L^2) / 2 is good enough; the conditions are numbers that must be positive.
 */
SKF_INLINE void inverse_triangle_middle(const triangle_row *T, inverse_triangle_state *s) {
  const skf_vd *r = s->r, az = vd_abs(s->z), num = az * (T->twice + T->twice);
  skf_vd sum[3], edge = vd_set(81 * VD_LOG_UNIT * VD_LOG_UNIT), cube = r[0] * r[1] * r[2], den = vd_set(-4) * cube;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    sum[i] = r[i] + r[j];
    skf_vd far = sum[i] + T->L[i], near = sum[i] - T->L[i];
    skf_vlog l = vd_log_parts(far, near, T->L[i] + T->L[i]);
    s->count[i] = l.count, s->t[i] = l.top / l.bottom;
    edge = vd_fnma(l.count, l.count, edge); /* where `near` is negative these are large, too */
    den = vd_fma(far * near, r[k], den);
  }
  skf_vangle a = vd_angle_parts(num, den);
  s->offset = a.offset, s->tangent = a.top / a.bottom;
  /* as for doubles */
  skf_vd corner = vd_fnma(vd_set(0x1p-4) * T->twice, r[0], vd_max(num, vd_abs(den)));
  skf_vd face = vd_max(den, vd_fms(vd_set(0x1p20), az, r[0])), nearer = (T->limit - T->L[0]) - (sum[0] + r[2]);
  s->good = vd_min(vd_min(vd_min(corner, face), vd_min(edge, nearer)), cube - vd_set(1e-18)) > vd_set(0);
}
#else
SKF_INLINE void inverse_triangle_middle(const triangle_row *T, inverse_triangle_state *s) {
  const skf_vd *r = s->r, *dot = s->dot;
  skf_vd rr[3], far[3], num = vd_abs(s->z) * T->twice;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    rr[i] = r[i] * r[j];
    skf_vd near = rr[i] + dot[i], twice = T->L[i] + T->L[i];
    far[i] = (r[i] + r[j]) + T->L[i];
    skf_vlog l = vd_log_parts(far[i] * far[i], near + near, twice * far[i]);
    s->count[i] = l.count, s->t[i] = l.top / l.bottom;
  }
  skf_vd cube = rr[0] * r[2], den = vd_fma(dot[0], r[2], vd_fma(dot[1], r[0], vd_fma(dot[2], r[1], cube)));
  skf_vangle a = vd_angle_parts(num, den);
  s->offset = a.offset, s->tangent = a.top / a.bottom;
  /* next to a corner z must be taken from there */
  s->good = vd_max(num, vd_abs(den)) > vd_set(0x1p-10) * (r[0] * T->twice);
  s->good &= (far[0] + r[2] < T->limit) & ((den > vd_set(0)) | (vd_set(0x1p20) * vd_abs(s->z) > r[0]));
  /* The logarithm's powers of two are few: r0 r1 + d0 d1 > r0 r1 / 100. */
  s->good &= vd_max(s->count[0], vd_max(s->count[1], s->count[2])) < vd_set(10);
  s->good &= cube > vd_set(1e-140);
}
#endif

SKF_INLINE void inverse_triangle_series(const triangle_row *T, inverse_triangle_state *s) {
  (void)T;
  for (int i = 0; i < 3; i++) s->t[i] = vd_log_series(s->count[i], s->t[i]);
  skf_vd solid = (skf_vd)((skf_vi)vd_angle_series(s->offset, s->tangent) ^ vd_sign(s->z));
  s->tangent = solid + solid;
}

SKF_INLINE skf_vvalue inverse_triangle_end(const triangle_row *T, const inverse_triangle_state *s) {
  skf_vd Z = s->tangent, F = vd_fma(s->d[0], s->t[0], vd_fma(s->d[1], s->t[1], vd_fms(s->d[2], s->t[2], s->z * Z)));
  skf_v3d g = vd3_scale(Z, vd3_scale(T->strength, T->n));
  for (int i = 0; i < 3; i++) g = vd3_less(g, s->t[i], vd3_scale(T->strength, T->m[i]));
  return (skf_vvalue){T->strength * F, g, s->good};
}

SKF_INLINE skf_vvalue inverse_triangle_any(const triangle_row *T, skf_v3d x) {
  skf_v3d a[3];
  skf_vd r[3];
  for (int i = 0; i < 3; i++) a[i] = vd3_sub(T->v[i], x), r[i] = vd_sqrt(vd3_dot(a[i], a[i]));
  skf_vi far = vd_min(r[0], vd_min(r[1], r[2])) > T->far;
  skf_vvalue v = {.good = vi_set(0)};
  if (vi_any(far)) v = far_triangle(T, a[0]), v.good = far & vd_sane(r[0]);
  if (!vi_all(far)) {
    const skf_vvalue u = near_triangle(T, a, r);
    v = (skf_vvalue){vd_select(far, v.F, u.F), vd3_select(far, v.g, u.g), v.good | (~far & u.good)};
  }
#ifdef SKF_VEC_FLOAT
  if (!vi_all(v.good | far)) {
    const skf_vvalue u = sliver_triangle(T, a);
    const skf_vi some = ~(v.good | far) & u.good & vd_sane(r[0]) & vd_sane(r[1]) & vd_sane(r[2]);
    v = (skf_vvalue){vd_select(some, u.F, v.F), vd3_select(some, u.g, v.g), v.good | some};
  }
#endif
  return vv_scale(T->strength, v);
}

SKF_BATCH_LACED(inverse_triangle, triangle, inverse_triangle_any, inverse_triangle_roots, inverse_triangle_middle,
                inverse_triangle_series)

#endif
