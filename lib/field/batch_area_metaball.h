/* SPDX-License-Identifier: MIT */
/* Vector forms: the metaball over a triangle, as triangle_cone.c: 3/2 k_R - 1/2 k_{R/3}, k_R = (1 - r / R)^2. */
#ifndef SKF_FIELD_BATCH_AREA_METABALL_H
#define SKF_FIELD_BATCH_AREA_METABALL_H

#include "field/batch_area_compact.h"

/* With u = r / R, w = |z| / R, a = 1 - u, b = 1 - w: G0 = R^2 b^3 (4 - 3 b) / 12 */
typedef struct cone_view {
  skf_vd R, R2, per_R, per_R2, power[3], rm2, rm, w, b, G0;
  skf_vi beyond, rim; /* the disc is seen from far beside itself; it is a small cap of the support */
} cone_view;

typedef struct cone_part {
  skf_vd F, W, J; /* W = dF/dz / z */
} cone_part;

SKF_INLINE cone_view cone_see(const area_row *c, const area_view *f, double scale) {
  skf_vd zero = vd_set(0), az = vd_abs(f->z), one = vd_set(1);
  cone_view v = {.R = vd_set(scale) * c->param, .per_R = vd_set(1 / scale) * c->per_param};
  v.R2 = v.R * v.R, v.per_R2 = v.per_R * v.per_R;
  for (int i = 0; i < 3; i++) v.power[i] = v.R2 - f->r2[i];
  v.rm2 = vd_max((v.R - az) * (v.R + az), zero), v.rm = vd_sqrt(v.rm2);
  v.w = az * v.per_R, v.b = vd_max(one - v.w, zero);
  v.G0 = v.R2 * vd_set(1. / 12) * v.b * v.b * v.b * vd_fnma(vd_set(3), v.b, vd_set(4));
  v.rim = vd_set(SKF_PICK(1.75, 2)) * az > v.R;
  v.beyond = ~f->inside & (vd_set(SKF_PICK(3, 4)) * f->lat2 > v.rm2);
  return v;
}

/* The edges' parts in the disc: antiderivatives, with int dl / r and the solid angle each as one function of the two
   ends. They would cancel where the disc is a small cap. Step by step for all edges, whose roots and quotients take
   long. */
typedef struct cone_edge {
  skf_vd b1, b2, len, cc, r1, r2, near, beside, moment; /* b2 r2 - b1 r1 */
  skf_vlog log;
  skf_vangle angle;
  skf_vd t_log, t_angle, sign;
} cone_edge;

