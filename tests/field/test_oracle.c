/* SPDX-License-Identifier: MIT */
/* Every pair, by region, against fields integrated numerically with 113 bits: one point at a time and in a batch. */
#include "check.h"
#include "field/cases.h"

enum { ROUNDS = 24 };

/* Counts a case; false when it misses what it must reach. */
static bool check_case(const field_case *c, field_error *worst, int *limited) {
  const field_error target = {1e-12, 1e-11, 1e-10};
  skf_field *f;
  assert_int_equal(skf_field_new(&c->element, 1, &f), SKF_OK);
  oracle_value want = oracle(&c->element, c->x);
  field_result one = case_alone(f, c->x), many = case_in_batch(f, c->x);
  skf_field_free(f);
  if (!(fabsq(want.F) > 1e-280Q)) return true;
  field_error e = error_max(case_error(c, &want, &one), case_error(c, &want, &many));
  if (error_within(e, target)) {
    *worst = error_max(*worst, e);
    return true;
  }
  ++*limited;
  field_error moves = case_moves(c, &want, oracle);
  if (error_within(e, error_max(target, moves))) return true;
  print_message("F off by %.2g, gradient %.2g, Hessian %.2g; eight ulps move them by %.2g, %.2g, %.2g\n", e.F, e.g, e.h,
                moves.F, moves.g, moves.h);
  return false;
}

static void test_pairs(void **state) {
  (void)state;
  uint64_t seed = 31;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++) {
      field_error worst = {0, 0, 0};
      int seen = 0, limited = 0, failed = 0;
      for (int i = 0; i < ROUNDS * CASE_REGIONS; i++) {
        field_case c;
        uint64_t start = seed;
        if (!case_draw(&seed, (skf_kernel_type)k, (skf_shape)s, (case_region)(i % CASE_REGIONS), &c)) continue;
        seen++;
        if (check_case(&c, &worst, &limited)) continue;
        failed++;
        print_message("^ %s, seed %#llx\n", case_region_name[i % CASE_REGIONS], (unsigned long long)start);
      }
      print_message("%-16s %-9s F %.1e  gradient %.1e  Hessian %.1e  (%d places, %d limited by conditioning)\n",
                    skf_kernel_get((skf_kernel_type)k)->name, skf_shape_get((skf_shape)s)->name, worst.F, worst.g,
                    worst.h, seen, limited);
      assert_true(seen > ROUNDS);
      assert_true(limited < seen / 3);
      assert_int_equal(failed, 0);
    }
}

/* A support's rim crosses the triangle, from everywhere, near and far. */
static void test_rims_of_triangles(void **state) {
  (void)state;
  uint64_t seed = 5;
  field_error worst = {0, 0, 0};
  int limited = 0, failed = 0;
  for (int i = 0; i < 600; i++) {
    field_case c;
    double distance = rnd_power(&seed, -0.3, 4.3);
    memset(&c, 0, sizeof c);
    c.element.strength = 1, c.size = 1;
    c.element.kernel.type = (skf_kernel_type)(SKF_METABALL + i % 3);
    c.element.primitive.shape = SKF_TRIANGLE;
    case_anchor a = case_triangle(&seed, i % 2 ? CASE_EDGE : CASE_NEAR, 1, rnd_vec(&seed, 1), &c.element.primitive);
    c.x = v3_mad(a.at, distance, a.to);
    c.distance = skf_primitive_distance(&c.element.primitive, c.x);
    c.element.kernel.param = c.distance * (1 + rnd_power(&seed, -3.3, -2));
    failed += !check_case(&c, &worst, &limited);
  }
  assert_int_equal(failed, 0);
}

/* Places where a sum once cancelled. */
static void test_known_places(void **state) {
  (void)state;
  static const field_case rows[] = {
      /* beside a sliver 1 / r^2's edge terms do, each within itself */
      {.element = {.kernel.type = SKF_INVERSE_SQUARED,
                   .primitive = {.shape = SKF_TRIANGLE,
                                 .triangle = {{{-0.10000258722097798, 0.014444487580453783, 0.002409707797479288},
                                               {0, 0, 0},
                                               {0.99040128561693097, -0.13616037028066705, -0.023783334782190524}}}}},
       .x = {0.62766381529002835, 1.0548183456020908, -0.0015294318130210796},
       .size = 1},
      /* a narrow Gaussian at the sharp corner of a wide triangle */
      {
          .element =
              {.kernel = {SKF_GAUSSIAN, 3397628345068.4775},
               .primitive = {.shape = SKF_TRIANGLE,
                             .triangle = {{{-7.5951606689339739e-06, -1.4088247328487046e-05, -2.0661126739906897e-05},
                                           {-3.5581910318694737e-06, -6.5007703602355418e-06, -9.5210491136998649e-06},
                                           {0, 0, 0}}}}},
          .x = {-1.6519498537474033e-14, 1.0308131800256089e-13, 1.6821974255966599e-13},
          .size = 2.6e-5},
      /* a short arc of a circle that the place is next to elsewhere */
      {.element = {.kernel = {SKF_CAUCHY, 0.071590064310628518},
                   .primitive = {.shape = SKF_ARC,
                                 .arc = {{-30720, -29184, 14848},
                                         {0.32719886874329057, -0.63177825431709111, 0.70270700698453248},
                                         {-0.53063841422062596, -0.73816412122796604, -0.41657724792067569},
                                         32768,
                                         3.9551475756702929e-05}}},
       .x = {-59056.446354494059, -25920.063052003981, 30976.681911036714},
       .size = 32768},
      /* a metaball's core ends at a distant arc, whose ends are as far to the last digit */
      {.element = {.kernel = {SKF_METABALL, 385267691868.92291},
                   .primitive = {.shape = SKF_ARC,
                                 .arc = {{188416, 69632, -212992},
                                         {-0.58926780084284114, -0.71958007075466024, -0.36737988603427896},
                                         {0.71042251755522579, -0.67804232874882409, 0.18856947519513053},
                                         262144,
                                         2.8536410810256201}}},
       .x = {75675470256.974869, 92410387289.982208, 47179653918.39991},
       .size = 262144},
      /* a Gaussian 1e9 times narrower than the radius, at an arc of more than half a turn */
      {.element = {.kernel = {SKF_GAUSSIAN, 3e9},
                   .primitive = {.shape = SKF_ARC,
                                 .arc = {{0.984375, -0.015625, 0.9375},
                                         {1, 0, 0},
                                         {0, 0.99984437155356187, 0.017641787683306865},
                                         1,
                                         4.3561393721399604}}},
       .x = {0.984375, 0.98421932566166459, 0.95514438859632456},
       .size = 1},
  };
  field_error worst = {0, 0, 0};
  int limited = 0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    field_case c = rows[i];
    c.element.strength = 1, c.distance = skf_primitive_distance(&c.element.primitive, c.x);
    if (!check_case(&c, &worst, &limited)) fail_msg("place %zu", i);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pairs), cmocka_unit_test(test_rims_of_triangles),
                                     cmocka_unit_test(test_known_places)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
