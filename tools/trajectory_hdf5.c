/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trajectories as HDF5: t (T), position and velocity (T, N, 3), on request place (T, N, 3) and invariants (T, N, 6),
   particles, bodies, contacts, the scene's text, and as attributes the program, its version, the frame and the seeds.
   No wall time: the same run gives the same data.

   Compiled twice, with the HDF5 of one process and with that of MPI. Both lay the file out by one process, open it
   again and write rows in blocks, each chunk whole and once (but for the last ones) and in the same order: so the file
   has the same bytes for any number of processes. It is valid after each block. */
#include "hdf5_share.h"
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TIME, POSITION, VELOCITY, PLACE, INVARIANTS, SERIES };
enum { TIMES = HDF5_CHUNK + 1, CONTACTS = HDF5_CHUNK / 16 + 1 }; /* in a chunk */

static const char *const series_names[SERIES] = {"t", "position", "velocity", "place", "invariants"};

/* A contact as it lies in the file. */
typedef struct contact_record {
  double t;
  long long particle, body;
  double position[3], normal[3], velocity[3], after[3];
  char outcome[8];
} contact_record;

typedef struct run_hdf5 {
  cli_out out; /* the first process's; the others know the temporary name */
  const trajectory_table *table;
  trajectory_table alone; /* when another process is lost */
  hdf5_share share;
  hid_t file, transfer, series[SERIES], contacts, contact_type;
  hsize_t rows, times, contact_count; /* in the file */
  double *held[SERIES];               /* what waits: times, and rows of this process's particles */
  size_t held_rows, held_times, block;
  contact_record *records; /* that wait */
  size_t record_count, record_room;
  bool no_room, failed;
} run_hdf5;

static bool leads(const run_hdf5 *w) { return !w->table->crew || team_leads(w->table->crew); }
static bool lost(const run_hdf5 *w) { return w->table->crew && team_lost(w->table->crew); }

