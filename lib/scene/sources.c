/* SPDX-License-Identifier: MIT */
/* Grids, discs, shells and clouds of particles. Random ones depend on the seed, the source's name and the particle's
   number only, and use no library's functions but sqrt, so that every machine makes the same. */
#include "scene/sources.h"
#include "core/alloc.h"
#include "core/random.h"
#include <stdio.h>
#include <string.h>

static skf_status read_whole(skf_reader *r, const skf_node *node, const char *name, double least, double most,
                             double *out) {
  char form[64];
  snprintf(form, sizeof form, "a whole number from %.0f to %.0f", least, most);
  const skf_range range = {least, most, false};
  const skf_key key = {.name = name, .type = SKF_KEY_NUMBER, .range = &range, .form = form};
  skf_status s = skf_read_number(r, node, &key, out);
  if (s || *out == floor(*out)) return s;
  return skf_error_set(r->error, SKF_ERR_RANGE, node->line, "%s is %s, expected %s", name,
                       skf_show(skf_node_text(&r->yaml, node)).text, form);
}

static skf_status read_count(skf_reader *r, const skf_node *node, void *into) {
  return read_whole(r, node, "count", 1, SKF_PARTICLES_MOST, &((skf_source *)into)->count);
}

static skf_status read_seed(skf_reader *r, const skf_node *node, void *into) {
  return read_whole(r, node, "seed", 0, 0x1p53, &((skf_source *)into)->seed);
}

static skf_status read_counts(skf_reader *r, const skf_node *node, void *into) {
  skf_source *source = into;
  skf_status s = skf_expect(r, node, SKF_NODE_LIST, "counts", "[nx, ny, nz]");
  if (!s && node->count != 3)
    s = skf_error_set(r->error, SKF_ERR_PARSE, node->line, "counts has %d entries, expected [nx, ny, nz]", node->count);
  const skf_node *n = s ? NULL : skf_node_first(&r->yaml, node);
  for (int i = 0; i < 3 && !s; i++, n = skf_node_next(&r->yaml, n))
    s = read_whole(r, n, "counts", 1, SKF_PARTICLES_MOST, source->counts + i);
  return s;
}

#define VECTOR(key, unit, doc, required, field)                                                                        \
  { key, unit, doc, SKF_KEY_VECTOR, required, .offset = offsetof(skf_source, field) }
#define NUMBER(key, unit, doc, required, field, bounds)                                                                \
  { key, unit, doc, SKF_KEY_NUMBER, required, .offset = offsetof(skf_source, field), .range = bounds }
#define WHOLE(key, doc, required, reader, text)                                                                        \
  { key, NULL, doc, SKF_KEY_OTHER, required, .read = reader, .form = text }
#define COUNT    WHOLE("count", "of particles", true, read_count, "a whole number from 1 to 1e8")
#define CENTER   VECTOR("center", "L", "(default: the origin)", false, center)
#define VELOCITY VECTOR("velocity", "L/T", "of all of them (default: 0)", false, velocity)
#define SPREAD                                                                                                         \
  NUMBER("spread", "L/T", "standard deviation of each velocity component about it", false, spread, &skf_not_negative), \
      NUMBER("temperature", "L^2/T^2", "instead of spread: its square, k T / m", false, temperature,                   \
             &skf_not_negative)
#define SEED WHOLE("seed", "another one draws others (default: 1)", false, read_seed, "a whole number >= 0")

