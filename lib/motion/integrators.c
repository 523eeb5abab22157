/* SPDX-License-Identifier: MIT */
/* The registry of integrators. */
#include "motion/integrator.h"
#include "motion/world.h"
#include <string.h>

static const skf_integrator_ops *const registry[] = {
    &skf_integrator_gauss_radau, &skf_integrator_dop853,     &skf_integrator_rkn12,    &skf_integrator_leapfrog,
    &skf_integrator_yoshida4,    &skf_integrator_mclachlan4, &skf_integrator_hermite4, &skf_integrator_yoshida6,
    &skf_integrator_kahan_li6,   &skf_integrator_yoshida8,   &skf_integrator_kahan_li8};

size_t skf_integrator_count(void) { return sizeof registry / sizeof *registry; }

const skf_integrator_info *skf_integrator_get(size_t i) {
  return i < skf_integrator_count() ? &registry[i]->info : NULL;
}

const skf_integrator_ops *skf_integrator_row(const char *name) {
  if (!name || !*name) return registry[0];
  for (size_t i = 0; i < skf_integrator_count(); i++)
    if (strcmp(registry[i]->info.name, name) == 0) return registry[i];
  return NULL;
}

const skf_integrator_info *skf_integrator_find(const char *name) {
  const skf_integrator_ops *row = skf_integrator_row(name);
  return row ? &row->info : NULL;
}

bool skf_integrator_takes(const char *name, const skf_force *force) {
  const skf_integrator_ops *row = skf_integrator_row(name);
  return row && row->takes >= (skf_force_drags(force) ? SKF_TAKES_DRAG : SKF_TAKES_PUSH);
}
