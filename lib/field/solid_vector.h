/* SPDX-License-Identifier: MIT */
/* Solids in vectors: at many points, each a lane, and at one point, with edges and faces as lanes. The formulas are
   those of solid.c. */
#ifndef SKF_FIELD_SOLID_VECTOR_H
#define SKF_FIELD_SOLID_VECTOR_H

#include "field/batch_loop.h"
#include "field/solid.h"

/* A block's vertices seen from the points, or from the point. */
enum { SOLID_VERTICES = 3 * SKF_SOLID_BLOCK + SKF_SOLID_PAD };

/* What edges and faces add up to: twice F, the gradient, xx, xy, xz, yy, yz, and the solid angle */
typedef struct solid_sum {
  skf_vd v[SKF_SOLID_OUT];
} solid_sum;

typedef struct solid_edge {
  skf_vd length, xx, xy, xz, yy, yz;
} solid_edge;

typedef struct solid_face {
  skf_v3d n;
  skf_vd twice;
} solid_face;

SKF_INLINE skf_v3d solid_set(skf_vec3 a) { return (skf_v3d){vd_set(a.x), vd_set(a.y), vd_set(a.z)}; }

SKF_INLINE skf_vd solid_log(skf_vd ra, skf_vd rb, skf_vd length, skf_vi *near) {
  skf_vd sum = ra + rb, excess = sum - length;
  *near = ~(excess > vd_set(SKF_SOLID_NEAR) * sum);
  return vd_log_ratio(sum + length, excess, length + length);
}

SKF_INLINE void solid_add_edge(const solid_edge *e, skf_v3d d, skf_vd lambda, bool hessian, solid_sum *s) {
  skf_vd zz = e->xx + e->yy;
  skf_v3d y = {vd_fma(e->xz, d.z, vd_fma(e->xy, d.y, e->xx * d.x)), vd_fma(e->yz, d.z, vd_fma(e->yy, d.y, e->xy * d.x)),
               vd_fnma(zz, d.z, vd_fma(e->yz, d.y, e->xz * d.x))};
  y = vd3_scale(lambda, y);
  s->v[0] = vd_fma(y.z, d.z, vd_fma(y.y, d.y, vd_fma(y.x, d.x, s->v[0])));
  s->v[1] -= y.x, s->v[2] -= y.y, s->v[3] -= y.z;
  if (!hessian) return;
  s->v[4] = vd_fma(lambda, e->xx, s->v[4]), s->v[5] = vd_fma(lambda, e->xy, s->v[5]);
  s->v[6] = vd_fma(lambda, e->xz, s->v[6]), s->v[7] = vd_fma(lambda, e->yy, s->v[7]);
  s->v[8] = vd_fma(lambda, e->yz, s->v[8]);
}

/* z: n'r. near, where it is asked for: the lanes that need skf_solid_face_angle. */
SKF_INLINE skf_vd solid_angle(const solid_face *f, const skf_v3d d[3], const skf_vd r[3], skf_vd z, skf_vi *near) {
  skf_vd rr = r[0] * r[1], cube = rr * r[2], num = z * f->twice;
  skf_vd den =
      vd_fma(vd3_dot(d[0], d[1]), r[2], vd_fma(vd3_dot(d[1], d[2]), r[0], vd_fma(vd3_dot(d[2], d[0]), r[1], cube)));
  skf_vd half = vd_atan2(num, den), omega = half + half;
  if (near) {
    skf_vd least = vd_min(r[0], vd_min(r[1], r[2])), squares = vd_fma(r[0], r[0], vd_fma(r[1], r[1], r[2] * r[2]));
    skf_vi clear = (vd_fma(num, num, den * den) > vd_set(SKF_SOLID_FACE_NEAR) * (cube * cube)) &
                   (least * least > vd_set(SKF_SOLID_CORNER_NEAR) * squares);
    *near = ~clear;
    omega = vd_select(num == vd_set(0), vd_set(0), omega);
  }
  return omega;
}

