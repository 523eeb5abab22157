/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "contact_map.h"
#include "core/vec3.h"
#include "launch.h"
#include "map_grid.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)

static void lay_bins(contact_map *m) {
  for (int k = 0; k < m->band_count; k++) {
    double middle = (k + 0.5) * m->step - 90;
    int n = (int)lround(360 / m->step * cos(middle * DEGREE));
    m->bands[k] = (contact_band){m->bin_count, n > 1 ? n : 1};
    m->bin_count += (size_t)m->bands[k].count;
  }
}

contact_bin contact_map_bin(const contact_map *m, int band, int i) {
  double width = 360.0 / m->bands[band].count;
  contact_bin b = {.south = band * m->step - 90, .west = i * width - 180};
  b.north = band + 1 < m->band_count ? b.south + m->step : 90;
  b.east = i + 1 < m->bands[band].count ? b.west + width : 180;
  b.share = (sin(b.north * DEGREE) - sin(b.south * DEGREE)) / 2 / m->bands[band].count;
  return b;
}

/* Where a body has no ellipsoid: a sphere about the axis of its spin, or about the middle of its skeleton. */
static skf_ellipsoid sphere_of(const skf_body *body) {
  skf_box box = map_skeleton_box(body);
  skf_vec3 middle = v3_scale(0.5, v3_add(box.lo, box.hi));
  skf_ellipsoid e = {true, 1, 1, middle, {0, 0, 1}, {1, 0, 0}};
  if (body->spin.rate == 0) return e;
  skf_vec3 axis = body->spin.axis, about = body->spin.about;
  double along = v3_dot(v3_sub(middle, about), axis) / v3_dot(axis, axis);
  e.center = v3_add(about, v3_scale(along, axis));
  e.axis = body->spin.rate > 0 ? axis : v3_scale(-1, axis);
  if (fabs(axis.y) + fabs(axis.z) < 1e-6 * fabs(axis.x)) e.meridian = v3(0, 1, 0);
  return e;
}

static int choose_body(contact_map *m, const cli *c) {
  const char *name = cli_value(c, "map-body");
  int b = name ? cli_body(m->scene, name) : 0;
  if (b < 0) return CLI_BAD;
  const skf_body *body = m->scene->bodies + b;
  skf_body with = *body;
  if (!with.ellipsoid.given) with.ellipsoid = sphere_of(body);
  m->body = (size_t)b;
  return launch_geo(&with, &m->geo);
}

static int choose_step(contact_map *m, const cli *c) {
  m->step = 5;
  int status = cli_number(c, "map-step", 0, &m->step);
  if (status) return status;
  double n = 180 / m->step;
  if (!(m->step >= 0.25) || fabs(n - round(n)) > 1e-9 * n)
    return cli_fail(CLI_BAD, "--map-step %s: expected degrees of which a whole number, at most 720, makes 180",
                    cli_value(c, "map-step"));
  m->band_count = (int)round(n);
  return CLI_DONE;
}

static int choose_quantity(contact_map *m, const cli *c) {
  const char *name = cli_value(c, "map-quantity");
  m->by_speed = name && strcmp(name, "speed") == 0;
  if (!name || m->by_speed || strcmp(name, "density") == 0) return CLI_DONE;
  return cli_fail(CLI_BAD, "--map-quantity %s: expected density or speed", name);
}

static int choose_files(contact_map *m, const cli *c) {
  m->picture_path = cli_value(c, "contact-map"), m->table_path = cli_value(c, "contact-bins");
  for (int k = 0; k < 2; k++) {
    const char *path = k ? m->table_path : m->picture_path;
    if (path && strcmp(path, "-") == 0)
      return cli_fail(CLI_BAD, "--contact-%s: expected a file name", k ? "bins" : "map");
  }
  if (!m->picture_path) return CLI_DONE;
  int status = picture_format_of(m->picture_path, &m->format);
  if (status == CLI_DONE && m->format->linear)
    status =
        cli_fail(CLI_BAD, "%s: this format holds light, a map needs one for pictures such as .png", m->picture_path);
  return status ? status : picture_module(&m->plot);
}

bool contact_map_wanted(const contact_map *m) { return m->picture_path || m->table_path; }

