/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "info.h"

static void put_box(cli_json *j, const char *key, skf_box b) {
  json_open(j, key, '{');
  json_vector(j, "lo", b.lo);
  json_vector(j, "hi", b.hi);
  json_close(j, '}');
}

static void put_primitives(cli_json *j, const info_body *b) {
  json_open(j, "primitives", '{');
  for (int i = 0; i < SKF_SHAPE_COUNT; i++) {
    if (!b->count[i]) continue;
    json_open(j, skf_shape_get((skf_shape)i)->name, '{');
    json_integer(j, "count", (long)b->count[i]);
    json_number(j, "measure", b->measure[i]);
    json_close(j, '}');
  }
  json_close(j, '}');
}

static void put_solids(cli_json *j, const skf_body *body) {
  static const char *const names[6] = {"xx", "xy", "xz", "yy", "yz", "zz"};
  json_open(j, "solids", '[');
  for (size_t i = 0; i < body->element_count; i++) {
    const skf_element *e = body->elements + i;
    if (e->primitive.shape != SKF_SOLID) continue;
    const skf_solid_info *s = skf_solid_get(e->primitive.solid);
    double m = body->rho * e->strength;
    json_open(j, NULL, '{');
    json_integer(j, "line", body->element_lines[i]);
    json_integer(j, "vertices", (long)s->vertices);
    json_integer(j, "faces", (long)s->faces);
    json_integer(j, "edges", (long)s->edges);
    json_integer(j, "components", (long)s->components);
    json_integer(j, "joined_vertices", (long)s->joined);
    json_integer(j, "unused_vertices", (long)s->unused);
    json_integer(j, "dropped_faces", (long)s->dropped);
    json_number(j, "area", s->area);
    json_number(j, "volume", s->volume);
    json_number(j, "mass", m * s->volume);
    json_vector(j, "center", s->center);
    json_open(j, "inertia", '{');
    for (int k = 0; k < 6; k++) json_number(j, names[k], m * s->inertia[k]);
    json_close(j, '}');
    put_box(j, "bounds", s->bounds);
    json_close(j, '}');
  }
  json_close(j, ']');
}

static void put_pair(cli_json *j, skf_kernel_type kernel, skf_shape shape) {
  skf_pair_info pair = skf_pair_get(kernel, shape);
  json_open(j, NULL, '{');
  json_string(j, "kernel", skf_kernel_get(kernel)->name);
  json_string(j, "primitive", skf_shape_get(shape)->name);
  json_string(j, "evaluation", pair.closed ? "closed form" : "quadrature");
  json_number(j, "relative_error", pair.error);
  json_string(j, "singular", pair.singular);
  json_close(j, '}');
}

static void put_kernels(cli_json *j, const info_body *b) {
  json_open(j, "kernels", '[');
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    if (!b->kernels[k].count) continue;
    const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)k);
    json_open(j, NULL, '{');
    json_string(j, "type", info->name);
    json_string(j, "formula", info->formula);
    json_integer(j, "primitives", (long)b->kernels[k].count);
    if (info->param) {
      json_string(j, "parameter", info->param);
      json_number(j, "least", b->kernels[k].least);
      json_number(j, "most", b->kernels[k].most);
    }
    json_close(j, '}');
  }
  json_close(j, ']');
  json_open(j, "evaluation", '[');
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SHAPE_COUNT; s++)
      if (b->pairs[k][s]) put_pair(j, (skf_kernel_type)k, (skf_shape)s);
  json_close(j, ']');
}

static void put_handles(cli_json *j, const skf_body *body) {
  json_open(j, "handles", '[');
  for (size_t i = 0; i < body->handled_count; i++) {
    const skf_handled *h = body->handled + i;
    const skf_element *e = body->elements + h->first;
    const skf_kernel_info *info = skf_kernel_get(e->kernel.type);
    skf_handles found;
    if (skf_handles_find(e, h->count, body->iso, &found)) continue;
    json_open(j, NULL, '{');
    json_string(j, "entry", h->kind);
    json_integer(j, "line", body->element_lines[h->first]);
    json_integer(j, "primitives", (long)h->count);
    json_number(j, "radius", found.radius);
    if (info->param) {
      json_number(j, "blobbiness", found.blobbiness);
      json_number(j, "influence", found.influence);
      json_number(j, info->param, e->kernel.param);
    }
    json_number(j, "strength", e->strength);
    json_close(j, '}');
  }
  json_close(j, ']');
}

