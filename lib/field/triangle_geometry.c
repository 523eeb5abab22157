/* SPDX-License-Identifier: MIT */
#include "field/triangle_parts.h"

static skf_vec3 over(skf_dd3 a, double b) { return v3(a.x.hi / b, a.y.hi / b, a.z.hi / b); }

void skf_triangle_prepare(const skf_triangle *triangle, skf_triangle_plan *T) {
  for (int i = 0; i < 3; i++) {
    T->v[i] = triangle->vertices[i];
    T->e[i] = dd3_diff(triangle->vertices[(i + 1) % 3], triangle->vertices[i]);
    T->L[i] = sqrt(dd3_dot(T->e[i], T->e[i]).hi);
    T->t[i] = over(T->e[i], T->L[i]);
  }
  T->N = dd3_cross(T->e[0], T->e[1]);
  T->twice = sqrt(dd3_dot(T->N, T->N).hi);
  T->area = 0.5 * T->twice;
  T->per_N = 1 / T->twice;
  T->n = over(T->N, T->twice);
  T->longest = 0;
  for (int i = 0; i < 3; i++) {
    T->m[i] = v3_cross(T->t[i], T->n);
    T->M[i] = dd3_cross(T->e[i], T->N);
    T->per_L[i] = 1 / T->L[i];
    T->per_M[i] = T->per_N * T->per_L[i];
    if (T->L[i] > T->L[T->longest]) T->longest = i;
  }
  int i = T->longest, j = (i + 1) % 3, k = (i + 2) % 3;
  T->diam = T->L[i];
  T->c[i] = 1, T->s[i] = 0;
  T->c[j] = dd3_dot(T->e[i], T->e[j]).hi / (T->L[i] * T->L[j]);
  T->s[j] = -T->twice / (T->L[i] * T->L[j]);
  T->c[k] = dd3_dot(T->e[i], T->e[k]).hi / (T->L[i] * T->L[k]);
  T->s[k] = T->twice / (T->L[i] * T->L[k]);
}

double skf_triangle_distance(const skf_vec3 a[3]) {
  skf_vec3 ab = v3_sub(a[1], a[0]), ac = v3_sub(a[2], a[0]);
  double d1 = -v3_dot(ab, a[0]), d2 = -v3_dot(ac, a[0]);
  if (d1 <= 0 && d2 <= 0) return v3_norm(a[0]);
  double d3 = -v3_dot(ab, a[1]), d4 = -v3_dot(ac, a[1]);
  if (d3 >= 0 && d4 <= d3) return v3_norm(a[1]);
  double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return v3_norm(v3_mad(a[0], d1 / (d1 - d3), ab));
  double d5 = -v3_dot(ab, a[2]), d6 = -v3_dot(ac, a[2]);
  if (d6 >= 0 && d5 <= d6) return v3_norm(a[2]);
  double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return v3_norm(v3_mad(a[0], d2 / (d2 - d6), ac));
  double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6)
    return v3_norm(v3_mad(a[1], (d4 - d3) / ((d4 - d3) + (d5 - d6)), v3_sub(a[2], a[1])));
  double sum = va + vb + vc;
  if (!(sum > 0)) return fmin(v3_norm(a[0]), fmin(v3_norm(a[1]), v3_norm(a[2])));
  return v3_norm(v3_mad(v3_mad(a[0], vb / sum, ab), vc / sum, ac));
}

void skf_triangle_face(const skf_triangle_plan *T, skf_vec3 x, skf_triangle_view *g) {
  g->T = T;
  g->nearest = 0;
  g->reach = 0;
  for (int i = 0; i < 3; i++) {
    g->a2[i] = dd3_diff(T->v[i], x);
    g->a[i] = dd3_round(g->a2[i]);
    g->r[i] = v3_norm(g->a[i]);
    g->reach = fmax(g->reach, g->r[i]);
    if (g->r[i] < g->r[g->nearest]) g->nearest = i;
  }
  g->dist = skf_triangle_distance(g->a);
}

/* How far the origin is from the interval of three numbers. */
static double outside(double a, double b, double c) { return fmax(0, fmax(fmin(a, fmin(b, c)), -fmax(a, fmax(b, c)))); }

bool skf_triangle_clear(const skf_triangle_view *g, double distance) {
  const skf_vec3 *a = g->a;
  double x = outside(a[0].x, a[1].x, a[2].x), y = outside(a[0].y, a[1].y, a[2].y), z = outside(a[0].z, a[1].z, a[2].z);
  return x * x + y * y + z * z > distance * distance * (1 + 1e-12);
}

