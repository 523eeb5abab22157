/* SPDX-License-Identifier: MIT */
/* Contacts on curved paths: when, where, and what follows. */
#include "motion/worlds.h"
#include "random.h"
#include <string.h>

/* A sphere of radius R: the surface of a point mass 1 (G M = gain). */
static skf_world *sphere(double R, double gain, skf_spin spin, skf_field **field) {
  skf_element e = point_at(0, 0, 0, newton);
  return single(&e, 1, 1 / R, gain, spin, field);
}

/* From rest at r0 to R: t = sqrt(r0^3 / 2) (acos sqrt x + sqrt(x (1 - x))), x = R / r0, at any scale. */
static void free_fall_takes_its_time(void **state) {
  (void)state;
  for (size_t i = 0; i < adaptive_count(); i++)
    for (int k = -7; k <= 7; k += 7) {
      double L = pow(10, k), T = sqrt(L * L * L), x = 0.3;
      skf_field *field;
      skf_world *w = sphere(0.3 * L, 1, still, &field);
      skf_flight *f =
          fly(w, (skf_flight_options){.integrator = skf_integrator_get(i)->name, .contact = SKF_CONTACT_STOP},
              (skf_state){0, {0, L, 0}, {0, 0, 0}});
      skf_contact c = {0};
      size_t n = 0;
      skf_state end = state_at(f, 2 * T, &n, &c);
      assert_int_equal(n, 1);
      check_close(c.t, T * sqrt(0.5) * (acos(sqrt(x)) + sqrt(x * (1 - x))), 1e-13);
      check_close(c.position.y, 0.3 * L, 1e-15);
      check_close(c.before.y, -sqrt(2 * (1 / 0.3 - 1)) * L / T, 1e-12);
      check_close(c.normal.y, 1.0, 1e-15);
      assert_int_equal(c.outcome, SKF_OUTCOME_STOP);
      check_scaled(v3_dist(end.position, c.position), 0, L, 0);
      check_scaled(v3_norm(end.velocity), 0, L / T, 0);
      skf_flight_free(f);
      drop_world(w, field);
    }
}

/* Without gravity, past a sphere: closer than its radius hits, farther misses, down to a few units of rounding. */
static void grazing_is_decided(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7)
    for (int d = 3; d <= 13; d++)
      for (int side = -1; side <= 1; side += 2) {
        double L = pow(10, k), b = 1 + side * pow(10, -d), want = 3 - sqrt(fmax(0, (1 - b) * (1 + b)));
        skf_field *field;
        skf_world *w = sphere(L, 0, still, &field);
        skf_flight *f =
            fly(w, (skf_flight_options){.contact = SKF_CONTACT_STOP}, (skf_state){0, {-3 * L, b * L, 0}, {L, 0, 0}});
        skf_contact c = {0};
        size_t n = 0;
        state_at(f, 6, &n, &c);
        assert_int_equal(n, side < 0);
        if (n) check_close(c.t, want, 1e-15 * pow(10, d / 2.0 + 0.5)); /* the crossing is that flat */
        skf_flight_free(f);
        drop_world(w, field);
      }
}

/* A body that spins about an axis of its own symmetry is, to what flies, one that does not: the same bits. One that
   spins about another axis is not. */
