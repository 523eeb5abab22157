/* SPDX-License-Identifier: MIT */
/* Flights meet what they must at any speed and scale, however late they start, and backwards as well: with closed forms
   where bodies spin, and rounding in each row of the log. */
#include "motion/worlds.h"
#include "random.h"

static const skf_flight_options stop = {.contact = SKF_CONTACT_STOP};

/* A cross of two bars, of size 1. */
static skf_world *cross(double gain, skf_spin spin, skf_field **field) {
  const skf_kernel k = {SKF_CAUCHY, 6};
  skf_element e[2] = {segment_of(v3(-2, 0, 0), v3(2, 0, 0), k, 1), segment_of(v3(0, -1.5, 0), v3(0, 1.5, 0), k, 1)};
  return single(e, 2, 0.1, gain, spin, field);
}

static skf_state shot(uint64_t *seed, double speed) {
  skf_vec3 from = v3_scale(3, rnd_unit(seed)), to = rnd_vec(seed, 1.2);
  return (skf_state){0, from, v3_scale(speed, v3_unit(v3_sub(to, from)))};
}

/* On the surface to rounding, that of the time included, and inwards as the turning ground sees it. */
static void check_row(const skf_world *w, const skf_contact *c, double iso) {
  skf_vec3 slip = v3_sub(c->before, skf_world_surface_velocity(w, c->body, c->position));
  double ground = v3_norm(skf_world_surface_velocity(w, c->body, c->position)), tick = fabs(c->t) * 0x1p-52;
  check_scaled(skf_world_level(w, c->body, c->t, c->position), 0, iso, 1e-13 + 10 * ground * tick);
  check_close(v3_norm(c->normal), 1, 1e-14);
  assert_true(v3_dot(slip, c->normal) < 0);
}

/* Without gravity, the spin being as fast as the flight: the same place at any speed, and every decade decides alike.
 */
static void fourteen_decades_of_speed(void **state) {
  (void)state;
  for (int spins = 0; spins < 2; spins++) {
    skf_contact first[100];
    size_t hits = 0, count[100];
    for (int k = 0; k >= -7; k = k > 0 ? -k : 1 - k) {
      if (k > 7) break;
      double v = pow(10, k);
      skf_field *field;
      skf_world *w = cross(0, (skf_spin){{0, 0.6, 0.8}, {0.1, 0, 0}, spins * v}, &field);
      uint64_t seed = 17;
      for (int i = 0; i < 100; i++) {
        skf_flight *f = fly(w, stop, shot(&seed, v));
        skf_contact c = {0};
        size_t n = 0;
        state_at(f, 6 / v, &n, &c);
        if (k == 0) count[i] = n, first[i] = c, hits += n;
        assert_int_equal(n, count[i]);
        if (n) {
          check_row(w, &c, 0.1);
          check_close(c.t * v, first[i].t, 1e-13);
          check_scaled(v3_dist(c.position, first[i].position), 0, 1, 1e-13);
        }
        skf_flight_free(f);
      }
      drop_world(w, field);
    }
    assert_in_range(hits, 20, 80);
  }
}

/* A sphere of radius r whose centre runs about the z axis: c(t) = R (cos w t, sin w t, 0). */
static skf_world *runner(double R, double r, double rate, skf_field **field) {
  skf_element e = point_at(R, 0, 0, newton);
  return single(&e, 1, 1 / r, 0, (skf_spin){{0, 0, 1}, {0, 0, 0}, rate}, field);
}

static double gap(double R, double r, double rate, const skf_state *s, double t) {
  skf_vec3 p = v3_mad(s->position, t - s->t, s->velocity);
  return v3_dist(p, v3(R * cos(rate * t), R * sin(rate * t), 0)) - r;
}

/* Much slower and much faster than what comes along: it is met where the distance says, and never before. */
static void slow_and_fast_meet_the_spin(void **state) {
  (void)state;
  enum { PLACES = 20000 };
  size_t hits = 0;
  for (int k = -3; k <= 7; k++) {
    double v = pow(10, k);
    skf_field *field;
    skf_world *w = runner(1, 0.3, 1, &field);
    uint64_t seed = 23;
    for (int i = 0; i < 10; i++) {
      skf_state s = {0, v3_scale(2, rnd_unit(&seed)), {0, 0, 0}};
      s.velocity = v3_scale(v, v3_unit(v3_sub(rnd_vec(&seed, 1), s.position)));
      skf_flight *f = fly(w, stop, s);
      skf_contact c = {0};
      size_t n = 0;
      state_at(f, 4 / v, &n, &c);
      double end = n ? c.t : 4 / v;
      for (int j = 1; j < PLACES; j++) assert_true(gap(1, 0.3, 1, &s, end * j / PLACES) > -1e-12);
      if (n) check_row(w, &c, 1 / 0.3);
      if (n) check_scaled(gap(1, 0.3, 1, &s, c.t), 0, 1, 1e-15 * fmax(10, c.t)); /* the angle of the check is rounded */
      hits += n;
      skf_flight_free(f);
    }
    drop_world(w, field);
  }
  assert_in_range(hits, 20, 100);
}

