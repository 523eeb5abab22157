/* SPDX-License-Identifier: MIT */
/* Helices, spirals and curves of the caller's own as chains of arcs: how far, how long, how smooth, how many. */
#include "check.h"
#include "random.h"
#include "skelfield/skeleton.h"

enum { MOST = 60000 };
static skf_primitive pieces[MOST];

/* Written anew, from the definition. */
static skf_vec3 helix_point(const skf_helix *h, double t) {
  skf_vec3 n = v3_unit(h->axis), e = v3_unit(v3_mad(h->start, -v3_dot(h->start, n), n)), f = v3_cross(n, e);
  double phi = 2 * SKF_PI * h->turns * t, r = (1 - t) * h->radius + t * h->end_radius;
  if (h->logarithmic) r = h->radius * pow(h->end_radius / h->radius, t);
  return v3_mad(v3_mad(v3_mad(h->center, r * cos(phi), e), r * sin(phi), f), h->pitch * h->turns * t, n);
}

static double helix_length(const skf_helix *h) {
  int n = 2000 * (int)ceil(h->turns);
  double sum = 0;
  skf_vec3 last = helix_point(h, 0);
  for (int i = 1; i <= n; i++) {
    skf_vec3 x = helix_point(h, (double)i / n);
    sum += v3_dist(x, last), last = x;
  }
  return sum; /* chords: too short by 4e-7 */
}

static size_t cut(const char *name, const skf_helix *h, double tolerance) {
  size_t n, again;
  skf_status s = skf_helix_cut(h, tolerance, NULL, 0, &n);
  if (s) fail_msg("%s is refused: %s", name, skf_status_text(s));
  assert_in_range(n, 1, MOST);
  assert_int_equal(skf_helix_cut(h, tolerance, pieces, n - 1, &again), SKF_ERR_CAPACITY);
  assert_int_equal(skf_helix_cut(h, tolerance, pieces, MOST, &again), SKF_OK);
  assert_int_equal(again, n);
  return n;
}

static skf_vec3 tangent(const skf_primitive *p, double s) {
  if (p->shape == SKF_SEGMENT) return v3_unit(v3_sub(p->segment.to, p->segment.from));
  skf_vec3 x = v3_sub(skf_primitive_point(p, s, 0), p->arc.center);
  return v3_unit(v3_cross(p->arc.normal, x));
}

/* Pieces join, in place and in direction; every place of the curve is near to a piece, and places of the pieces are
   near to the curve, which is looked for around the piece's share of the length. */
static size_t check_helix(const char *name, const skf_helix *h, double tolerance) {
  size_t n = cut(name, h, tolerance);
  double size = fmax(h->radius, h->end_radius), worst = 0, length = 0;
  if (tolerance == 0) tolerance = SKF_CURVE_TOLERANCE * size;
  double noise = 1e-13 * (size + fabs(h->pitch) * h->turns + v3_norm(h->center));
  int samples = 40 + (int)(200 * h->turns);
  size_t near = 0; /* both run forward */
  for (int k = 0; k <= samples; k++) {
    skf_vec3 x = helix_point(h, (double)k / samples);
    double best = INFINITY;
    size_t from = near > 60 ? near - 60 : 0, to = near + 60 < n ? near + 60 : n;
    for (size_t i = from; i < to; i++) {
      double d = skf_primitive_distance(pieces + i, x);
      if (d < best) best = d, near = i;
    }
    worst = fmax(worst, best);
  }
  if (!(worst <= tolerance + noise))
    fail_msg("%s: the curve is %g from its pieces, allowed %g", name, worst, tolerance);
  skf_vec3 end = helix_point(h, 0);
  for (size_t i = 0; i < n; i++) {
    assert_int_equal(skf_primitive_check(pieces + i, NULL), SKF_OK);
    check_scaled(v3_dist(end, skf_primitive_point(pieces + i, 0, 0)), 0, 0.01 * tolerance + noise, 1);
    if (i && pieces[i].shape == SKF_ARC && pieces[i - 1].shape == SKF_ARC)
      check_scaled(v3_dist(tangent(pieces + i - 1, 1), tangent(pieces + i, 0)), 0, 1, 1e-6);
    end = skf_primitive_point(pieces + i, 1, 0);
    length += skf_primitive_measure(pieces + i);
  }
  check_scaled(v3_dist(end, helix_point(h, 1)), 0, 0.01 * tolerance + noise, 1);
  check_close(length, helix_length(h), 1e-6 + 2 * tolerance / size);
  print_message("%-22s %6zu pieces at %.0e: off by %.2f tolerances, length %.1e\n", name, n, tolerance / size,
                worst / tolerance, fabs(length / helix_length(h) - 1));
  return n;
}

static const skf_helix coil = {{0.3, -1, 2}, {1, 2, 3}, {1, 0, 0}, 1, 1, 0.3, 5.25, false};

static void helices(void **state) {
  (void)state;
  skf_helix h = coil;
  size_t right = check_helix("a coil", &h, 0);
  assert_in_range(right, 200, 4000);
  h.pitch = -h.pitch;
  assert_int_equal(check_helix("left-handed", &h, 0), right);
  check_helix("loosely", &h, 0.1);
  check_helix("finely", &h, 1e-9);
  h = coil, h.pitch = 30;
  check_helix("steep", &h, 0);
  h = coil, h.turns = 0.01;
  check_helix("a hint of a turn", &h, 0);
  h = coil, h.end_radius = 0;
  check_helix("a cone to its tip", &h, 1e-5);
  h.radius = 0, h.end_radius = 2;
  check_helix("a cone from its tip", &h, 1e-5);
  h = coil, h.logarithmic = true, h.end_radius = 0.01;
  check_helix("a shell", &h, 1e-5);
}

