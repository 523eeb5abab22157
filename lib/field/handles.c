/* SPDX-License-Identifier: MIT */
/* From radius, blobbiness and influence to kernel parameter and strength, and back. */
#include "skelfield/handles.h"
#include "core/vec3.h"
#include "field/envelope.h"

/* r / width where d ln h / d ln r^2 = -b, for kernels with a parameter; NAN when there is no such r. */
static double ratio(skf_kernel_type type, double b) {
  switch (type) {
  case SKF_CAUCHY: return sqrt(b / (2 - b));
  case SKF_GAUSSIAN: return sqrt(b);
  case SKF_METABALL: return b <= 0.5 ? sqrt(b / (3 * (1 + b))) : b / (1 + b);
  case SKF_QUARTIC: return sqrt(b / (2 + b));
  case SKF_SOFT_OBJECT: { /* y (22 - 12 y) = b (1 - y) (9 - 4 y) */
    double q = 22 + 13 * b;
    return sqrt(18 * b / (q + sqrt(q * q - 36 * b * (12 + 4 * b))));
  }
  default: return NAN;
  }
}

/* influence / width */
static double depth(skf_kernel_type type) {
  double drop = 1 / SKF_INFLUENCE_SHARE;
  return type == SKF_CAUCHY ? sqrt(sqrt(drop) - 1) : type == SKF_GAUSSIAN ? sqrt(log(drop)) : 1;
}

static double param_of(skf_kernel_type type, double width) { return skf_kernel_get(type)->compact ? width : 1 / width; }

static skf_vec3 beside(skf_vec3 a, double r, skf_vec3 direction) { return v3_mad(a, r, v3_unit(direction)); }

skf_vec3 skf_handles_place(const skf_primitive *p, double r) {
  switch (p->shape) {
  case SKF_SEGMENT: {
    skf_vec3 d = v3_unit(v3_sub(p->segment.to, p->segment.from));
    return beside(skf_primitive_point(p, 0.5, 0), r, v3_perp(d));
  }
  case SKF_ARC: return beside(skf_primitive_point(p, 0.5, 0), r, p->arc.normal);
  case SKF_TRIANGLE: {
    const skf_vec3 *v = p->triangle.vertices;
    double a = v3_dist(v[1], v[2]), b = v3_dist(v[2], v[0]), c = v3_dist(v[0], v[1]), s = a + b + c;
    skf_vec3 center = v3_mad(v3_mad(v3_scale(a / s, v[0]), b / s, v[1]), c / s, v[2]);
    return beside(center, r, v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0])));
  }
  case SKF_PLANE: return beside(p->plane.through, r, p->plane.normal);
  case SKF_SOLID: return beside(skf_solid_get(p->solid)->bounds.hi, r, v3(1, 1, 1)); /* no radius is asked of it */
  default: return beside(p->point.at, r, v3(1, 0, 0));
  }
}

static const skf_primitive *largest(const skf_element *e, size_t n) {
  size_t best = 0;
  for (size_t i = 1; i < n; i++)
    if (skf_primitive_measure(&e[i].primitive) > skf_primitive_measure(&e[best].primitive)) best = i;
  return &e[best].primitive;
}

static void set_all(skf_element *e, size_t n, double param, double strength) {
  for (size_t i = 0; i < n; i++) e[i].kernel = (skf_kernel){e->kernel.type, param}, e[i].strength = strength;
}

static skf_status field_at(const skf_element *e, size_t n, skf_vec3 x, double *F) {
  skf_field *f;
  skf_status s = skf_field_new(e, n, &f);
  if (s) return s;
  *F = skf_field_at(f, x, NULL);
  skf_field_free(f);
  return SKF_OK;
}

static skf_status refuse(skf_status s, const char *text, const char **why) {
  if (why) *why = text;
  return s;
}

/* The width for which F = iso at the radius, by bisection to neighbouring doubles: F grows with the width. */
static skf_status solve_width(skf_element *e, size_t n, double iso, double radius, const char **why) {
  skf_kernel_type type = e->kernel.type;
  skf_vec3 x = skf_handles_place(largest(e, n), radius);
  double strength = e->strength, lo = 0, hi = radius, F;
  if (!(iso > 0)) return refuse(SKF_ERR_RANGE, "iso is not positive, expected iso > 0 for a radius", why);
  for (bool found = false;;) {
    double mid = found ? 0.5 * (lo + hi) : hi;
    if (found && !(mid > lo && mid < hi)) break;
    set_all(e, n, param_of(type, mid), strength);
    skf_status s = field_at(e, n, x, &F);
    if (s) return s;
    if (F >= iso)
      hi = mid, found = true;
    else
      lo = mid, hi = found ? hi : 2 * mid;
    if (!found && hi > 1e15 * radius)
      return refuse(SKF_ERR_RANGE, "no kernel parameter brings F to iso at the radius, expected a larger strength",
                    why);
  }
  set_all(e, n, param_of(type, hi), strength);
  return SKF_OK;
}

static skf_status solve_strength(skf_element *e, size_t n, double iso, double radius, const char **why) {
  double F;
  set_all(e, n, e->kernel.param, 1);
  skf_status s = field_at(e, n, skf_handles_place(largest(e, n), radius), &F);
  if (s) return s;
  if (F == 0)
    return refuse(SKF_ERR_RANGE, "the field is 0 at the radius, expected a wider kernel (influence > radius)", why);
  double w = iso / F;
  if (!(w > 0 && isfinite(w)))
    return refuse(
        SKF_ERR_RANGE,
        F > 0 ? "iso is not positive, expected iso > 0 for a radius"
              : "iso is not negative, expected iso < 0 for this radius beside a plane whose F is negative there",
        why);
  set_all(e, n, e->kernel.param, w);
  return SKF_OK;
}