/* The worst of all processes. */
static int agree(const trajectory_table *table, int status) {
  return table->crew ? team_agree(table->crew, status) : status;
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

static hsize_t series_width(int k) { return k == TIME ? 1 : k == INVARIANTS ? RUN_QUANTITIES : 3; }

static bool asked_for(const run_hdf5 *w, int k) {
  return (k != PLACE || w->table->track) && (k != INVARIANTS || w->table->invariants);
}

static bool lay_out(run_hdf5 *w) {
  bool ok = true;
  for (int k = 0; k < SERIES && ok; k++) {
    hsize_t shape[2] = {w->table->scene->particle_count, series_width(k)}, deep = k ? w->block : TIMES;
    if (asked_for(w, k))
      ok = hdf5_growing(w->file, series_names[k], H5T_NATIVE_DOUBLE, k ? 3 : 1, deep, shape, w->series + k);
  }
  if (ok && w->table->invariants) ok = hdf5_text(w->series[INVARIANTS], "columns", RUN_QUANTITY_NAMES);
  return ok && hdf5_growing(w->file, "contacts", w->contact_type, 1, CONTACTS, NULL, &w->contacts);
}

static bool close_file(run_hdf5 *w) {
  for (int k = 0; k < SERIES; k++)
    if (w->series[k] > 0) H5Dclose(w->series[k]);
  if (w->contacts > 0) H5Dclose(w->contacts);
  bool ok = w->file <= 0 || H5Fclose(w->file) >= 0;
  memset(w->series, 0, sizeof w->series);
  return w->contacts = w->file = 0, ok;
}

static int name_file(run_hdf5 *w, const char *path) {
  int status = cli_out_name(&w->out, path);
  if (status != CLI_DONE) w->out.temp[0] = 0;
  return status;
}

/* By the first process: the file without rows. What is no regular file is not written together. */
static bool make_file(run_hdf5 *w) {
  if (w->table->crew && strcmp(w->out.temp, w->out.path) == 0) return true;
  w->file = H5Fcreate(w->out.temp, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  bool ok = w->file >= 0 && hdf5_describe(w->file, w->table) && lay_out(w);
  return close_file(w) && ok;
}

/* What the first process tells the others of the file that it has made. */
typedef struct sight {
  char name[sizeof((cli_out *)0)->temp];
  unsigned long long node, size;
} sight;

static bool look(const char *name, sight *out) {
  struct stat info;
  int fd = open(name, O_RDWR | O_CLOEXEC);
  bool ok = fd >= 0 && fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  if (ok) out->node = info.st_ino, out->size = (unsigned long long)info.st_size;
  if (fd >= 0) close(fd);
  return ok;
}

/* Whether all processes see the file: they may be on machines that share no folder. */
static bool in_sight(run_hdf5 *w, const char *path) {
  const skf_team *link = &w->table->crew->link;
  sight told = {{0}, 0, 0}, own = {{0}, 0, 0};
  bool ok = true;
  if (link->rank > 0) {
    ok = !link->receive(link->user, 0, &told, sizeof told);
    memcpy(w->out.temp, told.name, sizeof told.name);
    snprintf(w->out.path, sizeof w->out.path, "%s", path);
    ok = ok && look(told.name, &own) && own.node == told.node && own.size == told.size;
  } else {
    ok = strcmp(w->out.temp, w->out.path) != 0 && look(w->out.temp, &told);
    strcpy(told.name, w->out.temp);
    for (size_t m = 1; m < link->size; m++) ok = !link->send(link->user, m, &told, sizeof told) && ok;
  }
  return team_agree(w->table->crew, ok ? CLI_DONE : CLI_FAILED) == CLI_DONE;
}

/* By all. Chunks go to the file at once, not by way of a cache. */
static bool open_file(run_hdf5 *w) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS), uncached = H5Pcreate(H5P_DATASET_ACCESS);
  w->transfer = H5Pcreate(H5P_DATASET_XFER);
  if (w->table->crew) hdf5_share_access(access, w->transfer);
  H5Pset_chunk_cache(uncached, 0, 0, 0);
  w->file = H5Fopen(w->out.temp, H5F_ACC_RDWR, access);
  bool ok = w->file >= 0;
  for (int k = 0; k < SERIES && ok; k++)
    if (asked_for(w, k)) ok = (w->series[k] = H5Dopen2(w->file, series_names[k], uncached)) >= 0;
  ok = ok && (w->contacts = H5Dopen2(w->file, "contacts", uncached)) >= 0;
  H5Pclose(access);
  H5Pclose(uncached);
  return ok;
}

static void forget(run_hdf5 *w) {
  if (w->transfer > 0) H5Pclose(w->transfer);
  if (w->contact_type > 0) H5Tclose(w->contact_type);
  for (int k = 0; k < SERIES; k++) free(w->held[k]);
  hdf5_share_free(&w->share);
  free(w->records);
  free(w);
}

/* What several processes have failed to write cannot be closed: some would wait for others. */
static void abort_hdf5(void *self) {
  run_hdf5 *w = self;
  if (w->table->crew && (w->failed || lost(w)))
    team_hurry(w->table->crew, 0);
  else
    close_file(w);
  if (leads(w)) cli_out_abort(&w->out);
  forget(w);
}

/* What is wrong with one process is wrong with all of them. But they may be waiting for it within HDF5: then it does
   what is else the first one's and ends alone, which makes the launcher end the others. */
static int agreed(run_hdf5 *w, bool ok) {
  if (!ok && w->table->crew) team_hurry(w->table->crew, 2);
  int status = agree(w->table, ok ? CLI_DONE : CLI_FAILED);
  if (status == CLI_DONE || w->failed) return status;
  w->failed = true;
  if (!ok && !leads(w) && lost(w)) {
    unlink(w->out.temp);
    fprintf(stderr, "skelfield: %s: HDF5 could not write\n", w->out.path);
  }
  return cli_fail(CLI_FAILED, "%s: HDF5 could not write", w->out.path);
}