static void spirals(void **state) {
  (void)state;
  skf_helix h = {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0, 2, 0, 4, false};
  check_helix("archimedes", &h, 0);
  h.logarithmic = true, h.radius = 0.001;
  check_helix("logarithmic", &h, 0);
  h.turns = 0.25, h.radius = h.end_radius;
  check_helix("a quarter", &h, 0); /* which is one arc, cut in two where the biarc has its joint */
}

/* Any scale and place gives the same pieces. */
static void scales(void **state) {
  (void)state;
  size_t n = cut("here", &coil, 0);
  for (int power = -900; power <= 900; power += 300) {
    skf_helix h = coil;
    double s = ldexp(1, power);
    h.center = v3_scale(s, h.center), h.radius *= s, h.end_radius *= s, h.pitch *= s;
    assert_int_equal(cut("scaled", &h, 0), n);
    assert_true(isfinite(skf_primitive_measure(pieces)) && skf_primitive_measure(pieces) > 0);
  }
}

/* Third order: a thousandth of the tolerance takes about ten times the pieces. */
static void order(void **state) {
  (void)state;
  size_t coarse = cut("coarse", &coil, 1e-5), fine = cut("fine", &coil, 1e-8);
  assert_in_range(fine, 5 * coarse, 20 * coarse);
}

/* A torus knot, and a square with a corner where two parts meet. */
static void knot(const void *user, double t, int side, skf_vec3 *x, skf_vec3 *d) {
  (void)side;
  const int *pq = user;
  double a = 2 * SKF_PI * pq[0] * t, b = 2 * SKF_PI * pq[1] * t, r = 2 + cos(b), s = -pq[1] * sin(b);
  *x = v3(r * cos(a), r * sin(a), -sin(b));
  *d = v3(s * cos(a) - pq[0] * r * sin(a), s * sin(a) + pq[0] * r * cos(a), -pq[1] * cos(b));
}

static void corner(const void *user, double t, int side, skf_vec3 *x, skf_vec3 *d) {
  (void)user;
  bool second = t > 0.5 || (t == 0.5 && side > 0);
  *x = second ? v3(1, 2 * t - 1, 0) : v3(2 * t, 0, 0);
  *d = second ? v3(0, 1, 0) : v3(1, 0, 0);
}

static void curves_of_the_callers_own(void **state) {
  (void)state;
  static const int pq[2] = {2, 3};
  skf_curve trefoil = {knot, pq, 16};
  size_t n;
  assert_int_equal(skf_curve_cut(&trefoil, 1e-5, pieces, MOST, &n), SKF_OK);
  assert_in_range(n, 50, 2000);
  for (int k = 0; k < 1000; k++) {
    skf_vec3 x, d;
    knot(pq, k / 1000.0, 1, &x, &d);
    double best = INFINITY;
    for (size_t i = 0; i < n; i++) best = fmin(best, skf_primitive_distance(pieces + i, x));
    assert_true(best <= 1e-5);
  }
  assert_int_equal(skf_curve_cut(&(skf_curve){corner, NULL, 2}, 0, pieces, MOST, &n), SKF_OK);
  assert_int_equal(n, 2);
  check_close(skf_primitive_measure(pieces) + skf_primitive_measure(pieces + 1), 2, 1e-15);
  assert_int_equal(skf_curve_cut(&trefoil, 1e-11, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(skf_curve_cut(&trefoil, NAN, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(n, 0);
}

static void refused(void **state) {
  (void)state;
  size_t n = 7;
  skf_helix h = coil;
#define REFUSED(change, status)                                                                                        \
  h = coil, change, assert_int_equal(skf_helix_cut(&h, 0, pieces, MOST, &n), status), assert_int_equal(n, 0)
  REFUSED(h.axis = v3(0, 0, 0), SKF_ERR_DEGENERATE);
  REFUSED(h.start = h.axis, SKF_ERR_DEGENERATE);
  REFUSED(h.radius = h.end_radius = 0, SKF_ERR_DEGENERATE);
  REFUSED(h.pitch = 0, SKF_ERR_DEGENERATE);
  REFUSED(h.radius = -1, SKF_ERR_RANGE);
  REFUSED(h.turns = 0, SKF_ERR_RANGE);
  REFUSED(h.turns = 2e5, SKF_ERR_RANGE);
  REFUSED(h.pitch = NAN, SKF_ERR_RANGE);
  REFUSED(h.center.x = INFINITY, SKF_ERR_RANGE);
  REFUSED((h.logarithmic = true, h.end_radius = 0), SKF_ERR_RANGE);
  assert_int_equal(skf_helix_cut(&coil, 0.2, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(skf_helix_cut(&coil, 1e-11, pieces, MOST, &n), SKF_ERR_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(helices), cmocka_unit_test(spirals), cmocka_unit_test(scales),
      cmocka_unit_test(order),   cmocka_unit_test(refused), cmocka_unit_test(curves_of_the_callers_own),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
