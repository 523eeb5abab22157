/* SPDX-License-Identifier: MIT */
/* Polynomials in place of smooth fields: never further from them than they say. */
#include "check.h"
#include "field/some.h"
#include "random.h"
#include "ray/room.h"
#include "skelfield/ray.h"
#include <stdlib.h>

enum { ELEMENTS = 5, CELLS = 60, PLACES = 20 };

static const skf_kernel_type kernels[] = {SKF_CAUCHY, SKF_INVERSE, SKF_INVERSE_SQUARED, SKF_GAUSSIAN};
static const skf_shape shapes[] = {SKF_POINT, SKF_SEGMENT, SKF_ARC, SKF_TRIANGLE};

static double power_sum(const skf_patch *p, skf_vec3 x) {
  const double *c = p->c;
  double sum = 0;
  for (int i = 0; i <= p->degree; i++)
    for (int j = 0; i + j <= p->degree; j++)
      for (int k = 0; i + j + k <= p->degree; k++) sum += *c++ * pow(x.x, i) * pow(x.y, j) * pow(x.z, k);
  return sum;
}

/* A cell of a field; returns whether it is a leaf, in which value, slope and second differences are held against the
   field's own. */
static bool check_cell(const skf_smooth *s, const skf_far_part *all, const skf_smooth_cell *c, uint64_t *state,
                       double *closest) {
  skf_patch patch;
  skf_model model;
  uint32_t kept[ELEMENTS], keep;
  skf_smooth_kind kind = skf_smooth_examine(s, c, all, &patch, &model, kept, &keep);
  assert_int_not_equal(kind, SKF_SMOOTH_LOST);
  for (int i = 0; i < PLACES; i++) {
    skf_vec3 x = rnd_vec(state, 1), g, u = rnd_unit(state), p = v3_mad(c->center, c->half, x);
    double F = skf_field_at(s->field, p, &g), h = 1e-4;
    if (kind == SKF_SMOOTH_OUTSIDE) assert_true(F < s->iso);
    if (kind == SKF_SMOOTH_INSIDE) assert_true(F > s->iso);
    if (kind != SKF_SMOOTH_LEAF) continue;
    double P = power_sum(&patch, x), off = fabs(F - s->iso - P);
    if (!(off <= patch.off.value)) fail_msg("off by %g, not by %g at most", off, patch.off.value);
    if (off > 1e-13 * fabs(F)) *closest = fmax(*closest, off / patch.off.value);
    double up = power_sum(&patch, v3_mad(x, h, u)), down = power_sum(&patch, v3_mad(x, -h, u));
    double slope = (up - down) / (2 * h * c->half), scale = (fabs(F) + v3_norm(g) * c->half) / c->half;
    assert_true(fabs(v3_dot(g, u) - slope) <= patch.off.slope + 1e-6 * scale);
    skf_vec3 to, from;
    skf_field_at(s->field, v3_mad(p, h * c->half, u), &to), skf_field_at(s->field, v3_mad(p, -h * c->half, u), &from);
    double bend = v3_dot(v3_sub(to, from), u) / (2 * h * c->half),
           bow = (up - 2 * P + down) / (h * h * c->half * c->half);
    assert_true(fabs(bend - bow) <= patch.off.bend + 1e-5 * scale / c->half);
  }
  return kind == SKF_SMOOTH_LEAF;
}