SKF_INLINE void solid_add_face(const solid_face *f, skf_vd z, skf_vd omega, bool hessian, solid_sum *s) {
  skf_v3d on = vd3_scale(omega, f->n);
  s->v[0] = vd_fnma(omega * z, z, s->v[0]);
  s->v[1] = vd_fma(z, on.x, s->v[1]), s->v[2] = vd_fma(z, on.y, s->v[2]), s->v[3] = vd_fma(z, on.z, s->v[3]);
  if (!hessian) return;
  s->v[4] = vd_fnma(on.x, f->n.x, s->v[4]), s->v[5] = vd_fnma(on.x, f->n.y, s->v[5]);
  s->v[6] = vd_fnma(on.x, f->n.z, s->v[6]), s->v[7] = vd_fnma(on.y, f->n.y, s->v[7]);
  s->v[8] = vd_fnma(on.y, f->n.z, s->v[8]), s->v[9] += omega;
}

/* ---- points as lanes */

typedef struct solid_view {
  skf_v3d d[SOLID_VERTICES];
  skf_vd r[SOLID_VERTICES];
} solid_view;

static skf_vec3 lane_of(skf_v3d x, int i) { return v3(x.x[i], x.y[i], x.z[i]); }

static __attribute__((noinline)) skf_vd solid_mend_edge(const skf_solid_block *b, size_t i, skf_v3d x, int lanes,
                                                        skf_vd lambda) {
  skf_vec3 p = skf_solid_block_vertex(b, b->ends[i]), q = skf_solid_block_vertex(b, b->ends[b->edge_room + i]);
  for (int k = 0; k < SKF_LANES; k++)
    if (lanes >> k & 1) lambda[k] = skf_solid_edge_log(p, q, lane_of(x, k));
  return lambda;
}

static __attribute__((noinline)) skf_vd solid_mend_face(const skf_solid_block *b, size_t i, skf_v3d x, int lanes,
                                                        skf_vd omega) {
  skf_vec3 v[3];
  for (size_t k = 0; k < 3; k++) v[k] = skf_solid_block_vertex(b, b->corners[k * b->face_room + i]);
  for (int k = 0; k < SKF_LANES; k++)
    if (lanes >> k & 1) omega[k] = skf_solid_face_angle(v[0], v[1], v[2], lane_of(x, k));
  return omega;
}

SKF_INLINE void solid_block(const skf_solid_block *b, skf_v3d x, solid_view *w, bool guarded, bool hessian,
                            solid_sum *sum) {
  const double *vx = b->vertex, *vy = vx + b->vertex_room, *vz = vy + b->vertex_room, *E = b->edge, *f = b->face;
  const unsigned short *ends = b->ends, *corners = b->corners;
  size_t er = b->edge_room, fr = b->face_room;
  solid_sum s = {{vd_set(0)}};
  for (size_t i = 0; i < b->vertices; i++) {
    w->d[i] = (skf_v3d){vd_set(vx[i]) - x.x, vd_set(vy[i]) - x.y, vd_set(vz[i]) - x.z};
    w->r[i] = vd_sqrt(vd3_dot(w->d[i], w->d[i]));
  }
  for (size_t i = 0; i < b->edges; i++) {
    const solid_edge e = {vd_set(E[i]),
                          vd_set(E[SKF_EDGE_XX * er + i]),
                          vd_set(E[SKF_EDGE_XY * er + i]),
                          vd_set(E[SKF_EDGE_XZ * er + i]),
                          vd_set(E[SKF_EDGE_YY * er + i]),
                          vd_set(E[SKF_EDGE_YZ * er + i])};
    skf_vi near;
    skf_vd lambda = solid_log(w->r[ends[i]], w->r[ends[er + i]], e.length, &near);
    if (guarded && vi_any(near)) lambda = solid_mend_edge(b, i, x, vi_bits(near), lambda);
    solid_add_edge(&e, w->d[ends[i]], lambda, hessian, &s);
  }
  for (size_t i = 0; i < b->faces; i++) {
    const solid_face g = {{vd_set(f[i]), vd_set(f[SKF_FACE_NY * fr + i]), vd_set(f[SKF_FACE_NZ * fr + i])},
                          vd_set(f[SKF_FACE_TWICE * fr + i])};
    size_t p = corners[i], q = corners[fr + i], t = corners[2 * fr + i];
    const skf_v3d d[3] = {w->d[p], w->d[q], w->d[t]};
    const skf_vd r[3] = {w->r[p], w->r[q], w->r[t]};
    skf_vi near;
    skf_vd z = vd3_dot(g.n, d[0]), omega = solid_angle(&g, d, r, z, guarded ? &near : NULL);
    if (guarded && vi_any(near)) omega = solid_mend_face(b, i, x, vi_bits(near), omega);
    solid_add_face(&g, z, omega, hessian, &s);
  }
  *sum = s;
}

