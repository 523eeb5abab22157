/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formats of trajectories. */
#include "trajectory.h"
#include "adapt/module.h"
#include <string.h>
#include <strings.h>

/* A format is written here, or by a module: HDF5 brings 35 libraries, which cost 10 ms of CPU at every start. Another
   module writes it by several processes together. */
typedef struct trajectory_format {
  const char *ending;
  const trajectory_writer *writer;
  const char *module, *together, *symbol;
} trajectory_format;

#ifdef SKF_HAVE_HDF5
#define HDF5_MODULE "skelfield-hdf5.so"
#else
#define HDF5_MODULE NULL
#endif
#ifdef SKF_HAVE_HDF5_MPI
#define HDF5_MPI_MODULE "skelfield-hdf5-mpi.so"
#else
#define HDF5_MPI_MODULE NULL
#endif

static const trajectory_format formats[] = {
    {".csv", &trajectory_writer_csv, NULL, NULL, NULL},
    {".h5", NULL, HDF5_MODULE, HDF5_MPI_MODULE, "trajectory_module_hdf5"},
};

static const trajectory_format *format_of(const char *path) {
  size_t n = path ? strlen(path) : 0;
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
    size_t m = strlen(formats[i].ending);
    if (n > m && strcasecmp(path + n - m, formats[i].ending) == 0) return formats + i;
  }
  return cli_streams(path) ? formats : NULL;
}

int trajectory_writer_for(const char *path, const trajectory_writer **out) {
  const trajectory_format *format = format_of(path);
  if (!format) return cli_fail(CLI_BAD, "%s: unknown ending of a trajectory, expected .csv or .h5", path);
  *out = format->writer;
  if (*out) return CLI_DONE;
  if (!format->module) return cli_fail(CLI_FAILED, "%s: this build has no HDF5, expected a .csv file", path);
  char error[256];
  *out = skf_module_symbol(format->module, format->symbol, error);
  return *out ? CLI_DONE : cli_fail(CLI_FAILED, "%s: %s", path, error);
}

const trajectory_writer *trajectory_writer_together(const char *path) {
  const trajectory_format *format = format_of(path);
  char error[256];
  return format && format->together ? skf_module_symbol(format->together, format->symbol, error) : NULL;
}
