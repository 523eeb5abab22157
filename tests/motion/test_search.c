/* SPDX-License-Identifier: MIT */
/* The search for contacts by itself: events of a motion, whatever piece of it, scale or direction of time one asks for;
   closest approaches; bounces and slides against closed forms. */
#include "motion/worlds.h"
#include "random.h"

static skf_touching touch(const skf_world *w, skf_ballistic m, double t0, double t1, skf_search how, skf_contact *c) {
  skf_touching is;
  assert_int_equal(skf_world_touch(w, &m, t0, t1, how, &is, c, NULL), SKF_OK);
  return is;
}

static skf_ballistic scaled(skf_ballistic m, double L, double T) {
  return (skf_ballistic){m.t * T, v3_scale(L, m.position), v3_scale(L / T, m.velocity),
                         v3_scale(L / (T * T), m.acceleration)};
}

/* From 2 to 4 away it comes close to the origin at t = 1. */
static skf_ballistic random_motion(uint64_t *seed) {
  skf_vec3 from = v3_scale(rnd(seed, 2, 4), rnd_unit(seed)), to = rnd_vec(seed, 1.6), a = rnd_vec(seed, 2);
  return (skf_ballistic){0, from, v3_mad(v3_sub(to, from), -0.5, a), a};
}

/* A cross of two bars, spun or not; a world of its size times L. */
static skf_world *cross(double L, skf_spin spin, skf_field **field) {
  skf_kernel k = {SKF_CAUCHY, 6 / L};
  skf_element e[2] = {segment_of(v3(-2 * L, 0, 0), v3(2 * L, 0, 0), k, 1),
                      segment_of(v3(0, -1.5 * L, 0), v3(0, 1.5 * L, 0), k, 1)};
  return single(e, 2, 0.1 * L, 1, spin, field);
}

static void three_answers(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&e, 1, 1, 1, still, &field);
  skf_contact c;
  skf_ballistic in = {3, {5, 0, 0}, {-2, 0, 0}, {0, 0, 0}};
  for (int how = 0; how < 2; how++) {
    assert_int_equal(touch(w, in, 3, 9, how, &c), SKF_TOUCHING_LATER);
    check_close(c.t, 5, 1e-15);
    check_close(c.position.x, 1, 1e-15);
    check_close(c.normal.x, 1, 1e-15);
    assert_int_equal(touch(w, in, 5, 9, how, &c), SKF_TOUCHING_AT_START);
    check_close(c.t, 5, 0);
    assert_int_equal(touch(w, in, 5.1, 9, how, &c), SKF_TOUCHING_NONE);  /* inside, and out again */
    assert_int_equal(touch(w, in, 6, 9, how, &c), SKF_TOUCHING_NONE);    /* on the surface, leaving */
    assert_int_equal(touch(w, in, -9, 4.9, how, &c), SKF_TOUCHING_NONE); /* not yet */
    assert_int_equal(touch(w, in, -9, 9, how, &c), SKF_TOUCHING_LATER);
    check_close(c.t, 5, 1e-14);
  }
  skf_touching is;
  in.velocity.x = NAN;
  assert_int_equal(skf_world_touch(w, &in, 0, 1, SKF_SEARCH_FAST, &is, NULL, NULL), SKF_ERR_RANGE);
  in.velocity.x = 1;
  assert_int_equal(skf_world_touch(w, &in, 1, 0, SKF_SEARCH_FAST, &is, NULL, NULL), SKF_ERR_RANGE);
  drop_world(w, field);
}

enum { EVENTS = 16 };

/* All contacts of a motion in [0, end], one after the other. */
static size_t events(const skf_world *w, skf_ballistic m, double end, double *t) {
  size_t n = 0;
  skf_contact c;
  for (double from = 0; n < EVENTS && touch(w, m, from, end, SKF_SEARCH_CERTIFIED, &c); from = c.t + 1e-9 * end)
    t[n++] = c.t;
  return n;
}

/* The first contact in any piece of a motion is the first of all its contacts that lie in the piece. */
static void pieces_of_a_motion_agree(void **state) {
  (void)state;
  const skf_spin spins[] = {still, {{0, 1, 1}, {0.2, 0, 0}, 1.7}};
  size_t met = 0;
  for (int k = 0; k < 2; k++) {
    skf_field *field;
    skf_world *w = cross(1, spins[k], &field);
    uint64_t seed = 11;
    for (int i = 0; i < 300; i++) {
      skf_ballistic m = random_motion(&seed);
      double t[EVENTS], end = 3;
      size_t n = events(w, m, end, t);
      for (int j = 0; j < 10; j++) {
        double a = rnd(&seed, 0, end), b = rnd(&seed, a, end);
        size_t first = 0;
        while (first < n && t[first] < a) first++;
        skf_contact c;
        skf_touching is = touch(w, m, a, b, SKF_SEARCH_CERTIFIED, &c);
        assert_int_equal(is != SKF_TOUCHING_NONE, first < n && t[first] <= b);
        if (is) check_close(c.t, t[first], 1e-13);
        met += is != SKF_TOUCHING_NONE;
      }
    }
    drop_world(w, field);
  }
  assert_in_range(met, 150, 5000);
}