void skf_triangle_look(skf_triangle_view *g) {
  const skf_triangle_plan *T = g->T;
  g->z = -dd3_dot_round(T->N, g->a2[g->nearest]) * T->per_N;
  g->inside = true;
  double lat2 = INFINITY;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    bool first = g->r[i] <= g->r[j];
    const skf_dd3 *near = g->a2 + (first ? i : j);
    double l = dd3_dot_round(T->e[i], *near) * T->per_L[i];
    g->l1[i] = first ? l : l - T->L[i];
    g->l2[i] = first ? l + T->L[i] : l;
    g->d[i] = dd3_dot_round(T->M[i], *near) * T->per_M[i];
    if (g->d[i] < 0) g->inside = false;
    double beyond = skf_edge_nearest(g->l1[i], g->l2[i]);
    lat2 = fmin(lat2, g->d[i] * g->d[i] + beyond * beyond);
  }
  g->lat = g->inside ? 0 : sqrt(lat2);
  g->dist = sqrt(g->z * g->z + g->lat * g->lat);
}

double skf_triangle_apex(const skf_triangle_view *g) {
  const skf_triangle_plan *T = g->T;
  return dd3_dot_round(T->e[T->longest], g->a2[(T->longest + 2) % 3]) / T->diam;
}

void skf_triangle_rotate(const skf_triangle_plan *T, const double b[6], double h[6]) {
  skf_vec3 t = T->t[T->longest], m = T->m[T->longest], n = T->n;
  /* rows of B F', F = [t m n] */
  skf_vec3 bt = v3_add(v3_scale(b[0], t), v3_add(v3_scale(b[1], m), v3_scale(b[2], n)));
  skf_vec3 bm = v3_add(v3_scale(b[1], t), v3_add(v3_scale(b[3], m), v3_scale(b[4], n)));
  skf_vec3 bn = v3_add(v3_scale(b[2], t), v3_add(v3_scale(b[4], m), v3_scale(b[5], n)));
  h[0] = t.x * bt.x + m.x * bm.x + n.x * bn.x;
  h[1] = t.x * bt.y + m.x * bm.y + n.x * bn.y;
  h[2] = t.x * bt.z + m.x * bm.z + n.x * bn.z;
  h[3] = t.y * bt.y + m.y * bm.y + n.y * bn.y;
  h[4] = t.y * bt.z + m.y * bm.z + n.y * bn.z;
  h[5] = t.z * bt.z + m.z * bm.z + n.z * bn.z;
}

/* A ratio for |sum| = 0: nothing was summed, or all of it cancelled. */
static double condition(double abs_sum, double size) { return size > 0 ? abs_sum / size : abs_sum > 0 ? INFINITY : 1; }

skf_triangle_cond skf_triangle_assemble(const skf_triangle_view *g, const skf_triangle_sum *s, int order,
                                        skf_value *v) {
  const skf_triangle_plan *T = g->T;
  double gt = 0, gm = 0, abs_g = s->absZ, S = fmax(T->diam, g->dist);
  for (int i = 0; i < 3; i++) {
    gt += T->s[i] * s->J[i];
    gm -= T->c[i] * s->J[i];
    abs_g += fabs(s->J[i]);
  }
  v->F = s->F;
  v->g = v3_add(v3_scale(gt, T->t[T->longest]), v3_add(v3_scale(gm, T->m[T->longest]), v3_scale(s->Z, T->n)));
  skf_triangle_cond c = {condition(s->absF, fabs(s->F)), 0, 1};
  c.g = condition(abs_g, fmax(fmax(fmax(fabs(gt), fabs(gm)), fabs(s->Z)), 1e-3 * fabs(s->F) / S));
  if (order < 2) return c;

  double b[6] = {0, 0, 0, 0, 0, s->zz}, abs_h = s->abszz, size = fabs(s->zz);
  for (int i = 0; i < 3; i++) {
    double ci = T->c[i], si = T->s[i], dk = g->d[i] * s->K[i], zk = g->z * s->K[i], jump = s->jump[i];
    /* the jumps add up to 0 around the triangle: the longest edge's is taken out of the others */
    b[0] += si * si * dk - si * ci * jump;
    b[1] -= si * ci * dk + si * si * jump;
    b[2] += si * zk;
    b[3] += ci * ci * dk + si * ci * jump;
    b[4] -= ci * zk;
    abs_h += fabs(dk) + fabs(zk) + fabs(si * jump);
  }
  for (int i = 0; i < 5; i++) size = fmax(size, fabs(b[i]));
  c.h = condition(abs_h, fmax(size, 1e-3 * fabs(s->F) / (S * S)));
  skf_triangle_rotate(T, b, v->h);
  return c;
}
