/* SPDX-License-Identifier: MIT */
/* The Gaussian of triangles whose edge sums cancel: an error function per slice, Gauss-Legendre across the slices. */
#include "field/triangle_gaussian.h"

/* 17 for each slice end, 2 x 20 for each side edge (a^2 l^2 grows by 2.5 a step up to 45), 3 more. */
#define MAX_BREAKS 128

typedef struct strips {
  double a, z, d, l1, l2, apex, L, height;
  double reach;  /* in the plane; beyond it nothing is left */
  double e0, e1; /* of the coordinate eta across the slices, 0 at the longest edge */
  int count;
  double at[MAX_BREAKS];
} strips;

static void cut(strips *s, double eta) {
  if (!(eta > s->e0 && eta < s->e1) || s->count == MAX_BREAKS - 1) return;
  int i = s->count++;
  for (; i > 1 && s->at[i - 1] > eta; i--) s->at[i] = s->at[i - 1];
  s->at[i] = eta;
}

/* Where a slice's end passes through the error function's step. */
static void cut_end(strips *s, double start) {
  double slope = (s->apex - start) / s->height;
  if (slope == 0) return;
  for (int j = -8; j <= 8; j++) cut(s, (0.85 * j / s->a - start) / slope);
}

/* Where the exponent has changed by a few along a side edge. `left`: it ends at the start of the longest edge. */
static void cut_side(strips *s, const skf_triangle_view *g, int edge, bool left) {
  double near = skf_edge_nearest(g->l1[edge], g->l2[edge]), a = s->a, X = near;
  if (near > s->reach) return;
  while (a * a * (X - near) * (X + near) < 45) {
    for (int sign = -1; sign <= 1; sign += 2) {
      double l = sign * X, along = left ? g->l2[edge] - l : l - g->l1[edge];
      cut(s, s->height * along / g->T->L[edge]);
    }
    X += 0.9 / a / fmax(1, 0.7 * a * X);
  }
}

typedef struct moments {
  double F, Y, YY, t, tt, tY; /* of h: 1, Y, Y^2 over the area; over the ends: h, x h, Y h, right less left */
} moments;

static void slice(const strips *s, double eta, double w, moments *m) {
  double a2 = s->a * s->a, Y = eta - s->d, c2 = Y * Y + s->z * s->z;
  double xl = s->l1 + (s->apex - s->l1) * (eta / s->height), len = s->L * (1 - eta / s->height), xr = xl + len;
  double F = w * skf_gaussian_segment(s->a, c2, xl, xr);
  double hl = exp(-a2 * (c2 + xl * xl)), r1 = s->a * sqrt(c2 + xl * xl), r2 = s->a * sqrt(c2 + xr * xr);
  double step = a2 * len * (xl + xr), diff = w * skf_gaussian_difference(r1, r2, step);
  m->F += F;
  m->Y += Y * F;
  m->YY += Y * Y * F;
  m->t += diff;
  m->tY += Y * diff;
  m->tt += fabs(step) < 1 ? xr * diff + w * len * hl : w * (xr * exp(-r2 * r2) - xl * hl);
}

static void set_up(strips *s, double a, const skf_triangle_view *g) {
  const skf_triangle_plan *T = g->T;
  int i = T->longest;
  *s = (strips){
      .a = a, .z = g->z, .d = g->d[i], .l1 = g->l1[i], .l2 = g->l2[i], .apex = skf_triangle_apex(g), .L = T->diam};
  s->height = T->twice / T->diam;
  s->reach = sqrt(g->lat * g->lat + 42 / (a * a));
  s->e0 = fmax(0, s->d - s->reach);
  s->e1 = fmin(s->height, s->d + s->reach);
  s->at[0] = s->e0;
  s->count = 1;
  cut_end(s, s->l1);
  cut_end(s, s->l2);
  cut_side(s, g, (i + 2) % 3, true);
  cut_side(s, g, (i + 1) % 3, false);
  cut(s, s->d);
  s->at[s->count] = s->e1;
}

void skf_gaussian_strips(double a, const skf_triangle_view *g, int order, skf_value *v) {
  strips s;
  moments m = {0};
  const skf_gauss_node *rule = skf_gauss_rule(16);
  set_up(&s, a, g);
  for (int i = 0; i < s.count && s.e1 > s.e0; i++) {
    double u = s.at[i], h = s.at[i + 1] - u, a2 = a * a, Y = fmax(fabs(u - s.d), fabs(u + h - s.d));
    int count = (int)fmax(1, ceil(fmax(a * h / 1.5, fmin(a2 * Y * h / 4, 15))));
    h /= count;
    for (int k = 0; k < count; k++)
      for (int j = 0; j < 16; j++) slice(&s, u + h * (k + 0.5 + 0.5 * rule[j].x), 0.5 * h * rule[j].w, &m);
  }
  const skf_triangle_plan *T = g->T;
  double a2 = a * a, z = g->z, gt = -m.t, gm = -2 * a2 * m.Y;
  skf_vec3 t = T->t[T->longest], mm = T->m[T->longest];
  v->F = m.F;
  v->g = v3_add(v3_scale(gt, t), v3_add(v3_scale(gm, mm), v3_scale(-2 * a2 * z * m.F, T->n)));
  if (order < 2) return;
  double zm = 2 * a2 * (2 * a2 * z * z - 1);
  skf_triangle_rotate(T,
                      (double[]){-2 * a2 * m.tt, 2 * a2 * m.tY, -2 * a2 * z * gt, 4 * a2 * a2 * m.YY - 2 * a2 * m.F,
                                 -2 * a2 * z * gm, zm * m.F},
                      v->h);
}
