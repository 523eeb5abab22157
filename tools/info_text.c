/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "info.h"

enum { LABEL = 14 };

static void put_box(FILE *f, skf_box b) {
  fprintf(f, "[%.6g, %.6g, %.6g] .. [%.6g, %.6g, %.6g]", b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z);
}

static void put_vector(FILE *f, const char *label, skf_vec3 v) {
  fprintf(f, "%s[%.6g, %.6g, %.6g]", label, v.x, v.y, v.z);
}

static void put_primitives(FILE *f, const info_body *b) {
  static const char *const what[] = {[SKF_POINT] = NULL,      [SKF_SEGMENT] = "length", [SKF_ARC] = "length",
                                     [SKF_TRIANGLE] = "area", [SKF_PLANE] = "area",     [SKF_SOLID] = "volume"};
  const char *comma = "";
  fprintf(f, "  %-*s", LABEL, "skeleton");
  for (int i = 0; i < SKF_SHAPE_COUNT; i++) {
    if (!b->count[i]) continue;
    fprintf(f, "%s%zu %s%s", comma, b->count[i], skf_shape_get((skf_shape)i)->name, b->count[i] > 1 ? "s" : "");
    if (what[i]) fprintf(f, " (%s %.10g)", what[i], b->measure[i]);
    comma = ", ";
  }
  fprintf(f, "\n  %-*s", LABEL, "");
  put_box(f, b->skeleton);
  fprintf(f, "\n  %-*s%.10g (sum of strength times measure)\n", LABEL, "measure", b->total);
}

static void put_solids(FILE *f, const skf_body *body, double rho) {
  for (size_t i = 0; i < body->element_count; i++) {
    const skf_element *e = body->elements + i;
    if (e->primitive.shape != SKF_SOLID) continue;
    const skf_solid_info *s = skf_solid_get(e->primitive.solid);
    double m = rho * e->strength;
    fprintf(f, "  %-*s%zu vertices, %zu faces, %zu edges, %zu component%s; area %.10g, volume %.10g\n", LABEL, "solid",
            s->vertices, s->faces, s->edges, s->components, s->components == 1 ? "" : "s", s->area, s->volume);
    if (s->joined || s->unused || s->dropped)
      fprintf(f, "  %-*s  %zu equal vertices joined, %zu unused ones and %zu faces without area left out\n", LABEL, "",
              s->joined, s->unused, s->dropped);
    fprintf(f, "  %-*s  mass %.10g, centre ", LABEL, "", m * s->volume);
    put_vector(f, "", s->center);
    fprintf(f, "\n  %-*s  inertia about it: xx %.10g, xy %.10g, xz %.10g, yy %.10g, yz %.10g, zz %.10g\n", LABEL, "",
            m * s->inertia[0], m * s->inertia[1], m * s->inertia[2], m * s->inertia[3], m * s->inertia[4],
            m * s->inertia[5]);
  }
}

static void put_kernels(FILE *f, const info_body *b) {
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)k);
    const info_kernel *used = b->kernels + k;
    if (!used->count) continue;
    fprintf(f, "  %-*s%s, h(r) = %s", LABEL, "kernel", info->name, info->formula);
    if (info->param) fprintf(f, ", %s = %.6g", info->param, used->least);
    if (info->param && used->most > used->least) fprintf(f, " .. %.6g", used->most);
    fputc('\n', f);
    for (int s = 0; s < SKF_SHAPE_COUNT; s++) {
      if (!b->pairs[k][s]) continue;
      skf_pair_info pair = skf_pair_get((skf_kernel_type)k, (skf_shape)s);
      fprintf(f, "  %-*s  on %s: %s, relative error %.0e", LABEL, "", skf_shape_get((skf_shape)s)->name,
              pair.closed ? "closed form" : "adaptive quadrature", pair.error);
      if (pair.singular) fprintf(f, "; %s", pair.singular);
      fputc('\n', f);
    }
  }
}

enum { HANDLED = 8 }; /* as many are shown */

static void put_handles(FILE *f, const skf_body *body) {
  for (size_t i = 0; i < body->handled_count; i++) {
    const skf_handled *h = body->handled + i;
    const skf_element *e = body->elements + h->first;
    const skf_kernel_info *info = skf_kernel_get(e->kernel.type);
    skf_handles found;
    if (i == HANDLED) {
      fprintf(f, "  %-*s  and %zu more: --json tells them\n", LABEL, "", body->handled_count - HANDLED);
      return;
    }
    if (skf_handles_find(e, h->count, body->iso, &found)) continue;
    fprintf(f, "  %-*s%s (line %ld): radius %.10g", LABEL, i ? "" : "handles", h->kind, body->element_lines[h->first],
            found.radius);
    if (info->param)
      fprintf(f, ", blobbiness %.6g, influence %.6g: %s = %.10g", found.blobbiness, found.influence, info->param,
              e->kernel.param);
    fprintf(f, "%s strength %.10g\n", info->param ? "," : ":", e->strength);
  }
}

