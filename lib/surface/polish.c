/* SPDX-License-Identifier: MIT */
/* Puts points onto the surface, many at a time. */
#include "surface/mesher.h"
#include <float.h>

enum { BLOCK = 4096 }; /* points in flight: enough for the field's own threads, small enough for the cache */

skf_status skf_sample(const skf_field *field, size_t n, const skf_vec3 *at, double *F, skf_vec3 *g) {
  double *work = skf_alloc(7 * (size_t)BLOCK, sizeof *work);
  if (!work) return SKF_ERR_NOMEM;
  double *x = work, *y = x + BLOCK, *z = y + BLOCK, *f = z + BLOCK;
  double *const grad[3] = {f + BLOCK, f + 2 * BLOCK, f + 3 * BLOCK};
  skf_status s = SKF_OK;
  for (size_t i = 0; i < n && !s; i += BLOCK) {
    size_t k = n - i < BLOCK ? n - i : BLOCK;
    for (size_t j = 0; j < k; j++) x[j] = at[i + j].x, y[j] = at[i + j].y, z[j] = at[i + j].z;
    s = skf_field_eval(field, k, (const double *const[3]){x, y, z}, f, g ? grad : NULL, NULL);
    for (size_t j = 0; j < k && !s; j++) {
      if (F) F[i + j] = f[j];
      if (g) g[i + j] = v3(grad[0][j], grad[1][j], grad[2][j]);
    }
  }
  skf_free(work);
  return s;
}

/* One root in flight: t runs from 0 (inside) to 1 (outside). */
typedef struct root {
  size_t i; /* which segment */
  double lo, hi, t, step, best, best_f;
} root;

static double size_of(skf_vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* Takes in f and its slope at t and chooses the next t; false when done. Newton inside the bracket, else halving. */
static bool advance(root *r, double f, double slope, double floor_t) {
  if (fabs(f) < r->best_f) r->best_f = fabs(f), r->best = r->t;
  if (f == 0) return false;
  if (f > 0)
    r->lo = r->t;
  else
    r->hi = r->t;
  double next = r->t - f / slope, move = fabs(next - r->t);
  if (!(slope < 0) || !(next > r->lo && next < r->hi) || !(move < 0.6 * r->step)) {
    if (slope < 0 && move <= floor_t) return false; /* as near as rounding allows */
    next = 0.5 * (r->lo + r->hi);
    move = 0.5 * (r->hi - r->lo);
  }
  if (next == r->t || r->hi - r->lo <= floor_t || !(next > r->lo && next < r->hi)) return false;
  r->step = move;
  r->t = next;
  return true;
}

skf_status skf_polish_segments(const skf_field *field, double iso, size_t n, const skf_vec3 *in, const skf_vec3 *out,
                               skf_vec3 *at) {
  root *roots = skf_alloc(n, sizeof *roots);
  skf_vec3 *p = skf_alloc(n, sizeof *p), *g = skf_alloc(n, sizeof *g);
  double *F = skf_alloc(n, sizeof *F);
  skf_status s = roots && p && g && F ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < n && !s; i++) roots[i] = (root){i, 0, 1, 0.5, 1, 0.5, INFINITY};
  size_t live = n;
  while (live && !s) {
    for (size_t k = 0; k < live; k++) {
      const root *r = roots + k;
      p[k] = v3_mad(in[r->i], r->t, v3_sub(out[r->i], in[r->i]));
    }
    s = skf_sample(field, live, p, F, g);
    size_t left = 0;
    for (size_t k = 0; k < live && !s; k++) {
      root *r = roots + k;
      skf_vec3 d = v3_sub(out[r->i], in[r->i]);
      double floor_t = DBL_EPSILON * (size_of(in[r->i]) + size_of(d)) / size_of(d);
      if (advance(r, F[k] - iso, v3_dot(g[k], d), floor_t))
        roots[left++] = *r;
      else
        at[r->i] = v3_mad(in[r->i], r->best, d);
    }
    live = left;
  }
  skf_free(roots), skf_free(p), skf_free(g), skf_free(F);
  return s;
}

skf_status skf_polish_points(const skf_field *field, double iso, double reach, size_t n, skf_vec3 *at,
                             signed char *moved) {
  skf_vec3 *p = skf_alloc(n, sizeof *p), *g = skf_alloc(n, sizeof *g);
  double *F = skf_alloc(n, sizeof *F);
  size_t *who = skf_alloc(n, sizeof *who), live = n;
  skf_status s = p && g && F && who ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < n && !s; i++) p[i] = at[i], who[i] = i, moved[i] = 0;
  for (int k = 0; k < 8 && live && !s; k++) {
    s = skf_sample(field, live, p, F, g);
    size_t left = 0;
    for (size_t j = 0; j < live && !s; j++) {
      double g2 = v3_norm2(g[j]), f = F[j] - iso;
      skf_vec3 q = v3_mad(p[j], -f / g2, g[j]);
      if (!isfinite(f) || !(g2 > 0) || !v3_finite(q) || !(v3_dist(q, at[who[j]]) < reach)) continue;
      if (fabs(f) <= 4 * DBL_EPSILON * fmax(fabs(iso), size_of(p[j]) * sqrt(g2))) {
        at[who[j]] = p[j], moved[who[j]] = 1;
        continue;
      }
      p[left] = q, who[left++] = who[j];
    }
    live = left;
  }
  skf_free(p), skf_free(g), skf_free(F), skf_free(who);
  return s;
}