/* Cells of all sizes, one below the other as in an octree. */
static void margins(void **unused) {
  (void)unused;
  uint64_t state = 12;
  int leaves[4] = {0};
  double closest = 0;
  for (int scene = 0; scene < 64; scene++) {
    skf_element e[ELEMENTS];
    skf_source sources[ELEMENTS];
    skf_field *f;
    int kind = scene % 4;
    double scale = scene % 3 == 0 ? 1e-7 : 1;
    for (int i = 0; i < ELEMENTS; i++) {
      e[i] = (skf_element){.kernel = {kernels[kind], rnd(&state, 1, 4) / scale}, .strength = rnd(&state, 0.5, 2)};
      if (scene % 5 == 0 && i) e[i].strength = -0.3 * e[i].strength;
      rnd_primitive(&state, shapes[scene / 4 % 4], scale, &e[i].primitive);
    }
    assert_int_equal(skf_field_new(e, ELEMENTS, &f), SKF_OK);
    for (size_t i = 0; i < ELEMENTS; i++) {
      skf_source_init(skf_field_element(f, i), sources + i);
      assert_true(skf_source_is_smooth(sources + i));
    }
    for (int cell = 0; cell < CELLS; cell++) {
      skf_vec3 on = skf_primitive_point(&e[cell % ELEMENTS].primitive, 0.4, 0.3);
      skf_vec3 p = v3_mad(on, scale * rnd(&state, 0.1, 0.8), rnd_unit(&state));
      skf_smooth s = {.field = f, .sources = sources, .iso = skf_field_at(f, p, NULL), .noise = 1e-15};
      skf_chebyshev_init(&s.table, skf_isa_pick(), 1e-8);
      skf_far_part *above = calloc(1, sizeof *above + ELEMENTS * sizeof(uint32_t));
      above->count = ELEMENTS;
      for (uint32_t i = 0; i < ELEMENTS; i++) above->list[i] = i;
      skf_smooth_cell c = {p, 0.4 * scale, 0, false};
      int first = (int)rnd(&state, 0, 8);
      for (int level = 0; level < 12; level++) { /* towards p, with what is far put aside on the way */
        if (check_cell(&s, above, &c, &state, &closest)) {
          leaves[kind]++;
          break;
        }
        skf_patch patch;
        skf_model model;
        uint32_t kept[ELEMENTS], keep = above->count;
        if (skf_smooth_examine(&s, &c, above, &patch, &model, kept, &keep) != SKF_SMOOTH_BRANCH) break;
        above->model = model, above->count = keep;
        for (uint32_t i = 0; i < keep; i++) above->list[i] = kept[i];
        c.child = level ? 7 - first : first; /* p is at its corner */
        double half = 0.5 * c.half / (1 + 1e-8);
        c.center =
            v3_add(c.center, v3(c.child & 1 ? half : -half, c.child & 2 ? half : -half, c.child & 4 ? half : -half));
        c.half *= 0.5;
      }
      free(above);
    }
    for (size_t i = 0; i < ELEMENTS; i++) skf_source_free(sources + i);
    skf_field_free(f);
  }
  print_message("%d, %d, %d, %d leaves; off by up to %.2g of the margin\n", leaves[0], leaves[1], leaves[2], leaves[3],
                closest);
  for (int k = 0; k < 4; k++) assert_true(leaves[k] > 100);
}

static double chebyshev_sum(const skf_model *m, skf_vec3 x) {
  double sum = 0;
  for (int i = 0; i < SKF_ALL_NODES; i++)
    sum += m->c[i] * cos(i / SKF_NODES / SKF_NODES * acos(x.x)) * cos(i / SKF_NODES % SKF_NODES * acos(x.y)) *
           cos(i % SKF_NODES * acos(x.z));
  return sum;
}

/* What few samples of one element make of it is no further from it than their margin. */
static void rough(void **unused) {
  (void)unused;
  uint64_t state = 21;
  static skf_chebyshev t;
  double closest = 0;
  skf_chebyshev_init(&t, skf_isa_pick(), 1e-8);
  for (int i = 0; i < 640; i++) {
    skf_element e = {.kernel = {kernels[i % 4], rnd(&state, 1, 4)}, .strength = rnd(&state, -2, 2)};
    skf_source s;
    skf_field *f;
    rnd_primitive(&state, shapes[i / 4 % 4], 1, &e.primitive);
    assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
    skf_source_init(skf_field_element(f, 0), &s);
    double half = rnd(&state, 0.02, 0.3), values[SKF_ALL_ROUGH];
    skf_vec3 c = rnd_vec(&state, 2);
    double near = fmax(skf_source_distance(&s, c) - 1.7320508075688773 * half, 0);
    double margin = skf_margin_rough(&s, near, skf_source_grade(&s, near, near).above.value, half);
    for (int k = 0; k < SKF_ALL_ROUGH; k++) {
      skf_vec3 x = v3(t.rough[k / 16], t.rough[k / 4 % 4], t.rough[k % 4]);
      values[k] = skf_field_at(f, v3_mad(c, half, x), NULL);
    }
    skf_model m = {.c = {0}};
    skf_model_add_rough(&t, values, &m);
    for (int k = 0; k < PLACES; k++) {
      skf_vec3 x = rnd_vec(&state, 1);
      double F = skf_field_at(f, v3_mad(c, half, x), NULL), off = fabs(chebyshev_sum(&m, x) - F);
      assert_true(off <= margin + 1e-13 * fabs(F));
      closest = fmax(closest, off / margin);
    }
    skf_source_free(&s);
    skf_field_free(f);
  }
  print_message("off by up to %.2g of the margin\n", closest);
  assert_true(closest > 0.01);
}

