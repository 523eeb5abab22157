/* SPDX-License-Identifier: MIT */
/* Mesh files: what is written is read back, what is malformed is refused with its place. */
#include "core/alloc.h"
#include "worlds.h"
#include <string.h>
#include <unistd.h>

static char path[64];

static void put(const void *data, size_t size) {
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  assert_int_equal(fwrite(data, 1, size, f), size);
  fclose(f);
}

static int make_path(void **state) {
  (void)state;
  strcpy(path, "/tmp/skf_mesh_XXXXXX");
  int fd = mkstemp(path);
  if (fd >= 0) close(fd);
  return fd < 0;
}

static int drop_path(void **state) {
  (void)state;
  return unlink(path);
}

/* A tetrahedron with coordinates that single precision holds, two bodies and normals. */
static skf_mesh sample(void) {
  static const skf_vec3 at[4] = {{0, 0, 0}, {1.5, 0, 0}, {0, 0.25, 0}, {0, 0, -2}};
  static const unsigned faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  skf_mesh m = {4,
                4,
                skf_alloc(4, sizeof *m.vertices),
                skf_alloc(4, sizeof *m.normals),
                skf_alloc(4, sizeof *m.triangles),
                skf_alloc(4, sizeof *m.bodies)};
  memcpy(m.vertices, at, sizeof at);
  memcpy(m.triangles, faces, sizeof faces);
  for (int i = 0; i < 4; i++) m.normals[i] = v3(0, 0.6, -0.8), m.bodies[i] = (unsigned)i / 2;
  return m;
}

static void every_format_reads_what_it_writes(void **state) {
  (void)state;
  skf_mesh m = sample(), got;
  skf_error error;
  for (int i = 0; skf_mesh_format_get(i); i++) {
    const skf_mesh_format *format = skf_mesh_format_get(i);
    bool single = !strcmp(format->extension, ".stl");
    /* A third is not a float: the others must keep it. */
    m.vertices[1].x = single ? 1.5 : 1.0 / 3;
    m.vertices[2].y = single ? 0.25 : 1e-17;
    FILE *f = fopen(path, "wb");
    assert_int_equal(skf_mesh_write(&m, format, f), SKF_OK);
    fclose(f);
    /* By content: the name has no ending. */
    if (skf_mesh_read(path, &got, &error)) fail_msg("%s: line %ld: %s", format->extension, error.line, error.text);
    assert_int_equal(got.vertex_count, 4);
    assert_int_equal(got.triangle_count, 4);
    for (int t = 0; t < 4; t++)
      for (int k = 0; k < 3; k++)
        assert_memory_equal(got.vertices + got.triangles[t][k], m.vertices + m.triangles[t][k], sizeof(skf_vec3));
    skf_mesh_free(&got);
  }
  skf_mesh_free(&m);
}

static void endings_are_found(void **state) {
  (void)state;
  assert_string_equal(skf_mesh_format_find("a.b/c.PLY")->extension, ".ply");
  assert_string_equal(skf_mesh_format_find("x.stl")->extension, ".stl");
  assert_null(skf_mesh_format_find("ply"));
  assert_null(skf_mesh_format_find("a.ply/b"));
  assert_null(skf_mesh_format_find("a.plyx"));
}

static void full_disk_is_an_error(void **state) {
  (void)state;
  skf_mesh m = sample();
  for (int i = 0; skf_mesh_format_get(i); i++) {
    FILE *f = fopen("/dev/full", "wb");
    if (!f) skip();
    setvbuf(f, NULL, _IONBF, 0);
    assert_int_equal(skf_mesh_write(&m, skf_mesh_format_get(i), f), SKF_ERR_IO);
    fclose(f);
  }
  skf_mesh_free(&m);
}