static void round_bodies_turn_for_nothing(void **state) {
  (void)state;
  const skf_element arc = ring_of(1, newton, 1), rod = segment_of(v3(0, 0, -1), v3(0, 0, 2), newton, 1);
  const skf_element *const bodies[] = {&arc, &rod};
  const skf_spin spins[] = {{{0, 0, 1}, {0, 0, 3}, 2.5}, {{0, 0, -2}, {0, 0, 0}, 7}, {{1, 0, 0}, {0, 0, 0}, 2.5}};
  for (size_t b = 0; b < 2; b++)
    for (size_t k = 0; k < 3; k++) {
      skf_field *fields[2];
      skf_world *worlds[2] = {single(bodies[b], 1, 8, 0.2, still, fields),
                              single(bodies[b], 1, 8, 0.2, spins[k], fields + 1)};
      uint64_t seed = 9;
      size_t hits = 0, same = 0;
      for (int i = 0; i < 40; i++) {
        skf_state start = {0, v3_scale(2.5, rnd_unit(&seed)), rnd_vec(&seed, 0.2)}, end[2];
        skf_contact c[2] = {{0}, {0}};
        size_t n[2] = {0, 0};
        for (int w = 0; w < 2; w++) {
          skf_flight *f = fly(worlds[w], (skf_flight_options){.contact = SKF_CONTACT_STOP}, start);
          end[w] = state_at(f, 8, n + w, c + w);
          skf_flight_free(f);
          if (n[w]) check_scaled(skf_world_level(worlds[w], 0, c[w].t, c[w].position), 0, 8, 1e-14);
        }
        hits += n[0];
        same += n[0] == n[1] && memcmp(end, end + 1, sizeof *end) == 0 && c[0].t == c[1].t &&
                v3_dist(c[0].normal, c[1].normal) == 0;
      }
      assert_true(hits > 5);
      assert_int_equal(same == 40, k < 2);
      for (int w = 0; w < 2; w++) drop_world(worlds[w], fields[w]);
    }
}

/* Thin spikes in all directions, crossed by straight flights in one long step each: as the ray solver says. */
static void spikes_are_not_missed(void **state) {
  (void)state;
  enum { SPIKES = 40, SHOTS = 400 };
  skf_element e[SPIKES];
  uint64_t seed = 7;
  for (int i = 0; i < SPIKES; i++) {
    double z = -1 + (i + 0.5) * 2.0 / SPIKES, phi = 2.399963 * i, r = sqrt(1 - z * z);
    e[i] = segment_of(v3(0, 0, 0), v3(r * cos(phi), r * sin(phi), z), (skf_kernel){SKF_CAUCHY, 100}, 1);
  }
  skf_field *field = field_of(e, SPIKES);
  double iso = 0.01; /* of a single spike: about 0.007 thick */
  skf_world *w = world_of(&(skf_attractor){field, iso, 0, still}, 1);
  skf_tracer *tracer;
  assert_int_equal(skf_tracer_new(field, iso, &tracer), SKF_OK);
  int hits = 0;
  for (int i = 0; i < SHOTS; i++) {
    skf_vec3 from = v3(rnd(&seed, -2, 2), rnd(&seed, -2, 2), 3),
             to = v3(rnd(&seed, -0.6, 0.6), rnd(&seed, -0.6, 0.6), 0), d = v3_sub(to, from);
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_STOP}, (skf_state){0, from, v3_scale(100, d)});
    skf_contact c = {0};
    size_t n = 0;
    state_at(f, 0.02, &n, &c);
    skf_hit hit;
    bool found;
    skf_ray ray = {from, d, 0, 2 * v3_norm(d)};
    assert_int_equal(skf_tracer_first(tracer, &ray, &hit, &found, NULL), SKF_OK);
    assert_int_equal(n, found);
    if (n) check_scaled(v3_dist(c.position, hit.at), 0, 1, 1e-9);
    if (n) check_scaled(skf_world_level(w, 0, c.t, c.position), 0, iso, 1e-9);
    hits += (int)n;
    skf_flight_free(f);
  }
  assert_in_range(hits, SHOTS / 10, SHOTS);
  skf_tracer_free(tracer);
  drop_world(w, field);
}

