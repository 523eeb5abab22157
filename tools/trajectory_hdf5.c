/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trajectories as HDF5: t (T), position and velocity (T, N, 3), on request place (T, N, 3) and invariants (T, N, 6),
   particles, bodies, contacts, the scene's text, and as attributes the program, its version, the frame and the seeds.
   No wall time: the same run gives the same data. */
#include "trajectory.h"
#include <stdlib.h>
#include <string.h>

#include <hdf5.h>

enum { TIME, POSITION, VELOCITY, PLACE, INVARIANTS, SERIES };
/* A chunk holds about this many numbers: 8000 doubles are 64 kB. */
#define CHUNK 8000

/* A contact as it lies in the file. */
typedef struct contact_record {
  double t;
  long long particle, body;
  double position[3], normal[3], velocity[3], after[3];
  char outcome[8];
} contact_record;

typedef struct run_hdf5 {
  cli_out out;
  const trajectory_table *table;
  hid_t file, series[SERIES], contacts, contact_type;
  hsize_t rows, contact_count;
  double *buffer; /* 6 N */
  bool failed;
} run_hdf5;

static bool text_attribute(hid_t at, const char *name, const char *text) {
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, strlen(text) + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  hid_t a = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool ok = a >= 0 && H5Awrite(a, type, text) >= 0;
  if (a >= 0) H5Aclose(a);
  H5Sclose(space);
  H5Tclose(type);
  return ok;
}

/* A data set of its final size, and what is in it. Without its time of birth: the same run gives the same bytes. */
static bool fixed(hid_t at, const char *name, hid_t type, hid_t space, const void *data) {
  hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(plan, false);
  hid_t d = H5Dcreate2(at, name, type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
  bool ok = d >= 0 && (!data || H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
  if (d >= 0) H5Dclose(d);
  H5Pclose(plan);
  return ok;
}

/* The scene's text goes to a data set: attributes are limited to 64 kB. */
static bool text_data(hid_t at, const char *name, const char *text, size_t length) {
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, length + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  bool ok = fixed(at, name, type, space, text);
  H5Sclose(space);
  H5Tclose(type);
  return ok;
}

static bool names(run_hdf5 *w, const char *name, size_t n, const char *(*get)(const skf_scene *, size_t)) {
  hsize_t dims[1] = {n};
  const char **list = calloc(n + 1, sizeof *list);
  if (!list) return false;
  for (size_t i = 0; i < n; i++) list[i] = get(w->table->scene, i);
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, dims, NULL);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  bool ok = fixed(w->file, name, type, space, n ? list : NULL);
  H5Sclose(space);
  H5Tclose(type);
  free(list);
  return ok;
}

static const char *particle_name(const skf_scene *s, size_t i) { return s->particles[i].name; }
static const char *body_name(const skf_scene *s, size_t i) { return s->bodies[i].name; }

/* A data set that grows along its first dimension, chunked, shuffled and deflated. */
static hid_t growing(hid_t file, const char *name, hid_t type, int rank, const hsize_t *rest, size_t width) {
  hsize_t dims[3] = {0}, most[3] = {H5S_UNLIMITED}, chunk[3] = {CHUNK / (width ? width : 1) + 1};
  for (int k = 1; k < rank; k++) dims[k] = most[k] = chunk[k] = rest[k - 1];
  if (rank > 1 && chunk[1] > CHUNK / 3) chunk[1] = CHUNK / 3;
  hid_t space = H5Screate_simple(rank, dims, most), plan = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(plan, rank, chunk);
  H5Pset_shuffle(plan);
  H5Pset_deflate(plan, 1);
  H5Pset_obj_track_times(plan, false);
  hid_t d = H5Dcreate2(file, name, type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
  H5Pclose(plan);
  H5Sclose(space);
  return d;
}

static hid_t contact_type(void) {
  hsize_t three = 3;
  hid_t vector = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three), text = H5Tcopy(H5T_C_S1);
  hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(contact_record));
  H5Tset_size(text, sizeof((contact_record *)0)->outcome);
  H5Tinsert(type, "t", offsetof(contact_record, t), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "particle", offsetof(contact_record, particle), H5T_NATIVE_LLONG);
  H5Tinsert(type, "body", offsetof(contact_record, body), H5T_NATIVE_LLONG);
  H5Tinsert(type, "position", offsetof(contact_record, position), vector);
  H5Tinsert(type, "normal", offsetof(contact_record, normal), vector);
  H5Tinsert(type, "velocity", offsetof(contact_record, velocity), vector);
  H5Tinsert(type, "velocity_after", offsetof(contact_record, after), vector);
  H5Tinsert(type, "outcome", offsetof(contact_record, outcome), text);
  H5Tclose(vector);
  H5Tclose(text);
  return type;
}

