/* SPDX-License-Identifier: GPL-3.0-or-later */
/* No file is written that is read, or twice. */
#include "cli_private.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The folder and the last part of a name that does not exist yet; of one that does, the file behind it. */
static void true_name(const char *path, char out[PATH_MAX]) {
  char folder[PATH_MAX];
  if (realpath(path, out)) return;
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
  if (!realpath(folder, out)) snprintf(out, PATH_MAX, "%s", folder);
  size_t n = strlen(out);
  snprintf(out + n, PATH_MAX - n, "/%s", name);
}

/* Whether two names are one regular file, now or when both have been written. */
static bool same_file(const char *a, const char *b) {
  char x[PATH_MAX], y[PATH_MAX];
  struct stat s, t;
  if (strcmp(a, "-") == 0 || strcmp(b, "-") == 0) return false;
  if (stat(a, &s) == 0 && stat(b, &t) == 0) return s.st_dev == t.st_dev && s.st_ino == t.st_ino && S_ISREG(s.st_mode);
  true_name(a, x), true_name(b, y);
  return strcmp(x, y) == 0;
}

/* The first option, up to `end`, that names the file. */
static const char *find(const cli *c, const char *const *options, const char *const *end, const char *path) {
  for (; options && options != end && *options; options++) {
    const char *other = cli_value(c, *options);
    if (other && same_file(other, path)) return *options;
  }
  return NULL;
}

static bool is_operand(const cli *c, const char *path) {
  int i = 0;
  while (i < c->operand_count && !same_file(c->operands[i], path)) i++;
  return i < c->operand_count;
}

bool cli_names(const cli *c, const char *path) {
  return is_operand(c, path) || find(c, c->command->writes, NULL, path) || find(c, c->command->reads, NULL, path);
}

int cli_check_read(const cli *c, const char *path) {
  const char *option = find(c, c->command->writes, NULL, path);
  return option ? cli_fail(CLI_BAD, "--%s %s is read, too, expected another file", option, cli_value(c, option))
                : CLI_DONE;
}

int cli_check_files(const cli *c) {
  for (const char *const *option = c->command->writes; option && *option; option++) {
    const char *path = cli_value(c, *option), *other;
    if (!path) continue;
    if (is_operand(c, path) || find(c, c->command->reads, NULL, path))
      return cli_fail(CLI_BAD, "--%s %s is read, too, expected another file", *option, path);
    if ((other = find(c, c->command->writes, option, path)))
      return cli_fail(CLI_BAD, "--%s and --%s name the same file", other, *option);
  }
  return CLI_DONE;
}
