/* SPDX-License-Identifier: MIT */
/* Vector forms: quartic and soft object over a triangle in its plane's own coordinates, in units of the support. There
   few numbers give all edges' distances and abscissae, to an ulp of the triangle's size or of the support, and the
   powers 1 - r^2 to an ulp of 1: as good as the coordinates of floats are. */
#ifndef SKF_FIELD_BATCH_AREA_FLAT_H
#define SKF_FIELD_BATCH_AREA_FLAT_H

#include "field/batch_loop.h"
#include "num/gauss.h"

/* t, n1: along and across the longest edge, n: the normal, all over R; by edge, its direction along and across; its
   line's distance from `at`, its ends' abscissae from there; the first vertex, the sides from there and on, along and
   across; the height of `at`, which is rounded; max(diameter, R) / R, and by how much more than rounding the sums'
   terms are off for the size of the lines' coordinates; strength R^2 */
typedef struct flat_row {
  skf_v3d at, t, n1, n;
  skf_vd c[3], s[3], d[3], l[3], L[3], first[2], side[2], base[2], height, half_area, span, loss, strength;
} flat_row;

/* As vectors have it. (GCC 12 forgets a rounding to floats and back that it does for two numbers at once.) */
static double flat_round(double a) {
  const volatile skf_real rounded = (skf_real)a;
  return (double)rounded;
}

static double *flat_pack(const skf_prepared *e, double *k) {
  const skf_triangle_plan *T = &e->plan.triangle;
  const double R = e->kernel.param, per = 1 / R;
  const skf_vec3 t = v3_scale(per, T->t[T->longest]), n1 = v3_scale(per, T->m[T->longest]);
  const skf_vec3 middle = v3_scale(1. / 3, v3_add(v3_add(T->v[0], T->v[1]), T->v[2]));
  const skf_vec3 at = v3(flat_round(middle.x), flat_round(middle.y), flat_round(middle.z));
  k = pack3(pack3(pack3(pack3(k, at), t), n1), v3_scale(per, T->n));
  for (int i = 0; i < 3; i++) k = pack1(k, T->c[i]);
  for (int i = 0; i < 3; i++) k = pack1(k, T->s[i]);
  for (int i = 0; i < 3; i++) k = pack1(k, per * v3_dot(v3_sub(T->v[i], at), T->m[i]));
  for (int i = 0; i < 3; i++) k = pack1(k, per * v3_dot(v3_sub(T->v[i], at), T->t[i]));
  for (int i = 0; i < 3; i++) k = pack1(k, per * T->L[i]);
  const skf_vec3 way[3] = {v3_sub(T->v[0], at), v3_sub(T->v[1], T->v[0]), v3_sub(T->v[2], T->v[1])};
  for (int i = 0; i < 3; i++) k = pack1(pack1(k, v3_dot(way[i], t)), v3_dot(way[i], n1));
  k = pack1(k, -v3_dot(way[0], v3_scale(per, T->n)));
  const double diam = per * T->diam, span = fmax(diam, 1);
  const bool narrow = SKF_COUNT(span > 16, 0); /* doubles owe the gradient next to the plane more digits */
  k = pack1(pack1(pack1(k, 0.5 * per * per * T->area), span),
            narrow ? INFINITY : fmax(1, fmax(span / (16 * diam), fmin(span / 8, 32))));
  return pack1(k, e->strength * R * R);
}

/* Of each edge: its line's distance from the foot, > 0 inside, its first end, the square of half its line's chord in
   the disc about the foot that the support cuts out, of squared radius rm2, and its root; within: the triangle in the
   support. */
typedef struct flat_view {
  skf_vd u, w, z, rm2;
  skf_vd d[3], l1[3], chord2[3], chord[3];
  skf_vi within, sane;
} flat_view;

SKF_INLINE flat_view flat_see(const flat_row *c, skf_v3d x) {
  const skf_vd zero = vd_set(0);
  const skf_v3d a = vd3_sub(x, c->at);
  flat_view f = {.u = vd3_dot(a, c->t), .w = vd3_dot(a, c->n1), .z = c->height};
  f.z = vd_fma(a.z, c->n.z, vd_fma(a.y, c->n.y, vd_fma(a.x, c->n.x, f.z)));
  const skf_vd rm2 = vd_fnma(f.z, f.z, vd_set(1));
  f.rm2 = vd_max(rm2, zero);
  skf_vd power[3];
  for (int i = 0; i < 3; i++) {
    f.d[i] = vd_fma(c->s[i], f.u, vd_fnma(c->c[i], f.w, c->d[i]));
    f.l1[i] = vd_fnma(c->c[i], f.u, vd_fnma(c->s[i], f.w, c->l[i]));
    f.chord2[i] = vd_fnma(f.d[i], f.d[i], rm2);
    power[i] = vd_fnma(f.l1[i], f.l1[i], f.chord2[i]);
  }
  const skf_vd least = vd_min(power[0], vd_min(power[1], power[2]));
  f.within = least > zero, f.sane = least > vd_set(SKF_PICK(-1e290, -1e30));
  for (int i = 0; i < 3; i++) f.chord[i] = vd_sqrt(vd_max(f.chord2[i], zero));
  return f;
}