SKF_INLINE void cone_closed(const cone_view *v, const area_view *f, const cut_view e[3], cone_part part[3],
                            skf_vi *good) {
  const skf_vd one = vd_set(1), zero = vd_set(0), third = vd_set(1. / 3), eight = vd_set(8), az = vd_abs(f->z);
  cone_edge s[3];
  SKF_EACH(i, 3) {
    s[i].b1 = vd_select(e[i].in, e[i].b1, -one), s[i].b2 = vd_select(e[i].in, e[i].b2, one);
    s[i].cc = vd_select(e[i].in, vd_fma(f->d[i], f->d[i], f->zz), one);
    s[i].r1 = vd_sqrt(vd_fma(s[i].b1, s[i].b1, s[i].cc)), s[i].r2 = vd_sqrt(vd_fma(s[i].b2, s[i].b2, s[i].cc));
  }
  SKF_EACH(i, 3) {
    skf_vd b1 = s[i].b1, b2 = s[i].b2, cc = s[i].cc, bb = b1 * b2;
    s[i].near = vd_fma(bb, bb, cc * vd_fma(b1, b1, b2 * b2)) / vd_fma(s[i].r1, s[i].r2, cc); /* r1 r2 - c^2 */
    s[i].beside = cc * vd_abs(b1 + b2) / vd_fma(vd_abs(b2), s[i].r1, vd_abs(b1) * s[i].r2);
    /* without cancellation, where the edge is seen from far beside it, too */
    skf_vd both = s[i].r1 + s[i].r2, mid = b1 + b2;
    s[i].moment = vd_set(0.5) * (b2 - b1) * vd_fma(mid / both, mid, both);
  }
  SKF_EACH(i, 3) {
    skf_vd b1 = s[i].b1, b2 = s[i].b2, r1 = s[i].r1, r2 = s[i].r2, cc = s[i].cc, d = f->d[i], len = b2 - b1;
    skf_vi right = b1 >= zero, aside = right | (b2 <= zero);
    skf_vd a1 = vd_abs(b1), a2 = vd_abs(b2), sum = vd_abs(b1 + b2);
    skf_vd base = vd_select(aside, vd_select(right, b1 + r1, r2 - b2) * (r1 + r2), cc);
    skf_vd top = vd_select(aside, len * (r1 + r2 + sum), vd_fma(a2, r1, vd_fma(a1, r2, a1 * a2)) + s[i].near);
    skf_vd D1 = vd_fma(az, r1, cc), D2 = vd_fma(az, r2, cc);
    skf_vd rise = d * vd_select(aside, len * vd_fma(az, s[i].beside, cc), vd_fma(b2, D1, -(b1 * D2)));
    s[i].log = vd_log_parts(base + top, base, top);
    s[i].angle = vd_angle_parts(vd_abs(rise), vd_fma(D1, D2, d * d * (b1 * b2)));
    s[i].t_log = s[i].log.top / s[i].log.bottom, s[i].t_angle = s[i].angle.top / s[i].angle.bottom;
    s[i].sign = (skf_vd)vd_sign(rise), s[i].len = len;
    *good &= ~e[i].in | (vd_sane(base) & vd_sane(cc));
  }
  SKF_EACH(i, 3) {
    skf_vd b1 = s[i].b1, b2 = s[i].b2, cc = s[i].cc, d = f->d[i], len = s[i].len;
    skf_vd lam = vd_log_series(s[i].log.count, s[i].t_log), solid = vd_angle_series(s[i].angle.offset, s[i].t_angle);
    skf_vd th = vd_fma(d, lam, -(az * (skf_vd)((skf_vi)solid ^ (skf_vi)s[i].sign)));
    skf_vd int_r = vd_set(0.5) * vd_fma(cc, lam, s[i].moment);
    skf_vd int_ll = len * third * vd_fma(b1, b1 + b2, b2 * b2);
    skf_vd J = vd_fma(v->per_R2, vd_fma(cc, len, int_ll), len) - vd_set(2) * v->per_R * int_r;
    skf_vd F = vd_fma(vd_set(3) * v->per_R2, vd_fma(cc + f->zz, len, int_ll), vd_set(6) * len);
    F = vd_fma(d, vd_fnma(eight * v->per_R, int_r, F), -(eight * f->zz * v->per_R * th)) * vd_set(1. / 12);
    skf_vd W = -(vd_fma(vd_set(2) * v->R, th, -(d * len)) * v->per_R2);
    part[i] = (cone_part){(skf_vd)((skf_vi)F & e[i].in), (skf_vd)((skf_vi)W & e[i].in), (skf_vd)((skf_vi)J & e[i].in)};
  }
}

/* The same by Gauss's rule, near the rim and from beyond, lengths over R: terms of the H-form, those of the G-form from
   beyond. The integrand's singularities are as far from the edge's line as the point or from beyond the foot, 0.57 R or
   0.57 of the disc's radius at least: 1e-16, in floats 1e-6 are left. */
enum { CONE_NODES = SKF_COUNT(28, 12) };
typedef struct cone_node {
  skf_vd u, q, inv;
} cone_node;
typedef struct cone_piece {
  skf_vd half, mid, dd, cc, chord;
  cone_part sum;
} cone_piece;

SKF_INLINE skf_vd cone_at(const cone_piece *e, double at) { return vd_fma(e->half, vd_set(at), e->mid); }
SKF_INLINE void cone_root(const cone_piece *e, double at, cone_node *n) {
  skf_vd l = cone_at(e, at);
  n->u = vd_sqrt(vd_fma(l, l, e->cc));
}
SKF_INLINE void cone_quotient(const cone_view *v, const cone_piece *e, double at, cone_node *n) {
  skf_vd l = cone_at(e, at), one = vd_set(1);
  n->q = vd_select(v->beyond, vd_fma(l, l, e->dd), n->u + v->w), n->inv = one / ((one + n->u) * n->q);
}
SKF_INLINE void cone_sum(const cone_view *v, const cone_piece *e, double at, double weight, const cone_node *n,
                         cone_part *sum) {
  skf_vd l = cone_at(e, at), w = vd_set(weight), by = w * vd_fma(n->u, n->inv, n->inv), b = v->b;
  skf_vd a = (e->chord - l) * (e->chord + l) * (n->q * n->inv), aa = a * a, s = a + b;
  skf_vd near = vd_fms(vd_set(4), vd_fma(b, s, aa), vd_set(3) * s * vd_fma(b, b, aa));
  skf_vd F = vd_select(v->beyond, aa * a * vd_fnma(vd_set(3), a, vd_set(4)), near);
  sum->F = vd_fma(by, F, sum->F), sum->W = vd_fma(by, vd_select(v->beyond, aa, s), sum->W);
  sum->J = vd_fma(w, aa, sum->J);
}

