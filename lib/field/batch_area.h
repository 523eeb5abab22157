/* SPDX-License-Identifier: MIT */
/* A triangle seen from several points at once, as triangle_parts.h in plain arithmetic: where this is not enough the
   closed form decides. */
#ifndef SKF_FIELD_BATCH_AREA_H
#define SKF_FIELD_BATCH_AREA_H

#include "field/batch_span.h"
#include "field/batch_triangle.h"
#include "simd/vecspecial.h"

/* A triangle, the directions of its edges, its longest edge; the kernel's parameter, its square, 1 / both. */
typedef struct area_row {
  triangle_row T;
  skf_v3d t[3], N, N_lo; /* N + N_lo: the normal, twice the area long */
  skf_vd per_N, diam, param, param2, per_param, per_param2;
} area_row;

static double *area_pack(const skf_prepared *e, double *k) {
  const skf_triangle_plan *T = &e->plan.triangle;
  k = triangle_pack(e, k);
  for (int i = 0; i < 3; i++) k = pack3(k, T->t[i]);
  k = pack3(pack3(k, dd3_round(T->N)), v3(T->N.x.lo, T->N.y.lo, T->N.z.lo));
  k = pack1(k, T->per_N);
  return pack_parameter(pack1(k, T->diam), e);
}

typedef struct area_view {
  skf_v3d a[3];        /* vertices less the point */
  skf_vd r2[3];        /* their squared lengths */
  skf_vd z, zz;        /* height, squared */
  skf_vd d[3];         /* distances of the edges' lines from the foot, > 0 inside */
  skf_vd l1[3], l2[3]; /* abscissae of their ends */
  skf_vd lat2, dist2;  /* squared distances from the foot and from the point */
  skf_vi inside;
} area_view;

/* Height over the plane from a = v - x, to a few ulps: a narrow kernel's slope needs it. */
SKF_INLINE skf_vd area_height(const area_row *c, skf_v3d x, skf_v3d v, skf_v3d a) {
  skf_v3d lo = vd3_lost(v, x, a), n = c->N;
  skf_vd px = a.x * n.x, py = a.y * n.y, pz = a.z * n.z, s = px + py, t = s + pz;
  skf_vd low = vd_lost(px, -py, s) + vd_lost(s, -pz, t) + (vd3_dot(lo, n) + vd3_dot(a, c->N_lo));
  low += vd_fms(a.x, n.x, px) + vd_fms(a.y, n.y, py) + vd_fms(a.z, n.z, pz);
  return -(t + low) * c->per_N;
}

SKF_INLINE area_view area_see(const area_row *c, skf_v3d x) {
  const triangle_row *T = &c->T;
  area_view f;
  for (int i = 0; i < 3; i++) f.a[i] = vd3_sub(T->v[i], x), f.r2[i] = vd3_dot(f.a[i], f.a[i]);
  skf_vd zero = vd_set(0);
  skf_vi first = f.r2[0] < f.r2[1], third = f.r2[2] < vd_min(f.r2[0], f.r2[1]);
  skf_v3d nearest = vd3_select(third, f.a[2], vd3_select(first, f.a[0], f.a[1]));
  f.z = area_height(c, x, vd3_select(third, T->v[2], vd3_select(first, T->v[0], T->v[1])), nearest);
  f.zz = f.z * f.z;
  f.inside = vi_set(-1);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    f.l1[i] = vd3_dot(f.a[i], c->t[i]), f.l2[i] = vd3_dot(f.a[j], c->t[i]);
    f.d[i] = vd3_dot(vd3_select(f.r2[i] < f.r2[j], f.a[i], f.a[j]), T->m[i]);
    f.inside &= f.d[i] >= zero;
    skf_vd beyond = vd_max(vd_max(f.l1[i], -f.l2[i]), zero), far = vd_fma(f.d[i], f.d[i], beyond * beyond);
    f.lat2 = i ? vd_min(f.lat2, far) : far;
  }
  f.lat2 = vd_select(f.inside, zero, f.lat2);
  f.dist2 = f.zz + f.lat2;
  return f;
}

/* What the edges give: terms of F, int h dl, terms of dF/dz, with the sums of their sizes. */
typedef struct area_sum {
  skf_vd F, abs_F, J[3], Z, abs_Z;
} area_sum;

/* grad F = -sum m_i J_i + n Z; not good where a sum cancels: F by 64, the gradient by 128, or by less where its terms
   have lost `loss` x 16 ulps, or because the edges' lines are known to an ulp of their distance only; nor where the
   lines' own errors count, next to an edge in a narrow kernel, unless as much as `moved` ulps of the size, by which the
   point may be off, change F. */