/* Born on the surface: outwards is no contact, inwards and at rest one at once; born inside: none until it is back. */
static void births_on_and_in_the_surface(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = sphere(1, 1, still, &field);
  skf_flight_options stop = {.contact = SKF_CONTACT_STOP};
  skf_contact c = {0};
  size_t n = 0;
  double v = sqrt(2 * (1 - 1 / 1.5)); /* rises to 1.5 */
  double back = 2 * sqrt(1.5 * 1.5 * 1.5 / 2) * (acos(sqrt(1 / 1.5)) + sqrt(1 / 1.5 * (1 - 1 / 1.5)));
  skf_flight *f = fly(w, stop, (skf_state){0, {1, 0, 0}, {v, 0, 0}});
  state_at(f, 9, &n, &c);
  assert_int_equal(n, 1);
  check_close(c.t, back, 1e-12);
  skf_flight_free(f);
  const double speed[] = {-1, 0};
  for (int k = 0; k < 2; k++) {
    f = fly(w, stop, (skf_state){5, {1, 0, 0}, {speed[k], 0, 0}});
    n = 0, state_at(f, 9, &n, &c);
    assert_int_equal(n, 1);
    check_close(c.t, 5, 0);
    check_scaled(skf_world_level(w, 0, c.t, c.position), 0, 1, 1e-15);
    skf_flight_free(f);
  }
  /* From the inside at 0.9 up to 1.5: contact on the way down only. */
  v = sqrt(2 * (1 / 0.9 - 1 / 1.5));
  f = fly(w, stop, (skf_state){0, {0.9, 0, 0}, {v, 0, 0}});
  n = 0, state_at(f, 9, &n, &c);
  assert_int_equal(n, 1);
  assert_true(c.before.x < 0);
  check_close(c.position.x, 1.0, 1e-14);
  skf_flight_free(f);
  drop_world(w, field);
}

/* Along the surface, closer than rounding: no contact, and no endless search. Too fast for it by 1e-8: it leaves. A
   start where the field is infinite is inside. */
static void flights_along_the_surface(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7)
    for (int faster = 0; faster < 2; faster++) {
      double L = pow(10, k), T = sqrt(L * L * L), v = (1 + faster * 1e-8) * L / T;
      skf_field *field;
      skf_world *w = sphere(L, 1, still, &field);
      skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_STOP}, (skf_state){0, {L, 0, 0}, {0, v, 0}});
      size_t n = 0;
      skf_state s = state_at(f, 6 * T, &n, NULL);
      assert_int_equal(n, 0);
      check_close(v3_norm(s.position), L, 1e-7);
      assert_in_range(skf_flight_get_report(f).bounds, 100, 1000000);
      skf_flight_free(f);
      drop_world(w, field);
    }
  skf_field *field;
  skf_world *w = sphere(1, 0, still, &field);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_STOP}, (skf_state){0, {0, 0, 0}, {0, 1, 0}});
  size_t n = 0;
  check_close(state_at(f, 4, &n, NULL).position.y, 4, 1e-15);
  assert_int_equal(n, 0);
  skf_flight_free(f);
  drop_world(w, field);
}

/* Restitution 1: many bounces, the same height and energy each time. */
static void elastic_bounces_keep_energy(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = sphere(1, 1, still, &field);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 1},
                      (skf_state){0, {1.5, 0, 0}, {0, 0.1, 0}});
  size_t n = 0;
  skf_contact c = {0};
  skf_state s = state_at(f, 100, &n, &c);
  skf_invariants a = skf_world_invariants(w, &(skf_state){0, {1.5, 0, 0}, {0, 0.1, 0}}),
                 b = skf_world_invariants(w, &s);
  assert_true(n > 20);
  check_scaled(b.energy, a.energy, a.scale, 1e-12);
  check_close(v3_norm(c.after), v3_norm(c.before), 1e-14);
  skf_flight_free(f);
  drop_world(w, field);
}

/* Restitution 0.5 and friction: comes to rest after a finite number of bounces; the log tells it and stays short. */
static void lossy_bounces_come_to_rest(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), T = sqrt(L * L * L);
    skf_field *field;
    skf_world *w = sphere(L, 1, still, &field);
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 0.5, .friction = 0.3},
                        (skf_state){0, {1.5 * L, 0, 0}, {0, 0.2 * L / T, 0}});
    size_t n = 0;
    skf_contact c = {0};
    skf_state s = state_at(f, 30 * T, &n, &c);
    assert_int_equal(c.outcome, SKF_OUTCOME_REST);
    assert_in_range(n, 5, 30);
    check_close(v3_norm(s.position), L, 1e-12);
    check_scaled(v3_norm(s.velocity), 0, L / T, 0);
    skf_flight_free(f);
    drop_world(w, field);
  }
}