static __attribute__((noinline)) void solid_clear(const skf_solid_block *b, skf_v3d x, solid_view *w, solid_sum *s) {
  solid_block(b, x, w, false, false, s);
}
static __attribute__((noinline)) void solid_clear_hessian(const skf_solid_block *b, skf_v3d x, solid_view *w,
                                                          solid_sum *s) {
  solid_block(b, x, w, false, true, s);
}
static __attribute__((noinline)) void solid_guarded(const skf_solid_block *b, skf_v3d x, solid_view *w, solid_sum *s) {
  solid_block(b, x, w, true, true, s);
}

/* Whether a lane is so near to the block that its edges and faces need care. */
SKF_INLINE bool solid_is_near(const skf_solid_block *b, skf_v3d x) {
  skf_vd zero = vd_set(0), limit = vd_set(SKF_SOLID_CLEAR * b->longest);
  skf_v3d out = {vd_max(zero, vd_max(vd_set(b->box.lo.x) - x.x, x.x - vd_set(b->box.hi.x))),
                 vd_max(zero, vd_max(vd_set(b->box.lo.y) - x.y, x.y - vd_set(b->box.hi.y))),
                 vd_max(zero, vd_max(vd_set(b->box.lo.z) - x.z, x.z - vd_set(b->box.hi.z)))};
  return vi_any(vd3_dot(out, out) <= limit * limit);
}

/* The expansion; lanes nearer than `far` get anything. */
static void solid_far(const skf_solid *s, skf_v3d x, solid_sum *sum) {
  skf_v3d d = vd3_sub(x, solid_set(s->info.center));
  skf_vd r = vd_sqrt(vd3_dot(d, d)), per = vd_set(1 / s->radius), limit = vd_set(s->degree), zero = vd_set(0);
  d = vd3_scale(per, d);
  skf_vd inv = vd_set(1) / vd3_dot(d, d), re = vd_sqrt(inv), im = zero;
  int degree = 0;
  const double *row = s->moments;
  for (int k = 1; k < SKF_SOLID_BANDS; k++) limit = vd_select(r >= vd_set(s->band[k]), vd_set(s->degrees[k]), limit);
  for (int i = 0; i < SKF_LANES; i++) degree = limit[i] > degree ? (int)limit[i] : degree;
  for (int k = 0; k < SKF_SOLID_OUT; k++) sum->v[k] = zero;
  for (int m = 0; m <= degree; m++) {
    skf_vd now = vd_select(vd_set(m) <= limit, vd_set(1), zero), last = zero, a[SKF_SOLID_FAR_COLUMNS];
    for (int k = 0; k < SKF_SOLID_FAR_COLUMNS; k++) a[k] = zero;
    for (int n = m; n <= degree; n++) {
      const double *c = row + (n - m) * SKF_SOLID_FAR_COLUMNS;
      for (int k = 0; k < SKF_SOLID_FAR_COLUMNS; k++) a[k] = vd_fma(vd_set(c[k]), now, a[k]);
      skf_vi on = vd_set(n + 1) <= limit;
      skf_vd next = inv * vd_fms(vd_set(2 * n + 1) * d.z, now, vd_set(n * n - m * m) * last);
      last = vd_select(on, now, zero), now = vd_select(on, next, zero);
    }
    for (int k = 0; k < 9; k++) sum->v[k] = vd_fma(a[2 * k], re, vd_fma(a[2 * k + 1], im, sum->v[k]));
    skf_vd u = vd_set(2 * m + 1) * inv, v = u * vd_fms(d.x, re, d.y * im);
    im = u * vd_fma(d.x, im, d.y * re), re = v;
    row += (s->degree - m + 1) * SKF_SOLID_FAR_COLUMNS;
  }
  skf_vd R = vd_set(s->radius);
  sum->v[0] *= R * R, sum->v[1] *= R, sum->v[2] *= R, sum->v[3] *= R;
  sum->v[9] = -(sum->v[4] + sum->v[7]);
}

/* Sums with their rounding errors apart [Knuth; Neumaier 1974]. */
typedef struct solid_totals {
  double s[SKF_SOLID_OUT][SKF_SOLID_POINTS], low[SKF_SOLID_OUT][SKF_SOLID_POINTS];
} solid_totals;