/* Other programs' ways of writing the same things. */
static void variants_are_read(void **state) {
  (void)state;
  static const struct {
    const char *text;
    size_t vertices, triangles;
  } good[] = {
      {"OFF\n4 2 0\n0 0 0\n1 0 0 # a comment\n1 1 0\n0 1 0\n\n3 0 1 2\n3 0 2 3 255 0 0\n", 4, 2},
      {"OFF 4 1 0 0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", 4, 2},
      {"COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 0 0 0 0\n3 0 1 2\n", 3, 1},
      {"NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n", 3, 1},
      {"CNOFF\n# both\n3 1 0\n0 0 0 0 0 1 1 0 0 1\n1 0 0 0 0 1 1 0 0 1\n0 1 0 0 0 1 1 0 0 1\n3 0 1 2\n", 3, 1},
      {"v 0 0 \\\n 0\nv 1 0 0\nvn 0 \\\r\n0 1\n# none \\\nv 1 1 0\nv 0 1 0\nf 1 2\\\n 3 \\\n4\n", 4, 2},
      {"# quad\r\nv 0 0 0\r\nv 1 0 0 0.5 0.5 0.5\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nf 1/1 2/1 3/1 4/1\r\n", 4, 2},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 5 5 5\n", 4, 1},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
       "red\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2\n",
       3, 1},
      {"solid a b\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 -0\n endloop\n"
       "endfacet\nfacet normal 0 0 1\n outer loop\n  vertex 1 0 0\n  vertex 1 1 0\n  vertex 0 1 0\n endloop\n"
       "endfacet\nendsolid a b\n",
       4, 2},
  };
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    skf_mesh m;
    skf_error error;
    put(good[i].text, strlen(good[i].text));
    if (skf_mesh_read(path, &m, &error)) fail_msg("variant %zu: line %ld: %s", i, error.line, error.text);
    assert_int_equal(m.vertex_count, good[i].vertices);
    assert_int_equal(m.triangle_count, good[i].triangles);
    skf_mesh_free(&m);
  }
}

/* Without the word it is the name that tells. */
static void off_without_its_word(void **state) {
  (void)state;
  static const char text[] = "# a triangle\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  char kept[sizeof path];
  strcpy(kept, path);
  strcat(path, ".off");
  put(text, strlen(text));
  skf_mesh m;
  skf_error error;
  skf_status s = skf_mesh_read(path, &m, &error);
  unlink(path);
  strcpy(path, kept);
  if (s) fail_msg("line %ld: %s", error.line, error.text);
  assert_int_equal(m.vertex_count, 3);
  assert_int_equal(m.triangle_count, 1);
  skf_mesh_free(&m);
}

static const struct {
  const char *text;
  long line; /* where the complaint must point */
} malformed[] = {
    {"", 0},
    {"hello\nworld\n", 1},
    {"OFF\n", 2},
    {"OFF\n3 x 0\n", 2},
    {"OFF\n-3 1 0\n", 2},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n", 5},
    {"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", 4},
    {"OFF\n3 1 0\n0 0 0\n1 1e999 0\n0 1 0\n3 0 1 2\n", 4},
    {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 4},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 6},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", 6},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 6},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1.5 2\n", 6},
    {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", 7},
    {"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", 0},
    {"OFF\n1000000000000 1000000000000 0\n0 0 0\n", 2},
    {"OFF BINARY\n1 1 1\n", 1},
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", 4},
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", 4},
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", 4},
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3x\n", 4},
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", 4},
    {"v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", 2},
    {"v 0 0 0\nv 1 0 inf\nv 0 1 0\nf 1 2 3\n", 2},
    {"v 0 0 0\nwhatever\n", 2},
    {"v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 \\\n9\n", 7},
    {"v 0 0 0 \\", 0},
    {"COFF BINARY\n1 1 1\n", 1},
    {"ply\nformat ascii 1.0\n", 3},
    {"ply\nformat utf8 1.0\nend_header\n", 2},
    {"ply\nelement vertex 0\nend_header\n", 4},
    {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float w\nelement face "
     "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
     10},
    {"ply\nformat ascii 1.0\nelement vertex 99999999\nproperty float x\nproperty float y\nproperty float z\nelement "
     "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
     10},
    {"ply\nformat ascii 1.0\nproperty float x\nend_header\n", 3},
    {"ply\nformat ascii 1.0\nelement vertex 3\nproperty quaternion x\nend_header\n", 4},
    {"ply\nformat ascii 1.0\nelement vertex 3\nproperty list float int x\nend_header\n", 4},
    {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
     "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
     13},
    {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
     "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
     13},
    {"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n", 6},
    {"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 z\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
     5},
    {"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n", 9},
};