/* Without friction it slides on around the body with the speed that it had along the ground; friction mu stops it after
   v / (mu g) on a plane. */
static void sliding_goes_on_and_friction_stops_it(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = sphere(1, 1, still, &field);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 0},
                      (skf_state){0, {1.0001, 0, 0}, {0, 0.3, 0}});
  size_t n = 0;
  skf_contact c = {0};
  skf_state s = state_at(f, 10, &n, &c);
  assert_int_equal(c.outcome, SKF_OUTCOME_SLIDE);
  assert_in_range(n, 1, 3);
  check_close(v3_norm(s.velocity), 0.3, 0.01);
  check_close(v3_norm(s.position), 1.0, 1e-5);
  skf_flight_free(f);
  drop_world(w, field);
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, {SKF_CAUCHY, 1}, 1};
  w = single(&plane, 1, SKF_PI / 4, 1, still, &field); /* F = pi / (1 + z^2): z = sqrt 3 */
  f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 0, .friction = 0.2},
          (skf_state){0, {0, 0, 3}, {0.5, 0, 0}});
  n = 0, s = state_at(f, 100, &n, &c);
  assert_int_equal(c.outcome, SKF_OUTCOME_REST);
  check_scaled(v3_norm(s.velocity), 0, 1, 0);
  assert_true(s.position.x > 0.5);
  skf_flight_free(f);
  drop_world(w, field);
}

/* Dropped from height 1 right above the origin of a floor that does not pull: all bounces take sqrt(2 / g) (1 + e) / (1
   - e), less those too low to tell. */
static void bounces_above_the_origin_end(void **state) {
  (void)state;
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, -1}, {0, 0, 1}}}, {SKF_CAUCHY, 1}, 1};
  skf_force weight = {.type = SKF_FORCE_PUSH, .push = {0, 0, -2}};
  skf_field *field;
  skf_world *w;
  assert_int_equal(skf_field_new(&plane, 1, &field), SKF_OK);
  skf_attractor floor = {field, skf_field_at(field, v3(0, 0, 0), NULL), 0, still};
  assert_int_equal(skf_world_new_with(&floor, 1, &weight, 1, &w), SKF_OK);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 0.5},
                      (skf_state){0, {0, 0, 1}, {0, 0, 0}});
  size_t n = 0;
  skf_contact c = {0};
  skf_state s = state_at(f, 4, &n, &c);
  assert_int_equal(c.outcome, SKF_OUTCOME_REST);
  check_close(c.t, 3, 2e-3);
  check_scaled(s.position.z, 0, 1, 1e-15);
  skf_flight_free(f);
  drop_world(w, field);
}

/* A sphere that spins: friction drags the particle along; a particle that sticks rides with the ground. */
static void spinning_ground_counts(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = sphere(1, 1e-3, (skf_spin){{0, 0, 1}, {0, 0, 0}, 2}, &field);
  skf_flight_options o = {.contact = SKF_CONTACT_BOUNCE, .restitution = 1, .friction = 0.1};
  skf_flight *f = fly(w, o, (skf_state){0, {3, 0, 0}, {-1, 0, 0}});
  size_t n = 0;
  skf_contact c = {0};
  state_at(f, 3, &n, &c);
  assert_int_equal(n, 1);
  check_close(c.after.x, -c.before.x, 1e-14);
  check_close(c.after.y, 0.1 * 2 * -c.before.x, 1e-13); /* mu (1 + e) v_n, towards the ground's velocity */
  skf_flight_free(f);
  o.contact = SKF_CONTACT_STICK;
  f = fly(w, o, (skf_state){0, {3, 0, 0.5}, {-1, 0, 0}});
  n = 0;
  state_at(f, 3, &n, &c);
  skf_state s = state_at(f, c.t + SKF_PI / 4, NULL, NULL); /* a quarter turn later */
  check_scaled(s.position.x, -c.position.y, 1, 1e-14);
  check_scaled(s.position.y, c.position.x, 1, 1e-14);
  check_scaled(s.position.z, c.position.z, 1, 0);
  check_scaled(s.velocity.x, -2 * s.position.y, 1, 1e-15);
  check_scaled(s.velocity.y, 2 * s.position.x, 1, 1e-15);
  assert_int_equal(c.outcome, SKF_OUTCOME_STICK);
  skf_flight_free(f);
  drop_world(w, field);
}