static bool allocate(run_hdf5 *w) {
  size_t n = w->table->scene->particle_count;
  w->block = HDF5_CHUNK / (3 * n) + 1;
  bool ok = hdf5_share_new(&w->share, w->table->crew, n, w->block);
  ok = ok && (w->held[TIME] = calloc(TIMES, sizeof(double)));
  for (int k = POSITION; k < SERIES && ok; k++)
    if (asked_for(w, k)) ok = (w->held[k] = calloc(w->block * w->share.mine + 1, series_width(k) * sizeof(double)));
  return ok;
}

static int open_hdf5(void **self, const char *path, const trajectory_table *table) {
  run_hdf5 *w = calloc(1, sizeof *w);
  if (w) w->table = table;
  bool room = w && allocate(w);
  int status = agree(table, room ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory"));
  *self = NULL;
  if (status != CLI_DONE && !w) return status;
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  w->contact_type = contact_type();
  if (status == CLI_DONE) status = agree(table, leads(w) ? name_file(w, path) : CLI_DONE);
  if (status == CLI_DONE) status = agreed(w, !leads(w) || make_file(w));
  bool seen = status == CLI_DONE && (!table->crew || in_sight(w, path));
  if (seen) status = agreed(w, open_file(w));
  if (!seen || status != CLI_DONE) return abort_hdf5(w), status;
  return *self = w, CLI_DONE;
}

/* Writes n records of a growing data set at `at`: of each this process's part of the second dimension, from `first` to
   `end`; without one, the first process writes. */
static int put(run_hdf5 *w, hid_t d, hid_t type, hsize_t at, hsize_t n, hsize_t width, const void *data) {
  const hdf5_share *share = &w->share;
  hsize_t size[3] = {at + n, share->count, width}, start[3] = {at, share->first, 0};
  hsize_t count[3] = {n, share->end - share->first, width};
  bool some = width ? count[1] > 0 : leads(w);
  bool ok = H5Dset_extent(d, size) >= 0;
  hid_t file = H5Dget_space(d), memory = H5Screate_simple(width ? 3 : 1, count, NULL);
  if (some) {
    H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, count, NULL);
  } else {
    H5Sselect_none(file);
    H5Sselect_none(memory);
  }
  ok = ok && H5Dwrite(d, type, memory, file, w->transfer, data) >= 0;
  H5Sclose(memory);
  H5Sclose(file);
  return agreed(w, ok);
}

static int put_times(run_hdf5 *w) {
  hsize_t n = w->held_times;
  int status = n ? put(w, w->series[TIME], H5T_NATIVE_DOUBLE, w->times, n, 0, w->held[TIME]) : CLI_DONE;
  w->times += n, w->held_times = 0;
  return status;
}

/* Contacts that wait: those of whole chunks, or all. */
static int put_contacts(run_hdf5 *w, bool all) {
  if (agreed(w, !w->no_room) != CLI_DONE) return CLI_FAILED;
  size_t n = all ? w->record_count : w->record_count - w->record_count % CONTACTS;
  n = (size_t)agree(w->table, (int)n); /* the others have none */
  if (n == 0) return CLI_DONE;
  int status = put(w, w->contacts, w->contact_type, w->contact_count, n, 0, w->records);
  w->contact_count += n;
  if (w->record_count == 0) return status;
  w->record_count -= n;
  memmove(w->records, w->records + n, w->record_count * sizeof *w->records);
  return status;
}

/* The rows that wait. */
static int put_block(run_hdf5 *w) {
  int status = CLI_DONE;
  for (int k = POSITION; k < SERIES && status == CLI_DONE && w->held_rows; k++) {
    if (!asked_for(w, k)) continue;
    const double *columns = hdf5_share_columns(&w->share, w->held[k], w->held_rows, series_width(k));
    status = agreed(w, columns != NULL);
    if (status == CLI_DONE)
      status = put(w, w->series[k], H5T_NATIVE_DOUBLE, w->rows, w->held_rows, series_width(k), columns);
  }
  w->rows += w->held_rows, w->held_rows = 0;
  return status;
}

