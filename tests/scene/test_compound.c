/* SPDX-License-Identifier: MIT */
/* Entries that stand for several primitives: their pieces, their fields, and the mesh files they read. */
#include "scene/scene_text.h"
#include "core/alloc.h"
#include "random.h"
#include <sys/stat.h>
#include <unistd.h>

#define HEAD "skelfield: 1\nbodies:\n- name: a\n  iso: 1\n  kernel: {type: inverse}\n  skeleton:\n"

static char folder[] = "/tmp/skelfield-compound-XXXXXX";

static void put(const char *name, const char *text) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  fputs(text, f);
  assert_int_equal(fclose(f), 0);
}

static skf_scene *good(const char *text) {
  skf_scene *scene;
  skf_error e;
  if (skf_scene_parse(text, strlen(text), folder, &scene, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return scene;
}

static const char everything[] =
    HEAD "  - circle: {center: [0, 0, 1], normal: [0, 3, 4], radius: 2, strength: -2}\n"
         "  - polyline: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], kernel: {type: cauchy, s: 2}}\n"
         "  - polyline:\n      points:\n      - [0, 0, 0]\n      - [1, 0, 0]\n      - [1, 1, 0]\n      closed: true\n"
         "  - point: {at: [5, 5, 5]}\n"
         "  - polygon: {vertices: [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]], strength: 3}\n"
         "  - bezier: {points: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], tolerance: 0.1}\n"
         "  - mesh: {file: pyramid.off, kernel: {type: gaussian, a: 1}, strength: 0.5}\n";

/* A quadrilateral, a triangle and a vertex that nobody uses. */
static const char pyramid[] = "OFF\n6 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.5 1\n9 9 9\n4 0 3 2 1\n3 0 1 4\n";

static void pieces(void **state) {
  (void)state;
  put("pyramid.off", pyramid);
  skf_scene *s = good(everything);
  const skf_body *b = s->bodies;
  static const struct {
    skf_shape shape;
    skf_kernel_type kernel;
    double strength;
    long line;
  } want[] = {
      {SKF_ARC, SKF_INVERSE, -2, 7},         {SKF_SEGMENT, SKF_CAUCHY, 1, 8},
      {SKF_SEGMENT, SKF_CAUCHY, 1, 8},       {SKF_SEGMENT, SKF_INVERSE, 1, 9},
      {SKF_SEGMENT, SKF_INVERSE, 1, 9},      {SKF_SEGMENT, SKF_INVERSE, 1, 9},
      {SKF_POINT, SKF_INVERSE, 1, 15},       {SKF_TRIANGLE, SKF_INVERSE, 3, 16},
      {SKF_TRIANGLE, SKF_INVERSE, 3, 16},    {SKF_TRIANGLE, SKF_INVERSE, 3, 16},
      {SKF_TRIANGLE, SKF_INVERSE, 3, 16},    {SKF_SEGMENT, SKF_INVERSE, 1, 17},
      {SKF_TRIANGLE, SKF_GAUSSIAN, 0.5, 18}, {SKF_TRIANGLE, SKF_GAUSSIAN, 0.5, 18},
      {SKF_TRIANGLE, SKF_GAUSSIAN, 0.5, 18},
  };
  assert_int_equal(b->element_count, sizeof want / sizeof *want);
  assert_int_equal(skf_field_size(b->field), b->element_count);
  double area = 0;
  for (size_t i = 0; i < b->element_count; i++) {
    const skf_element *e = b->elements + i;
    assert_int_equal(e->primitive.shape, want[i].shape);
    assert_int_equal(e->kernel.type, want[i].kernel);
    assert_true(e->strength == want[i].strength);
    assert_int_equal(b->element_lines[i], want[i].line);
    if (i >= 7 && i < 11) area += skf_primitive_measure(&e->primitive);
  }
  check_close(area, 4.0, 1e-15);
  assert_true(b->elements[5].primitive.segment.from.y == 1 && b->elements[5].primitive.segment.to.x == 0);
  assert_true(b->elements[14].primitive.triangle.vertices[2].z == 1);
  skf_scene_free(s);
}

/* Two texts of one body: value and gradient agree at random points. */
static void same_field(const char *one, const char *other, double tol) {
  skf_scene *a = good(one), *b = good(other);
  uint64_t seed = 11;
  for (int i = 0; i < 200; i++) {
    skf_vec3 p = rnd_vec(&seed, 4), g, h;
    double F = skf_field_at(a->bodies[0].field, p, &g), want = skf_field_at(b->bodies[0].field, p, &h);
    check_close(F, want, tol);
    check_scaled(v3_dist(g, h), 0, v3_norm(h) + fabs(want), 10 * tol);
  }
  check_close(a->bodies[0].rho, b->bodies[0].rho, 1e-14);
  skf_scene_free(a), skf_scene_free(b);
}

static void fields(void **state) {
  (void)state;
  same_field(HEAD "  - circle: {center: [0, 0, 1], normal: [0, 0, 2], radius: 1.5}\n  mass: 3\n",
             HEAD "  - arc: {center: [0, 0, 1], normal: [0, 0, 1], start: [1, 2, 0], radius: 1.5, sweep: 360}\n"
                  "  mass: 3\n",
             1e-12);
  same_field(HEAD "  - polyline: {points: [[0, 0, 0], [0.7, 0, 0], [2, 0, 0]]}\n  mass: 3\n",
             HEAD "  - segment: {from: [0, 0, 0], to: [2, 0, 0]}\n  mass: 3\n", 1e-12);
  same_field(HEAD "  - polygon: {vertices: [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]]}\n"
                  "  mass: 3\n",
             HEAD "  - triangle: {vertices: [[0, 0, 0], [2, 0, 0], [2, 1, 0]]}\n"
                  "  - triangle: {vertices: [[0, 0, 0], [2, 1, 0], [0, 1, 0]]}\n"
                  "  - triangle: {vertices: [[0, 1, 0], [1, 1, 0], [1, 3, 0]]}\n"
                  "  - triangle: {vertices: [[0, 1, 0], [1, 3, 0], [0, 3, 0]]}\n  mass: 3\n",
             1e-12);
  put("pyramid.off", pyramid);
  put("pyramid.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 1 3 2\nf 1 4 3\nf 1 2 5\n");
  same_field(HEAD "  - mesh: {file: pyramid.off}\n  mass: 3\n", HEAD "  - mesh: {file: ./pyramid.obj}\n  mass: 3\n",
             1e-12);
}

/* A curve's field against that of 4000 chords; both are off by less than a millionth of the distance. */
static void curves(void **state) {
  (void)state;
  same_field(HEAD "  - bezier: {points: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]}\n  mass: 3\n",
             HEAD "  - segment: {from: [0, 0, 0], to: [3, 0, 0]}\n  mass: 3\n", 1e-14);
  skf_scene *s = good(HEAD "  - bezier: {points: [[0, 0, 0], [1, 2, 0], [3, 1, 2], [2, 0, 1]], strength: 2}\n"
                           "  - bezier: {points: [[0, 0, 0], [1, 2, 0], [3, 1, 2], [2, 0, 1]], tolerance: 0.01}\n");
  enum { N = 4000 };
  const skf_vec3 q[4] = {{0, 0, 0}, {1, 2, 0}, {3, 1, 2}, {2, 0, 1}};
  skf_element *e = calloc(N, sizeof *e);
  skf_vec3 from = q[0];
  for (int i = 1; i <= N; i++) {
    double t = (double)i / N, u = 1 - t;
    skf_vec3 to =
        v3_mad(v3_mad(v3_mad(v3_scale(u * u * u, q[0]), 3 * u * u * t, q[1]), 3 * u * t * t, q[2]), t * t * t, q[3]);
    e[i - 1] = (skf_element){{.shape = SKF_SEGMENT, .segment = {from, to}}, {SKF_INVERSE, 0}, 2};
    from = to;
  }
  size_t n = 0;
  while (n < s->bodies[0].element_count && s->bodies[0].elements[n].strength == 2) n++;
  assert_in_range(n, 20, 400);
  assert_in_range(s->bodies[0].element_count - n, 2, 16);
  skf_field *fine, *curve, *loose;
  assert_int_equal(skf_field_new(e, N, &fine), SKF_OK);
  assert_int_equal(skf_field_new(s->bodies[0].elements, n, &curve), SKF_OK);
  assert_int_equal(skf_field_new(s->bodies[0].elements + n, s->bodies[0].element_count - n, &loose), SKF_OK);
  uint64_t seed = 12;
  for (int i = 0; i < 20; i++) {
    skf_vec3 p = v3_add(v3(1.5, 0.7, 0.7), v3_scale(rnd(&seed, 2, 6), rnd_unit(&seed)));
    double want = skf_field_at(fine, p, NULL);
    check_close(skf_field_at(curve, p, NULL), want, 2e-6);
    check_close(2 * skf_field_at(loose, p, NULL), want, 1e-2);
  }
  skf_field_free(fine), skf_field_free(curve), skf_field_free(loose);
  free(e);
  skf_scene_free(s);
}

/* A coil and a spiral against chains of 4000 chords a turn, which are too short by 4e-7. */
static void helices(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double r0, r1, pitch, turns;
    bool log;
  } all[] = {
      {"  - helix: {center: [1, 2, 3], axis: [0, 0, 2], start: [0, 5, 7], radius: 2, pitch: 0.5, turns: 3.25}\n", 2, 2,
       0.5, 3.25, false},
      {"  - helix: {center: [1, 2, 3], axis: [0, 0, 2], start: [0, 5, 7], radius: 2, end_radius: 0, pitch: -1, turns: "
       "2}\n",
       2, 0, -1, 2, false},
      {"  - spiral: {center: [1, 2, 3], normal: [0, 0, 2], start: [0, 1, 0], radius: 0.5, end_radius: 3, turns: 2}\n",
       0.5, 3, 0, 2, false},
      {"  - spiral: {center: [1, 2, 3], normal: [0, 0, 2], start: [0, 1, 0], radius: 0.5, end_radius: 3, turns: 2, "
       "law: "
       "logarithmic}\n",
       0.5, 3, 0, 2, true},
  };
  enum { N = 16000 };
  skf_element *e = calloc(N, sizeof *e);
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    char text[512];
    snprintf(text, sizeof text, HEAD "%s", all[k].text);
    skf_scene *s = good(text);
    skf_vec3 from = {0, 0, 0};
    for (int i = 0; i <= N; i++) {
      double t = (double)i / N, phi = 2 * SKF_PI * all[k].turns * t, r = all[k].r0 + t * (all[k].r1 - all[k].r0);
      if (all[k].log) r = all[k].r0 * pow(all[k].r1 / all[k].r0, t);
      skf_vec3 to = v3(1 - r * sin(phi), 2 + r * cos(phi), 3 + all[k].pitch * all[k].turns * t);
      if (i) e[i - 1] = (skf_element){{.shape = SKF_SEGMENT, .segment = {from, to}}, {SKF_INVERSE, 0}, 1};
      from = to;
    }
    skf_field *fine;
    assert_int_equal(skf_field_new(e, N, &fine), SKF_OK);
    uint64_t seed = 13;
    for (int i = 0; i < 10; i++) {
      skf_vec3 p = v3_add(v3(1, 2, 3), v3_scale(rnd(&seed, 4, 9), rnd_unit(&seed)));
      check_close(skf_field_at(s->bodies[0].field, p, NULL), skf_field_at(fine, p, NULL), 2e-6);
    }
    skf_field_free(fine), skf_scene_free(s);
  }
  free(e);
}

