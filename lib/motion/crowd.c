/* SPDX-License-Identifier: MIT */
#include "motion/crowd.h"
#include <string.h>

static bool eval(const skf_crowd *c, skf_clock t, bool listen) {
  return c->eval(c->user, t, c->x, c->drags ? c->v : NULL, c->a, listen ? c->noise : NULL);
}

static bool eval_at(skf_crowd *c, skf_orbit *const *at, bool listen) {
  for (size_t i = 0; i < c->n; i++) c->x[i] = v3_add(at[i]->x, at[i]->x_low), c->v[i] = v3_add(at[i]->v, at[i]->v_low);
  return eval(c, at[0]->t, listen);
}

skf_status skf_crowd_begin(skf_crowd *c, double h) {
  if (c->n == 0) return SKF_OK;
  if (!eval_at(c, c->orbit, true)) return SKF_ERR_CONVERGENCE;
  for (size_t i = 0; i < c->n; i++) {
    memset(c->work[i], 0, sizeof *c->work[i]);
    c->work[i]->h = h, c->work[i]->a0 = c->a[i], c->work[i]->noise = c->noise[i];
  }
  return SKF_OK;
}

/* One sweep over the nodes. False where the force is not finite. */
static bool sweep(skf_crowd *c, double h) {
  for (size_t i = 0; i < c->n; i++) c->guess[i].size = skf_radau_size(c->work[i]->a0);
  for (int n = 1; n < SKF_RADAU_NODES; n++) {
    bool listen = skf_radau_listens(n);
    for (size_t i = 0; i < c->n; i++) c->ops->place(c->guess + i, h, n, c->x + i, c->drags ? c->v + i : NULL);
    if (!eval(c, clock_add(c->work[0]->from.t, h * skf_radau_node[n]), listen)) return false;
    for (size_t i = 0; i < c->n; i++) skf_radau_learn(c->work[i], n, c->a[i], listen ? c->noise[i] : 0, c->guess + i);
  }
  return true;
}

/* The same as for one particle, once the slowest has settled. */
static bool solve(skf_crowd *c, double h) {
  double last = INFINITY;
  bool settled = false, will_do = false;
  for (int k = 0; k < SKF_RADAU_SWEEPS && !settled; k++) {
    if (!sweep(c, h)) return false;
    double change = 0;
    settled = will_do = true;
    for (size_t i = 0; i < c->n; i++) {
      const skf_radau_guess *u = c->guess + i;
      if (skf_radau_settled(u)) continue;
      settled = false, will_do = will_do && skf_radau_will_do(c->work[i], u);
      change = fmax(change, u->change / u->size);
    }
    if (k > 1 && change >= last) return will_do;
    last = change;
  }
  return settled || last <= 1e-9;
}

/* One attempt. Returns the share of h that would meet the tolerance; below SKF_RADAU_REFUSE nothing has moved. */
static double attempt(skf_crowd *c, double h, double tolerance) {
  double q = 4;
  for (size_t i = 0; i < c->n; i++) {
    c->work[i]->from = *c->orbit[i];
    c->before[i] = *c->work[i];
    skf_radau_predict(c->ops, c->work[i], h, c->guess + i);
  }
  bool solved = solve(c, h);
  for (size_t i = 0; i < c->n && solved; i++) q = fmin(q, skf_radau_share(c->work[i], c->guess + i, h, tolerance));
  if (!solved || q < SKF_RADAU_REFUSE) q = solved ? fmax(q, 0.1) : 0.25;
  bool good = solved && q >= SKF_RADAU_REFUSE;
  for (size_t i = 0; i < c->n && good; i++) skf_radau_finish(c->work[i], c->guess + i, h, c->orbit[i]);
  if (good && !eval_at(c, c->orbit, false)) good = false, q = 0.25;
  for (size_t i = 0; i < c->n && good; i++) {
    good = skf_radau_meets(c->work[i], h, c->guess[i].size, tolerance, c->a[i]);
    if (!good) q = 0.25;
  }
  for (size_t i = 0; i < c->n; i++) {
    if (good) c->work[i]->a0 = c->a[i];
    if (!good) *c->work[i] = c->before[i], *c->orbit[i] = c->before[i].from;
  }
  return q;
}

skf_status skf_crowd_step(skf_crowd *c, double tolerance, double h_max, size_t *rejected) {
  if (c->n == 0) return SKF_OK;
  double h = fmin(c->work[0]->h, h_max);
  for (;; (*rejected)++) {
    if (!(h > skf_step_floor(c->orbit[0]->t)) || !isfinite(h)) return SKF_ERR_CONVERGENCE;
    double q = attempt(c, h, tolerance);
    h *= q;
    if (q < SKF_RADAU_REFUSE) continue;
    for (size_t i = 0; i < c->n; i++) c->work[i]->h = h;
    return SKF_OK;
  }
}