/* Appends one record of shape `rest` to a growing data set. */
static bool append(hid_t d, hid_t type, int rank, const hsize_t *rest, hsize_t at, const void *data) {
  hsize_t size[3] = {at + 1}, start[3] = {at}, count[3] = {1};
  for (int k = 1; k < rank; k++) size[k] = count[k] = rest[k - 1];
  if (H5Dset_extent(d, size) < 0) return false;
  hid_t file = H5Dget_space(d), memory = H5Screate_simple(rank, count, NULL);
  H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, count, NULL);
  bool ok = H5Dwrite(d, type, memory, file, H5P_DEFAULT, data) >= 0;
  H5Sclose(memory);
  H5Sclose(file);
  return ok;
}

/* The scene's file, whole; NULL when it cannot be read again (a pipe). */
static char *slurp(const char *path, size_t *length) {
  FILE *f = fopen(path, "rb");
  char *text = NULL;
  size_t n = 0, room = 0;
  while (f && !feof(f) && !ferror(f)) {
    if (n + 65536 > room) {
      char *more = realloc(text, room = 2 * room + 65536);
      if (!more) break;
      text = more;
    }
    n += fread(text + n, 1, 65535, f);
  }
  if (f) fclose(f);
  if (text) text[n] = 0;
  return *length = n, text;
}

static bool integers_attribute(hid_t at, const char *name, int rank, const hsize_t *shape, const long long *values) {
  hid_t space = H5Screate_simple(rank, shape, NULL);
  hid_t a = H5Acreate2(at, name, H5T_NATIVE_LLONG, space, H5P_DEFAULT, H5P_DEFAULT);
  bool ok = a >= 0 && H5Awrite(a, H5T_NATIVE_LLONG, values) >= 0;
  if (a >= 0) H5Aclose(a);
  H5Sclose(space);
  return ok;
}

/* `seed` of each source that draws its particles, and `seeded`: their first one and how many. */
static bool seeds(run_hdf5 *w) {
  enum { MOST = 1000 }; /* attributes are limited to 64 kB */
  const skf_scene *scene = w->table->scene;
  size_t n = scene->drawn_count < MOST ? scene->drawn_count : MOST;
  long long seed[MOST], range[MOST][2];
  for (size_t i = 0; i < n; i++) {
    const skf_drawn *d = scene->drawn + i;
    seed[i] = d->seed, range[i][0] = (long long)d->first, range[i][1] = (long long)d->count;
  }
  hsize_t shape[2] = {n, 2};
  return n == 0 || (integers_attribute(w->file, "seed", 1, shape, seed) &&
                    integers_attribute(w->file, "seeded", 2, shape, range[0]));
}

static bool describe(run_hdf5 *w) {
  size_t length;
  char *text = slurp(w->table->scene_path, &length);
  bool ok = text_attribute(w->file, "program", "skelfield") && text_attribute(w->file, "version", skf_version());
  ok = ok && text_attribute(w->file, "frame", w->table->turning ? "body" : "inertial");
  ok = ok && seeds(w);
  if (text && length > 0) ok = ok && text_data(w->file, "scene", text, length);
  free(text);
  ok = ok && names(w, "particles", w->table->scene->particle_count, particle_name);
  return ok && names(w, "bodies", w->table->scene->body_count, body_name);
}

static bool lay_out(run_hdf5 *w) {
  static const char *const name[SERIES] = {"t", "position", "velocity", "place", "invariants"};
  hsize_t n = w->table->scene->particle_count;
  bool ok = true;
  for (int k = 0; k < SERIES; k++) {
    if ((k == PLACE && !w->table->track) || (k == INVARIANTS && !w->table->invariants)) continue;
    hsize_t shape[2] = {n, k == INVARIANTS ? RUN_QUANTITIES : 3};
    w->series[k] = growing(w->file, name[k], H5T_NATIVE_DOUBLE, k ? 3 : 1, shape, k ? shape[0] * shape[1] : 1);
    ok = ok && w->series[k] >= 0;
  }
  if (w->table->invariants) ok = ok && text_attribute(w->series[INVARIANTS], "columns", RUN_QUANTITY_NAMES);
  w->contact_type = contact_type();
  w->contacts = growing(w->file, "contacts", w->contact_type, 1, NULL, 16);
  return ok && w->contacts >= 0;
}

