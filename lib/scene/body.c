/* SPDX-License-Identifier: MIT */
/* Bodies: what the contract says about one, and the checks that need the whole of it. */
#include "scene/reader.h"
#include "scene/skeleton.h"
#include "core/alloc.h"
#include "core/sum.h"
#include "core/vec3.h"
#include <float.h>
#include <stdint.h>
#include <string.h>

/* A body while it is read: the skeleton waits until the default kernel is known. */
typedef struct draft {
  skf_body body;
  skf_style style;
  const skf_node *skeleton;
} draft;

static skf_status zero_vector(skf_reader *r, const skf_node *map, const char *key) {
  return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, key),
                       "%s is the zero vector, expected a direction", key);
}

static const skf_key spin_keys[] = {
    {"axis", "1", "axis of rotation, right-handed", SKF_KEY_VECTOR, true, .offset = offsetof(skf_spin, axis)},
    {"rate", "rad/T", "rate of rotation", SKF_KEY_NUMBER, true, .offset = offsetof(skf_spin, rate)},
    {"about", "L", "a point of the axis (default: the origin)", SKF_KEY_VECTOR, false,
     .offset = offsetof(skf_spin, about)},
};
const skf_section skf_section_spin = {"spin", "uniform rotation; body and inertial frame agree at t = 0", spin_keys, 3};

static skf_status read_spin(skf_reader *r, const skf_node *map, void *into) {
  skf_spin *spin = &((draft *)into)->body.spin;
  skf_status s = skf_read_map(r, map, &skf_section_spin, spin, NULL);
  return s || v3_norm(v3_unit(spin->axis)) > 0 ? s : zero_vector(r, map, "axis");
}

static const skf_key motion_keys[] = {
    {"velocity", "L/T", "of the center of mass at t = 0 (default: 0)", SKF_KEY_VECTOR, false,
     .offset = offsetof(draft, body.velocity)},
    {"angular_velocity", "rad/T", "at t = 0, inertial frame (default: 0)", SKF_KEY_VECTOR, false,
     .offset = offsetof(draft, body.angular_velocity)},
};
const skf_section skf_section_motion = {"motion", "a rigid body's start; it is attracted and collides", motion_keys, 2};

static skf_status read_motion(skf_reader *r, const skf_node *map, void *into) {
  ((draft *)into)->body.moves = true;
  return skf_read_map(r, map, &skf_section_motion, into, NULL);
}

static const skf_key ellipsoid_keys[] = {
    {"equatorial", "L", "semi-axis of the equator", SKF_KEY_NUMBER, true, .offset = offsetof(skf_ellipsoid, equatorial),
     .range = &skf_positive},
    {"polar", "L", "semi-axis to the poles", SKF_KEY_NUMBER, true, .offset = offsetof(skf_ellipsoid, polar),
     .range = &skf_positive},
    {"center", "L", "its centre (default: the origin)", SKF_KEY_VECTOR, false,
     .offset = offsetof(skf_ellipsoid, center)},
    {"axis", "1", "to the north pole (default: z)", SKF_KEY_VECTOR, false, .offset = offsetof(skf_ellipsoid, axis)},
    {"meridian", "1", "to latitude 0, longitude 0 (default: x); projected onto the equator", SKF_KEY_VECTOR, false,
     .offset = offsetof(skf_ellipsoid, meridian)},
};
const skf_section skf_section_ellipsoid = {"ellipsoid", "reference ellipsoid of revolution for surface coordinates",
                                           ellipsoid_keys, 5};

static skf_status read_ellipsoid(skf_reader *r, const skf_node *map, void *into) {
  skf_ellipsoid *e = &((draft *)into)->body.ellipsoid;
  e->given = true;
  skf_status s = skf_read_map(r, map, &skf_section_ellipsoid, e, NULL);
  if (s) return s;
  skf_vec3 axis = v3_unit(e->axis), meridian = v3_unit(e->meridian);
  if (!(v3_norm(axis) > 0)) return zero_vector(r, map, "axis");
  if (v3_norm(v3_cross(axis, meridian)) > 1e-12) return SKF_OK; /* below, rounding would choose the meridian */
  return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, "meridian"),
                       "meridian is zero or along the axis, expected another direction than the axis");
}