static const skf_key grid_keys[] = {
    VECTOR("from", "L", "one corner", true, from),
    VECTOR("to", "L", "the opposite corner", true, to),
    WHOLE("counts", "points along x, y and z; x runs fastest", true, read_counts, "[nx, ny, nz]"),
    VELOCITY,
    SPREAD,
    SEED,
};
static const skf_key disc_keys[] = {
    CENTER,
    VECTOR("normal", "1", "(default: z)", false, normal),
    NUMBER("inner", "L", "radius of the hole (default: 0)", false, inner, &skf_not_negative),
    NUMBER("outer", "L", "radius; uniform by area", true, outer, &skf_positive),
    COUNT,
    VELOCITY,
    NUMBER("circular", "1", "speed about the normal, in speeds of a circular orbit (default: 0)", false, circular,
           NULL),
    SPREAD,
    SEED,
};
static const skf_key shell_keys[] = {
    CENTER,
    NUMBER("inner", "L", "radius (default: outer)", false, inner, &skf_not_negative),
    NUMBER("outer", "L", "radius; uniform by volume", true, outer, &skf_positive),
    COUNT,
    VELOCITY,
    NUMBER("radial", "L/T", "speed outwards (default: 0)", false, radial, NULL),
    NUMBER("tangential", "L/T", "speed in a random direction across (default: 0)", false, tangential,
           &skf_not_negative),
    SPREAD,
    SEED,
};
static const skf_key maxwellian_keys[] = {
    CENTER, NUMBER("radius", "L", "of the ball that it fills (default: 0)", false, outer, &skf_not_negative),
    COUNT,  VELOCITY,
    SPREAD, SEED,
};
#define SECTION(name, doc, keys)                                                                                       \
  { name, doc, keys, sizeof keys / sizeof *keys }
const skf_section skf_section_grid =
                      SECTION("grid", "particles on the points of a grid, its faces included", grid_keys),
                  skf_section_disc = SECTION("disc", "particles all over a disc or ring", disc_keys),
                  skf_section_shell = SECTION("shell", "particles all over a sphere or between two", shell_keys),
                  skf_section_maxwellian =
                      SECTION("maxwellian", "a cloud of particles with normal velocities", maxwellian_keys);

static const skf_section *const sections[] = {[SKF_SOURCE_GRID] = &skf_section_grid,
                                              [SKF_SOURCE_DISC] = &skf_section_disc,
                                              [SKF_SOURCE_SHELL] = &skf_section_shell,
                                              [SKF_SOURCE_MAXWELLIAN] = &skf_section_maxwellian};

skf_status skf_read_source(skf_reader *r, const skf_node *map, skf_source_kind kind, skf_source *source) {
  *source = (skf_source){.kind = kind, .node = map, .normal = {0, 0, 1}, .seed = 1, .inner = -1};
  source->spread = source->temperature = -1;
  skf_status s = skf_read_map(r, map, sections[kind], source, NULL);
  if (s) return s;
  if (source->inner < 0) source->inner = kind == SKF_SOURCE_SHELL ? source->outer : 0;
  if (source->inner > source->outer)
    return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, map, "inner"),
                         "inner is larger than outer, expected inner <= outer");
  source->normal = v3_unit(source->normal);
  if (!(v3_norm(source->normal) > 0))
    return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, "normal"),
                         "normal is the zero vector, expected a direction");
  if (source->spread >= 0 && source->temperature >= 0)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "temperature"),
                         "both spread and temperature, expected one of them");
  if (kind == SKF_SOURCE_MAXWELLIAN && source->spread < 0 && source->temperature < 0)
    return skf_error_set(r->error, SKF_ERR_PARSE, map->line,
                         "missing 'spread' in maxwellian, expected a finite number "
                         ">= 0, or a temperature");
  if (source->temperature > 0) source->spread = sqrt(source->temperature);
  return SKF_OK;
}

static double between(double a, double b, double i, double n) {
  return n > 1 ? a + (b - a) * (i / (n - 1)) : 0.5 * (a + b);
}

static void place_on_grid(const skf_source *c, size_t i, skf_particle *p) {
  size_t nx = (size_t)c->counts[0], ny = (size_t)c->counts[1];
  p->position = v3(between(c->from.x, c->to.x, (double)(i % nx), c->counts[0]),
                   between(c->from.y, c->to.y, (double)(i / nx % ny), c->counts[1]),
                   between(c->from.z, c->to.z, (double)(i / nx / ny), c->counts[2]));
}

