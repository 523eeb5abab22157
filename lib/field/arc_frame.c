/* SPDX-License-Identifier: MIT */
#include "field/arc_frame.h"

/* a + b in about 106 bits, not normalised; |a.lo|, |b.lo| are of the size of rounding errors. */
static skf_dd loose_sum(skf_dd a, skf_dd b) {
  skf_dd s = dd_two_sum(a.hi, b.hi);
  return (skf_dd){s.hi, s.lo + (a.lo + b.lo)};
}

static skf_dd loose_product(skf_dd a, skf_dd b) {
  skf_dd p = dd_two_prod(a.hi, b.hi);
  return (skf_dd){p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi)};
}

static skf_dd loose_dot(skf_dd3 a, skf_dd3 b) {
  return loose_sum(loose_sum(loose_product(a.x, b.x), loose_product(a.y, b.y)), loose_product(a.z, b.z));
}

/* k^2 - rho^2 = |d|^2 - z^2 - rho^2 and z in double-double: near the circle the plain difference loses rho / distance.
 */
static void exact_place(const skf_arc_plan *a, skf_arc_frame *f) {
  skf_dd3 n = {{a->raw.x, 0}, {a->raw.y, 0}, {a->raw.z, 0}};
  skf_dd z = loose_dot(f->d, n),
         near = loose_sum(loose_product(loose_dot(f->d, f->d), a->raw2), dd_neg(a->radius2_raw2));
  skf_dd rest = loose_sum(near, dd_neg(loose_product(z, z)));
  f->inner = (rest.hi + rest.lo) / (a->raw2.hi * f->outer);
  f->z = (z.hi + z.lo) / a->raw_length;
}

/* Half the angle whose cosine and sine are c >= 0 and s. */
static void halve(double c, double s, double *half_c, double *half_s) {
  *half_c = sqrt(0.5 * (1 + c));
  *half_s = 0.5 * s / *half_c;
}

static void place_ends(const skf_arc_plan *a, skf_arc_frame *f) {
  double S = a->sin_half, C = a->cos_half, cb, sb;
  f->behind = f->ux < 0;
  double ux = f->behind ? -f->ux : f->ux, uy = f->behind ? -f->uy : f->uy;
  halve(ux, -uy, &cb, &sb);
  double c1 = C * cb - S * sb, s1 = S * cb + C * sb;
  f->a0 = -0.5 * atan2(uy, ux);
  f->a1 = a->half + f->a0;
  double turn = uy <= 0 ? 1 : -1;
  f->c0 = f->behind ? turn * sb : cb;
  f->s0 = f->behind ? -turn * cb : sb;
  f->c1 = f->behind ? turn * s1 : c1;
  f->s1 = f->behind ? -turn * c1 : s1;
  f->half = a->half, f->sin_half = S, f->cos_half = C;
  f->sin_mid = S * f->ux - C * f->uy;
  f->cos_mid = C * f->ux + S * f->uy;
  f->r02 = f->alpha * f->c0 * f->c0 + f->beta * f->s0 * f->s0;
  f->r12 = f->alpha * f->c1 * f->c1 + f->beta * f->s1 * f->s1;
  f->r0 = sqrt(f->r02);
  f->r1 = sqrt(f->r12);
  f->turn = 4 * f->rho * S * f->sin_mid;
}

void skf_arc_place(const skf_prepared *e, skf_vec3 x, skf_arc_frame *f) {
  const skf_arc_plan *a = &e->plan.arc;
  f->plan = a;
  f->e = a->e, f->f = a->f, f->n = a->n;
  f->d = dd3_diff(x, e->primitive.arc.center);
  f->rho = a->radius;
  f->full = a->full;
  skf_vec3 d = dd3_round(f->d);
  double u = v3_dot(d, a->e), v = v3_dot(d, a->f);
  f->k = sqrt(u * u + v * v);
  f->ux = f->k > 0 ? u / f->k : 1;
  f->uy = f->k > 0 ? v / f->k : 0;
  f->z = v3_dot(d, a->n);
  f->inner = f->k - f->rho;
  f->outer = f->k + f->rho;
  if (16 * (f->inner * f->inner + f->z * f->z) < f->outer * f->outer) exact_place(a, f);
  f->alpha = f->inner * f->inner + f->z * f->z;
  f->beta = f->outer * f->outer + f->z * f->z;
  f->da = sqrt(f->alpha);
  f->db = sqrt(f->beta);
  f->spread = 4 * f->rho * f->k;
  if (!f->full) place_ends(a, f);
}