static skf_status read_default_kernel(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_kernel(r, map, &((draft *)into)->style);
}

static skf_status read_default_material(skf_reader *r, const skf_node *name, void *into) {
  return skf_read_material(r, name, &((draft *)into)->style);
}

static skf_status keep_skeleton(skf_reader *r, const skf_node *list, void *into) {
  static const char form[] = "a list of primitives";
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "skeleton", form);
  if (!s && !list->count)
    s = skf_error_set(r->error, SKF_ERR_PARSE, list->line, "skeleton is empty, expected %s", form);
  ((draft *)into)->skeleton = list;
  return s;
}

enum {
  KEY_NAME,
  KEY_ISO,
  KEY_KERNEL,
  KEY_MASS,
  KEY_DENSITY,
  KEY_SPIN,
  KEY_MOTION,
  KEY_SKELETON,
  KEY_ELLIPSOID,
  KEY_COLOR,
  KEY_MATERIAL,
  KEY_RADIUS,
  KEY_BLOBBINESS,
  KEY_INFLUENCE,
  KEYS
};

static const skf_key body_keys[KEYS] = {
    [KEY_NAME] = {"name", NULL, "unique among the bodies", SKF_KEY_NAME, true, .offset = offsetof(draft, body.name)},
    [KEY_ISO] = {"iso", "F", "the surface is where F = iso", SKF_KEY_NUMBER, true, .offset = offsetof(draft, body.iso)},
    [KEY_KERNEL] = {"kernel", NULL, "default for its primitives", SKF_KEY_OTHER, .read = read_default_kernel,
                    .form = "{type: ...}"},
    [KEY_MASS] = {"mass", "M", "sets density to mass / sum of strength times measure", SKF_KEY_NUMBER, false,
                  offsetof(draft, body.mass)},
    [KEY_DENSITY] = {"density", "M/measure", "negative repels (default: 1)", SKF_KEY_NUMBER, false,
                     offsetof(draft, body.density)},
    [KEY_SPIN] = {"spin", NULL, "uniform rotation", SKF_KEY_OTHER, .read = read_spin, .form = "{axis, rate, about}"},
    [KEY_MOTION] = {"motion", NULL, "it moves as a rigid body (default: fixed)", SKF_KEY_OTHER, .read = read_motion,
                    .form = "{velocity, angular_velocity}"},
    [KEY_SKELETON] = {"skeleton", NULL, "its primitives", SKF_KEY_OTHER, true, .read = keep_skeleton,
                      .form = "a list of primitives"},
    [KEY_ELLIPSOID] = {"ellipsoid", NULL, "for surface coordinates", SKF_KEY_OTHER, .read = read_ellipsoid,
                       .form = "{equatorial, polar, ...}"},
    [KEY_COLOR] = {"color", "1", "linear light, for pictures", SKF_KEY_COLOR, false,
                   .offset = offsetof(draft, body.color)},
    [KEY_MATERIAL] = {"material", NULL, "whose properties it has where it is silent", SKF_KEY_OTHER,
                      .read = read_default_material, .form = "a material's name"},
    [KEY_RADIUS] = SKF_RADIUS_KEY(draft, style),
    [KEY_BLOBBINESS] = SKF_BLOBBINESS_KEY(draft, style),
    [KEY_INFLUENCE] = SKF_INFLUENCE_KEY(draft, style),
};
const skf_section skf_section_body = {"body", "a skeleton, its surface and its mass", body_keys, KEYS};

