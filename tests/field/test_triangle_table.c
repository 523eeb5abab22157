/* SPDX-License-Identifier: MIT */
/* Triangles against a table of reference values made with 58 digits. */
#include "random.h"
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

/* The same point among others near the triangle, in a place of the batch that depends on the row. */
static skf_value in_batch(const tri_case *c, int number) {
  enum { N = 11 };
  double p[3][N], F[N], G[3][N], d = tri_size(c);
  uint64_t seed = (uint64_t)number;
  for (int i = 0; i < N; i++) {
    skf_vec3 x = i == number % N ? c->x : v3_mad(c->x, d, rnd_vec(&seed, 1));
    p[0][i] = x.x, p[1][i] = x.y, p[2][i] = x.z;
  }
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {G[0], G[1], G[2]};
  skf_element e = {.primitive = {.shape = SKF_TRIANGLE, .triangle = c->triangle}, .kernel = c->kernel, .strength = 1};
  skf_field *f;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  assert_int_equal(skf_field_eval(f, N, in, F, out, NULL), SKF_OK);
  skf_field_free(f);
  int i = number % N;
  return (skf_value){.F = F[i], .g = v3(G[0][i], G[1][i], G[2][i])};
}

static void check_table(bool batch) {
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
    skf_value v = batch ? in_batch(&c, number) : tri_eval(&c, 1);
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

static void test_points(void **state) {
  (void)state;
  check_table(false);
}

static void test_batches(void **state) {
  (void)state;
  check_table(true);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_points), cmocka_unit_test(test_batches)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
