/* SPDX-License-Identifier: MIT */
#include "motion/scout.h"
#include "core/alloc.h"
#include "ray/walk.h"
#include <omp.h>
#include <stdatomic.h>

struct skf_scout {
  omp_lock_t lock;
  atomic_bool sent;
  size_t n;
  skf_tracer *tracers[]; /* NULL: of no use */
};

skf_scout *skf_scout_new(size_t bodies) {
  skf_scout *s = skf_alloc(1, sizeof *s + bodies * sizeof *s->tracers);
  if (!s) return NULL;
  omp_init_lock(&s->lock);
  s->n = bodies;
  return s;
}

void skf_scout_free(skf_scout *s) {
  if (!s) return;
  for (size_t i = 0; i < s->n; i++) skf_tracer_free(s->tracers[i]);
  omp_destroy_lock(&s->lock);
  skf_free(s);
}

static skf_status make(const skf_world_body *b, skf_tracer **out) {
  if (!b->surface || !b->bounds) return SKF_OK;
  skf_status s = skf_tracer_new(b->is.field, b->is.iso, out);
  if (s || (*out)->tree) return s;
  skf_tracer_free(*out); /* nothing that its bounds could tell beforehand */
  return *out = NULL, SKF_OK;
}

skf_status skf_scout_send(const skf_world *w) {
  skf_scout *s = w->scout;
  skf_status bad = SKF_OK;
  if (atomic_load_explicit(&s->sent, memory_order_acquire)) return SKF_OK;
  omp_set_lock(&s->lock);
  if (!atomic_load_explicit(&s->sent, memory_order_relaxed)) {
    for (size_t i = 0; i < s->n && !bad; i++)
      if (!s->tracers[i]) bad = make(w->bodies + i, s->tracers + i);
    if (!bad) atomic_store_explicit(&s->sent, true, memory_order_release);
  }
  omp_unset_lock(&s->lock);
  return bad;
}

const skf_tracer *skf_scout_tracer(const skf_world *w, size_t body) {
  return atomic_load_explicit(&w->scout->sent, memory_order_acquire) ? w->scout->tracers[body] : NULL;
}