static void place_on_disc(const skf_source *c, skf_random *r, skf_particle *p) {
  double x, y, s = sqrt(random_disc(r, &x, &y)), a = c->inner / c->outer;
  double radius = c->outer * sqrt(a * a + (1 - a * a) * random_next(r));
  skf_vec3 e = v3_perp(c->normal), f = v3_cross(c->normal, e);
  p->position = v3_mad(v3_mad(c->center, radius * (x / s), e), radius * (y / s), f);
}

/* In a shell or a ball. */
static skf_vec3 place_in_shell(const skf_source *c, skf_random *r, skf_particle *p) {
  skf_vec3 n = random_direction(r);
  double a = c->outer > 0 ? c->inner / c->outer : 0, u = random_next(r);
  double radius = a == 1 ? c->outer : c->outer * random_cbrt(a * a * a + (1 - a * a * a) * u);
  p->position = v3_mad(c->center, radius, n);
  return n;
}

static void place(const skf_source *c, uint32_t stream, size_t i, skf_particle *p) {
  skf_random r = random_of((uint64_t)c->seed, stream, i);
  p->velocity = c->velocity;
  if (c->kind == SKF_SOURCE_GRID) {
    place_on_grid(c, i, p);
  } else if (c->kind == SKF_SOURCE_DISC) {
    place_on_disc(c, &r, p);
  } else {
    skf_vec3 n = place_in_shell(c, &r, p), across = v3_perp(n);
    double x, y, s = sqrt(random_disc(&r, &x, &y));
    across = v3_mad(v3_scale(x / s, across), y / s, v3_cross(n, across));
    p->velocity = v3_mad(v3_mad(p->velocity, c->radial, n), c->tangential, across);
  }
  if (!(c->spread > 0)) return;
  double a[4];
  random_normal(&r, a, a + 1), random_normal(&r, a + 2, a + 3);
  p->velocity = v3_mad(p->velocity, c->spread, v3(a[0], a[1], a[2]));
}

enum { BLOCK = 1024 };

/* Accelerations of n <= BLOCK particles at t = 0, when every body's frame is the inertial one. */
static skf_status pull(const skf_scene *scene, const skf_particle *p, size_t n, skf_vec3 *a) {
  double at[3][BLOCK], F[BLOCK], slope[3][BLOCK], *const g[3] = {slope[0], slope[1], slope[2]};
  const double *const x[3] = {at[0], at[1], at[2]};
  for (size_t i = 0; i < n; i++) {
    at[0][i] = p[i].position.x, at[1][i] = p[i].position.y, at[2][i] = p[i].position.z;
    a[i] = v3(0, 0, 0);
  }
  for (size_t b = 0; b < scene->body_count; b++) {
    skf_status s = skf_field_eval(scene->bodies[b].field, n, x, F, g, NULL);
    if (s) return s;
    double gain = scene->G * scene->bodies[b].rho;
    for (size_t i = 0; i < n; i++) a[i] = v3_mad(a[i], gain, v3(g[0][i], g[1][i], g[2][i]));
  }
  return SKF_OK;
}

/* Adds the speed of circular orbits about the disc's normal. */
static skf_status circulate(skf_reader *r, const skf_source *c, skf_particle *p, size_t n) {
  skf_vec3 a[BLOCK];
  for (size_t first = 0; first < n; first += BLOCK) {
    size_t count = n - first < BLOCK ? n - first : BLOCK;
    skf_status s = pull(r->scene, p + first, count, a);
    if (s) return skf_error_set(r->error, s, c->node->line, "disc: %s", skf_status_text(s));
    for (size_t i = 0; i < count; i++) {
      skf_vec3 d = v3_sub(p[first + i].position, c->center), n1 = v3_unit(d);
      double radius = v3_norm(d), inwards = -v3_dot(a[i], n1);
      if (!(inwards >= 0) || !isfinite(inwards))
        return skf_error_set(
            r->error, SKF_ERR_RANGE, skf_map_line(r, c->node, "circular"),
            "no circular orbit at %.6g from the centre, where nothing pulls towards it, expected other "
            "radii",
            radius);
      p[first + i].velocity =
          v3_mad(p[first + i].velocity, c->circular * sqrt(radius * inwards), v3_cross(c->normal, n1));
    }
  }
  return SKF_OK;
}