/* The surface of a box: area, outward orientation, volume; a turned one is the polygons that it is made of. */
static void boxes(void **state) {
  (void)state;
  skf_scene *s = good(HEAD "  - box: {center: [1, 2, 3], size: [2, 3, 4], axis: [1, 1, 0], angle: 40}\n");
  const skf_body *b = s->bodies;
  assert_int_equal(b->element_count, 12);
  double area = 0, volume = 0;
  for (int i = 0; i < 12; i++) {
    const skf_vec3 *v = b->elements[i].primitive.triangle.vertices;
    area += skf_primitive_measure(&b->elements[i].primitive);
    volume += v3_dot(v3_sub(v[0], v3(1, 2, 3)), v3_cross(v3_sub(v[1], v3(1, 2, 3)), v3_sub(v[2], v3(1, 2, 3)))) / 6;
  }
  check_close(area, 52, 1e-14);
  check_close(volume, 24, 1e-14);
  skf_scene_free(s);
  same_field(HEAD "  - box: {center: [0, 0, 0], size: [2, 4, 6], axis: [0, 0, 3], angle: 90}\n  mass: 3\n",
             HEAD "  - polygon: {vertices: [[-2, -1, -3], [2, -1, -3], [2, 1, -3], [-2, 1, -3]]}\n"
                  "  - polygon: {vertices: [[-2, -1, 3], [2, -1, 3], [2, 1, 3], [-2, 1, 3]]}\n"
                  "  - polygon: {vertices: [[-2, -1, -3], [2, -1, -3], [2, -1, 3], [-2, -1, 3]]}\n"
                  "  - polygon: {vertices: [[-2, 1, -3], [2, 1, -3], [2, 1, 3], [-2, 1, 3]]}\n"
                  "  - polygon: {vertices: [[-2, -1, -3], [-2, 1, -3], [-2, 1, 3], [-2, -1, 3]]}\n"
                  "  - polygon: {vertices: [[2, -1, -3], [2, 1, -3], [2, 1, 3], [2, -1, 3]]}\n  mass: 3\n",
             1e-12);
}

