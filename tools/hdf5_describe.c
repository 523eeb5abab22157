/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an HDF5 file of a run tells of it besides rows, and data sets that grow. */
#include "hdf5_describe.h"
#include <stdlib.h>
#include <string.h>

bool hdf5_text(hid_t at, const char *name, const char *text) {
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

static bool names(hid_t file, const char *name, const skf_scene *scene, size_t n,
                  const char *(*get)(const skf_scene *, size_t)) {
  hsize_t dims[1] = {n};
  const char **list = calloc(n + 1, sizeof *list);
  if (!list) return false;
  for (size_t i = 0; i < n; i++) list[i] = get(scene, i);
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, dims, NULL);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  bool ok = fixed(file, name, type, space, n ? list : NULL);
  H5Sclose(space);
  H5Tclose(type);
  free(list);
  return ok;
}

static const char *particle_name(const skf_scene *s, size_t i) { return s->particles[i].name; }
static const char *body_name(const skf_scene *s, size_t i) { return s->bodies[i].name; }

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
static bool seeds(hid_t file, const skf_scene *scene) {
  enum { MOST = 1000 }; /* attributes are limited to 64 kB */
  size_t n = scene->drawn_count < MOST ? scene->drawn_count : MOST;
  long long seed[MOST], range[MOST][2];
  for (size_t i = 0; i < n; i++) {
    const skf_drawn *d = scene->drawn + i;
    seed[i] = d->seed, range[i][0] = (long long)d->first, range[i][1] = (long long)d->count;
  }
  hsize_t shape[2] = {n, 2};
  return n == 0 ||
         (integers_attribute(file, "seed", 1, shape, seed) && integers_attribute(file, "seeded", 2, shape, range[0]));
}

bool hdf5_describe(hid_t file, const trajectory_table *table) {
  const skf_scene *scene = table->scene;
  size_t length;
  char *text = slurp(table->scene_path, &length);
  bool ok = hdf5_text(file, "program", "skelfield") && hdf5_text(file, "version", skf_version());
  ok = ok && hdf5_text(file, "frame", table->turning ? "body" : "inertial");
  ok = ok && seeds(file, scene);
  if (text && length > 0) ok = ok && text_data(file, "scene", text, length);
  free(text);
  ok = ok && names(file, "particles", scene, scene->particle_count, particle_name);
  return ok && names(file, "bodies", scene, scene->body_count, body_name);
}

/* Chunks are there before they are written: MPI's HDF5 needs that. */
bool hdf5_growing(hid_t file, const char *name, hid_t type, int rank, hsize_t deep, const hsize_t *rest, hid_t *out) {
  hsize_t dims[3] = {0}, most[3] = {H5S_UNLIMITED}, chunk[3] = {deep};
  for (int k = 1; k < rank; k++) dims[k] = most[k] = chunk[k] = rest[k - 1];
  if (rank > 1 && chunk[1] > HDF5_WIDE) chunk[1] = HDF5_WIDE;
  hid_t space = H5Screate_simple(rank, dims, most), plan = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(plan, rank, chunk);
  H5Pset_shuffle(plan);
  H5Pset_deflate(plan, 1);
  H5Pset_obj_track_times(plan, false);
  H5Pset_alloc_time(plan, H5D_ALLOC_TIME_EARLY);
  *out = H5Dcreate2(file, name, type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
  H5Pclose(plan);
  H5Sclose(space);
  return *out >= 0;
}