/* Shots at a spinning cross: F = iso and inwards at each contact; starting later in a world that lies the same way
   changes no outcome. */
static void moving_bodies_are_met(void **state) {
  (void)state;
  skf_element e[2] = {segment_of(v3(-2, 0, 0), v3(2, 0, 0), (skf_kernel){SKF_CAUCHY, 6}, 1),
                      segment_of(v3(0, -1.5, 0), v3(0, 1.5, 0), (skf_kernel){SKF_CAUCHY, 6}, 1)};
  const skf_spin spin = {{0, 0, 1}, {0.1, 0, 0}, 3};
  skf_field *field;
  double iso = 0.1;
  skf_world *w = single(e, 2, iso, 1, spin, &field);
  uint64_t seed = 3;
  int hits = 0;
  for (int i = 0; i < 200; i++) {
    skf_vec3 from = v3(rnd(&seed, -2, 2), rnd(&seed, -2, 2), 4),
             v = v3(rnd(&seed, -0.3, 0.3), rnd(&seed, -0.3, 0.3), -2);
    size_t n = 0, m = 0;
    skf_contact c = {0}, d = {0};
    double later = TAU / 3 * 5;
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_STOP}, (skf_state){0, from, v});
    skf_flight *g = fly(w, (skf_flight_options){.contact = SKF_CONTACT_STOP}, (skf_state){later, from, v});
    state_at(f, 6, &n, &c);
    state_at(g, 6 + later, &m, &d);
    assert_int_equal(n, m);
    hits += (int)n;
    if (n) {
      skf_vec3 slip = v3_sub(c.before, skf_world_surface_velocity(w, 0, c.position));
      check_scaled(skf_world_level(w, 0, c.t, c.position), 0, iso, 1e-12);
      assert_true(v3_dot(slip, c.normal) < 0);
      check_close(d.t - later, c.t, 1e-10);
      check_scaled(v3_dist(c.position, d.position), 0, 1, 1e-9);
    }
    skf_flight_free(f);
    skf_flight_free(g);
  }
  assert_in_range(hits, 20, 180);
  drop_world(w, field);
}

/* Through two spheres that overlap, at any scale: an entry into each, told in order, on a path that they do not
 * disturb. */
static void passing_tells_every_entry(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), T = sqrt(L * L * L);
    skf_element near = point_at(0, 0, 0, newton), far = point_at(0.8 * L, 0, 0, newton);
    skf_field *fields[2] = {field_of(&near, 1), field_of(&far, 1)};
    skf_world *w = world_of((skf_attractor[]){{fields[0], 2 / L, 1e-3, still}, {fields[1], 2 / L, 1e-3, still}}, 2);
    skf_state start = {0, {2 * L, 0.2 * L, 0}, {-L / T, 0.1 * L / T, 0.1 * L / T}};
    skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_PASS}, start);
    skf_flight *free = fly(w, (skf_flight_options){.contact = SKF_CONTACT_NONE}, start);
    size_t n = 0;
    skf_contact c = {0};
    skf_state here = state_at(f, 1.8 * T, &n, &c), there = state_at(free, 1.8 * T, NULL, NULL);
    assert_true(skf_world_level(w, 1, 0, there.position) < 0);
    assert_int_equal(n, 2);
    assert_int_equal(c.outcome, SKF_OUTCOME_PASS);
    assert_int_equal(c.body, 0);
    check_scaled(v3_dist(c.position, v3(0, 0, 0)), 0.5 * L, L, 1e-14);
    assert_true(v3_dot(c.normal, c.before) < 0 && v3_dist(c.before, c.after) == 0);
    check_scaled(v3_dist(here.position, there.position), 0, L, 1e-11);
    skf_flight_free(f), skf_flight_free(free);
    skf_world_free(w);
    skf_field_free(fields[0]), skf_field_free(fields[1]);
  }
}

