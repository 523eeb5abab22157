/* SPDX-License-Identifier: MIT */
/* A scene that uses every key, and the malformed scenes of malformed.txt. */
#ifndef SKF_TESTS_SCENE_TEXT_H
#define SKF_TESTS_SCENE_TEXT_H

#include "check.h"
#include "skelfield/scene.h"
#include <string.h>

static const char full_scene[] =
    "# every key\n"
    "skelfield: 1\n"
    "gravity: {G: 1.0}\n"
    "bodies:\n"
    "  - name: cross\n"
    "    iso: 0.35\n"
    "    kernel: {type: cauchy, s: 2.5}\n"
    "    mass: 6.0\n"
    "    spin: {axis: [0, 0, 2], rate: 0.6, about: [1, 2, 3]}\n"
    "    ellipsoid: {equatorial: 1, polar: 2, center: [0, 0, 1], axis: [0, 1, 0], meridian: [0, 0, 1]}\n"
    "    color: [0.1, 0.2, 0.3]\n"
    "    skeleton:\n"
    "      - point:    {at: [0, 0, 0], strength: 1.5}\n"
    "      - segment:  {from: [-2, 0, 0], to: [2, 0, 0]}\n"
    "      - arc:      {center: [0, 0, 0], normal: [0, 0, 1], start: [1, 0, 0], radius: 1.5, sweep: 360}\n"
    "      - triangle: {vertices: [[0, 0, 0], [2, 0, 0], [0, 1.5, 0]], kernel: {type: gaussian, a: 2}, strength: -1}\n"
    "  - name: \"ground plane\"\n"
    "    iso: -1\n"
    "    density: -3\n"
    "    skeleton:\n"
    "      - plane:\n"
    "          through: [0, 0, -0.5]\n"
    "          normal: [0, 0, 1]\n"
    "          kernel:\n"
    "            type: inverse-squared\n"
    "particles:\n"
    "  - {name: probe, position: [3.2, 0.1, 0.4], velocity: [0.05, 0.95, 0.35]}\n"
    "  - name: ball\n"
    "    launch: {body: cross, latitude: 30, longitude: -60, height: 0.5, azimuth: 90, elevation: 45, speed: 2}\n"
    "simulation: {t_end: 40.0, output_every: 2.0, tolerance: 1.0e-10, contact: bounce, restitution: 0.5, friction: "
    "0.1}\n"
    "camera: {from: [5, 5, 5], to: [0, 0, 0], up: [0, 1, 0], fov: 30}\n"
    "lights:\n"
    "  - {point: [1, 2, 3], color: [1, 0.5, 0.25], intensity: 4}\n"
    "  - {direction: [0, 0, 1]}\n"
    "background: [0, 0, 0.5]\n";

/* Materials and handles, every key of theirs. */
static const char handled_scene[] =
    "skelfield: 1\n"
    "materials:\n"
    "  - {name: ice, kernel: {type: gaussian}, blobbiness: -0.3, color: [0.1, 0.2, 0.3]}\n"
    "  - {name: iron, strength: 3, radius: 0.5, influence: 2}\n"
    "bodies:\n"
    "  - name: a\n"
    "    iso: 0.7\n"
    "    material: ice\n"
    "    radius: 0.4\n"
    "    skeleton:\n"
    "      - point: {at: [0, 0, 0]}\n"
    "      - circle: {center: [0, 0, 0], normal: [0, 0, 1], radius: 2, thickness: 0.1}\n"
    "      - polyline: {points: [[0, 5, 0], [1, 5, 0], [4, 5, 0]], kernel: {type: quartic}, profile: sin2}\n"
    "      - segment: {from: [0, 0, 0], to: [0, 0, 3], profile: {cubic: [[0, 1, 0], [0.3, 2, 1], [1, 0, 0]]}}\n"
    "      - segment: {from: [0, 0, 0], to: [0, 0, 3], profile: {linear: [0, 1]}}\n";

static const char small_scene[] = "skelfield: 1\nbodies:\n  - {name: a, iso: 1, kernel: {type: inverse}, "
                                  "skeleton: [{point: {at: [0, 0, 0]}}]}\n";

static inline skf_status parse(const char *text, skf_scene **scene, skf_error *error) {
  return skf_scene_parse(text, strlen(text), ".", scene, error);
}

/* One entry of malformed.txt; the text is not NUL-terminated. */
typedef struct malformed {
  char name[128], part[128];
  long line;
  const char *text;
  size_t length;
} malformed;

static inline char *read_malformed(void) {
  char path[4096];
  const char *root = getenv("SKF_SOURCE_ROOT");
  snprintf(path, sizeof path, "%s/tests/scene/malformed.txt", root ? root : ".");
  FILE *f = fopen(path, "rb");
  if (!f) fail_msg("%s cannot be opened", path);
  char *text = calloc(1, 1 << 20);
  assert_true(fread(text, 1, (1 << 20) - 1, f) > 0);
  fclose(f);
  return text;
}

/* The entry that starts at or after `at`; returns where to look for the next one, NULL when there is none. */
static inline const char *next_malformed(const char *at, malformed *m) {
  at = strncmp(at, "== ", 3) == 0 ? at : strstr(at, "\n== ");
  if (!at) return NULL;
  at += *at == '\n';
  if (sscanf(at, "== %127[^|]| %ld | %127[^\n]\n", m->name, &m->line, m->part) != 3) fail_msg("bad entry: %.80s", at);
  m->text = strchr(at, '\n') + 1;
  const char *end = strstr(m->text - 1, "\n== ");
  m->length = end ? (size_t)(end + 1 - m->text) : strlen(m->text);
  return end ? end + 1 : m->text + m->length;
}

#endif
