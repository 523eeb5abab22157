/* SPDX-License-Identifier: MIT */
/* The search for contacts on its own, along a parabola or a straight line. */
#include "motion/contact.h"
#include "motion/scout.h"
#include "motion/view.h"
#include <stdint.h>

/* x(s) = p(t0 + s h) */
static skf_path parabola(const skf_ballistic *m, double t0, double h) {
  double u = t0 - m->t;
  skf_vec3 v = v3_mad(m->velocity, u, m->acceleration);
  skf_path p = {.t0 = {t0, 0}, .h = h, .degree = 2, .v0 = v};
  p.x0 = v3_mad(v3_mad(m->position, u, m->velocity), 0.5 * u * u, m->acceleration);
  p.x[0] = v3_scale(h, v), p.x[1] = v3_scale(0.5 * h * h, m->acceleration);
  p.v[0] = v3_scale(h, m->acceleration);
  return p;
}

static void describe(const skf_world *w, const skf_path *p, const skf_touch *at, skf_contact *c) {
  const skf_world_body *b = w->bodies + at->body;
  skf_clock t = clock_add(p->t0, at->s * p->h);
  *c = (skf_contact){.t = t.hi, .body = at->body, .position = skf_path_position(p, at->s)};
  c->before = c->after = skf_path_velocity(p, at->s);
  c->normal = skf_contact_normal(b, t, c->position);
}

skf_status skf_world_touch(const skf_world *w, const skf_ballistic *m, double t0, double t1, skf_search how,
                           skf_touching *touching, skf_contact *contact, size_t *grazing) {
  *touching = SKF_TOUCHING_NONE;
  if (!isfinite(m->t) || !isfinite(t0) || !isfinite(t1) || !(t0 <= t1)) return SKF_ERR_RANGE;
  if (!v3_finite(m->position) || !v3_finite(m->velocity) || !v3_finite(m->acceleration)) return SKF_ERR_RANGE;
  if ((unsigned)how > SKF_SEARCH_FAST) return SKF_ERR_ARG;
  if (how == SKF_SEARCH_CERTIFIED && !skf_world_has_bound(w)) return SKF_ERR_UNSUPPORTED;
  skf_status s = skf_scout_send(w);
  if (s) return s;
  double origin = fmin(m->t, t0); /* the same for all t0 after the motion's own time */
  skf_path p = parabola(m, origin, t1 > origin ? t1 - origin : 1);
  double from = (t0 - origin) / p.h, to = t1 > origin ? 1 : 0;
  skf_search_report report = {0, 0};
  skf_vec3 start = skf_path_position(&p, from);
  skf_hunt hunt = {&p, from, to, skf_contact_born(w, (skf_clock){t0, 0}, start), -1, how == SKF_SEARCH_FAST};
  skf_touch at = skf_contact_find(w, &hunt, &report);
  if (grazing) *grazing += report.grazing;
  if (!at.found) return SKF_OK;
  *touching = at.s <= from ? SKF_TOUCHING_AT_START : SKF_TOUCHING_LATER;
  if (contact) describe(w, &p, &at, contact);
  return SKF_OK;
}