/* Loop after loop: what waits for roots and quotients would fill the scheduler. */
SKF_INLINE void cone_rule(const cone_view *v, const area_view *f, const cut_view cut[3], skf_vi some,
                          cone_part part[3]) {
  const skf_gauss_node *node = skf_gauss_rule(CONE_NODES);
  const skf_vd zero = vd_set(0);
  cone_node n[CONE_NODES];
  cone_piece piece[3];
  size_t edge[3], count = 0;
  for (size_t i = 0; i < 3; i++) {
    const cut_view *e = cut + i;
    const skf_vd half = vd_set(0.5) * v->per_R, d = v->per_R * f->d[i], z = v->per_R * f->z;
    part[i] = (cone_part){zero, zero, zero};
    if (!vi_any(some & e->in)) continue;
    piece[count] = (cone_piece){half * (e->b2 - e->b1), half * (e->b1 + e->b2), d * d,
                                vd_fma(d, d, z * z),    v->per_R * e->chord,    part[i]};
    edge[count++] = i;
  }
  SKF_ROLLED for (size_t k = 0; k < count; k++) {
    const cone_piece e = piece[k];
    if (k == 0) {
      SKF_ROLLED for (int j = 0; j < CONE_NODES; j++) cone_root(&e, node[j].x, n + j);
    } else {
      const cone_piece last = piece[k - 1];
      cone_part sum = last.sum;
      SKF_ROLLED for (int j = 0; j < CONE_NODES; j++) {
        cone_sum(v, &last, node[j].x, node[j].w, n + j, &sum);
        cone_root(&e, node[j].x, n + j);
      }
      piece[k - 1].sum = sum;
    }
    SKF_ROLLED for (int j = 0; j < CONE_NODES; j++) cone_quotient(v, &e, node[j].x, n + j);
  }
  if (count > 0) {
    const cone_piece last = piece[count - 1];
    cone_part sum = last.sum;
    SKF_ROLLED for (int j = 0; j < CONE_NODES; j++) cone_sum(v, &last, node[j].x, node[j].w, n + j, &sum);
    piece[count - 1].sum = sum;
  }
  for (size_t k = 0; k < count; k++) {
    const cone_part *s = &piece[k].sum;
    skf_vd half = v->R * (skf_vd)((skf_vi)piece[k].half & some & cut[edge[k]].in), size = f->d[edge[k]] * half;
    skf_vd F = vd_set(1. / 12) * size * s->F, W = -(size * s->W) * v->per_R2;
    F = vd_select(v->beyond, -F, F), W = vd_select(v->beyond, -W, W);
    part[edge[k]] = (cone_part){F, W, half * s->J};
  }
}

/* Adds `by` times what the edges give in `some`, by the rule or in closed form; not good where that has cancelled.
   terms: a quarter of the sizes of what makes up J. */
SKF_INLINE void cone_add(const area_row *c, const area_view *f, const cone_view *v, skf_vi some, bool careful,
                         double by, area_sum *sum, skf_vd *terms, skf_vi *good) {
  const skf_vd factor = (skf_vd)((skf_vi)vd_set(by) & some);
  cut_view cut[3];
  cone_part part[3];
  SKF_EACH(i, 3) cut[i] = area_cut(c, f, (int)i, v->power, v->rm, v->R);
  if (careful)
    cone_rule(v, f, cut, some, part);
  else
    cone_closed(v, f, cut, part, good);
  SKF_EACH(i, 3) {
    const cut_view e = cut[i];
    const cone_part p = part[i];
    skf_vd out = careful ? (skf_vd)((skf_vi)e.out & ~v->beyond) : e.out;
    *good &= ~e.rough;
    skf_vd F = factor * vd_fma(v->G0, out, p.F), Z = factor * (f->z * vd_fnma(v->b * v->b, out, p.W));
    sum->J[i] = vd_fma(factor, p.J, sum->J[i]);
    sum->F += F, sum->abs_F += vd_abs(F), sum->Z += Z, sum->abs_Z += vd_abs(Z);
    if (!careful) *terms += vd_abs((skf_vd)((skf_vi)(factor * (e.b2 - e.b1)) & e.in));
  }
}