static void hold(run_hdf5 *w, size_t i, const skf_state *s, const run_more *more) {
  size_t at = w->held_rows * w->share.mine + i;
  const skf_vec3 p = s->position, v = s->velocity;
  memcpy(w->held[POSITION] + 3 * at, (double[3]){p.x, p.y, p.z}, 3 * sizeof(double));
  memcpy(w->held[VELOCITY] + 3 * at, (double[3]){v.x, v.y, v.z}, 3 * sizeof(double));
  if (w->table->invariants) run_quantities(more->quantities + i, w->held[INVARIANTS] + RUN_QUANTITIES * at);
  if (!w->table->track) return;
  const run_place *place = more->places + i;
  memcpy(w->held[PLACE] + 3 * at, (double[3]){place->latitude, place->longitude, place->height}, 3 * sizeof(double));
}

static int row_hdf5(void *self, double t, const skf_state *states, const run_more *more) {
  run_hdf5 *w = self;
  for (size_t i = 0; i < w->share.mine; i++) hold(w, i, states + i, more);
  w->held[TIME][w->held_times++] = t;
  int status = CLI_DONE;
  if (++w->held_rows == w->block) {
    status = put_block(w);
    if (status == CLI_DONE) status = put_contacts(w, false);
    if (status == CLI_DONE) status = agreed(w, H5Fflush(w->file, H5F_SCOPE_LOCAL) >= 0);
  }
  return status == CLI_DONE && w->held_times == TIMES ? put_times(w) : status;
}

static void vector(double out[3], skf_vec3 v) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

/* A failure waits until the next block: the other processes know of it then. */
static int contact_hdf5(void *self, const skf_contact *c) {
  run_hdf5 *w = self;
  if (w->record_count == w->record_room) {
    size_t room = 2 * w->record_room + CONTACTS;
    contact_record *more = realloc(w->records, room * sizeof *more);
    if (!more) return w->no_room = true, CLI_DONE;
    w->records = more, w->record_room = room;
  }
  contact_record *r = w->records + w->record_count++;
  *r = (contact_record){.t = c->t, .particle = (long long)c->particle, .body = (long long)c->body};
  vector(r->position, c->position);
  vector(r->normal, c->normal);
  vector(r->velocity, c->before);
  vector(r->after, c->after);
  strncpy(r->outcome, skf_outcome_name(c->outcome), sizeof r->outcome - 1);
  return CLI_DONE;
}

/* Without one of the processes the file cannot be closed. It is valid as it was after the last block: the first process
   opens it by itself and adds what it has. */
static int go_on_alone(run_hdf5 *w) {
  trajectory_table *alone = &w->alone;
  *alone = *w->table, alone->crew = NULL, w->table = alone;
  memset(w->series, 0, sizeof w->series);
  w->contacts = w->file = 0;
  w->held_rows = 0, w->held_times = (size_t)(w->rows - w->times);
  return agreed(w, open_file(w));
}

static int commit_hdf5(void *self) {
  run_hdf5 *w = self;
  if (lost(w) && !leads(w)) return abort_hdf5(w), CLI_FAILED;
  int status = lost(w) ? go_on_alone(w) : CLI_DONE;
  if (status == CLI_DONE) status = put_block(w);
  if (status == CLI_DONE) status = put_contacts(w, true);
  if (status == CLI_DONE) status = put_times(w);
  if (status == CLI_DONE) status = agreed(w, close_file(w));
  if (status != CLI_DONE) return abort_hdf5(w), status;
  status = agree(w->table, leads(w) ? cli_out_commit(&w->out) : CLI_DONE);
  return forget(w), status;
}

/* Found by this name in the module. */
extern const trajectory_writer trajectory_module_hdf5;
const trajectory_writer trajectory_module_hdf5 = {open_hdf5, row_hdf5, contact_hdf5, commit_hdf5, abort_hdf5};