SKF_INLINE void solid_total(solid_totals *t, size_t i, const solid_sum *part, int columns) {
  for (int k = 0; k < columns; k++) {
    skf_vd a = vd_load(t->s[k] + i), b = part->v[k], s = a + b, u = s - a;
    vd_store(t->s[k] + i, s);
    vd_store(t->low[k] + i, vd_load(t->low[k] + i) + ((a - (s - u)) + (b - u)));
  }
}

static void solid_points(const skf_solid *s, size_t n, const double *const given[3], bool hessian,
                         double out[SKF_SOLID_OUT][SKF_SOLID_POINTS]) {
  double p[3][SKF_SOLID_POINTS];
  unsigned char near[SKF_SOLID_POINTS / SKF_LANES], far[SKF_SOLID_POINTS / SKF_LANES];
  size_t groups = (n + SKF_LANES - 1) / SKF_LANES, nears = 0;
  int columns = hessian ? SKF_SOLID_OUT : 4;
  solid_totals t;
  solid_view w;
  solid_sum part;
  for (size_t k = 0; k < 3; k++) /* the last point again as padding */
    for (size_t i = 0; i < groups * SKF_LANES; i++) p[k][i] = given[k][i < n ? i : n - 1];
  for (size_t j = 0; j < groups; j++) {
    size_t i = j * SKF_LANES;
    skf_v3d d = vd3_sub((skf_v3d){vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)}, solid_set(s->info.center));
    skf_vi beyond = vd_sqrt(vd3_dot(d, d)) >= vd_set(s->far);
    far[j] = vi_any(beyond);
    if (!vi_all(beyond)) near[nears++] = (unsigned char)j;
    for (int k = 0; k < columns; k++) vd_store(t.s[k] + i, vd_set(0)), vd_store(t.low[k] + i, vd_set(0));
  }
  for (size_t m = 0; m < s->block_count && nears; m++) {
    const skf_solid_block *b = s->blocks + m;
    for (size_t j = 0; j < nears; j++) {
      size_t i = (size_t)near[j] * SKF_LANES;
      skf_v3d x = {vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)};
      if (solid_is_near(b, x))
        solid_guarded(b, x, &w, &part);
      else if (hessian)
        solid_clear_hessian(b, x, &w, &part);
      else
        solid_clear(b, x, &w, &part);
      solid_total(&t, i, &part, columns);
    }
  }
  for (size_t j = 0; j < groups; j++) {
    size_t i = j * SKF_LANES;
    skf_v3d x = {vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)}, d = vd3_sub(x, solid_set(s->info.center));
    skf_vi beyond = vd_sqrt(vd3_dot(d, d)) >= vd_set(s->far);
    for (int k = 0; k < columns; k++) part.v[k] = vd_load(t.s[k] + i) + vd_load(t.low[k] + i);
    part.v[0] *= vd_set(0.5);
    if (hessian) part.v[9] = -(part.v[4] + part.v[7] + part.v[9]);
    if (far[j]) {
      solid_sum other;
      solid_far(s, x, &other);
      for (int k = 0; k < columns; k++) part.v[k] = vd_select(beyond, other.v[k], part.v[k]);
    }
    for (int k = 0; k < columns; k++) vd_store(out[k] + i, part.v[k]);
  }
}

/* ---- one point, edges and faces as lanes */

typedef struct solid_look {
  double d[3][SOLID_VERTICES], r[SOLID_VERTICES];
} solid_look;

SKF_INLINE skf_vd solid_gather(const double *from, const unsigned short *at) {
  skf_vd v;
  for (int k = 0; k < SKF_LANES; k++) v[k] = from[at[k]];
  return v;
}
SKF_INLINE skf_v3d solid_gather3(const solid_look *w, const unsigned short *at) {
  return (skf_v3d){solid_gather(w->d[0], at), solid_gather(w->d[1], at), solid_gather(w->d[2], at)};
}

