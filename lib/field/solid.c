/* SPDX-License-Identifier: MIT */
/* Solids point by point, and the integrals that need care next to edges and faces. */
#include "field/solid.h"
#include "core/sum.h"
#include "field/segment_frame.h"
#include "field/triangle.h"

double skf_solid_edge_log(skf_vec3 a, skf_vec3 b, skf_vec3 x) {
  skf_dd3 da = dd3_diff(a, x), db = dd3_diff(b, x), e = dd3_diff(b, a);
  double L = v3_norm(dd3_round(e)), ra = v3_norm(dd3_round(da)), rb = v3_norm(dd3_round(db));
  if (!(L > 0)) return 0;
  skf_dd3 near = ra < rb ? da : db, across = dd3_cross(near, e);
  double h2 = dd3_dot(across, across).hi / (L * L), t = dd3_dot_round(near, e) / L;
  double ta = ra < rb ? t : t - L, tb = ra < rb ? t + L : t, E = skf_segment_excess(ta, ra, tb, rb, h2);
  return E > 0 ? log1p(2 * L / E) : 0;
}

double skf_solid_face_angle(skf_vec3 a, skf_vec3 b, skf_vec3 c, skf_vec3 x) {
  return skf_triangle_angle(&(skf_triangle){{a, b, c}}, x);
}

/* A block's vertices seen from a point. */
typedef struct view {
  skf_vec3 d[3 * SKF_SOLID_BLOCK];
  double r[3 * SKF_SOLID_BLOCK];
} view;

static void add_edges(const skf_solid_block *b, skf_vec3 x, const view *w, double out[SKF_SOLID_OUT]) {
  const double *E = b->edge;
  size_t room = b->edge_room;
  for (size_t i = 0; i < b->edges; i++, E++) {
    unsigned p = b->ends[i], q = b->ends[room + i];
    skf_vec3 d = w->d[p];
    double sum = w->r[p] + w->r[q], excess = sum - E[0], lambda;
    if (excess > SKF_SOLID_NEAR * sum)
      lambda = log1p(2 * E[0] / excess);
    else
      lambda = skf_solid_edge_log(skf_solid_block_vertex(b, p), skf_solid_block_vertex(b, q), x);
    double xx = E[SKF_EDGE_XX * room], xy = E[SKF_EDGE_XY * room], xz = E[SKF_EDGE_XZ * room];
    double yy = E[SKF_EDGE_YY * room], yz = E[SKF_EDGE_YZ * room];
    skf_vec3 y =
        v3(xx * d.x + xy * d.y + xz * d.z, xy * d.x + yy * d.y + yz * d.z, xz * d.x + yz * d.y - (xx + yy) * d.z);
    out[0] += lambda * v3_dot(y, d);
    out[1] -= lambda * y.x, out[2] -= lambda * y.y, out[3] -= lambda * y.z;
    out[4] += lambda * xx, out[5] += lambda * xy, out[6] += lambda * xz, out[7] += lambda * yy, out[8] += lambda * yz;
  }
}

static double face_angle(const skf_solid_block *b, const unsigned v[3], skf_vec3 x, const view *w, double num) {
  const skf_vec3 *p = w->d + v[0], *q = w->d + v[1], *s = w->d + v[2];
  double r0 = w->r[v[0]], r1 = w->r[v[1]], r2 = w->r[v[2]], cube = r0 * r1 * r2;
  double den = cube + v3_dot(*p, *q) * r2 + v3_dot(*q, *s) * r0 + v3_dot(*s, *p) * r1;
  double least = fmin(r0, fmin(r1, r2)), squares = r0 * r0 + r1 * r1 + r2 * r2;
  if (num * num + den * den > SKF_SOLID_FACE_NEAR * (cube * cube) && least * least > SKF_SOLID_CORNER_NEAR * squares)
    return num == 0 ? 0 : 2 * atan2(num, den);
  return skf_solid_face_angle(skf_solid_block_vertex(b, v[0]), skf_solid_block_vertex(b, v[1]),
                              skf_solid_block_vertex(b, v[2]), x);
}

/* out[9]: the sum of the solid angles, 4 pi inside */
static void add_faces(const skf_solid_block *b, skf_vec3 x, const view *w, double out[SKF_SOLID_OUT]) {
  const double *f = b->face;
  size_t room = b->face_room;
  for (size_t i = 0; i < b->faces; i++, f++) {
    const unsigned v[3] = {b->corners[i], b->corners[room + i], b->corners[2 * room + i]};
    skf_vec3 n = v3(f[0], f[SKF_FACE_NY * room], f[SKF_FACE_NZ * room]);
    double z = v3_dot(n, w->d[v[0]]), omega = face_angle(b, v, x, w, z * f[SKF_FACE_TWICE * room]), zo = z * omega;
    out[0] -= zo * z;
    out[1] += zo * n.x, out[2] += zo * n.y, out[3] += zo * n.z;
    out[4] -= omega * n.x * n.x, out[5] -= omega * n.x * n.y, out[6] -= omega * n.x * n.z;
    out[7] -= omega * n.y * n.y, out[8] -= omega * n.y * n.z, out[9] += omega;
  }
}