/* Fourteen decades of scale and of time, reversed time, and a later start change no outcome. */
static void scales_do_not_matter(void **state) {
  (void)state;
  skf_field *field, *large_field, *small_field;
  skf_world *w = cross(1, still, &field), *large = cross(1e7, still, &large_field),
            *small = cross(1e-7, still, &small_field);
  uint64_t seed = 5;
  int hits = 0;
  for (int i = 0; i < 500; i++) {
    skf_ballistic m = random_motion(&seed), back = m;
    skf_contact a, b, c, d;
    skf_touching is = touch(w, m, 0, 3, SKF_SEARCH_CERTIFIED, &a);
    assert_int_equal(touch(large, scaled(m, 1e7, 1e-7), 0, 3e-7, SKF_SEARCH_CERTIFIED, &b), is);
    assert_int_equal(touch(small, scaled(m, 1e-7, 1e7), 0, 3e7, SKF_SEARCH_CERTIFIED, &c), is);
    if (is) check_close(b.t, a.t * 1e-7, 1e-13);
    if (is) check_close(c.t, a.t * 1e7, 1e-13);
    m.t = 100;
    assert_int_equal(touch(w, m, 100, 103, SKF_SEARCH_CERTIFIED, &d), is);
    if (is) check_scaled(d.t - 100, a.t, 100, 1e-14);
    back.velocity = v3_scale(-1, v3_mad(m.velocity, 3, m.acceleration)); /* from where it ends */
    back.position = v3_mad(v3_mad(m.position, 3, m.velocity), 4.5, m.acceleration);
    if (skf_world_level(w, 0, 0, m.position) < 0 && skf_world_level(w, 0, 0, back.position) < 0)
      assert_int_equal(touch(w, back, 0, 3, SKF_SEARCH_CERTIFIED, NULL) != 0, is != 0);
    hits += is != 0;
  }
  assert_in_range(hits, 50, 400);
  drop_world(w, field), drop_world(large, large_field), drop_world(small, small_field);
}

/* Brute force with 4000 places on each path: none is inside before the contact; each contact is on the surface and goes
   inwards. Several bodies, one of them spinning, and many elements. */
static void nothing_is_missed(void **state) {
  (void)state;
  enum { SPIKES = 60, PLACES = 4000 };
  skf_element spikes[SPIKES], ring = ring_of(1.5, newton, 1);
  for (int i = 0; i < SPIKES; i++) {
    double z = -1 + (i + 0.5) * 2.0 / SPIKES, phi = 2.399963 * i, r = sqrt(1 - z * z);
    spikes[i] = segment_of(v3(0, 0, 0), v3(r * cos(phi), r * sin(phi), z), (skf_kernel){SKF_CAUCHY, 50}, 1);
  }
  skf_field *f[2] = {field_of(spikes, SPIKES), field_of(&ring, 1)};
  const double iso[2] = {0.02, 9};
  const skf_attractor bodies[2] = {{f[0], iso[0], 1, {{0, 0, 1}, {0, 0, 0}, 2}}, {f[1], iso[1], 1, still}};
  skf_world *w = world_of(bodies, 2);
  uint64_t seed = 21;
  int met[2] = {0, 0}, fast = 0;
  for (int i = 0; i < 300; i++) {
    skf_ballistic m = random_motion(&seed);
    skf_contact c = {.t = 2}, d;
    bool found = touch(w, m, 0, 2, SKF_SEARCH_CERTIFIED, &c);
    for (int k = 1; k < PLACES; k++) {
      double t = c.t * k / PLACES;
      skf_vec3 p = v3_mad(v3_mad(m.position, t, m.velocity), 0.5 * t * t, m.acceleration);
      for (size_t b = 0; b < 2; b++) assert_true(skf_world_level(w, b, t, p) < 1e-12 * iso[b]);
    }
    if (found) {
      check_scaled(skf_world_level(w, c.body, c.t, c.position), 0, iso[c.body], 1e-13);
      assert_true(v3_dot(c.normal, v3_sub(c.before, skf_world_surface_velocity(w, c.body, c.position))) < 0);
      met[c.body]++;
    }
    if (!touch(w, m, 0, 2, SKF_SEARCH_FAST, &d)) continue;
    fast++; /* it may be a later one than the first, but it is one */
    assert_true(found && d.t >= c.t * (1 - 1e-13));
    check_scaled(skf_world_level(w, d.body, d.t, d.position), 0, iso[d.body], 1e-13);
  }
  assert_true(met[0] >= 5 && met[1] >= 50);
  assert_in_range(fast, met[1] / 2, met[0] + met[1]);
  skf_world_free(w);
  skf_field_free(f[0]), skf_field_free(f[1]);
}

