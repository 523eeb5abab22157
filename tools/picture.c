/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands that write pictures share. */
#include "picture.h"
#include "core/number.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int picture_numbers(const cli *c, const char *option, int count, double *out) {
  const char *text = cli_value(c, option);
  double got[8];
  if (!text) return CLI_DONE;
  const char *p = text;
  for (int i = 0; i < count; i++) {
    size_t used;
    if ((i && *p++ != ',') || skf_number_read(p, &used, got + i) != SKF_OK)
      return cli_fail(CLI_BAD, "--%s %s: expected %d finite numbers separated by commas", option, text, count);
    p += used;
  }
  if (*p) return cli_fail(CLI_BAD, "--%s %s: expected %d finite numbers separated by commas", option, text, count);
  memcpy(out, got, (size_t)count * sizeof *out);
  return CLI_DONE;
}

int picture_size(const cli *c, int *width, int *height) {
  const char *text = cli_value(c, "size");
  if (!text) return CLI_DONE;
  char *end = NULL;
  long w = strtol(text, &end, 10), h = end != text && *end == 'x' ? strtol(end + 1, &end, 10) : 0;
  if (*end || w < 16 || h < 16 || w > 16384 || h > 16384)
    return cli_fail(CLI_BAD, "--size %s: expected WIDTHxHEIGHT, each from 16 to 16384 pixels", text);
  *width = (int)w, *height = (int)h;
  return CLI_DONE;
}

int picture_format(const cli *c, const skf_picture_format **out) {
  const char *path = cli_value(c, "output");
  *out = NULL;
  if (!path || !strcmp(path, "-")) {
    if (isatty(STDOUT_FILENO)) return cli_fail(CLI_BAD, "a picture is not written to a terminal: name a file with -o");
    *out = skf_picture_format_get(0);
    return CLI_DONE;
  }
  return picture_format_of(path, out);
}

int picture_format_of(const char *path, const skf_picture_format **out) {
  *out = skf_picture_format_find(path);
  if (!*out && cli_streams(path)) *out = skf_picture_format_get(0);
  if (*out) return CLI_DONE;
  char list[256] = "";
  for (int i = 0; skf_picture_format_get(i); i++)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s.%s", i ? ", " : "",
             skf_picture_format_get(i)->ending);
  return cli_fail(CLI_BAD, "%s: unknown kind of picture, expected a name that ends in %s", path, list);
}

int picture_module(const skf_plot **out) {
  char error[256];
  *out = skf_plot_load(error);
  return *out ? CLI_DONE : cli_fail(CLI_FAILED, "%s", error);
}

int picture_write(const cli *c, const unsigned char *bytes, size_t n) {
  cli_out o;
  int status = cli_out_open(&o, cli_value(c, "output"));
  if (!status) {
    fwrite(bytes, 1, n, o.file);
    status = cli_out_commit(&o);
  }
  return status;
}

void picture_color(size_t i, double rgba[4]) {
  static const double colors[][3] = {{1.00, 0.35, 0.16}, {0.25, 0.80, 1.00}, {1.00, 0.80, 0.15}, {0.98, 0.45, 0.80},
                                     {0.55, 0.95, 0.40}, {0.72, 0.55, 1.00}, {1.00, 1.00, 1.00}, {0.85, 0.60, 0.35}};
  const double *rgb = colors[i % (sizeof colors / sizeof *colors)];
  for (int k = 0; k < 3; k++) rgba[k] = rgb[k];
  rgba[3] = 1;
}