int contact_map_new(contact_map *m, const cli *c, const skf_scene *scene, const skf_world *world) {
  static const char *const details[] = {"map-body", "map-step", "map-quantity"};
  *m = (contact_map){.scene = scene, .world = world};
  bool wanted = cli_given(c, "contact-map") || cli_given(c, "contact-bins");
  for (size_t i = 0; i < sizeof details / sizeof *details && !wanted; i++)
    if (cli_given(c, details[i])) return cli_fail(CLI_BAD, "--%s needs --contact-map or --contact-bins", details[i]);
  if (!wanted) return CLI_DONE;
  int status = choose_step(m, c);
  if (!status) status = choose_quantity(m, c);
  if (!status) status = choose_body(m, c);
  if (!status) status = choose_files(m, c);
  if (status) return status;
  m->bands = calloc((size_t)m->band_count, sizeof *m->bands);
  if (m->bands) lay_bins(m);
  m->count = calloc(m->bin_count + 1, sizeof *m->count);
  m->speed = calloc(m->bin_count + 1, sizeof *m->speed);
  return m->bands && m->count && m->speed ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
}

int contact_map_open(contact_map *m) {
  int status = m->picture_path ? cli_out_open(&m->picture, m->picture_path) : CLI_DONE;
  if (status) return status;
  m->picture_open = m->picture_path != NULL;
  if (m->table_path) status = cli_out_open(&m->table, m->table_path);
  m->table_open = m->table_path && !status;
  return status;
}

void contact_map_add(contact_map *m, const skf_contact *c) {
  skf_place p;
  if (c->body != m->body || skf_geo_place(m->geo, skf_world_to_body(m->world, c->body, c->t, c->position), &p)) return;
  double latitude = p.latitude / DEGREE, longitude = p.longitude / DEGREE;
  int k = (int)((latitude + 90) / m->step);
  const contact_band *band = m->bands + (k < 0 ? 0 : k < m->band_count ? k : m->band_count - 1);
  int i = (int)((longitude + 180) / 360 * band->count);
  size_t bin = band->first + (size_t)(i < 0 ? 0 : i < band->count ? i : band->count - 1);
  m->contacts++;
  m->count[bin]++;
  m->speed[bin] += v3_norm(v3_sub(c->before, skf_world_surface_velocity(m->world, c->body, c->position)));
}

static void put_table(const contact_map *m, FILE *f) {
  fputs("lat_min,lat_max,lon_min,lon_max,count,speed\n", f);
  for (int k = 0; k < m->band_count; k++)
    for (int i = 0; i < m->bands[k].count; i++) {
      contact_bin b = contact_map_bin(m, k, i);
      size_t bin = m->bands[k].first + (size_t)i;
      const double edges[4] = {b.south, b.north, b.west, b.east};
      for (int e = 0; e < 4; e++) cli_put(f, edges[e]), putc(',', f);
      fprintf(f, "%ld,", m->count[bin]);
      cli_put(f, m->count[bin] ? m->speed[bin] / (double)m->count[bin] : NAN);
      putc('\n', f);
    }
}

static int put_picture(contact_map *m) {
  unsigned char *bytes;
  size_t n;
  int status = contact_map_draw(m, &bytes, &n);
  if (status) return status;
  fwrite(bytes, 1, n, m->picture.file);
  m->plot->release(bytes);
  return CLI_DONE;
}

int contact_map_close(contact_map *m, bool keep) {
  int status = keep && m->picture_open ? put_picture(m) : CLI_DONE;
  keep = keep && status == CLI_DONE;
  if (m->table_open && keep) put_table(m, m->table.file);
  cli_out *const outs[2] = {m->picture_open ? &m->picture : NULL, m->table_open ? &m->table : NULL};
  for (int k = 0; k < 2; k++) {
    if (outs[k] && keep && cli_out_commit(outs[k])) status = CLI_FAILED;
    if (outs[k] && !keep) cli_out_abort(outs[k]);
  }
  m->picture_open = m->table_open = false;
  return status;
}

void contact_map_free(contact_map *m) {
  contact_map_close(m, false);
  skf_geo_free(m->geo);
  free(m->bands), free(m->count), free(m->speed);
}