skf_arc_terms skf_arc_gather(const skf_arc_frame *f, const skf_arc_moments *m, int order) {
  double in = f->inner, out = f->outer, z = f->z, g = m->g_cc + m->g_ss;
  skf_arc_terms t = {.F = m->F, .k = in * m->g_cc + out * m->g_ss, .p = m->ends, .z = z * g};
  if (order < 2) return t;
  t.kk = g + in * in * m->k_c4 + 2 * in * out * m->k_c2s2 + out * out * m->k_s4;
  t.pp = g + 4 * f->rho * f->rho * m->k_c2s2;
  t.zz = g + z * z * (m->k_c4 + 2 * m->k_c2s2 + m->k_s4);
  t.kp = -2 * f->rho * (in * m->k_c3s + out * m->k_cs3);
  t.kz = z * (in * (m->k_c4 + m->k_c2s2) + out * (m->k_c2s2 + m->k_s4));
  t.pz = z * m->g_ends;
  return t;
}

/* out += a (b c^T + c b^T) / 2 */
static void add_outer(double a, skf_vec3 b, skf_vec3 c, double out[6]) {
  out[0] += a * b.x * c.x;
  out[1] += 0.5 * a * (b.x * c.y + b.y * c.x);
  out[2] += 0.5 * a * (b.x * c.z + b.z * c.x);
  out[3] += a * b.y * c.y;
  out[4] += 0.5 * a * (b.y * c.z + b.z * c.y);
  out[5] += a * b.z * c.z;
}

void skf_arc_result(const skf_arc_frame *f, const skf_arc_terms *t, int order, skf_value *v) {
  skf_vec3 k = v3_mad(v3_scale(f->ux, f->e), f->uy, f->f), p = v3_mad(v3_scale(-f->uy, f->e), f->ux, f->f);
  v->F = t->F;
  v->g = v3_mad(v3_mad(v3_scale(t->k, k), t->p, p), t->z, f->n);
  if (order < 2) return;
  add_outer(t->kk, k, k, v->h);
  add_outer(t->pp, p, p, v->h);
  add_outer(t->zz, f->n, f->n, v->h);
  add_outer(2 * t->kp, k, p, v->h);
  add_outer(2 * t->kz, k, f->n, v->h);
  add_outer(2 * t->pz, p, f->n, v->h);
}

static double angle(double c, double s) { return s < c ? asin(fmin(1, s)) : acos(fmin(1, c)); }

/* One piece between the angles (cl, sl) and (ch, sh); cut: which of the two lie on a multiple of pi/2. */
static skf_arc_piece fold(const skf_arc_frame *f, double cl, double sl, double ch, double sh, bool cut_l, bool cut_h,
                          bool angles) {
  double C = fabs(cl), S = fabs(sl), D = fabs(ch), T = fabs(sh);
  bool up = T > S || (T == S && D < C);
  skf_arc_piece p = {.ca = up ? C : D, .sa = up ? S : T, .cb = up ? D : C, .sb = up ? T : S, .weight = 1};
  bool at_zero = p.sa == 0 && (cut_l || cut_h); /* the cut end is chi = 0, else pi/2 */
  if (cut_l && cut_h)
    p.rise = 1;
  else if (cut_l || cut_h)
    p.rise = at_zero ? p.sb * p.sb : p.ca * p.ca;
  else
    p.rise = fabs(f->sin_half * f->sin_mid);
  if (!angles) return p;
  p.xa = angle(p.ca, p.sa);
  p.xb = angle(p.cb, p.sb);
  if (cut_l && cut_h)
    p.length = SKF_PI / 2;
  else if (cut_l || cut_h)
    p.length = at_zero ? p.xb : p.ca < 0.5 ? asin(p.ca) : SKF_PI / 2 - p.xa;
  else
    p.length = f->half;
  return p;
}

int skf_arc_pieces(const skf_arc_frame *f, bool angles, skf_arc_piece out[4]) {
  if (f->full) {
    out[0] = (skf_arc_piece){.ca = 1, .sb = 1, .rise = 1, .weight = 2, .xb = SKF_PI / 2, .length = SKF_PI / 2};
    return 1;
  }
  int n = 0, cut = f->a0 < 0 ? 0 : 1; /* -pi/4 <= a0 <= pi/4 */
  double cl = f->c0, sl = f->s0;
  for (bool first = true, last = false; !last; first = false, cut++) {
    last = !(cut * (SKF_PI / 2) < f->a1); /* so that NaN ends, too */
    bool odd = (cut + f->behind) & 1;
    double ch = last ? f->c1 : odd ? 0 : 1, sh = last ? f->s1 : odd ? 1 : 0;
    skf_arc_piece p = fold(f, cl, sl, ch, sh, !first, !last, angles);
    p.sign = odd ? 1 : -1;
    if (p.rise > 0) out[n++] = p;
    cl = ch, sl = sh;
  }
  return n;
}