static void files_are_relative_to_the_scene(void **state) {
  (void)state;
  put("pyramid.off", pyramid);
  put("scene.yaml", HEAD "  - mesh: {file: pyramid.off}\n");
  char path[256], text[512];
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  skf_scene *s;
  assert_int_equal(skf_scene_read(path, &s, NULL), SKF_OK);
  assert_int_equal(s->bodies[0].element_count, 3);
  skf_scene_free(s);
  snprintf(text, sizeof text, HEAD "  - mesh: {file: %s/pyramid.off}\n", folder);
  assert_int_equal(skf_scene_parse(text, strlen(text), "/nonexistent", &s, NULL), SKF_OK);
  skf_scene_free(s);
}

static void broken_files_are_refused(void **state) {
  (void)state;
  char path[256];
  snprintf(path, sizeof path, "%s/pipe", folder);
  assert_int_equal(mkfifo(path, 0600), 0);
  static const struct {
    const char *name, *text, *part;
  } all[] = {
      {"gone.off", NULL, "mesh gone.off: No such file or directory, expected"},
      {".", NULL, "mesh .: not a regular file, expected"},
      {"pipe", NULL, "mesh pipe: not a regular file, expected"},
      {"word.off", "hello", "mesh word.off:1: "},
      {"empty.ply", "", "the file is empty, expected"},
      {"cut.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "mesh cut.off:5: the file ends after 2 of 3 vertices, expected"},
      {"nan.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 nan 0\n3 0 1 2\n", "mesh nan.off:5: vertex 2: expected three finite"},
      {"thin.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n2 0 0\n3 0 1 2\n3 0 1 3\n",
       "triangle 2 of the 2 of mesh thin.off has no area (vertices 0, 1, 3"},
      {"twice.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 0\n", "triangle 1 of the 1 of mesh twice.off has no area"},
      {"huge.off", "OFF\n3 1 0\n0 0 0\n1e150 0 0\n1e150 1e150 0\n3 0 1 2\n", "overflows, expected smaller"},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    if (all[i].text) put(all[i].name, all[i].text);
    char text[512];
    snprintf(text, sizeof text, HEAD "  - point: {at: [0, 0, 0]}\n  - mesh: {file: %s}\n", all[i].name);
    skf_scene *s;
    skf_error e;
    if (!skf_scene_parse(text, strlen(text), folder, &s, &e)) fail_msg("%s is accepted", all[i].name);
    assert_null(s);
    assert_int_equal(e.line, 8);
    if (!strstr(e.text, all[i].part) || !strstr(e.text, "expected")) fail_msg("%s: %s", all[i].name, e.text);
  }
}

#define TETRAHEDRON "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n"

static void solids(void **state) {
  (void)state;
  put("good.off", TETRAHEDRON "3 0 3 2\n");
  put("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 1 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 5\n");
  put("open.off", TETRAHEDRON "3 0 1 2\n");
  put("inward.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 3 1\n3 1 3 2\n3 0 2 3\n");
  skf_scene *s = good(HEAD "  - solid: {file: good.off, strength: 3}\n  - solid: {file: good.obj}\n  mass: 8\n");
  const skf_element *e = s->bodies[0].elements;
  assert_true(s->bodies[0].element_count == 2 && e->kernel.type == SKF_INVERSE && e->strength == 3);
  assert_true(e->primitive.shape == SKF_SOLID && skf_solid_get(e[1].primitive.solid)->joined == 1);
  check_close(skf_primitive_measure(&e->primitive), 1 / 6.0, 1e-15);
  check_close(s->bodies[0].rho, 12, 1e-15);
  skf_scene_free(s);
  s = good("skelfield: 1\nbodies:\n- {name: a, iso: 1, skeleton: [{solid: {file: good.off}}]}\n"); /* no kernel */
  skf_scene_free(s);
  static const struct {
    const char *entry, *part;
  } bad[] = {
      {"{file: open.off}", "mesh open.off: is not closed at the edge from (0, 0, 0) to (1, 0, 0), which has 3 faces"},
      {"{file: inward.off}", "mesh inward.off: faces inward (its volume is -0.166666667), expected a closed mesh that"},
      {"{file: gone.off}", "mesh gone.off: No such file or directory, expected"},
      {"{strength: 2}", "missing 'file' in solid, expected a file name"},
      {"{file: good.off, size: 2}", "unknown key 'size' in solid"},
      {"{file: good.off, strength: 0}", "strength is 0"},
      {"{file: good.off, radius: 2}", "a solid has no such handles"},
      {"{file: good.off, kernel: {type: cauchy, s: 1}}", "the kernel of this solid is cauchy, expected inverse"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    char text[512];
    snprintf(text, sizeof text, HEAD "  - point: {at: [0, 0, 0]}\n  - solid: %s\n", bad[i].entry);
    skf_error why;
    if (!skf_scene_parse(text, strlen(text), folder, &s, &why)) fail_msg("%s is accepted", bad[i].entry);
    assert_int_equal(why.line, 8);
    if (!strstr(why.text, bad[i].part) || !strstr(why.text, "expected")) fail_msg("%s: %s", bad[i].entry, why.text);
  }
}

static void failing_allocations_are_errors(void **state) {
  (void)state;
  put("pyramid.off", pyramid);
  skf_scene *s = NULL;
  long k = 0;
  skf_status status = SKF_ERR_NOMEM;
  while (status) {
    assert_true(++k < 1000);
    skf_alloc_fail_after(k);
    status = skf_scene_parse(everything, sizeof everything - 1, folder, &s, NULL);
    skf_alloc_fail_after(0);
    if (status) assert_int_equal(status, SKF_ERR_NOMEM);
  }
  assert_true(k > 20);
  skf_scene_free(s);
}

static int make_folder(void **state) { return (void)state, mkdtemp(folder) ? 0 : -1; }

static int remove_folder(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  return system(command);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pieces),
      cmocka_unit_test(fields),
      cmocka_unit_test(solids),
      cmocka_unit_test(curves),
      cmocka_unit_test(helices),
      cmocka_unit_test(boxes),
      cmocka_unit_test(files_are_relative_to_the_scene),
      cmocka_unit_test(broken_files_are_refused),
      cmocka_unit_test(failing_allocations_are_errors),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