static void solid_one_block(const skf_solid_block *b, skf_vec3 x, solid_look *w, bool guarded,
                            double out[SKF_SOLID_OUT]) {
  size_t er = b->edge_room, fr = b->face_room;
  solid_sum s = {{vd_set(0)}};
  for (size_t i = 0; i < b->vertices; i += SKF_LANES) {
    skf_v3d d = {vd_load(b->vertex + i) - vd_set(x.x), vd_load(b->vertex + b->vertex_room + i) - vd_set(x.y),
                 vd_load(b->vertex + 2 * b->vertex_room + i) - vd_set(x.z)};
    vd_store(w->d[0] + i, d.x), vd_store(w->d[1] + i, d.y), vd_store(w->d[2] + i, d.z);
    vd_store(w->r + i, vd_sqrt(vd3_dot(d, d)));
  }
  for (size_t i = 0; i < b->edges; i += SKF_LANES) {
    const double *E = b->edge + i;
    const solid_edge e = {vd_load(E),
                          vd_load(E + SKF_EDGE_XX * er),
                          vd_load(E + SKF_EDGE_XY * er),
                          vd_load(E + SKF_EDGE_XZ * er),
                          vd_load(E + SKF_EDGE_YY * er),
                          vd_load(E + SKF_EDGE_YZ * er)};
    skf_vi near;
    skf_vd lambda = solid_log(solid_gather(w->r, b->ends + i), solid_gather(w->r, b->ends + er + i), e.length, &near);
    for (int k = 0, lanes = guarded ? vi_bits(near) : 0; lanes >> k; k++)
      if (lanes >> k & 1)
        lambda[k] = skf_solid_edge_log(skf_solid_block_vertex(b, b->ends[i + (size_t)k]),
                                       skf_solid_block_vertex(b, b->ends[er + i + (size_t)k]), x);
    solid_add_edge(&e, solid_gather3(w, b->ends + i), lambda, true, &s);
  }
  for (size_t i = 0; i < b->faces; i += SKF_LANES) {
    const double *f = b->face + i;
    const unsigned short *c = b->corners + i;
    const solid_face g = {{vd_load(f), vd_load(f + SKF_FACE_NY * fr), vd_load(f + SKF_FACE_NZ * fr)},
                          vd_load(f + SKF_FACE_TWICE * fr)};
    const skf_v3d d[3] = {solid_gather3(w, c), solid_gather3(w, c + fr), solid_gather3(w, c + 2 * fr)};
    const skf_vd r[3] = {solid_gather(w->r, c), solid_gather(w->r, c + fr), solid_gather(w->r, c + 2 * fr)};
    skf_vi near;
    skf_vd z = vd3_dot(g.n, d[0]), omega = solid_angle(&g, d, r, z, guarded ? &near : NULL);
    for (int k = 0, lanes = guarded ? vi_bits(near) : 0; lanes >> k; k++)
      if (lanes >> k & 1)
        omega[k] = i + (size_t)k < b->faces ? skf_solid_face_angle(skf_solid_block_vertex(b, c[k]),
                                                                   skf_solid_block_vertex(b, c[fr + (size_t)k]),
                                                                   skf_solid_block_vertex(b, c[2 * fr + (size_t)k]), x)
                                            : 0;
    solid_add_face(&g, z, omega, true, &s);
  }
  for (int k = 0; k < SKF_SOLID_OUT; k++) {
    out[k] = s.v[k][0];
    for (int i = 1; i < SKF_LANES; i++) out[k] += s.v[k][i];
  }
}

static void solid_point(const skf_solid *s, skf_vec3 x, bool hessian, double out[SKF_SOLID_OUT]) {
  double low[SKF_SOLID_OUT] = {0};
  skf_v3d at = solid_set(x);
  (void)hessian;
  if (v3_dist(x, s->info.center) >= s->far) {
    skf_solid_scalar.point(s, x, hessian, out);
    return;
  }
  solid_look w;
  for (int k = 0; k < SKF_SOLID_OUT; k++) out[k] = 0;
  for (size_t m = 0; m < s->block_count; m++) {
    double part[SKF_SOLID_OUT];
    solid_one_block(s->blocks + m, x, &w, solid_is_near(s->blocks + m, at), part);
    for (int k = 0; k < SKF_SOLID_OUT; k++) {
      double a = out[k], b = part[k], sum = a + b, u = sum - a;
      out[k] = sum, low[k] += (a - (sum - u)) + (b - u);
    }
  }
  for (int k = 0; k < SKF_SOLID_OUT; k++) out[k] += low[k];
  out[0] *= 0.5;
  out[9] = -(out[4] + out[7] + out[9]);
}

#endif
