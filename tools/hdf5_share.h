/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a process writes of an HDF5 file: all of it (hdf5_share_alone.c), or some of the chunks (hdf5_share_mpi.c). */
#ifndef SKF_TOOLS_HDF5_SHARE_H
#define SKF_TOOLS_HDF5_SHARE_H

#include "hdf5_describe.h"

typedef struct hdf5_share {
  size_t rank, size, count, mine; /* of processes; all particles, and those of this one: rank, rank + size, ... */
  size_t first, end;              /* particles that it writes, those of whole chunks */
  double *out, *in, *columns;     /* what is exchanged for that */
  int *counts;
} hdf5_share;

/* For blocks of so many rows; false without memory, or when there are too many particles for MPI. */
bool hdf5_share_new(hdf5_share *s, const team *crew, size_t count, size_t rows);
void hdf5_share_free(hdf5_share *s);
/* How the file is opened and written. */
void hdf5_share_access(hid_t access, hid_t transfer);
/* From rows of this process's particles, `width` numbers each, to rows of those that it writes; NULL when MPI fails. */
const double *hdf5_share_columns(const hdf5_share *s, const double *own, size_t rows, size_t width);

#endif