static void put_body(cli_json *j, const skf_scene *scene, const skf_body *body) {
  info_body b;
  info_gather(scene, body, &b);
  json_open(j, NULL, '{');
  json_string(j, "name", body->name);
  json_integer(j, "line", body->line);
  json_number(j, "iso", body->iso);
  json_integer(j, "primitive_count", (long)body->element_count);
  put_primitives(j, &b);
  if (b.count[SKF_SOLID]) put_solids(j, body);
  json_number(j, "weighted_measure", b.total);
  if (b.profiled) json_integer(j, "profiled", (long)b.profiled);
  json_bool(j, "mass_given", body->has_mass);
  json_number(j, "mass", b.mass);
  json_number(j, "density", body->rho);
  json_number(j, "GM", b.gm);
  put_box(j, "skeleton_bounds", b.skeleton);
  json_string(j, "surface", info_surface(&b));
  if (b.surface == SKF_OK) put_box(j, "surface_bounds", b.region);
  if (b.surface == SKF_OK && b.around) json_bool(j, "inside_unbounded", true);
  put_kernels(j, &b);
  if (body->handled_count) put_handles(j, body);
  if (body->spin.rate != 0) {
    json_open(j, "spin", '{');
    json_vector(j, "axis", body->spin.axis);
    json_vector(j, "about", body->spin.about);
    json_number(j, "rate", body->spin.rate);
    json_close(j, '}');
  }
  if (body->ellipsoid.given) {
    json_open(j, "ellipsoid", '{');
    json_number(j, "equatorial", body->ellipsoid.equatorial);
    json_number(j, "polar", body->ellipsoid.polar);
    json_vector(j, "center", body->ellipsoid.center);
    json_vector(j, "axis", body->ellipsoid.axis);
    json_vector(j, "meridian", body->ellipsoid.meridian);
    json_close(j, '}');
  }
  json_close(j, '}');
}

static void put_particle(cli_json *j, const skf_scene *scene, const skf_particle *p) {
  json_open(j, NULL, '{');
  json_string(j, "name", p->name);
  if (p->launch.given) {
    json_open(j, "launch", '{');
    json_string(j, "body", scene->bodies[p->launch.body].name);
    json_string(j, "angles", "radians");
    json_number(j, "latitude", p->launch.latitude);
    json_number(j, "longitude", p->launch.longitude);
    json_number(j, "height", p->launch.height);
    json_number(j, "azimuth", p->launch.azimuth);
    json_number(j, "elevation", p->launch.elevation);
    json_number(j, "speed", p->launch.speed);
    json_close(j, '}');
  } else {
    json_vector(j, "position", p->position);
    json_vector(j, "velocity", p->velocity);
  }
  json_close(j, '}');
}

static void put_simulation(cli_json *j, const skf_simulation *s) {
  json_open(j, "simulation", '{');
  json_number(j, "t_end", s->t_end);
  json_number(j, "output_every", s->output_every);
  json_number(j, "tolerance", s->tolerance);
  json_string(j, "contact", info_contact(s->contact));
  json_number(j, "restitution", s->restitution);
  json_number(j, "friction", s->friction);
  json_string(j, "integrator", s->integrator[0] ? s->integrator : NULL);
  json_close(j, '}');
}

void info_json(FILE *f, const skf_scene *scene, const char *path) {
  cli_json j = {.file = f};
  json_open(&j, NULL, '{');
  json_string(&j, "scene", path);
  json_number(&j, "G", scene->G);
  json_open(&j, "bodies", '[');
  for (size_t i = 0; i < scene->body_count; i++) put_body(&j, scene, scene->bodies + i);
  json_close(&j, ']');
  json_open(&j, "particles", '[');
  for (size_t i = 0; i < scene->particle_count; i++) put_particle(&j, scene, scene->particles + i);
  json_close(&j, ']');
  if (scene->simulation.given) put_simulation(&j, &scene->simulation);
  json_close(&j, '}');
}
