/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formats of trajectories. */
#include "trajectory.h"
#include "adapt/module.h"
#include <string.h>

/* A format is written here, or by a module: HDF5 brings 35 libraries, which cost 10 ms of CPU at every start. */
typedef struct trajectory_format {
  const char *ending;
  const trajectory_writer *writer;
  const char *module, *symbol;
} trajectory_format;

static const trajectory_format formats[] = {
    {".csv", &trajectory_writer_csv, NULL, NULL},
#ifdef SKF_HAVE_HDF5
    {".h5", NULL, "skelfield-hdf5.so", "trajectory_module_hdf5"},
#else
    {".h5", NULL, NULL, NULL},
#endif
};

static int writer_of(const trajectory_format *format, const char *path, const trajectory_writer **out) {
  *out = format->writer;
  if (*out) return CLI_DONE;
  if (!format->module) return cli_fail(CLI_FAILED, "%s: this build has no HDF5, expected a .csv file", path);
  char error[256];
  *out = skf_module_symbol(format->module, format->symbol, error);
  return *out ? CLI_DONE : cli_fail(CLI_FAILED, "%s: %s", path, error);
}

int trajectory_writer_for(const char *path, const trajectory_writer **out) {
  if (!path || strcmp(path, "-") == 0) return writer_of(formats, path, out);
  size_t n = strlen(path);
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
    size_t m = strlen(formats[i].ending);
    if (n > m && strcmp(path + n - m, formats[i].ending) == 0) return writer_of(formats + i, path, out);
  }
  return cli_fail(CLI_BAD, "%s: unknown ending of a trajectory, expected .csv or .h5", path);
}