/* Through surfaces that coincide: an entry into each, at the same place, and no other. */
static void passing_coincident_surfaces_ends(void **state) {
  (void)state;
  enum { N = 3 };
  for (int turns = 0; turns < 2; turns++) {
    skf_element e = point_at(0, 0, 0, newton);
    skf_field *fields[N];
    skf_attractor bodies[N];
    const skf_spin spin = {{0, 0, 1}, {0, 0, 0}, 0.3 * turns};
    for (int i = 0; i < N; i++) bodies[i] = (skf_attractor){fields[i] = field_of(&e, 1), 1, 0, i == 1 ? spin : still};
    skf_world *w = world_of(bodies, N);
    for (int k = 0; k < 40; k++) { /* ever closer to grazing */
      double b = 0.1 + 0.0224 * k;
      for (int search = SKF_SEARCH_CERTIFIED; search <= SKF_SEARCH_FAST; search++) {
        skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_PASS, .search = (skf_search)search},
                            (skf_state){0, {-3, b, 0}, {1, 0, 0}});
        size_t n = 0;
        skf_contact c = {0};
        check_close(state_at(f, 6, &n, &c).position.x, 3, 1e-15);
        assert_int_equal(n, N);
        check_close(c.t, 3 - sqrt(1 - b * b), 1e-14);
        skf_flight_free(f);
      }
    }
    skf_world_free(w);
    for (int i = 0; i < N; i++) skf_field_free(fields[i]);
  }
}

/* A wide orbit that dips into a body again and again enters it once a revolution. */
static void passing_comes_back(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = sphere(0.7, 1, still, &field);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_PASS}, kepler(0.5));
  size_t n = 0;
  skf_state s = state_at(f, 10 * TAU, &n, NULL); /* it begins within */
  assert_int_equal(n, 10);
  check_scaled(v3_dist(s.position, v3(0.5, 0, 0)), 0, 1, 1e-9);
  skf_flight_free(f);
  drop_world(w, field);
}

static void the_absorbed_are_gone(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = sphere(0.3, 1, still, &field);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_ABSORB}, (skf_state){0, {0, 1, 0}, {0, 0, 0}});
  size_t n = 0;
  skf_contact c = {0};
  skf_state s = state_at(f, 0.5, &n, &c);
  assert_true(n == 0 && isfinite(s.position.y));
  s = state_at(f, 1e300, &n, &c);
  assert_int_equal(n, 1);
  assert_int_equal(c.outcome, SKF_OUTCOME_ABSORB);
  check_close(c.position.y, 0.3, 1e-15);
  assert_true(isnan(s.position.y) && isnan(s.velocity.x) && s.t == 1e300);
  assert_int_equal(skf_flight_at(f, c.t, &s), SKF_OK);
  assert_true(isnan(s.position.y));
  skf_flight_free(f);
  drop_world(w, field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_fall_takes_its_time),
      cmocka_unit_test(grazing_is_decided),
      cmocka_unit_test(round_bodies_turn_for_nothing),
      cmocka_unit_test(spikes_are_not_missed),
      cmocka_unit_test(births_on_and_in_the_surface),
      cmocka_unit_test(flights_along_the_surface),
      cmocka_unit_test(elastic_bounces_keep_energy),
      cmocka_unit_test(lossy_bounces_come_to_rest),
      cmocka_unit_test(sliding_goes_on_and_friction_stops_it),
      cmocka_unit_test(spinning_ground_counts),
      cmocka_unit_test(moving_bodies_are_met),
      cmocka_unit_test(passing_tells_every_entry),
      cmocka_unit_test(passing_coincident_surfaces_ends),
      cmocka_unit_test(passing_comes_back),
      cmocka_unit_test(the_absorbed_are_gone),
      cmocka_unit_test(bounces_above_the_origin_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
