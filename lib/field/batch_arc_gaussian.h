/* SPDX-License-Identifier: MIT */
/* Vector forms: Gaussians along an arc that is no circle and not much longer than their width. An incomplete Bessel
   function has no closed form: the Gauss rule of fixed points of the arc, whatever x is, so that neither angles nor
   ends are needed and nothing cancels. With H half the sweep and b = 2 a^2 rho k, k from the axis, an element's
   Gaussian is a factor times exp(b cos(phi - phi_x)), |phi| <= H: up to a b that depends on H the rule leaves 5e-15 of
   the integral (in floats 2e-8), wherever x is. */
#ifndef SKF_FIELD_BATCH_ARC_GAUSSIAN_H
#define SKF_FIELD_BATCH_ARC_GAUSSIAN_H

#include "field/batch_arc.h"
#include "num/gauss.h"

/* Half of the nodes of each rule */
enum { GAUSSIAN_ARC_FEW = SKF_COUNT(6, 4), GAUSSIAN_ARC_MANY = SKF_COUNT(12, 8) };

/* A node pair's coordinates from the middle of the arc, towards it and along it there, and its weight */
typedef struct arc_node {
  skf_vd u, t, w;
} arc_node;

/* With d from the arc's middle, m outwards and t along it there, the squared distance from a node pair is |d|^2 - 2 u
   (d m + rho) -+ 2 t (d t). Of the exponents only |d|^2 may be large, and is known to more than an ulp. */
typedef struct gaussian_arc_place {
  skf_v3d from, low;       /* the arc's middle, and what it lost to rounding */
  skf_v3d m, t;            /* times minus twice the exponent */
  skf_vd rise;             /* rho times the same */
  skf_vd exponent, beyond; /* and what it lost */
  skf_vd slope;            /* -2 a^2 */
  skf_vd k2, most;         /* bounds of k^2, by the same factor squared, and of |d|^2 */
} gaussian_arc_place;

typedef struct few_nodes_row {
  gaussian_arc_place at;
  arc_node node[GAUSSIAN_ARC_FEW];
} few_nodes_row;

typedef struct many_nodes_row {
  gaussian_arc_place at;
  arc_node node[GAUSSIAN_ARC_MANY];
} many_nodes_row;

static double *gaussian_arc_pack(const skf_prepared *e, int pairs, bool many, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double C = a->cos_half, S = a->sin_half, rho = a->radius, param = e->kernel.param;
  double by = (double)(-2 * exponent_of(param));
  skf_vec3 m = v3_add(v3_scale(C, a->e), v3_scale(S, a->f)), t = v3_sub(v3_scale(C, a->f), v3_scale(S, a->e));
  skf_vec3 center = e->primitive.arc.center, from = v3_mad(center, rho, m);
  skf_dd3 off = dd3_diff(from, center);
  /* from + low is on the circle, in its plane and nowhere along it */
  double low_m = 0.5 * dd3_power(rho, off) / rho, low_t = -dd3_dot_d(off, t);
  double low_n = -dd3_dot_d(off, a->raw) / a->raw_length;
  k = pack3(pack3(k, from), v3_mad(v3_mad(v3_scale(low_m, m), low_t, t), low_n, a->n));
  k = pack1(pack3(pack3(k, v3_scale(by, m)), v3_scale(by, t)), by * rho);
  k = pack1(pack_exponent_low(k, param), -2 * param * param);
  double far = skf_gaussian_arc_most(a->half, many) / (2 * param * param * rho) * by;
  double seen = sqrt((double)SKF_PICK(690, 84)) / param - rho * a->half; /* each node then is within VD_EXP_MAX */
  k = pack1(pack1(k, far * far), seen > 0 ? seen * seen : 0);
  const skf_gauss_node *node = skf_gauss_rule(2 * pairs) + pairs;
  for (int j = 0; j < pairs; j++) {
    double phi = a->half * node[j].x, half = sin(0.5 * phi);
    k = pack1(pack1(pack1(k, -2 * rho * half * half), rho * sin(phi)), rho * a->half * node[j].w);
  }
  return k;
}

static double *few_nodes_pack(const skf_prepared *e, double *k) {
  return gaussian_arc_pack(e, GAUSSIAN_ARC_FEW, false, k);
}
static double *many_nodes_pack(const skf_prepared *e, double *k) {
  return gaussian_arc_pack(e, GAUSSIAN_ARC_MANY, true, k);
}

/* d; the exponents' slopes in u and t; whole and fraction of the exponent of |d|^2; then the integrals of h, h u, h t
 */
typedef struct gaussian_arc_state {
  skf_v3d d;
  skf_vd u, t, whole, f, F;
  skf_vi good;
} gaussian_arc_state;
typedef gaussian_arc_state gaussian_arc_brief_state, gaussian_arc_wide_state;