SKF_INLINE skf_vi flat_inside(const flat_view *f) { return vd_min(f->d[0], vd_min(f->d[1], f->d[2])) >= vd_set(0); }

/* The gradient along and across the longest edge, along the normal */
typedef struct flat_value {
  skf_vd F, t, m, n;
} flat_value;

SKF_INLINE skf_vvalue flat_put(const flat_row *c, const flat_value *v, skf_vi good) {
  const skf_vd t = c->strength * v->t, m = c->strength * v->m, n = c->strength * v->n;
  return (skf_vvalue){c->strength * v->F, vd3_mad(vd3_mad(vd3_scale(t, c->t), m, c->n1), n, c->n), good};
}

SKF_INLINE skf_vd flat_h(bool soft, skf_vd y) {
  return soft ? y * y * vd_fma(vd_set(4. / 9), y, vd_set(5. / 9)) : y * y;
}
/* int_y^0 h / 2 dy */
SKF_INLINE skf_vd flat_G(bool soft, skf_vd y) {
  return y * y * y * (soft ? vd_fma(vd_set(3. / 54), y, vd_set(5. / 54)) : vd_set(1. / 6));
}

/* Within the support: a product rule, exact */
SKF_INLINE flat_value flat_rule(bool soft, const flat_row *c, const flat_view *f) {
  const int n = soft ? 4 : 3;
  const skf_gauss_node *node = skf_gauss_rule(n);
  const skf_vd u0 = c->first[0] - f->u, w0 = c->first[1] - f->w, four = vd_set(4);
  flat_value v = {vd_set(0), vd_set(0), vd_set(0), vd_set(0)};
  for (int i = 0; i < n; i++) {
    const skf_vd xi = vd_set(0.5 * (1 + node[i].x)), wi = vd_set(node[i].w) * xi * c->half_area;
    const skf_vd us = vd_fma(xi, c->side[0], u0), ws = vd_fma(xi, c->side[1], w0);
    for (int j = 0; j < n; j++) {
      const skf_vd eta = vd_set(0.5 * (1 + node[j].x)) * xi, u = vd_fma(eta, c->base[0], us),
                   w = vd_fma(eta, c->base[1], ws);
      const skf_vd y = vd_fnma(u, u, vd_fnma(w, w, f->rm2)), by = wi * vd_set(node[j].w);
      skf_vd slope = by * y; /* -h' / 2 r or half that */
      if (soft) slope *= vd_fma(vd_set(24. / 36), y, vd_set(20. / 36));
      v.F = vd_fma(by, flat_h(soft, y), v.F);
      v.t = vd_fma(slope, u, v.t), v.m = vd_fma(slope, w, v.m), v.n = vd_fnma(slope, f->z, v.n);
    }
  }
  v.t *= four, v.m *= four, v.n *= four;
  return v;
}

/* An edge's part in the disc: half its length and its middle; h's integral J; sums of y and of y^2 over its Gauss nodes
   that are exact for both, of y^3 for the soft object */
typedef struct flat_part {
  skf_vd half, mid, J, s1, s2, s3;
} flat_part;

SKF_INLINE flat_part flat_cut(bool soft, const flat_row *c, const flat_view *f, int i) {
  const skf_vd c2 = f->chord2[i], chord = f->chord[i];
  const skf_vd b1 = vd_max(f->l1[i], -chord), b2 = vd_min(f->l1[i] + c->L[i], chord);
  flat_part p = {.half = vd_set(0.5) * vd_max(b2 - b1, vd_set(0)), .mid = vd_set(0.5) * (b1 + b2)};
  const skf_gauss_node *node = skf_gauss_rule(soft ? 4 : 3);
  const skf_vd ym = vd_fnma(p.mid, p.mid, c2), mid2 = p.mid + p.mid;
  if (!soft) { /* nodes at mid +- q: y = t -+ e */
    const skf_vd q = p.half * vd_set(node[2].x), t = vd_fnma(q, q, ym), e = mid2 * q, w0 = vd_set(node[1].w),
                 w = vd_set(2 * node[2].w);
    p.s1 = vd_fma(w, t, w0 * ym), p.s2 = vd_fma(w, vd_fma(t, t, e * e), w0 * (ym * ym));
    p.J = p.half * p.s2;
  } else {
    for (int j = 2; j < 4; j++) {
      const skf_vd q = p.half * vd_set(node[j].x), t = vd_fnma(q, q, ym), e = mid2 * q, w = vd_set(2 * node[j].w),
                   tt = t * t, ee = e * e, wt = w * t, s2 = w * (tt + ee), s3 = wt * vd_fma(vd_set(3), ee, tt);
      p.s1 = j > 2 ? p.s1 + wt : wt, p.s2 = j > 2 ? p.s2 + s2 : s2, p.s3 = j > 2 ? p.s3 + s3 : s3;
    }
    p.J = p.half * vd_fma(vd_set(5. / 9), p.s2, vd_set(4. / 9) * p.s3);
  }
  return p;
}

