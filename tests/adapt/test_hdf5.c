/* SPDX-License-Identifier: MIT */
/* Trajectories in HDF5, read back: the numbers of the CSV to the last bit, the scene, the seeds, the contacts. */
#include "check.h"
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 6, COUNT = 13 };

static const char scene[] = "skelfield: 1\n"
                            "gravity: {G: 1}\n"
                            "bodies:\n"
                            "  - {name: sun, iso: 2, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0]}}]}\n"
                            "particles:\n"
                            "  - {name: stone, position: [1, 0, 0], velocity: [0, 0, 0]}\n"
                            "  - {name: cloud, shell: {inner: 1, outer: 2, count: 7, tangential: 0.5, seed: 42}}\n"
                            "  - {name: ring, disc: {inner: 1, outer: 2, count: 5, circular: 1}}\n"
                            "simulation: {t_end: 2.5, output_every: 0.5, contact: stick}\n";

static char folder[] = "/tmp/skelfield-hdf5-XXXXXX";
static hid_t file;

static int set_up(void **state) {
  (void)state;
  const char *program = getenv("SKF_PROGRAM");
  if (!program || !mkdtemp(folder) || chdir(folder)) return -1;
  FILE *f = fopen("scene.yaml", "w");
  if (!f || fputs(scene, f) < 0 || fclose(f)) return -1;
  char line[4096];
  for (int k = 0; k < 2; k++) {
    snprintf(line, sizeof line, "'%s' simulate scene.yaml -o run.%s --contacts hits.csv 2>/dev/null", program,
             k ? "h5" : "csv");
    if (system(line)) return -1;
  }
  file = H5Fopen("run.h5", H5F_ACC_RDONLY, H5P_DEFAULT);
  return file < 0 ? -1 : 0;
}

static int tear_down(void **state) {
  (void)state;
  H5Fclose(file);
  static const char *const made[] = {"scene.yaml", "run.csv", "run.h5", "hits.csv"};
  for (size_t i = 0; i < sizeof made / sizeof *made; i++) unlink(made[i]);
  return rmdir(folder);
}

/* Reads a whole data set of this shape. */
static void read_doubles(const char *name, int rank, const hsize_t *shape, double *out) {
  hid_t d = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(d), plan = H5Dget_create_plist(d);
  hsize_t dims[3];
  assert_int_equal(H5Sget_simple_extent_dims(space, dims, NULL), rank);
  for (int k = 0; k < rank; k++) assert_int_equal(dims[k], shape[k]);
  assert_int_equal(H5Pget_layout(plan), H5D_CHUNKED);
  assert_true(H5Dread(d, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
  H5Pclose(plan), H5Sclose(space), H5Dclose(d);
}

static void numbers_are_those_of_the_csv(void **state) {
  (void)state;
  double t[ROWS], x[ROWS][COUNT][3], v[ROWS][COUNT][3], want[7];
  const hsize_t shape[3] = {ROWS, COUNT, 3};
  read_doubles("t", 1, shape, t);
  read_doubles("position", 3, shape, x[0][0]);
  read_doubles("velocity", 3, shape, v[0][0]);
  FILE *f = fopen("run.csv", "r");
  char line[512], name[64];
  assert_non_null(f);
  assert_non_null(fgets(line, sizeof line, f));
  for (int k = 0; k < ROWS; k++)
    for (int i = 0; i < COUNT; i++) {
      assert_non_null(fgets(line, sizeof line, f));
      assert_int_equal(sscanf(line, "%lf,%63[^,],%lf,%lf,%lf,%lf,%lf,%lf", want, name, want + 1, want + 2, want + 3,
                              want + 4, want + 5, want + 6),
                       8);
      assert_true(t[k] == want[0]);
      for (int c = 0; c < 3; c++) assert_true(x[k][i][c] == want[1 + c] && v[k][i][c] == want[4 + c]);
    }
  fclose(f);
}

static void it_tells_where_it_comes_from(void **state) {
  (void)state;
  hid_t d = H5Dopen2(file, "scene", H5P_DEFAULT), type = H5Dget_type(d);
  char text[sizeof scene + 1] = "";
  assert_int_equal(H5Tget_size(type), sizeof scene);
  assert_true(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0);
  assert_string_equal(text, scene);
  H5Tclose(type), H5Dclose(d);

  long long seed[2], seeded[2][2];
  hid_t a = H5Aopen(file, "seed", H5P_DEFAULT), b = H5Aopen(file, "seeded", H5P_DEFAULT);
  hid_t space = H5Aget_space(b);
  assert_int_equal(H5Sget_simple_extent_npoints(space), 4);
  assert_true(H5Aread(a, H5T_NATIVE_LLONG, seed) >= 0 && H5Aread(b, H5T_NATIVE_LLONG, seeded) >= 0);
  assert_true(seed[0] == 42 && seeded[0][0] == 1 && seeded[0][1] == 7);
  assert_true(seed[1] == 1 && seeded[1][0] == 8 && seeded[1][1] == 5);
  H5Sclose(space), H5Aclose(a), H5Aclose(b);
  assert_true(H5Aexists(file, "version") > 0 && H5Aexists(file, "program") > 0);
}

typedef struct hit {
  double t, position[3];
  long long particle;
} hit;

static void contacts_are_those_of_the_log(void **state) {
  (void)state;
  hid_t d = H5Dopen2(file, "contacts", H5P_DEFAULT), space = H5Dget_space(d);
  hsize_t n, three = 3;
  H5Sget_simple_extent_dims(space, &n, NULL);
  assert_true(n > 0 && n <= COUNT);
  hit hits[COUNT];
  hid_t vector = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three), type = H5Tcreate(H5T_COMPOUND, sizeof *hits);
  H5Tinsert(type, "t", offsetof(hit, t), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "position", offsetof(hit, position), vector);
  H5Tinsert(type, "particle", offsetof(hit, particle), H5T_NATIVE_LLONG);
  assert_true(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, hits) >= 0);
  FILE *f = fopen("hits.csv", "r");
  char line[512], name[64], body[64];
  double t, x[3];
  assert_non_null(f);
  assert_non_null(fgets(line, sizeof line, f));
  for (hsize_t i = 0; i < n; i++) {
    assert_non_null(fgets(line, sizeof line, f));
    assert_int_equal(sscanf(line, "%lf,%63[^,],%63[^,],%lf,%lf,%lf", &t, name, body, x, x + 1, x + 2), 6);
    assert_true(hits[i].t == t && !memcmp(hits[i].position, x, sizeof x));
    assert_true(hits[i].particle == 0 ? !strcmp(name, "stone") : hits[i].particle < COUNT);
  }
  assert_null(fgets(line, sizeof line, f));
  fclose(f);
  H5Tclose(type), H5Tclose(vector), H5Sclose(space), H5Dclose(d);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(numbers_are_those_of_the_csv),
      cmocka_unit_test(it_tells_where_it_comes_from),
      cmocka_unit_test(contacts_are_those_of_the_log),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
