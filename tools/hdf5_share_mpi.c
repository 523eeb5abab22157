/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each process flies particles rank, rank + size, ..., and writes those of some chunks, the first process the first
   ones and so on: chunks then lie in the file as if one process had written them. */
#include "hdf5_share.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include <mpi.h>

/* The first particle that process m writes. */
static size_t first_of(const hdf5_share *s, size_t m) {
  size_t chunks = (s->count + HDF5_WIDE - 1) / HDF5_WIDE, first = chunks * m / s->size * HDF5_WIDE;
  return first < s->count ? first : s->count;
}

/* How many of the particles that process m flies come before particle p. */
static size_t before(const hdf5_share *s, size_t p, size_t m) { return p > m ? (p - m - 1) / s->size + 1 : 0; }

bool hdf5_share_new(hdf5_share *s, const team *crew, size_t count, size_t rows) {
  *s = (hdf5_share){(size_t)crew->rank, (size_t)crew->size, count};
  s->mine = before(s, count, s->rank), s->first = first_of(s, s->rank), s->end = first_of(s, s->rank + 1);
  size_t most = rows * RUN_QUANTITIES, written = s->end - s->first;
  H5dont_atexit(); /* what is lost is not closed */
  if (count > INT_MAX / most) return false;
  s->out = malloc((most * s->mine + 1) * sizeof *s->out);
  s->in = malloc((most * written + 1) * sizeof *s->in);
  s->columns = malloc((most * written + 1) * sizeof *s->columns);
  s->counts = malloc(4 * s->size * sizeof *s->counts);
  return s->out && s->in && s->columns && s->counts;
}

void hdf5_share_free(hdf5_share *s) { free(s->out), free(s->in), free(s->columns), free(s->counts); }

/* Processes write whole chunks, so each does by itself; the first one writes what HDF5 keeps besides. */
void hdf5_share_access(hid_t access, hid_t transfer) {
  H5AC_cache_config_t cache = {.version = H5AC__CURR_CACHE_CONFIG_VERSION};
  H5Pset_fapl_mpio(access, MPI_COMM_WORLD, MPI_INFO_NULL);
  if (H5Pget_mdc_config(access, &cache) >= 0) {
    cache.metadata_write_strategy = H5AC_METADATA_WRITE_STRATEGY__PROCESS_0_ONLY;
    H5Pset_mdc_config(access, &cache);
  }
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  H5Pset_dxpl_mpio_collective_opt(transfer, H5FD_MPIO_INDIVIDUAL_IO);
}

/* What goes to each process, one after the other: its columns of each row. */
static void pack(const hdf5_share *s, const double *own, size_t rows, size_t width) {
  double *to = s->out;
  for (size_t m = 0; m < s->size; m++) {
    size_t first = before(s, first_of(s, m), s->rank), n = before(s, first_of(s, m + 1), s->rank) - first;
    for (size_t k = 0; k < rows && n; k++, to += n * width)
      memcpy(to, own + (k * s->mine + first) * width, n * width * sizeof *to);
  }
}

static void unpack(const hdf5_share *s, size_t rows, size_t width) {
  const double *from = s->in;
  for (size_t m = 0; m < s->size; m++) {
    size_t first = before(s, s->first, m), end = before(s, s->end, m);
    for (size_t k = 0; k < rows; k++)
      for (size_t i = first; i < end; i++, from += width) {
        size_t column = m + i * s->size - s->first;
        memcpy(s->columns + (k * (s->end - s->first) + column) * width, from, width * sizeof *from);
      }
  }
}

const double *hdf5_share_columns(const hdf5_share *s, const double *own, size_t rows, size_t width) {
  int *sent = s->counts, *sent_at = sent + s->size, *got = sent_at + s->size, *got_at = got + s->size;
  size_t out = 0, in = 0;
  for (size_t m = 0; m < s->size; m++) {
    sent_at[m] = (int)out, got_at[m] = (int)in;
    sent[m] = (int)(rows * width * (before(s, first_of(s, m + 1), s->rank) - before(s, first_of(s, m), s->rank)));
    got[m] = (int)(rows * width * (before(s, s->end, m) - before(s, s->first, m)));
    out += (size_t)sent[m], in += (size_t)got[m];
  }
  pack(s, own, rows, width);
  if (MPI_Alltoallv(s->out, sent, sent_at, MPI_DOUBLE, s->in, got, got_at, MPI_DOUBLE, MPI_COMM_WORLD) != MPI_SUCCESS)
    return NULL;
  unpack(s, rows, width);
  return s->columns;
}
