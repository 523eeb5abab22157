/* SPDX-License-Identifier: MIT */
/* Every row of the shared table of reference values on points, segments, arcs and planes: F and its gradient, rounded
   from 40 digits. Triangles have their own. */
#include "check.h"
#include "core/vec3.h"
#include "random.h"
#include "skelfield/field.h"
#include <string.h>

typedef struct row {
  skf_element element;
  skf_vec3 x, g;
  double F;
} row;

static FILE *open_shared(const char *name) {
  char path[1024];
  const char *shared = getenv("SKF_SHARED"), *source = getenv("SKF_SOURCE_ROOT");
  if (shared)
    snprintf(path, sizeof path, "%s/reference/%s", shared, name);
  else
    snprintf(path, sizeof path, "%s/../shared/reference/%s", source ? source : ".", name);
  return fopen(path, "r");
}

/* Splits a line at commas; empty cells are 0. */
static int split(char *line, char *word[], double x[], int most) {
  int n = 0;
  for (char *p = line; p && n < most; n++) {
    char *comma = strchr(p, ',');
    if (comma) *comma = 0;
    word[n] = p;
    x[n] = strtod(p, NULL);
    p = comma ? comma + 1 : NULL;
  }
  return n;
}

static skf_kernel_type kernel(char *name) {
  for (char *c = name; *c; c++)
    if (*c == '_') *c = '-';
  return skf_kernel_find(name);
}

static skf_vec3 at(const double *x) { return v3(x[0], x[1], x[2]); }

static bool read_line(char *line, row *r) {
  char *w[24];
  double x[24];
  int n = split(line, w, x, 24);
  if (n != 24) return false;
  skf_primitive *p = &r->element.primitive;
  memset(r, 0, sizeof *r);
  r->element.strength = 1;
  r->element.kernel = (skf_kernel){kernel(w[0]), x[1]};
  if (!strcmp(w[2], "point")) {
    p->shape = SKF_POINT;
    p->point.at = at(x + 3);
  } else if (!strcmp(w[2], "segment")) {
    p->shape = SKF_SEGMENT;
    p->segment.from = at(x + 3);
    p->segment.to = at(x + 6);
  } else if (!strcmp(w[2], "arc")) {
    p->shape = SKF_ARC;
    p->arc = (skf_arc){at(x + 3), at(x + 9), at(x + 12), x[15], x[16]};
  } else {
    p->shape = SKF_PLANE;
    p->plane = (skf_plane){at(x + 3), at(x + 9)};
  }
  r->x = at(x + 17);
  r->F = x[20];
  r->g = at(x + 21);
  return true;
}

static double size(const skf_primitive *p) {
  return p->shape == SKF_ARC ? p->arc.radius : p->shape == SKF_SEGMENT ? skf_primitive_measure(p) : 0;
}

typedef struct errors {
  double F, g;
} errors;

/* Scales of fields-1d.md, section 7: |F| and max(|g|, |F| / max(size, distance)). */
static errors compare(const row *r, double F, skf_vec3 g) {
  double d = fmax(size(&r->element.primitive), skf_primitive_distance(&r->element.primitive, r->x));
  double f = fabs(r->F), G = fmax(v3_norm(r->g), f / d);
  if (r->element.primitive.shape == SKF_PLANE && r->element.kernel.type == SKF_INVERSE_SQUARED) f = fmax(f, 6.28);
  double e = fabs(F - r->F), eg = v3_dist(g, r->g);
  return (errors){e == 0 ? 0 : e / f, eg == 0 ? 0 : eg / G};
}

/* How far F and g move, by the same scales, when each coordinate of x moves by eight ulps. */
static errors conditioning(const row *r, const skf_field *f) {
  errors worst = {0, 0};
  skf_vec3 g0, g1;
  double F0 = skf_field_at(f, r->x, &g0);
  for (int i = 0; i < 6; i++) {
    skf_vec3 x = r->x;
    double *c = v3_at(&x, i / 2), step = 8 * 2.3e-16 * fmax(fabs(*c), size(&r->element.primitive));
    *c += i & 1 ? step : -step;
    double F1 = skf_field_at(f, x, &g1);
    row moved = *r;
    moved.F = F0, moved.g = g0;
    errors e = compare(&moved, F1, g1);
    worst.F = fmax(worst.F, e.F), worst.g = fmax(worst.g, e.g);
  }
  return worst;
}

/* The same point among others near the body, in a place of the batch that depends on the row. */
static double in_batch(const row *r, const skf_field *f, int number, skf_vec3 *g) {
  enum { N = 11 };
  double p[3][N], F[N], G[3][N],
      d = fmax(size(&r->element.primitive), skf_primitive_distance(&r->element.primitive, r->x));
  uint64_t seed = (uint64_t)number;
  for (int i = 0; i < N; i++) {
    skf_vec3 x = i == number % N ? r->x : v3_mad(r->x, d, rnd_vec(&seed, 1));
    p[0][i] = x.x, p[1][i] = x.y, p[2][i] = x.z;
  }
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {G[0], G[1], G[2]};
  assert_int_equal(skf_field_eval(f, N, in, F, out, NULL), SKF_OK);
  *g = v3(G[0][number % N], G[1][number % N], G[2][number % N]);
  return F[number % N];
}

static void check_table(bool batch) {
  FILE *in = open_shared("public_1d.csv");
  if (!in) {
    print_message("public_1d.csv is not here: skipped\n");
    skip();
  }
  char line[2048];
  errors worst[SKF_KERNEL_COUNT][SKF_SHAPE_COUNT] = {{{0, 0}}};
  int rows = 0, limited = 0, failed = 0;
  assert_non_null(fgets(line, sizeof line, in));
  while (fgets(line, sizeof line, in)) {
    row r;
    assert_true(read_line(line, &r));
    skf_field *f;
    assert_int_equal(skf_field_new(&r.element, 1, &f), SKF_OK);
    skf_vec3 g;
    double F = batch ? in_batch(&r, f, rows, &g) : skf_field_at(f, r.x, &g);
    errors e = compare(&r, F, g);
    skf_kernel_type k = r.element.kernel.type;
    skf_shape s = r.element.primitive.shape;
    bool closed = skf_pair_get(k, s).closed;
    double tf = closed ? 1e-12 : 1e-9, tg = closed ? 1e-11 : 1e-9;
    rows++;
    if (!(e.F <= tf && e.g <= tg)) {
      errors c = conditioning(&r, f);
      if (e.F <= fmax(tf, c.F) && e.g <= fmax(tg, c.g))
        limited++;
      else {
        failed++;
        print_message("%s %d on %s: F off by %.2g, gradient by %.2g (moves by %.2g, %.2g)\n", skf_kernel_get(k)->name,
                      rows + 1, skf_shape_get(s)->name, e.F, e.g, c.F, c.g);
      }
    } else {
      worst[k][s].F = fmax(worst[k][s].F, e.F);
      worst[k][s].g = fmax(worst[k][s].g, e.g);
    }
    skf_field_free(f);
  }
  fclose(in);
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      if (worst[k][s].F + worst[k][s].g > 0)
        print_message("%-16s %-9s F %.1e  gradient %.1e\n", skf_kernel_get((skf_kernel_type)k)->name,
                      skf_shape_get((skf_shape)s)->name, worst[k][s].F, worst[k][s].g);
  print_message("%d rows, %d limited by conditioning, %d failed\n", rows, limited, failed);
  assert_true(rows > 500);
  assert_int_equal(failed + limited, 0); /* no row of this table needs the leave */
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