static void malformed_text_is_refused(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof malformed / sizeof *malformed; i++) {
    skf_mesh m;
    skf_error error = {SKF_OK, -1, ""};
    put(malformed[i].text, strlen(malformed[i].text));
    skf_status s = skf_mesh_read(path, &m, &error);
    if (s == SKF_OK) fail_msg("row %zu was accepted", i);
    assert_null(m.vertices);
    assert_int_equal(error.status, s);
    assert_true(strlen(error.text) > 10);
    if (error.line != malformed[i].line)
      fail_msg("row %zu: line %ld, expected %ld: %s", i, error.line, malformed[i].line, error.text);
  }
}

/* Each file cut short at every length, and with every byte turned: refused or read, never a crash. */
static void damaged_files_do_no_harm(void **state) {
  (void)state;
  skf_mesh m = sample(), got;
  skf_error error;
  size_t cut = 0, accepted = 0;
  for (int i = 0; skf_mesh_format_get(i); i++) {
    FILE *f = fopen(path, "wb+");
    assert_int_equal(skf_mesh_write(&m, skf_mesh_format_get(i), f), SKF_OK);
    size_t n = (size_t)ftell(f);
    char *data = skf_alloc(n, 1);
    rewind(f);
    assert_int_equal(fread(data, 1, n, f), n);
    fclose(f);
    for (size_t k = 0; k < n; k++, cut++) {
      bool last = k + 3 >= n && skf_mesh_format_get(i)->read != skf_mesh_format_find("a.ply")->read;
      put(data, k);
      if (skf_mesh_read(path, &got, &error) == SKF_OK) {
        /* Half a last line of OBJ still is a line. */
        if (strcmp(skf_mesh_format_get(i)->extension, ".obj") && !last) fail_msg("format %d cut at %zu", i, k);
        skf_mesh_free(&got);
      }
      data[k] ^= 0x55;
      put(data, n);
      if (skf_mesh_read(path, &got, &error) == SKF_OK) accepted++, skf_mesh_free(&got);
      data[k] ^= 0x55;
    }
    skf_free(data);
  }
  assert_true(cut > 500 && accepted < cut);
  skf_mesh_free(&m);
}

static void memory_may_run_out(void **state) {
  (void)state;
  const char *text = malformed[14].text; /* its first face is good */
  char good[128];
  strcpy(good, text);
  good[strlen(good) - strlen("3 0 1 2\n")] = 0;
  put(good, strlen(good));
  int failures = 0;
  for (long k = 1; k < 20; k++) {
    skf_mesh m;
    skf_alloc_fail_after(k);
    skf_status s = skf_mesh_read(path, &m, NULL);
    skf_alloc_fail_after(0);
    assert_true(s == SKF_OK || s == SKF_ERR_NOMEM);
    failures += s == SKF_ERR_NOMEM;
    skf_mesh_free(&m);
  }
  assert_int_equal(failures, 3); /* the file, the vertices, the triangles */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_format_reads_what_it_writes),
      cmocka_unit_test(endings_are_found),
      cmocka_unit_test(full_disk_is_an_error),
      cmocka_unit_test(variants_are_read),
      cmocka_unit_test(off_without_its_word),
      cmocka_unit_test(malformed_text_is_refused),
      cmocka_unit_test(damaged_files_do_no_harm),
      cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, make_path, drop_path);
}