/* Normals of many elements: to rounding, or as far off as the options allow; the hits are the same. */
static void normals(void **unused) {
  (void)unused;
  enum { MANY = 60, RAYS = 400 };
  uint64_t state = 5;
  for (int kind = 0; kind < 4; kind++) {
    skf_element e[MANY];
    skf_field *f;
    skf_tracer *t[2];
    for (int i = 0; i < MANY; i++) {
      e[i] = (skf_element){.kernel = {kernels[kind], 3}, .strength = 1};
      rnd_primitive(&state, shapes[i % 2], 1, &e[i].primitive);
    }
    assert_int_equal(skf_field_new(e, MANY, &f), SKF_OK);
    double iso = skf_field_at(f, v3(1.1, 0.2, 0.1), NULL);
    assert_int_equal(skf_tracer_new(f, iso, t), SKF_OK);
    assert_int_equal(skf_tracer_new_with(f, iso, &(skf_tracer_options){.normals = 1e-8}, t + 1), SKF_OK);
    size_t hits = 0;
    for (int i = 0; i < RAYS; i++) {
      skf_ray ray = {v3_scale(4, rnd_unit(&state)), v3(0, 0, 0), 0, INFINITY};
      ray.direction = v3_sub(rnd_vec(&state, 1), ray.origin);
      skf_hit hit[2], all[8];
      bool found[2];
      size_t n;
      for (int k = 0; k < 2; k++) assert_int_equal(skf_tracer_first(t[k], &ray, hit + k, found + k, NULL), SKF_OK);
      assert_int_equal(skf_tracer_all(t[0], &ray, 8, all, &n, NULL), SKF_OK);
      assert_true(found[0] == found[1] && found[0] == (n > 0));
      if (!n) continue;
      hits++;
      for (int k = 0; k < 3; k++) {
        skf_vec3 g, at = k < 2 ? hit[k].at : all[0].at, normal = k < 2 ? hit[k].normal : all[0].normal;
        skf_field_at(f, at, &g);
        assert_true(v3_norm(v3_add(normal, v3_unit(g))) <= (k == 1 ? 1e-8 : 1e-13));
        assert_true(v3_norm(v3_sub(at, hit[0].at)) <= 1e-14);
      }
    }
    assert_true(hits > RAYS / 4);
    skf_tracer *none;
    for (int k = 0; k < 3; k++)
      assert_int_equal(skf_tracer_new_with(f, iso, &(skf_tracer_options){(double[]){-1, 0.1, NAN}[k]}, &none),
                       SKF_ERR_ARG);
    for (int k = 0; k < 2; k++) skf_tracer_free(t[k]);
    skf_field_free(f);
  }
}

/* Within its error a model may have one sign at both ends of a crossing: the field's own signs tell. */
static void ends_of_models(void **unused) {
  (void)unused;
  skf_element e = {{.shape = SKF_POINT, .point = {{0, 0, 0}}}, {SKF_CAUCHY, 1}, 1};
  skf_field *f;
  skf_tracer *t;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  assert_int_equal(skf_tracer_new(f, skf_field_at(f, v3(1, 0, 0), NULL), &t), SKF_OK);
  skf_walk w = {.tracer = t, .origin = {3, 0, 0}, .direction = {-1, 0, 0}};
  skf_knot a = {.t = 1.999, .f = 1e-9}, b = {.t = 2.5, .f = 0.1}, k = skf_walk_polish(&w, &a, &b, 2.2);
  assert_true(fabs(k.t - 2) <= 1e-15 && fabs(k.at.x - 1) <= 1e-15 && k.gradient.x < 0);
  skf_tracer_free(t);
  skf_field_free(f);
}

/* Places to look at stay between the ends of the crossing, whatever the slope. */
static void stays_between(void **unused) {
  (void)unused;
  skf_patch patch = {.per = 1};
  skf_leaf leaf = {.patch = &patch, .bend = 1e3};
  skf_bow bow = {.loose = 1e3};
  skf_tracer t = {.normals = 0};
  skf_walk w = {.direction = {0, 0, 1}, .leaf = &leaf, .bow = &bow};
  skf_knot a = {.t = 1, .f = -1}, b = {.t = 2, .f = 1};
  for (int i = 0; i < 4; i++) {
    skf_room r;
    skf_sights at = {.F = {0}};
    skf_hit hit;
    bool done[4];
    r.count = 0;
    for (int k = 0; k < 4; k++) {
      skf_room_add(&r, &hit, &w, &a, &b, 1.5);
      at.F[k] = 0.1, at.size[k] = 1, at.g[2][k] = (double[]){0.01, -0.01, 0, 0.2}[i];
    }
    skf_room_settle_scalar(&t, &r, 4, &at, done);
    for (int k = 0; k < 4; k++) assert_true(!done[k] && r.t[k] >= 1 && r.t[k] <= 2);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(margins), cmocka_unit_test(rough), cmocka_unit_test(normals),
                                     cmocka_unit_test(ends_of_models), cmocka_unit_test(stays_between)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