/* Along a surface, all the way within rounding of it, beside one that turns: the fast search does no more than its
   share of each step. */
static void the_fast_search_is_bounded(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  for (int spins = 0; spins < 2; spins++) {
    skf_field *field;
    skf_world *w = single(&e, 1, 1, 1, spins ? (skf_spin){{1, 0, 0}, {0, 0, 1e-9}, 1} : still, &field);
    skf_flight_options o = {.contact = SKF_CONTACT_PASS, .search = SKF_SEARCH_FAST};
    skf_flight *f = fly(w, o, (skf_state){0, {1, 0, 0}, {0, 1 + 1e-12, 0}});
    check_close(v3_norm(state_at(f, 20, NULL, NULL).position), 1, 1e-8);
    skf_flight_report r = skf_flight_get_report(f);
    assert_true(r.bounds <= 16 * (r.steps + r.contacts));
    skf_flight_free(f);
    drop_world(w, field);
  }
}

/* Past a sphere on a straight line, around it on an ellipse, and past a cross, where no sample beats it. */
static void closest_approaches(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&e, 1, 10, 0, still, &field);
  skf_approach a;
  skf_flight_options o = {.approach = true};
  skf_flight *f = fly(w, o, (skf_state){0, {-3, 0.5, 0}, {2, 0, 0}});
  assert_int_equal(skf_flight_approach(f, 0, &a), SKF_ERR_ARG);
  state_at(f, 10, NULL, NULL);
  assert_int_equal(skf_flight_approach(f, 0, &a), SKF_OK);
  check_close(a.t, 1.5, 1e-14);
  check_close(a.position.y, 0.5, 1e-15);
  check_scaled(a.position.x, 0, 1, 1e-14);
  check_close(a.level, 2 - 10, 1e-14);
  check_close(a.distance, 8 * 0.25, 1e-14);
  skf_flight_free(f);
  drop_world(w, field);
  w = single(&e, 1, 10, 1, still, &field);
  skf_state half = {0, {-1.5, 0, 0}, {0, -sqrt(1 / 3.0), 0}}; /* at the apoapsis of e = 0.5 */
  f = fly(w, o, half);
  state_at(f, 6, NULL, NULL);
  assert_int_equal(skf_flight_approach(f, 0, &a), SKF_OK);
  check_close(a.t, SKF_PI, 1e-11);
  check_close(v3_norm(a.position), 0.5, 1e-11);
  skf_flight_free(f);
  o.contact = SKF_CONTACT_STOP; /* a contact is the closest approach */
  f = fly(w, o, (skf_state){0, {1, 0, 0}, {0, 0, 0}});
  skf_contact c = {0};
  state_at(f, 3, NULL, &c);
  assert_int_equal(skf_flight_approach(f, 0, &a), SKF_OK);
  check_close(a.t, c.t, 1e-15);
  check_scaled(a.level, 0, 10, 1e-14);
  skf_flight_free(f);
  drop_world(w, field);
  w = cross(1, (skf_spin){{0, 0, 1}, {0, 0, 0}, 1}, &field);
  o.contact = SKF_CONTACT_NONE;
  uint64_t seed = 3;
  for (int i = 0; i < 30; i++) {
    skf_state s = {0, v3_scale(3, rnd_unit(&seed)), rnd_vec(&seed, 1)};
    double most = -INFINITY, from, to = 0;
    f = fly(w, o, s);
    while (to < 5) {
      assert_int_equal(skf_flight_step(f, NULL, NULL), SKF_OK);
      skf_flight_span(f, &from, &to);
      for (int k = 0; k <= 100; k++) {
        assert_int_equal(skf_flight_at(f, fmin(to, from + (to - from) * k / 100), &s), SKF_OK);
        most = fmax(most, skf_world_level(w, 0, s.t, s.position));
      }
    }
    assert_int_equal(skf_flight_approach(f, 0, &a), SKF_OK);
    assert_true(a.level >= most - 1e-14);
    assert_true(a.level < most + 0.1); /* the samples are close */
    check_scaled(skf_world_level(w, 0, a.t, a.position), a.level, 1, 1e-14);
    skf_flight_free(f);
  }
  drop_world(w, field);
}