/* Sum of w mu, compensated, and of its absolute terms. */
static double total_measure(const skf_body *b, double *absolute) {
  skf_sum sum = {0, 0};
  *absolute = 0;
  for (size_t i = 0; i < b->element_count; i++) {
    double term = b->elements[i].strength * skf_element_measure(b->elements + i);
    sum_add(&sum, term);
    *absolute += fabs(term);
  }
  return sum_total(sum);
}

static skf_status set_density(skf_reader *r, skf_body *b, const skf_node *map) {
  b->rho = b->density;
  if (!b->has_mass) return SKF_OK;
  double absolute, total = total_measure(b, &absolute);
  long line = skf_map_line(r, map, "mass");
  if (isinf(total)) return b->rho = 0, SKF_OK;     /* a plane: a finite mass spread over an infinite area */
  if (!(fabs(total) > 4 * DBL_EPSILON * absolute)) /* less is the rounding of the measures; also two opposite planes */
    return skf_error_set(r->error, SKF_ERR_RANGE, line,
                         "mass where strength times measure sums to zero, expected density instead");
  b->rho = b->mass / total;
  if (isfinite(b->rho)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_RANGE, line, "mass / measure overflows, expected a finite density");
}

static skf_status finish(skf_reader *r, draft *d, const skf_node *map, unsigned given) {
  skf_body *b = &d->body;
  if ((given >> KEY_MASS & 1) && (given >> KEY_DENSITY & 1)) {
    long mass = skf_map_line(r, map, "mass"), density = skf_map_line(r, map, "density");
    return skf_error_set(r->error, SKF_ERR_PARSE, mass > density ? mass : density,
                         "both mass and density in a body, expected one of them");
  }
  b->has_mass = given >> KEY_MASS & 1;
  const skf_material *m = d->style.material;
  if (!(b->looks = skf_alloc(1, sizeof *b->looks))) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  b->looks[0] = skf_look_default(), b->look_count = 1;
  skf_material_paint(m, b->looks);
  if (given >> KEY_COLOR & 1) memcpy(b->looks[0].color, b->color, sizeof b->color);
  memcpy(b->color, b->looks[0].color, sizeof b->color);
  skf_status s = skf_read_skeleton(r, d->skeleton, &d->style, b);
  if (!s) s = set_density(r, b, map);
  if (s) return s;
  s = skf_field_new(b->elements, b->element_count, &b->field);
  return s ? skf_error_set(r->error, s, b->line, "the skeleton is refused: %s", skf_status_text(s)) : SKF_OK;
}

static skf_status read_body(skf_reader *r, const skf_node *map, skf_body *out) {
  draft d = {.body = {.density = 1,
                      .spin = {.axis = {0, 0, 1}},
                      .ellipsoid = {.axis = {0, 0, 1}, .meridian = {1, 0, 0}},
                      .color = {0.8, 0.8, 0.8},
                      .line = map->line},
             .style = skf_no_style};
  unsigned given;
  skf_status s = skf_read_map(r, map, &skf_section_body, &d, &given);
  if (!s) s = finish(r, &d, map, given);
  *out = d.body; /* whole or not, the scene owns it from here */
  return s;
}

static skf_named name_at(const skf_scene *scene, size_t i) {
  return (skf_named){scene->bodies[i].name, scene->bodies[i].line};
}

skf_status skf_read_bodies(skf_reader *r, const skf_node *list, void *into) {
  skf_scene *scene = into;
  static const char form[] = "a list of bodies";
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "bodies", form);
  if (!s && !list->count) s = skf_error_set(r->error, SKF_ERR_PARSE, list->line, "bodies is empty, expected %s", form);
  if (s) return s;
  scene->bodies = skf_alloc((size_t)list->count, sizeof *scene->bodies);
  if (!scene->bodies) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_body(r, n, scene->bodies + scene->body_count++);
  return s ? s : skf_refuse_duplicates(r, "body", scene->body_count, name_at);
}