static void put_body(FILE *f, const skf_scene *scene, const skf_body *body) {
  info_body b;
  info_gather(scene, body, &b);
  fprintf(f, "body %s (line %ld)\n", body->name, body->line);
  put_primitives(f, &b);
  put_solids(f, body, body->rho);
  put_kernels(f, &b);
  if (b.profiled)
    fprintf(f, "  %-*s%zu %s: weighted sums, relative error 1e-12\n", LABEL, "profiles", b.profiled,
            b.profiled == 1 ? "primitive" : "primitives");
  put_handles(f, body);
  if (b.massless)
    fprintf(f, "  %-*sno finite one, density %.10g\n", LABEL, "mass", body->rho);
  else
    fprintf(f, "  %-*s%.10g%s, density %.10g, G M = %.10g\n", LABEL, "mass", b.mass, body->has_mass ? " (given)" : "",
            body->rho, b.gm);
  fprintf(f, "  %-*sF = %.10g: %s", LABEL, "surface", body->iso, info_surface(&b));
  if (b.surface == SKF_OK) {
    fputs(", inside ", f);
    put_box(f, b.region);
    if (b.around) fputs(", the body is around it", f);
  }
  fputc('\n', f);
  if (body->spin.rate != 0) {
    fprintf(f, "  %-*srate %.10g", LABEL, "spin", body->spin.rate);
    put_vector(f, " about ", body->spin.axis);
    put_vector(f, " through ", body->spin.about);
    fputc('\n', f);
  }
  if (body->ellipsoid.given)
    fprintf(f, "  %-*sequatorial %.10g, polar %.10g\n", LABEL, "ellipsoid", body->ellipsoid.equatorial,
            body->ellipsoid.polar);
}

static void put_particle(FILE *f, const skf_scene *scene, const skf_particle *p) {
  fprintf(f, "particle %s", p->name);
  if (p->launch.given) {
    const double degree = 57.295779513082323;
    fprintf(f,
            " from body %s at latitude %.6g, longitude %.6g, height %.6g; azimuth %.6g, elevation %.6g, speed %.6g\n",
            scene->bodies[p->launch.body].name, p->launch.latitude * degree, p->launch.longitude * degree,
            p->launch.height, p->launch.azimuth * degree, p->launch.elevation * degree, p->launch.speed);
    return;
  }
  put_vector(f, " at ", p->position);
  put_vector(f, " with velocity ", p->velocity);
  fputc('\n', f);
}

/* Of a file, a grid, ... only the first ones. */
static void put_particles(FILE *f, const skf_scene *scene) {
  enum { SHOWN = 3 };
  for (size_t i = 0, n; i < scene->particle_count; i += n) {
    const skf_particle *p = scene->particles + i;
    for (n = 1; p->sourced && i + n < scene->particle_count && p[n].sourced && p[n].line == p->line;) n++;
    for (size_t k = 0; k < n && k < SHOWN; k++) put_particle(f, scene, p + k);
    if (n > SHOWN) fprintf(f, "  and %zu more to %s\n", n - SHOWN, p[n - 1].name);
  }
}

void info_text(FILE *f, const skf_scene *scene, const char *path) {
  fprintf(f, "scene %s: %zu %s, %zu %s, G = %.10g\n", path, scene->body_count,
          scene->body_count == 1 ? "body" : "bodies", scene->particle_count,
          scene->particle_count == 1 ? "particle" : "particles", scene->G);
  for (size_t i = 0; i < scene->body_count; i++) put_body(f, scene, scene->bodies + i);
  put_particles(f, scene);
  const skf_simulation *s = &scene->simulation;
  if (!s->given) return;
  fprintf(f, "simulation to t = %.10g, output every %.10g, tolerance %.3g, contact %s", s->t_end, s->output_every,
          s->tolerance, info_contact(s->contact));
  if (s->contact == SKF_CONTACT_BOUNCE) fprintf(f, " (restitution %.6g, friction %.6g)", s->restitution, s->friction);
  fprintf(f, "%s%s\n", s->integrator[0] ? ", integrator " : "", s->integrator);
}