/* What contradicts itself or is missing, whatever the numbers. */
static const char *contradiction(const skf_handles *g, unsigned fixed, bool has_param) {
  bool r = g->radius > 0, b = g->blobbiness != 0, d = g->influence > 0, w = fixed & SKF_FIXED_STRENGTH;
  if (!has_param) {
    if (b || d) return "this kernel has no parameter, expected radius alone";
    return r && w ? "both radius and strength for a kernel without parameter, expected one of them" : NULL;
  }
  bool p = fixed & SKF_FIXED_PARAM;
  if (p && d) return "both influence and the kernel's parameter, expected one of them";
  if (r && b && (d || p))
    return d ? "all of radius, blobbiness and influence, expected two of them"
             : "radius and blobbiness beside the kernel's parameter, expected one of them";
  int known = r + b + (d || p);
  if (w && known == 2 && (r || b)) return "strength beside handles that give it, expected one of them less";
  if (known == 2 || (r && w) || d) return NULL;
  if (r) return "radius alone, expected also blobbiness, influence, strength or the kernel's parameter";
  return b ? "blobbiness alone, expected also radius, influence or the kernel's parameter" : NULL;
}

static const char *range(const skf_handles *g, skf_kernel_type type) {
  if (!(g->radius >= 0 && g->radius < INFINITY)) return "radius out of range, expected a finite number > 0";
  if (!(g->influence >= 0 && g->influence < INFINITY)) return "influence out of range, expected a finite number > 0";
  if (!(g->blobbiness <= 0 && g->blobbiness > -INFINITY)) return "blobbiness out of range, expected a number < 0";
  if (type == SKF_CAUCHY && g->blobbiness <= -2)
    return "blobbiness of a cauchy kernel out of range, expected it between -2 and 0";
  if (g->radius > 0 && g->influence > 0 && g->radius >= g->influence)
    return "radius is not less than influence, expected radius < influence";
  return NULL;
}

/* All three, of a kernel and a radius. */
static skf_handles complete(skf_kernel k, double radius) {
  skf_handles g = {.radius = radius};
  double h[4];
  const skf_kernel_info *info = skf_kernel_get(k.type);
  if (!info || !info->param) return g; /* users' kernels: the radius alone */
  g.influence = depth(k.type) * skf_kernel_width(k);
  skf_kernel_eval(k, radius * radius, h);
  if (radius > 0 && h[0] > 0) g.blobbiness = radius * radius * h[1] / h[0];
  return g;
}

skf_status skf_handles_solve(const skf_handles *given, double iso, unsigned fixed, skf_element *e, size_t n,
                             skf_handles *out, const char **why) {
  skf_handles g = *given;
  const skf_kernel_info *info = n ? skf_kernel_get(e->kernel.type) : NULL;
  if (!info || !isfinite(iso)) return refuse(SKF_ERR_ARG, "no element or no iso", why);
  skf_kernel_type type = e->kernel.type;
  if (e->primitive.shape == SKF_SOLID)
    return refuse(SKF_ERR_UNSUPPORTED, "a solid has no such handles, expected strength or iso", why);
  const char *wrong = range(&g, type);
  if (wrong) return refuse(SKF_ERR_RANGE, wrong, why);
  if ((wrong = contradiction(&g, fixed, info->param))) return refuse(SKF_ERR_ARG, wrong, why);
  bool strength = g.radius > 0 || g.blobbiness < 0; /* is wanted */
  skf_status s = SKF_OK;
  if (info->param) {
    double width = fixed & SKF_FIXED_PARAM ? param_of(type, e->kernel.param) : g.influence / depth(type);
    if (g.blobbiness < 0 && g.radius > 0) width = g.radius / ratio(type, -g.blobbiness);
    if (g.blobbiness < 0) g.radius = ratio(type, -g.blobbiness) * width;
    if (width > 0)
      set_all(e, n, param_of(type, width), e->strength);
    else
      s = solve_width(e, n, iso, g.radius, why), strength = false;
  }
  if (!s && strength) s = solve_strength(e, n, iso, g.radius, why);
  if (!s && out) *out = complete(e->kernel, g.radius);
  return s;
}

/* A place along the line of skf_handles_place, away from the primitive F falls. */
skf_status skf_handles_find(const skf_element *e, size_t n, double iso, skf_handles *out) {
  skf_field *f;
  skf_status s = n ? skf_field_new(e, n, &f) : SKF_ERR_ARG;
  if (s) return s;
  const skf_primitive *p = largest(e, n);
  double width = skf_kernel_width(e->kernel), scale = width > 0 ? width : 1, lo = scale, hi = scale;
  while (lo > 1e-30 * scale && !(skf_field_at(f, skf_handles_place(p, lo), NULL) >= iso)) lo *= 0.5;
  while (hi < 1e30 * scale && !(skf_field_at(f, skf_handles_place(p, hi), NULL) < iso)) hi *= 2;
  bool found = lo > 1e-30 * scale && hi < 1e30 * scale;
  for (double mid = 0.5 * (lo + hi); found && mid > lo && mid < hi; mid = 0.5 * (lo + hi))
    *(skf_field_at(f, skf_handles_place(p, mid), NULL) >= iso ? &lo : &hi) = mid;
  skf_field_free(f);
  *out = complete(e->kernel, found ? lo : 0);
  return SKF_OK;
}