/* What is given as finite may overflow where it adds up. */
static skf_status check_finite(skf_reader *r, const skf_particle *p, size_t n, long line) {
  for (size_t i = 0; i < n; i++) {
    bool x = v3_finite(p[i].position);
    if (x && v3_finite(p[i].velocity)) continue;
    return skf_error_set(r->error, SKF_ERR_RANGE, line,
                         "a particle's %s is too large for a number, expected finite ones",
                         x ? "velocity" : "position");
  }
  return SKF_OK;
}

size_t skf_source_name_size(const char *name, size_t n) {
  return strlen(name) + 2 + (size_t)snprintf(NULL, 0, "%06zu", n);
}

void skf_source_name(char *out, const char *name, size_t i, size_t n) {
  int width = snprintf(NULL, 0, "%06zu", n - 1);
  size_t length = strlen(name);
  memcpy(out, name, length);
  out[length] = '-';
  for (int k = width; k > 0; k--, i /= 10) out[length + (size_t)k] = (char)('0' + i % 10);
  out[length + 1 + (size_t)width] = 0;
}

skf_status skf_keep_names(skf_reader *r, char *names) {
  skf_scene *scene = r->scene;
  char **more = names ? skf_realloc(scene->name_pools, scene->name_pool_count + 1, sizeof *more) : NULL;
  if (!more) return skf_free(names), skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  scene->name_pools = more;
  scene->name_pools[scene->name_pool_count++] = names;
  return SKF_OK;
}

static uint32_t stream_of(const char *name) {
  uint32_t h = 2166136261u; /* FNV-1a */
  for (; *name; name++) h = (h ^ (unsigned char)*name) * 16777619u;
  return h;
}

/* Notes the seed of the next n particles, if it matters to them. */
static skf_status keep_seed(skf_reader *r, const skf_source *c, size_t n) {
  skf_scene *scene = r->scene;
  if (c->kind == SKF_SOURCE_GRID && !(c->spread > 0)) return SKF_OK;
  skf_drawn *more = skf_realloc(scene->drawn, scene->drawn_count + 1, sizeof *more);
  if (!more) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  scene->drawn = more;
  more[scene->drawn_count++] = (skf_drawn){scene->particle_count, n, (long long)c->seed};
  return SKF_OK;
}

skf_status skf_add_source(skf_reader *r, const skf_source *source, const char *name, long line) {
  double total =
      source->kind == SKF_SOURCE_GRID ? source->counts[0] * source->counts[1] * source->counts[2] : source->count;
  skf_particle *p;
  skf_status s = skf_more_particles(r, total, line, &p);
  if (s) return s;
  size_t n = (size_t)total, size = skf_source_name_size(name, n);
  char *names = skf_alloc(n, size);
  s = skf_keep_names(r, names);
  if (!s) s = keep_seed(r, source, n);
  for (size_t i = 0; i < n && !s; i++) {
    place(source, stream_of(name), i, p + i);
    p[i].sourced = true, p[i].line = line, p[i].name = names + i * size;
    skf_source_name(p[i].name, name, i, n);
  }
  if (!s) s = check_finite(r, p, n, line);
  if (!s && source->circular != 0 && !(s = circulate(r, source, p, n))) s = check_finite(r, p, n, line);
  if (!s) r->scene->particle_count += n;
  return s;
}