/* Down along the axis of spin, past the sphere that comes by just then: nearest at t = 0, at a distance that is less or
   more than its radius by 1e-3 to 1e-11 of it. */
static void grazing_the_spin_is_decided(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7)
    for (int d = 3; d <= 11; d += 2)
      for (int side = -1; side <= 1; side += 2) {
        double L = pow(10, k), b = 0.3 * L * (1 + side * pow(10, -d));
        skf_field *field;
        skf_world *w = runner(L, 0.3 * L, 2, &field);
        skf_state s = {-1, {L + b, 0, L}, {0, 0, -L}};
        skf_flight *f = fly(w, stop, s);
        skf_contact c = {0};
        size_t n = 0;
        state_at(f, 1, &n, &c);
        assert_int_equal(n, side < 0);
        if (n) check_scaled(gap(L, 0.3 * L, 2, &s, c.t), 0, L, 1e-15);
        if (n) assert_true(c.t < 0);
        skf_flight_free(f);
        drop_world(w, field);
      }
}

/* Through gravity, a million turns later: the same outcome, time and place, to what times that large can tell. */
static void a_late_start_flips_nothing(void **state) {
  (void)state;
  skf_field *field;
  const double rate = 3, later = 1000000 * (TAU / rate);
  skf_world *w = cross(0.3, (skf_spin){{0, 0, 1}, {0.1, 0, 0}, rate}, &field);
  uint64_t seed = 29;
  size_t hits = 0;
  for (int i = 0; i < 100; i++) {
    skf_state s = shot(&seed, 1), z = s;
    z.t = later;
    skf_flight *f = fly(w, stop, s), *g = fly(w, stop, z);
    skf_contact c = {0}, d = {0};
    size_t n = 0, m = 0;
    state_at(f, 8, &n, &c), state_at(g, later + 8, &m, &d);
    assert_int_equal(n, m);
    if (n) check_row(w, &d, 0.1);
    if (n) check_scaled(d.t - later, c.t, 1, 1e-8);
    if (n) check_scaled(v3_dist(c.position, d.position), 0, 1, 1e-8);
    hits += n;
    skf_flight_free(f), skf_flight_free(g);
  }
  assert_in_range(hits, 20, 80);
  drop_world(w, field);
}

/* Entries on the way forth are exits on the way back: there are as many of each for those that end outside. */
static void reversed_time_flips_nothing(void **state) {
  (void)state;
  const double end = 8;
  size_t entries = 0, flights = 0;
  for (int spins = 0; spins < 2; spins++) {
    const double rate = 1.7 * spins;
    skf_field *field, *back_field;
    skf_world *w = cross(0.3, (skf_spin){{0, 0.6, 0.8}, {0.1, 0, 0}, rate}, &field);
    skf_world *back = cross(0.3, (skf_spin){{0, 0.6, 0.8}, {0.1, 0, 0}, -rate}, &back_field); /* t becomes -t */
    uint64_t seed = 31;
    for (int i = 0; i < 60; i++) {
      skf_state s = shot(&seed, 1), z;
      skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_PASS}, s);
      size_t n = 0, m = 0;
      z = state_at(f, end, &n, NULL);
      skf_flight_free(f);
      if (skf_world_level(w, 0, end, z.position) > 0) continue;
      z.t = -end, z.velocity = v3_scale(-1, z.velocity);
      skf_flight *g = fly(back, (skf_flight_options){.contact = SKF_CONTACT_PASS}, z);
      z = state_at(g, 0, &m, NULL);
      assert_int_equal(n, m);
      check_scaled(v3_dist(z.position, s.position), 0, 1, 1e-9);
      entries += n, flights++;
      skf_flight_free(g);
    }
    drop_world(w, field), drop_world(back, back_field);
  }
  assert_true(entries >= 30 && flights >= 100);
}

/* Dropped onto ground that turns, with losses and friction: it comes to rest on the ground, and turns with it. */
static void rest_rides_along(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), T = sqrt(L * L * L), rate = 0.3 / T;
    skf_element e = point_at(0, 0, 0, newton);
    skf_field *field;
    skf_world *w = single(&e, 1, 1 / L, 1, (skf_spin){{0, 0, 1}, {0, 0, 0}, rate}, &field);
    const skf_flight_options o = {.contact = SKF_CONTACT_BOUNCE, .restitution = 0.4, .friction = 0.8};
    skf_flight *f = fly(w, o, (skf_state){0, {1.3 * L, 0, 0}, {0, 0, 0}});
    skf_contact c = {0};
    size_t n = 0;
    state_at(f, 40 * T, &n, &c);
    assert_int_equal(c.outcome, SKF_OUTCOME_REST);
    assert_in_range(n, 5, 40);
    skf_vec3 ground = skf_world_surface_velocity(w, 0, c.position);
    check_scaled(v3_dist(c.after, ground), 0, L / T, 1e-15);
    skf_state s = state_at(f, c.t + SKF_PI / (2 * rate), NULL, NULL); /* a quarter turn later */
    check_scaled(s.position.x, -c.position.y, L, 1e-13);
    check_scaled(s.position.y, c.position.x, L, 1e-13);
    check_scaled(skf_world_level(w, 0, s.t, s.position), 0, 1 / L, 1e-13);
    skf_flight_free(f);
    drop_world(w, field);
  }
}

