/* SPDX-License-Identifier: MIT */
#include "field/extreme.h"
#include "field/kernel.h"
#include "field/solid.h"
#include "skeleton/shape.h"

static void segment(const skf_segment *s, skf_segment_plan *out) {
  skf_dd3 e = dd3_diff(s->to, s->from);
  out->e = dd3_round(e);
  out->e_lo = v3(e.x.lo, e.y.lo, e.z.lo);
  out->length = v3_norm(out->e);
  out->a = v3(out->e.x / out->length, out->e.y / out->length, out->e.z / out->length);
}

/* a times the power of two that brings its largest coordinate into [1/2, 1) */
static skf_vec3 near_one(skf_vec3 a) {
  int power;
  frexp(fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))), &power);
  return v3(ldexp(a.x, -power), ldexp(a.y, -power), ldexp(a.z, -power));
}

static void arc(const skf_arc *a, skf_arc_plan *out) {
  skf_arc_axes axes = skf_arc_frame(a);
  out->e = axes.e, out->f = axes.f, out->n = axes.n;
  out->raw = near_one(a->normal);
  skf_dd3 n = {{out->raw.x, 0}, {out->raw.y, 0}, {out->raw.z, 0}};
  out->raw2 = dd3_dot(n, n);
  out->radius2_raw2 = dd_mul(dd_two_prod(a->radius, a->radius), out->raw2);
  out->raw_length = sqrt(out->raw2.hi);
  out->radius = a->radius;
  out->full = a->sweep >= 2 * SKF_PI;
  out->half = out->full ? SKF_PI : 0.5 * a->sweep;
  out->sin_half = out->full ? 0 : sin(out->half);
  out->cos_half = out->full ? -1 : cos(out->half);
}

static void plane(const skf_plane *p, skf_plane_plan *out) {
  out->raw = near_one(p->normal);
  out->length = v3_norm(out->raw);
  out->unit = v3_scale(1 / out->length, out->raw);
}

void skf_prepare(const skf_element *e, skf_prepared *out) {
  out->primitive = e->primitive;
  out->kernel = e->kernel;
  out->strength = e->strength;
  out->scalable = e->kernel.type < SKF_KERNEL_COUNT && e->primitive.shape <= SKF_PLANE;
  out->moderate = !out->scalable || skf_moderate(e);
  out->weight = NULL;
  if (e->primitive.shape == SKF_SEGMENT) segment(&e->primitive.segment, &out->plan.segment);
  if (e->primitive.shape == SKF_ARC) arc(&e->primitive.arc, &out->plan.arc);
  if (e->primitive.shape == SKF_PLANE) plane(&e->primitive.plane, &out->plan.plane);
  if (e->primitive.shape == SKF_TRIANGLE) skf_triangle_prepare(&e->primitive.triangle, &out->plan.triangle);
  if (e->primitive.shape == SKF_SOLID) out->plan.solid = skf_solid_ops_get(skf_isa_pick());
}