/* Together: at the rim of R / 3 its cone, small then, may cancel; where that of R does, it is not reached. Carefully
   those lanes alone. */
SKF_INLINE skf_vvalue metaball_edges(const area_row *c, const area_view *f, skf_vi cones, bool careful) {
  const cone_view outer = cone_see(c, f, 1);
  skf_vd zero = vd_set(0), R2 = outer.R2;
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  skf_vd terms = zero;
  skf_vi clear = f->dist2 < R2 * vd_set(1 - SKF_PICK(1e-3, 1e-5)), inside = cones & (vd_set(9) * f->dist2 < R2);
  for (int i = 0; i < 3; i++) clear &= vd_set(SKF_PICK(1024, 1e6)) * vd_abs(outer.power[i]) > R2;
  skf_vi cancels = outer.rim | ((int)SKF_PICK(0, 1) ? outer.beyond : vi_set(0));
  skf_vi good = clear & cones & (careful ? outer.rim | outer.beyond : ~cancels);
  cone_add(c, f, &outer, careful ? good : cones, careful, 1.5, &sum, &terms, &good);
  if (!careful && vi_any(inside)) {
    const cone_view inner = cone_see(c, f, 1. / 3);
    skf_vi fine = vi_set(-1);
    cone_add(c, f, &inner, inside, false, -0.5, &sum, &terms, &fine);
    good &= fine | ~inside;
  }
  good &= sum.F > zero;
#ifdef SKF_VEC_FLOAT
  sum.abs_Z += terms;
  return area_gather_lossy(c, f, &sum, vd_set(1), 1.5, good);
#else
  skf_vvalue v = area_gather_lossy(c, f, &sum, rim_loss(R2, f), 0, good);
  const skf_vd g = vd_max(vd_max(vd_abs(v.g.x), vd_abs(v.g.y)), vd_abs(v.g.z)), S = vd_max(c->diam, vd_sqrt(f->dist2));
  if (!careful) v.good &= terms * S <= vd_set(128) * vd_max(g * S, v.F);
  return v;
#endif
}

SKF_INLINE skf_vvalue metaball_cones(const area_row *c, skf_v3d x, bool careful) {
  area_view f = area_see(c, x);
  skf_vd zero = vd_set(0), R2 = c->param2, reach2 = vd_max(vd_max(f.r2[0], f.r2[1]), f.r2[2]);
  skf_vi finite = reach2 < vd_set(INFINITY), core = vd_set(9) * reach2 < R2;
  skf_vi off = (f.dist2 > R2 * vd_set(1 + SKF_PICK(1e-3, 1e-5))) & finite, cones = finite & ~core & ~off;
  skf_vvalue v = {zero, {zero, zero, zero}, off};
  if (vi_any(core)) v = area_either(core, area_rule(AREA_CORE, c, &f, 2, core), v);
  if (!vi_any(cones)) return v;
  skf_vvalue w = metaball_edges(c, &f, cones, careful);
  /* all in the support and far, in the shell alone; in floats always so */
  skf_vi far = (reach2 < vd_set(0.99) * R2) & (f.dist2 > vd_set(2.25) * (c->diam * c->diam)) & cones &
               (vd_set(9) * f.dist2 > R2);
  if ((int)SKF_PICK(0, 1))
    w.good &= ~far;
  else
    far &= ~w.good;
  if (careful && vi_any(far))
    w = area_either(far, vv_scale(vd_set(1.5), area_rule(AREA_CONE, c, &f, MIDDLE_NODES, far)), w);
  return area_either(cones, w, v);
}

/* One stage: what for the loop gathers the points that need care. */
typedef struct metaball_triangle_state {
  skf_vvalue v;
} metaball_triangle_state;

SKF_OUTLINE skf_vvalue metaball_triangle_thin(const area_row *c, skf_v3d x) { return metaball_cones(c, x, true); }
SKF_OUTLINE skf_vvalue metaball_triangle_plain(const area_row *c, skf_v3d x) { return metaball_cones(c, x, false); }
SKF_INLINE void metaball_triangle_begin(const area_row *c, skf_v3d x, metaball_triangle_state *s) {
  s->v = metaball_triangle_plain(c, x);
}
SKF_INLINE skf_vvalue metaball_triangle_end(const area_row *c, const metaball_triangle_state *s) {
  (void)c;
  return s->v;
}

SKF_BATCH_STAGED(metaball_triangle, area, metaball_triangle_thin, skf_stage_none, skf_stage_none, skf_stage_none)

#endif