SKF_INLINE skf_vvalue area_gather_lossy(const area_row *c, const area_view *f, const area_sum *s, skf_vd loss,
                                        double moved, skf_vi good) {
  const triangle_row *T = &c->T;
  skf_vd gt = vd_set(0), gm = gt, abs_J = gt;
  for (int i = 0; i < 3; i++) {
    gt = vd_fma(T->s[i], s->J[i], gt);
    gm = vd_fnma(T->c[i], s->J[i], gm);
    abs_J += vd_abs(s->J[i]);
  }
  skf_vd abs_g = s->abs_Z + abs_J;
  skf_vd size = vd_max(vd_max(vd_abs(gt), vd_abs(gm)), vd_abs(s->Z)), S = vd_max(c->diam, vd_sqrt(f->dist2));
  loss = vd_max(loss, vd_set(1. / 16) * S / c->diam);
  const skf_vd F = vd_abs(s->F), slope = size * S;
  good &= loss * s->abs_F <= vd_fma(vd_set(0.25 * moved), slope, vd_set(64) * F);
  good &= abs_J * S <= vd_fma(vd_set(moved), slope, vd_set(512) * F);
  good &= loss * abs_g * S <= vd_set(128) * vd_max(slope, vd_set(1e-3) * s->F);
  return (skf_vvalue){s->F, vd3_mad(vd3_mad(vd3_scale(gt, T->t), gm, T->n1), s->Z, T->n), good};
}

SKF_INLINE skf_vvalue area_gather(const area_row *c, const area_view *f, const area_sum *s, skf_vi good) {
  return area_gather_lossy(c, f, s, vd_set(1), 0, good);
}

/* h and its slope h' / r at squared distance w */
typedef enum area_kind {
  AREA_CAUCHY,
  AREA_GAUSSIAN,
  AREA_SQUARED,
  AREA_QUARTIC,
  AREA_SOFT,
  AREA_CONE,
  AREA_CORE
} area_kind;
typedef struct area_node {
  skf_vd h, slope;
} area_node;

SKF_INLINE area_node area_at(area_kind kind, const area_row *c, skf_vd w) {
  skf_vd one = vd_set(1);
  if (kind == AREA_CAUCHY) {
    skf_vd q = one / vd_fma(c->param2, w, one), h = q * q;
    return (area_node){h, vd_set(-4) * c->param2 * (h * q)};
  }
  if (kind == AREA_GAUSSIAN) {
    skf_vd h = vd_exp(-vd_min(c->param2 * w, vd_set(VD_EXP_MAX)));
    return (area_node){h, vd_set(-2) * c->param2 * h};
  }
  if (kind == AREA_SQUARED) {
    skf_vd h = one / w;
    return (area_node){h, vd_set(-2) * (h * h)};
  }
  if (kind == AREA_CONE) { /* (1 - r / R)^2 */
    skf_vd r = vd_sqrt(w), m = vd_fnma(r, c->per_param, one);
    return (area_node){m * m, vd_set(-2) * c->per_param * m / r};
  }
  if (kind == AREA_CORE) /* of the metaball */
    return (area_node){vd_fnma(vd_set(3) * c->per_param2, w, one), vd_set(-6) * c->per_param2};
  skf_vd m = vd_fnma(w, c->per_param2, one), per = vd_set(-2) * c->per_param2 * m;
  if (kind == AREA_QUARTIC) return (area_node){m * m, per + per};
  return (area_node){m * m * vd_fma(vd_set(4. / 9), m, vd_set(5. / 9)),
                     per * vd_fma(vd_set(4. / 3), m, vd_set(10. / 9))};
}

/* n x n conical product rule */
SKF_INLINE skf_vvalue area_rule(area_kind kind, const area_row *c, const area_view *f, int n, skf_vi good) {
  const skf_gauss_node *node = skf_gauss_rule(n);
  skf_vd zero = vd_set(0);
  skf_vvalue v = {zero, {zero, zero, zero}, good};
  for (int i = 0; i < n; i++) {
    skf_vd xi = vd_set(0.5 * (1 + node[i].x)), wi = vd_set(node[i].w) * xi * c->T.half_area;
    skf_v3d start = vd3_mad(f->a[0], xi, c->T.side);
    for (int j = 0; j < n; j++) {
      skf_v3d X = vd3_mad(start, vd_set(0.5 * (1 + node[j].x)) * xi, c->T.base);
      area_node p = area_at(kind, c, vd3_dot(X, X));
      skf_vd w = wi * vd_set(node[j].w);
      v.F = vd_fma(w, p.h, v.F);
      v.g = vd3_mad(v.g, -(w * p.slope), X);
    }
  }
  return v;
}

SKF_INLINE skf_vvalue area_either(skf_vi m, skf_vvalue a, skf_vvalue b) {
  return (skf_vvalue){vd_select(m, a.F, b.F), vd3_select(m, a.g, b.g), (m & a.good) | (~m & b.good)};
}

#endif
