/* SPDX-License-Identifier: MIT */
/* The registry of kernels. */
#include "field/extreme.h"
#include "field/profiled.h"
#include "field/quadrature.h"
#include "field/simple.h"
#include <string.h>

static const skf_kernel_ops *const registry[SKF_KERNEL_COUNT] = {
    [SKF_CAUCHY] = &skf_kernel_cauchy,     [SKF_GAUSSIAN] = &skf_kernel_gaussian,
    [SKF_INVERSE] = &skf_kernel_inverse,   [SKF_INVERSE_SQUARED] = &skf_kernel_inverse_squared,
    [SKF_METABALL] = &skf_kernel_metaball, [SKF_SOFT_OBJECT] = &skf_kernel_soft_object,
    [SKF_QUARTIC] = &skf_kernel_quartic,
};

const skf_kernel_ops *skf_kernel_row(skf_kernel_type type) {
  return (unsigned)type < SKF_KERNEL_COUNT ? registry[type] : type == SKF_USER_KERNEL ? &skf_kernel_user : NULL;
}

const skf_kernel_info *skf_kernel_get(skf_kernel_type type) {
  return (unsigned)type < SKF_KERNEL_COUNT ? &registry[type]->info : NULL;
}

skf_kernel_type skf_kernel_find(const char *name) {
  int k = 0;
  while (k < SKF_KERNEL_COUNT && strcmp(registry[k]->info.name, name) != 0) k++;
  return (skf_kernel_type)k;
}

bool skf_kernel_singular(skf_kernel k) {
  return k.type == SKF_USER_KERNEL ? k.user->singular : registry[k.type]->info.singular;
}

double skf_kernel_end(skf_kernel k) {
  if (k.type == SKF_USER_KERNEL) return k.user->radius > 0 ? k.user->radius : INFINITY;
  return registry[k.type]->info.compact ? k.param : INFINITY;
}

int skf_kernel_breaks(skf_kernel k, double radii[SKF_KERNEL_BREAKS]) {
  int n = 0;
  if (k.type == SKF_USER_KERNEL)
    for (; n < k.user->break_count; n++) radii[n] = k.user->breaks[n];
  else if (k.type == SKF_METABALL)
    radii[n++] = k.param / 3;
  if (skf_kernel_end(k) < INFINITY) radii[n++] = skf_kernel_end(k);
  return n;
}

void skf_element_value(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_closed closed = skf_kernel_row(e->kernel.type)->closed[e->primitive.shape];
  if (closed && e->weight) closed = skf_profiled;
  if (e->primitive.shape == SKF_PLANE) x = skf_plane_seen(e, x, e->primitive.plane.through);
  (closed ? closed : skf_quadrature)(e, x, order, v);
  double sum = v->F + (v->g.x + v->g.y + v->g.z);
  for (int k = 0; k < 6 && order > 1; k++) sum += v->h[k];
  bool near = fmax(fabs(x.x), fmax(fabs(x.y), fabs(x.z))) < 1e50; /* of Cauchy's planes F falls like z^-2 only */
  near |= e->kernel.type == SKF_CAUCHY && e->primitive.shape == SKF_PLANE;
  if (!(e->moderate && near && fabs(sum) < INFINITY) && e->scalable && !e->weight) skf_extreme_value(e, x, order, v);
}

skf_pair_info skf_pair_get(skf_kernel_type kernel, skf_shape shape) {
  const skf_kernel_ops *row = skf_kernel_row(kernel);
  if (!row || (unsigned)shape >= SKF_SHAPE_COUNT) return (skf_pair_info){false, 0, NULL};
  bool closed = row->closed[shape] != NULL;
  return (skf_pair_info){closed, closed ? 1e-12 : 1e-10, row->singular[shape]};
}