/* The angles of the edges' parts out of the disc, both of one at once: together they have less than pi. */
typedef struct flat_angles {
  skf_vd offset[3], t[3];
} flat_angles;

SKF_INLINE flat_angles flat_turn(const flat_row *c, const flat_view *f) {
  flat_angles a;
  for (int i = 0; i < 3; i++) {
    const skf_vd d = f->d[i], l1 = f->l1[i], l2 = l1 + c->L[i], dd = d * d;
    const skf_vd to = vd_max(l1, vd_min(l2, -f->chord[i])), from = vd_min(l2, vd_max(l1, f->chord[i]));
    const skf_vd re1 = vd_fma(l1, to, dd), im1 = d * (to - l1), re2 = vd_fma(l2, from, dd), im2 = d * (l2 - from);
    const skf_vangle parts = vd_angle_parts(vd_abs(vd_fma(re1, im2, re2 * im1)),
                                            vd_fma(re1, re2, vd_fnma(im1, im2, vd_set(SKF_PICK(1e-300, 1e-36)))));
    a.offset[i] = parts.offset, a.t[i] = parts.top / parts.bottom;
  }
  return a;
}

/* Not good where a sum cancels, as area_gather_lossy, or, in doubles, at the rim, where an ulp of a place is many of F.
   Floats grant what the field changes when a place moves by some ulps. */
SKF_INLINE skf_vi flat_good(const flat_row *c, const flat_value *v, skf_vd abs_F, skf_vd abs_J, skf_vd abs_n) {
  const skf_vd F = vd_abs(v->F), size = vd_max(vd_max(vd_abs(v->t), vd_abs(v->m)), vd_abs(v->n));
  const skf_vd abs_g = c->span * (abs_J + abs_n);
  return (c->span * size < vd_set(SKF_PICK(512, INFINITY)) * F) &
         (c->loss * abs_F <= vd_fma(vd_set(SKF_PICK(0, 0.4)) * c->span, size, vd_set(64) * F)) &
         (abs_J * c->span <= vd_fma(vd_set(1.5) * c->span, size, vd_set(256) * F)) &
         (c->loss * abs_g <= vd_set(128) * vd_max(size * c->span, vd_set(1e-3) * F));
}

SKF_INLINE skf_vvalue flat_edges(bool soft, const flat_row *c, const flat_view *f, const flat_angles *a) {
  const skf_vd zero = vd_set(0), Y = f->rm2, YY = Y * Y;
  const skf_vd h0 = flat_h(soft, Y), G0 = flat_G(soft, Y);
  flat_value v = {zero, zero, zero, zero};
  skf_vd abs_F = zero, abs_J = zero, abs_n = zero, angle = zero, length = zero;
  for (int i = 0; i < 3; i++) {
    const flat_part p = flat_cut(soft, c, f, i);
    const skf_vd s2 = vd_fma(Y, p.s1, vd_fma(vd_set(2), YY, p.s2)), s1 = vd_fma(vd_set(2), Y, p.s1);
    skf_vd H = vd_set(1. / 6) * s2, D = s1;
    if (soft) {
      const skf_vd s3 = vd_fma(Y, s2, p.s3);
      H = vd_fma(vd_set(5. / 54), s2, vd_set(3. / 54) * s3), D = vd_fma(vd_set(5. / 9), s1, vd_set(4. / 9) * s2);
    }
    const skf_vd turn = vd_angle_series(a->offset[i], a->t[i]), out = (skf_vd)((skf_vi)turn ^ vd_sign(f->d[i]));
    const skf_vd by = f->d[i] * p.half, part = by * H, rest = by * D;
    v.F += part, v.n += rest, v.t = vd_fma(c->s[i], p.J, v.t), v.m = vd_fnma(c->c[i], p.J, v.m);
    angle += out, length += p.half;
    abs_F += vd_abs(vd_fma(G0, out, part)), abs_n += vd_abs(vd_fma(h0, out, rest)), abs_J += p.J;
  }
  /* Out of the support; then the angles add up to 0. */
  const skf_vi off = (Y == zero) | ((length == zero) & ~flat_inside(f));
  v.F = (skf_vd)((skf_vi)vd_fma(G0, angle, v.F) & ~off), v.t = (skf_vd)((skf_vi)v.t & ~off);
  v.m = (skf_vd)((skf_vi)v.m & ~off), v.n = (skf_vd)((skf_vi)(-f->z * vd_fma(h0, angle, v.n)) & ~off);
  return flat_put(c, &v, f->sane & (off | flat_good(c, &v, abs_F, abs_J, abs_n * vd_abs(f->z))));
}

