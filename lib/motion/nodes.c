/* SPDX-License-Identifier: MIT */
/* Gauss's rules over skeletons: where their mass is. */
#include "core/alloc.h"
#include "motion/swarm.h"
#include "num/gauss.h"

enum { ALONG = 16, AROUND = 32, ACROSS = 8 };

static size_t count(const skf_element *e) {
  switch (e->primitive.shape) {
  case SKF_POINT: return 1;
  case SKF_SEGMENT: return ALONG;
  case SKF_ARC: return AROUND;
  case SKF_TRIANGLE: return ACROSS * ACROSS;
  default: return 0;
  }
}

/* Nodes on [0, 1]^2; for triangles s, t map to vertices by 1 - s, s (1 - t), s t, of weight 2 s. */
static void place(const skf_mover *m, const skf_element *e, skf_node *out) {
  const skf_primitive *p = &e->primitive;
  size_t n = count(e), rule = p->shape == SKF_TRIANGLE ? ACROSS : n;
  double total = m->is.density * e->strength * skf_primitive_measure(p);
  const skf_gauss_node *g = skf_gauss_rule((int)rule);
  for (size_t i = 0; i < n; i++) {
    double s = 0.5 + 0.5 * g[i % rule].x, w = n > 1 ? 0.5 * g[i % rule].w : 1;
    skf_vec3 at;
    if (p->shape == SKF_TRIANGLE) {
      const skf_vec3 *v = p->triangle.vertices;
      double t = 0.5 + 0.5 * g[i / rule].x;
      w *= 0.5 * g[i / rule].w * 2 * s;
      at = v3_mad(v3_mad(v3_scale(1 - s, v[0]), s * (1 - t), v[1]), s * t, v[2]);
    } else {
      at = skf_primitive_point(p, s, 0);
      if (e->profile) w *= skf_profile_at(e->profile, s);
    }
    out[i] = (skf_node){v3_sub(at, m->center), total * w};
  }
}

skf_status skf_mover_place_nodes(skf_mover *m) {
  size_t n = 0;
  for (size_t i = 0; i < skf_field_size(m->is.field); i++) {
    const skf_element *e = skf_field_element(m->is.field, i);
    if (m->free && (!count(e) || e->kernel.type == SKF_USER_KERNEL)) return SKF_ERR_UNSUPPORTED;
    n += count(e);
  }
  m->node = skf_alloc(n, sizeof *m->node);
  if (!m->node) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < skf_field_size(m->is.field); i++) {
    const skf_element *e = skf_field_element(m->is.field, i);
    place(m, e, m->node + m->nodes);
    m->nodes += count(e);
  }
  for (size_t i = 0; i < skf_field_size(m->is.field); i++) /* what has no nodes pulls by its field alone */
    if (!count(skf_field_element(m->is.field, i))) m->nodes = 0;
  return SKF_OK;
}