static void near_point(const skf_solid *s, skf_vec3 x, double out[SKF_SOLID_OUT]) {
  double low[SKF_SOLID_OUT] = {0};
  view w;
  for (int k = 0; k < SKF_SOLID_OUT; k++) out[k] = 0;
  for (size_t j = 0; j < s->block_count; j++) {
    const skf_solid_block *b = s->blocks + j;
    double part[SKF_SOLID_OUT] = {0};
    for (unsigned i = 0; i < b->vertices; i++) {
      w.d[i] = v3_sub(skf_solid_block_vertex(b, i), x);
      w.r[i] = v3_norm(w.d[i]);
    }
    add_edges(b, x, &w, part);
    add_faces(b, x, &w, part);
    for (int k = 0; k < SKF_SOLID_OUT; k++) sum_add_to(out + k, low + k, part[k]);
  }
  for (int k = 0; k < SKF_SOLID_OUT; k++) out[k] += low[k];
  out[0] *= 0.5;
  out[9] = -(out[4] + out[7] + out[9]); /* zz, since the trace is minus that sum */
}

/* I_nm = P_n I_mm with P_m = 1, r^2 P_n+1 = (2 n + 1) z P_n - (n^2 - m^2) P_n-1. */
static void far_point(const skf_solid *s, skf_vec3 d, double r, double out[SKF_SOLID_OUT]) {
  double per = 1 / s->radius, x = per * d.x, y = per * d.y, z = per * d.z, inv = 1 / (x * x + y * y + z * z);
  double re = sqrt(inv), im = 0;
  int degree = s->degree;
  const double *row = s->moments;
  for (int k = 1; k < SKF_SOLID_BANDS; k++)
    if (r >= s->band[k]) degree = s->degrees[k];
  for (int k = 0; k < SKF_SOLID_OUT; k++) out[k] = 0;
  for (int m = 0; m <= degree; m++) {
    double now = 1, last = 0, sum[SKF_SOLID_FAR_COLUMNS] = {0};
    for (int n = m; n <= degree; n++) {
      const double *c = row + (n - m) * SKF_SOLID_FAR_COLUMNS;
      for (int k = 0; k < SKF_SOLID_FAR_COLUMNS; k++) sum[k] += c[k] * now;
      double next = ((2 * n + 1) * z * now - (n * n - m * m) * last) * inv;
      last = now, now = next;
    }
    for (int k = 0; k < 9; k++) out[k] += sum[2 * k] * re + sum[2 * k + 1] * im;
    double u = (2 * m + 1) * inv * (x * re - y * im);
    im = (2 * m + 1) * inv * (x * im + y * re), re = u;
    row += (s->degree - m + 1) * SKF_SOLID_FAR_COLUMNS;
  }
  out[0] *= s->radius * s->radius;
  for (int k = 1; k < 4; k++) out[k] *= s->radius;
  out[9] = -(out[4] + out[7]);
}

static void point(const skf_solid *s, skf_vec3 x, bool hessian, double out[SKF_SOLID_OUT]) {
  skf_vec3 d = v3_sub(x, s->info.center);
  double r = v3_norm(d);
  (void)hessian;
  if (r >= s->far)
    far_point(s, d, r, out);
  else
    near_point(s, x, out);
}

static void points(const skf_solid *s, size_t n, const double *const p[3], bool hessian,
                   double out[SKF_SOLID_OUT][SKF_SOLID_POINTS]) {
  for (size_t i = 0; i < n; i++) {
    double v[SKF_SOLID_OUT];
    point(s, v3(p[0][i], p[1][i], p[2][i]), hessian, v);
    for (int k = 0; k < SKF_SOLID_OUT; k++) out[k][i] = v[k];
  }
}

const skf_solid_ops skf_solid_scalar = {points, point};

const skf_solid_ops *skf_solid_ops_get(skf_isa isa) {
#ifdef SKF_HAVE_AVX2
  if (isa != SKF_ISA_SCALAR) return &skf_solid_avx2;
#endif
  (void)isa;
  return &skf_solid_scalar;
}

void skf_solid_inverse(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double out[SKF_SOLID_OUT];
  e->plan.solid->point(e->primitive.solid, x, order > 1, out);
  v->F = out[0];
  v->g = v3(out[1], out[2], out[3]);
  /* xx, xy, xz, yy, yz, zz */
  for (int k = 0; order > 1 && k < 6; k++) v->h[k] = out[4 + k];
}