/* G-form, far enough beside the triangle in terms of the disc that 8 nodes on an edge do in floats: the nearest
   singularity is more than 0.7 of the disc's radius from the edge's parts in it. */
SKF_INLINE skf_vvalue flat_beyond(bool soft, const flat_row *c, const flat_view *f, skf_vi good) {
  enum { NODES = SKF_COUNT(20, 8) };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  const skf_vd zero = vd_set(0);
  flat_value v = {zero, zero, zero, zero};
  skf_vd abs_F = zero, abs_J = zero, abs_n = zero;
  for (int i = 0; i < 3; i++) {
    const flat_part p = flat_cut(soft, c, f, i);
    const skf_vd dd = vd_fma(f->d[i], f->d[i], vd_set(SKF_PICK(1e-300, 1e-36)));
    skf_vd F = zero, n = zero;
    for (int j = 0; j < NODES; j++) {
      const skf_vd l = vd_fma(p.half, vd_set(node[j].x), p.mid), ll = l * l, y = f->chord2[i] - ll,
                   q = vd_set(node[j].w) / (dd + ll);
      F = vd_fma(q, flat_G(soft, y), F), n = vd_fma(q, flat_h(soft, y), n);
    }
    const skf_vd by = f->d[i] * p.half;
    F *= by, n *= by;
    v.F -= F, v.n += n, v.t = vd_fma(c->s[i], p.J, v.t), v.m = vd_fnma(c->c[i], p.J, v.m);
    abs_F += vd_abs(F), abs_n += vd_abs(n), abs_J += p.J;
  }
  v.n *= f->z;
  return flat_put(c, &v, good & flat_good(c, &v, abs_F, abs_J, abs_n * vd_abs(f->z)));
}

SKF_INLINE skf_vvalue flat_careful(bool soft, const flat_row *c, skf_v3d x) {
  const flat_view f = flat_see(c, x);
  skf_vd lat2 = vd_set(INFINITY);
  for (int i = 0; i < 3; i++) {
    const skf_vd past = vd_max(vd_max(f.l1[i], -(f.l1[i] + c->L[i])), vd_set(0));
    lat2 = vd_min(lat2, vd_fma(f.d[i], f.d[i], past * past));
  }
  /* not next to a corner at the rim, where the edges' lines disagree */
  const skf_vi seen = f.rm2 - lat2 > vd_set(SKF_PICK(0x1p-48, 0x1p-19)) * c->span;
  const skf_vi beyond = ~(flat_inside(&f) | f.within) & f.sane & seen & (vd_set(2) * lat2 > f.rm2);
  skf_vvalue v = {.good = vi_set(0)};
  if (vi_any(beyond)) v = flat_beyond(soft, c, &f, beyond);
  if (!vi_any(f.within)) return v;
  const flat_value w = flat_rule(soft, c, &f);
  const skf_vvalue u = flat_put(c, &w, f.within);
  return (skf_vvalue){vd_select(f.within, u.F, v.F), vd3_select(f.within, u.g, v.g), v.good | f.within};
}

/* For loops that look ahead: what ends with roots, with quotients, and the rest. Where all lanes are within the support
   the rule is all; other such lanes are left to flat_careful. */
typedef struct flat_state {
  flat_view f;
  flat_angles a;
} flat_state;

SKF_INLINE void flat_begin(const flat_row *c, skf_v3d x, flat_state *s) { s->f = flat_see(c, x); }
SKF_INLINE void flat_middle(const flat_row *c, flat_state *s) {
  if (!vi_all(s->f.within)) s->a = flat_turn(c, &s->f);
}
SKF_INLINE skf_vvalue flat_end(bool soft, const flat_row *c, const flat_state *s) {
  if (vi_all(s->f.within)) {
    const flat_value v = flat_rule(soft, c, &s->f);
    return flat_put(c, &v, s->f.within);
  }
  skf_vvalue v = flat_edges(soft, c, &s->f, &s->a);
  v.good &= ~s->f.within;
  return v;
}

#endif