/* |d|^2, and behind it what it has lost, with what d has */
SKF_INLINE skf_vd gaussian_arc_square(const gaussian_arc_place *c, skf_v3d x, skf_v3d d, skf_vd *low) {
#ifdef SKF_VEC_FLOAT
  (void)c, (void)x;
  *low = vd_set(0);
  return vd3_dot(d, d);
#else
  const skf_v3d lost = vd3_sub(vd3_lost(x, c->from, d), c->low);
  const skf_vd px = d.x * d.x, py = d.y * d.y, pz = d.z * d.z, s = px + py, w = s + pz;
  *low = vd_fms(d.x, d.x, px) + vd_fms(d.y, d.y, py) + vd_fms(d.z, d.z, pz);
  *low += vd_lost(px, -py, s) + vd_lost(s, -pz, w);
  *low = vd_fma(vd_set(2), vd3_dot(d, lost), *low);
  return w;
#endif
}

SKF_INLINE void gaussian_arc_see(const gaussian_arc_place *c, skf_v3d x, gaussian_arc_state *s) {
  const skf_v3d d = vd3_sub(x, c->from);
  skf_vd low;
  const skf_vd w = gaussian_arc_square(c, x, d, &low);
  const skf_vpower e = vd_exp2_begin_low(c->exponent, c->beyond, w);
  s->d = d, s->u = vd3_dot(d, c->m) + c->rise, s->t = vd3_dot(d, c->t);
  s->whole = e.whole, s->f = vd_fma(c->exponent, low, e.f);
  s->good = (vd_fma(s->u, s->u, s->t * s->t) < c->k2) & (w < c->most);
}

SKF_INLINE void gaussian_arc_sum(const arc_node *node, int pairs, gaussian_arc_state *s) {
  const skf_vd zero = vd_set(0);
  skf_vd F = zero, U = zero, T = zero;
  for (int j = 0; j < pairs; j += 2) {
    skf_vd y[4], h[4];
    SKF_EACH(i, 2) {
      const arc_node *at = node + j + i;
      const skf_vd both = vd_fma(at->u, s->u, s->f);
      y[2 * i] = vd_fma(at->t, s->t, both), y[2 * i + 1] = vd_fnma(at->t, s->t, both);
    }
    vd_exp2_each(4, y, h);
    SKF_EACH(i, 2) {
      const arc_node *at = node + j + i;
      const skf_vd both = at->w * (h[2 * i] + h[2 * i + 1]);
      F += both;
      U = vd_fma(both, at->u, U);
      T = vd_fma(at->w * at->t, h[2 * i] - h[2 * i + 1], T);
    }
  }
  s->F = F, s->u = U, s->t = T;
}

SKF_INLINE skf_vvalue gaussian_arc_pull(const gaussian_arc_place *c, const gaussian_arc_state *s) {
  const skf_vd scale = vd_exp2_raise(vd_set(SKF_PICK(0, 1)), s->whole), F = scale * s->F,
               ln2 = vd_set(0.69314718055994531) * scale;
  const skf_v3d g = vd3_scale(F, vd3_scale(c->slope, s->d)); /* wide kernels' slopes times F would underflow */
  return (skf_vvalue){F, vd3_mad(vd3_mad(g, ln2 * s->u, c->m), ln2 * s->t, c->t), s->good};
}

SKF_INLINE void gaussian_arc_brief_begin(const few_nodes_row *c, skf_v3d x, gaussian_arc_state *s) {
  gaussian_arc_see(&c->at, x, s);
}
SKF_INLINE void gaussian_arc_brief_sum(const few_nodes_row *c, gaussian_arc_state *s) {
  gaussian_arc_sum(c->node, GAUSSIAN_ARC_FEW, s);
}
SKF_INLINE skf_vvalue gaussian_arc_brief_end(const few_nodes_row *c, const gaussian_arc_state *s) {
  return gaussian_arc_pull(&c->at, s);
}
SKF_INLINE void gaussian_arc_wide_begin(const many_nodes_row *c, skf_v3d x, gaussian_arc_state *s) {
  gaussian_arc_see(&c->at, x, s);
}
SKF_INLINE void gaussian_arc_wide_sum(const many_nodes_row *c, gaussian_arc_state *s) {
  gaussian_arc_sum(c->node, GAUSSIAN_ARC_MANY, s);
}
SKF_INLINE skf_vvalue gaussian_arc_wide_end(const many_nodes_row *c, const gaussian_arc_state *s) {
  return gaussian_arc_pull(&c->at, s);
}

SKF_BATCH_STAGED(gaussian_arc_brief, few_nodes, skf_again_none, gaussian_arc_brief_sum, skf_stage_none, skf_stage_none)
SKF_BATCH_STAGED(gaussian_arc_wide, many_nodes, skf_again_none, gaussian_arc_wide_sum, skf_stage_none, skf_stage_none)

#endif
