/* SPDX-License-Identifier: MIT */
/* Triangles against a table of reference values made with 58 digits. */
#include "triangle_check.h"

static FILE *open_table(void) {
  const char *shared = getenv("SKF_SHARED"), *root = getenv("SKF_SOURCE_ROOT");
  char name[4096];
  if (shared)
    snprintf(name, sizeof name, "%s/reference/public_2d.csv", shared);
  else
    snprintf(name, sizeof name, "%s/../shared/reference/public_2d.csv", root ? root : ".");
  FILE *f = fopen(name, "r");
  if (!f) print_message("no table at %s\n", name);
  return f;
}

static bool read_row(char *line, tri_case *c, double want[4]) {
  char *at = line, *name = strsep(&at, ","), *param = strsep(&at, ","), *shape = strsep(&at, ",");
  for (char *p = name; *p; p++)
    if (*p == '_') *p = '-';
  if (!shape || strcmp(shape, "triangle") != 0) return false;
  c->kernel.type = skf_kernel_find(name);
  c->kernel.param = atof(param);
  double n[16];
  for (int i = 0; i < 16; i++) n[i] = at ? atof(strsep(&at, ",")) : NAN;
  for (int i = 0; i < 3; i++) c->triangle.vertices[i] = v3(n[3 * i], n[3 * i + 1], n[3 * i + 2]);
  c->x = v3(n[9], n[10], n[11]);
  for (int i = 0; i < 4; i++) want[i] = n[12 + i];
  return c->kernel.type < SKF_KERNEL_COUNT;
}

static void every_row(void **state) {
  (void)state;
  FILE *f = open_table();
  if (!f) skip();
  char line[4096];
  double worst[SKF_KERNEL_COUNT][2] = {{0}};
  int rows[SKF_KERNEL_COUNT] = {0}, number = 0;
  while (fgets(line, sizeof line, f)) {
    tri_case c;
    double want[4];
    number++;
    if (!read_row(line, &c, want)) continue;
    if (!skf_kernel_row(c.kernel.type)->closed[SKF_TRIANGLE]) continue;
    skf_value v = tri_eval(&c, 1);
    skf_vec3 g = v3(want[1], want[2], want[3]);
    double F_error = fabs(v.F - want[0]) / fabs(want[0]);
    double scale = fmax(v3_norm(g), 1e-3 * fabs(want[0]) / tri_size(&c)), g_error = tri_diff_g(v.g, g, scale);
    if (want[0] == 0) F_error = fabs(v.F), g_error = v3_norm(v.g);
    if (!(F_error <= 1e-12) || !(g_error <= 1e-11))
      fail_msg("row %d: F is off by %.3g, grad by %.3g", number, F_error, g_error);
    rows[c.kernel.type]++;
    worst[c.kernel.type][0] = fmax(worst[c.kernel.type][0], F_error);
    worst[c.kernel.type][1] = fmax(worst[c.kernel.type][1], g_error);
  }
  fclose(f);
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    print_message("%-16s %3d rows, F to %.1e, grad to %.1e\n", skf_kernel_get((skf_kernel_type)k)->name, rows[k],
                  worst[k][0], worst[k][1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_row)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