/* A plane of the inverse kernel: F = -2 pi |z|, the same weight everywhere; the ground is at z = 1. */
static skf_world *flat(double g, skf_field **field) {
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1};
  return single(&plane, 1, -TAU, g / TAU, still, field);
}

/* Drops from height H: the n-th bounce is at sqrt(2 H / g) (1 + 2 e + ... + 2 e^n) and goes up to e^2n H. */
static void bounces_lose_what_they_should(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), g = 9.81 * L, e = 0.7, H = 2 * L, T = sqrt(2 * H / g), when = T, top = H;
    skf_field *field;
    skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1};
    skf_world *w = single(&plane, 1, -TAU * L, g / TAU, still, &field);
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = e},
                        (skf_state){0, {0, 0, L + H}, {0, 0, 0}});
    skf_contact c;
    bool touched;
    double from, to = 0;
    int n = 0;
    for (;;) {
      assert_int_equal(skf_flight_step(f, &c, &touched), SKF_OK);
      skf_flight_span(f, &from, &to);
      if (!touched) continue;
      if (c.outcome != SKF_OUTCOME_BOUNCE) break;
      n++;
      check_close(c.t, when, top > 1e-6 * L ? 1e-12 : 1e-10); /* the ground is rough, too */
      check_scaled(c.after.z * c.after.z / (2 * g), top * e * e, top + 1e-6 * L, 1e-9);
      top *= e * e;
      when += 2 * T * pow(e, n);
    }
    assert_int_equal(c.outcome, SKF_OUTCOME_REST);
    assert_in_range(n, 35, 50); /* e^2n H > 1e-13 L, some hundred roundings of the ground */
    check_scaled(c.t, T * (1 + e) / (1 - e), T, 1e-5);
    skf_flight_free(f);
    drop_world(w, field);
  }
}

/* Put on the ground with a speed along it: friction stops it after v^2 / (2 mu g), whatever the restitution. */
static void slides_end_where_they_should(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    double e = 0.4 * k, mu = 0.3, g = 9.81, v = 2;
    skf_field *field;
    skf_world *w = flat(g, &field);
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = e, .friction = mu},
                        (skf_state){0, {0, 0, 1}, {v, 0, 0}});
    skf_contact c = {0};
    size_t n = 0;
    skf_state s = state_at(f, 10, &n, &c);
    assert_int_equal(c.outcome, SKF_OUTCOME_REST);
    check_close(s.position.x, v * v / (2 * mu * g), 1e-13);
    check_close(c.t, v / (mu * g), 1e-13);
    check_close(s.position.z, 1, 0);
    assert_in_range(n, 1, 4);
    skf_flight_free(f);
    drop_world(w, field);
  }
}

/* Bounces that get lower and lower on the donut end, in its hole as on its outside, with few rows in the log. */
static void bounces_on_the_donut_end(void **state) {
  (void)state;
  skf_element ring = ring_of(1, newton, 1);
  skf_field *field;
  skf_world *w = single(&ring, 1, 7.38278, 1, still, &field);
  uint64_t seed = 8;
  int rests = 0;
  for (int i = 0; i < 12; i++) {
    skf_state s = {0, v3_scale(2, rnd_unit(&seed)), rnd_vec(&seed, 0.3)};
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 0.5, .friction = 0.5}, s);
    skf_contact c = {0};
    size_t n = 0;
    s = state_at(f, 40, &n, &c);
    rests += c.outcome == SKF_OUTCOME_REST;
    skf_flight_free(f);
    if (n == 0) continue; /* through the hole and back, again and again */
    assert_in_range(n, 2, 80);
    check_scaled(skf_world_level(w, 0, 40, s.position), 0, 7.38278, c.outcome == SKF_OUTCOME_REST ? 1e-13 : 1e-4);
  }
  assert_true(rests >= 8);
  drop_world(w, field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(three_answers),
      cmocka_unit_test(pieces_of_a_motion_agree),
      cmocka_unit_test(scales_do_not_matter),
      cmocka_unit_test(nothing_is_missed),
      cmocka_unit_test(the_fast_search_is_bounded),
      cmocka_unit_test(closest_approaches),
      cmocka_unit_test(bounces_lose_what_they_should),
      cmocka_unit_test(slides_end_where_they_should),
      cmocka_unit_test(bounces_on_the_donut_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
