/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of the writer of HDF5, which is compiled twice: with the HDF5 of one process, and with that of MPI. */
#ifndef SKF_TOOLS_HDF5_DESCRIBE_H
#define SKF_TOOLS_HDF5_DESCRIBE_H

#include "trajectory.h"

#include <hdf5.h>

/* A chunk holds about this many numbers: 8000 doubles are 64 kB; and at most so many particles. */
enum { HDF5_CHUNK = 8000, HDF5_WIDE = HDF5_CHUNK / 3 };

/* A text as attribute. False when HDF5 fails, as all of these. */
bool hdf5_text(hid_t at, const char *name, const char *text);
/* The program, its version, the frame, the seeds, the scene, names of particles and bodies. */
bool hdf5_describe(hid_t file, const trajectory_table *table);
/* A data set that grows along its first dimension, chunked (`deep` along that), shuffled and deflated; the others are
   `rest`, rank - 1 of them. */
bool hdf5_growing(hid_t file, const char *name, hid_t type, int rank, hsize_t deep, const hsize_t *rest, hid_t *out);

#endif