/* Three bodies of different kernels, two of which spin; every kind of contact: each row of the log is in order, and no
   place of the path lies inside what it may not enter. */
static void every_row_of_the_log(void **state) {
  (void)state;
  skf_element ring = ring_of(1, newton, 1),
              bar = segment_of(v3(-1, 0, 1), v3(1, 0, 1), (skf_kernel){SKF_GAUSSIAN, 3}, 1);
  skf_element blobs[2] = {point_at(0, 0, -1, (skf_kernel){SKF_METABALL, 1}),
                          segment_of(v3(0, -1, -1), v3(0, 1, -1), (skf_kernel){SKF_SOFT_OBJECT, 0.8}, 1)};
  skf_field *f[3] = {field_of(&ring, 1), field_of(&bar, 1), field_of(blobs, 2)};
  const double iso[3] = {8, 0.3, 0.5};
  skf_world *w = world_of((skf_attractor[]){{f[0], iso[0], 0.1, {{0, 1, 1}, {0, 0, 0}, 1.3}},
                                            {f[1], iso[1], 0.1, {{0, 0, 1}, {0.2, 0, 0}, -2}},
                                            {f[2], iso[2], 0.1, still}},
                          3);
  size_t rows[3] = {0, 0, 0};
  for (int mode = SKF_CONTACT_STOP; mode < SKF_CONTACT_COUNT; mode++) {
    uint64_t seed = 37;
    const skf_flight_options o = {.contact = (skf_contact_mode)mode, .restitution = 0.8, .friction = 0.1};
    for (int i = 0; i < 40; i++) {
      skf_flight *flight = fly(w, o, shot(&seed, 1));
      double from, to = 0;
      while (to < 8) {
        skf_contact c;
        skf_state s;
        bool touched;
        assert_int_equal(skf_flight_step(flight, &c, &touched), SKF_OK);
        skf_flight_span(flight, &from, &to);
        if (touched) check_row(w, &c, iso[c.body]), rows[c.body]++;
        for (int j = 1; j < 20 && mode != SKF_CONTACT_PASS && to < INFINITY; j++) {
          assert_int_equal(skf_flight_at(flight, from + (to - from) * j / 20, &s), SKF_OK);
          for (size_t b = 0; b < 3; b++) assert_true(skf_world_level(w, b, s.t, s.position) < 1e-12 * iso[b]);
        }
      }
      skf_flight_free(flight);
    }
  }
  for (int b = 0; b < 3; b++) assert_true(rows[b] >= 20);
  skf_world_free(w);
  for (int b = 0; b < 3; b++) skf_field_free(f[b]);
}

/* Those that miss come as close at any scale, whatever the contact does to others. */
static void misses_know_their_distance(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), T = sqrt(L * L * L);
    skf_element e = point_at(0, 0, 0, newton);
    skf_field *field;
    skf_world *w = single(&e, 1, 10 / L, 1, still, &field);
    const skf_flight_options o = {.contact = SKF_CONTACT_STOP, .approach = true};
    skf_state apoapsis = {0, {-1.5 * L, 0, 0}, {0, -sqrt(1 / 3.0) * L / T, 0}}; /* a = 1, e = 0.5 */
    skf_flight *f = fly(w, o, apoapsis);
    size_t n = 0;
    state_at(f, 6 * T, &n, NULL);
    skf_approach a;
    assert_int_equal(n, 0);
    assert_int_equal(skf_flight_approach(f, 0, &a), SKF_OK);
    check_close(a.t, SKF_PI * T, 1e-7); /* the distance is that flat there */
    check_close(v3_norm(a.position), 0.5 * L, 1e-12);
    check_close(a.level, (2 - 10) / L, 1e-12);
    skf_flight_free(f);
    drop_world(w, field);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(fourteen_decades_of_speed),   cmocka_unit_test(slow_and_fast_meet_the_spin),
      cmocka_unit_test(grazing_the_spin_is_decided), cmocka_unit_test(a_late_start_flips_nothing),
      cmocka_unit_test(reversed_time_flips_nothing), cmocka_unit_test(rest_rides_along),
      cmocka_unit_test(every_row_of_the_log),        cmocka_unit_test(misses_know_their_distance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