static int broken(run_hdf5 *w) {
  w->failed = true;
  return cli_fail(CLI_FAILED, "%s: HDF5 could not write", w->out.path);
}

static void close_all(run_hdf5 *w) {
  for (int k = 0; k < SERIES; k++)
    if (w->series[k] > 0) H5Dclose(w->series[k]);
  if (w->contacts > 0) H5Dclose(w->contacts);
  if (w->contact_type > 0) H5Tclose(w->contact_type);
  if (w->file > 0 && H5Fclose(w->file) < 0) w->failed = true;
  free(w->buffer);
}

static void abort_hdf5(void *self) {
  run_hdf5 *w = self;
  close_all(w);
  cli_out_abort(&w->out);
  free(w);
}

static int open_hdf5(void **self, const char *path, const trajectory_table *table) {
  run_hdf5 *w = calloc(1, sizeof *w);
  if (!w || !(w->buffer = calloc(RUN_QUANTITIES * table->scene->particle_count + 1, sizeof(double))))
    return free(w), cli_fail(CLI_FAILED, "out of memory");
  w->table = table;
  int status = cli_out_name(&w->out, path);
  if (status != CLI_DONE) return free(w->buffer), free(w), status;
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  w->file = H5Fcreate(w->out.temp, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (w->file < 0 || !describe(w) || !lay_out(w)) return broken(w), abort_hdf5(w), CLI_FAILED;
  return *self = w, CLI_DONE;
}

static int row_hdf5(void *self, double t, const skf_state *states, const run_more *more) {
  run_hdf5 *w = self;
  const run_place *places = more->places;
  hsize_t n = w->table->scene->particle_count;
  bool ok = append(w->series[TIME], H5T_NATIVE_DOUBLE, 1, NULL, w->rows, &t);
  for (int k = POSITION; k < SERIES && ok; k++) {
    if ((k == PLACE && !places) || (k == INVARIANTS && !more->quantities)) continue;
    hsize_t shape[2] = {n, k == INVARIANTS ? RUN_QUANTITIES : 3};
    for (size_t i = 0; i < n; i++) {
      if (k == INVARIANTS) {
        run_quantities(more->quantities + i, w->buffer + RUN_QUANTITIES * i);
        continue;
      }
      skf_vec3 v = k == POSITION ? states[i].position : states[i].velocity;
      if (k == PLACE) v = (skf_vec3){places[i].latitude, places[i].longitude, places[i].height};
      memcpy(w->buffer + 3 * i, (double[3]){v.x, v.y, v.z}, 3 * sizeof(double));
    }
    ok = append(w->series[k], H5T_NATIVE_DOUBLE, 3, shape, w->rows, w->buffer);
  }
  w->rows++;
  return ok ? CLI_DONE : broken(w);
}

static void vector(double out[3], skf_vec3 v) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

static int contact_hdf5(void *self, const skf_contact *c) {
  run_hdf5 *w = self;
  contact_record r = {.t = c->t, .particle = (long long)c->particle, .body = (long long)c->body};
  vector(r.position, c->position);
  vector(r.normal, c->normal);
  vector(r.velocity, c->before);
  vector(r.after, c->after);
  strncpy(r.outcome, skf_outcome_name(c->outcome), sizeof r.outcome - 1);
  return append(w->contacts, w->contact_type, 1, NULL, w->contact_count++, &r) ? CLI_DONE : broken(w);
}

static int commit_hdf5(void *self) {
  run_hdf5 *w = self;
  close_all(w);
  int status = CLI_FAILED;
  if (w->failed)
    cli_out_abort(&w->out);
  else
    status = cli_out_commit(&w->out);
  free(w);
  return status;
}

/* Found by this name in the module. */
extern const trajectory_writer trajectory_module_hdf5;
const trajectory_writer trajectory_module_hdf5 = {open_hdf5, row_hdf5, contact_hdf5, commit_hdf5, abort_hdf5};
