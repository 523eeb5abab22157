/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes and bodies that a command line names. */
#include "cli_private.h"
#include "adapt/polygon.h"
#include <string.h>

/* A finite mass on an infinite plane is legal, and surprising. */
static void warn(const char *path, const skf_scene *scene) {
  for (size_t i = 0; i < scene->body_count; i++) {
    const skf_body *b = scene->bodies + i;
    if (b->has_mass && b->mass != 0 && b->rho == 0)
      cli_say("skelfield: %s:%ld: warning: body '%s' has a mass and infinite measure: its density is 0, it does not "
              "attract (give it a density)",
              path, b->line, b->name);
  }
}

int cli_scene(const cli *c, const char *path, skf_scene **out) {
  int status = cli_scene_at(c, path, 0, out);
  if (!status) warn(path, *out);
  return status;
}

/* No option writes a file that it names. */
static int check_files(const cli *c, skf_scene **scene) {
  int status = CLI_DONE;
  for (size_t i = 0; i < (*scene)->file_count && !status; i++) status = cli_check_read(c, (*scene)->files[i]);
  if (status) skf_scene_free(*scene), *scene = NULL;
  return status;
}

int cli_scene_at(const cli *c, const char *path, double time, skf_scene **out) {
  skf_error e;
  const skf_scene_hooks hooks = {.cut_rings = polygon_cutter(), .time = time};
  skf_status s = skf_scene_read_with(path, &hooks, out, &e);
  if (!s) return check_files(c, out);
  if (e.file[0]) path = e.file;
  if (e.line > 0) return cli_fail(CLI_BAD, "%s:%ld: %s", path, e.line, e.text);
  return cli_fail(s == SKF_ERR_NOMEM ? CLI_FAILED : CLI_BAD, "%s: %s", path, e.text);
}

/* From here on expansions save more than it costs to make them, from some 50 000 points on: four times as many where
   they are polynomials; and points are summed directly at two fifths of the cost of others. */
enum { MANY_PRIMITIVES = 5000, MANY_POINTS = 100000 };

static bool is_large(const skf_body *b) {
  size_t n = 0; /* twentieths */
  for (size_t i = 0; i < b->element_count; i++) {
    const skf_element *e = b->elements + i;
    bool quick = e->kernel.type == SKF_INVERSE || e->kernel.type == SKF_GAUSSIAN;
    n += (e->primitive.shape == SKF_POINT ? 2u : 5u) * (quick ? 4u : 1u);
  }
  return n >= 20 * MANY_PRIMITIVES;
}

/* The accuracy that is asked for, 0: none; where nothing is said, by the size of the work. */
static int accuracy_of(const cli *c, size_t points, skf_field_options *options, bool *automatic) {
  const char *text = cli_value(c, "accuracy");
  *options = (skf_field_options){.accuracy = 0};
  *automatic = !text && points >= MANY_POINTS;
  if (*automatic) options->accuracy = 1e-12;
  return !text || !strcmp(text, "exact") || !strcmp(text, "0") ? CLI_DONE
                                                               : cli_number(c, "accuracy", 0, &options->accuracy);
}

int cli_accuracy(const cli *c, skf_scene *scene, size_t points, bool *made) {
  skf_field_options options;
  bool automatic;
  *made = false;
  int status = accuracy_of(c, points, &options, &automatic);
  if (status || options.accuracy == 0) return status;
  for (size_t i = 0; i < scene->body_count; i++) {
    skf_body *b = scene->bodies + i;
    skf_field *field;
    if (automatic && !is_large(b)) continue;
    skf_status s = skf_field_new_with(b->elements, b->element_count, &options, &field);
    if (s && automatic) continue; /* no room: it goes on as it was */
    if (s == SKF_ERR_RANGE)
      return cli_fail(CLI_BAD, "--accuracy %s: expected a number from 1e-12 to 0.01, or exact",
                      cli_value(c, "accuracy"));
    if (s) return cli_fail_status(s, b->name);
    skf_field_free(b->field);
    b->field = field, *made = true;
  }
  return CLI_DONE;
}

int cli_body(const skf_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->body_count; i++)
    if (strcmp(scene->bodies[i].name, name) == 0) return (int)i;
  char list[256] = "";
  for (size_t i = 0; i < scene->body_count && strlen(list) < 200; i++) {
    size_t n = strlen(list);
    snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", scene->bodies[i].name);
  }
  cli_fail(CLI_BAD, "no body is called '%s', expected one of %s", name, list);
  return -1;
}
