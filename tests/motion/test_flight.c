/* SPDX-License-Identifier: MIT */
/* Flights around extended, spinning and compact bodies: invariants, returns, equilibria, frames. */
#include "motion/flight.h"
#include "motion/worlds.h"
#include <string.h>

/* A ring of mass 1 and radius 1: an inclined orbit around it. */
static void donut_keeps_its_invariants(void **state) {
  (void)state;
  skf_element e = ring_of(1, newton, 1);
  skf_field *field;
  skf_world *w = single(&e, 1, 1e3, 1 / TAU, still, &field);
  for (size_t i = 0; i < adaptive_count(); i++) {
    skf_flight *f = fly(w, (skf_flight_options){.integrator = skf_integrator_get(i)->name},
                        (skf_state){0, {2.5, 0, 0.2}, {0, 0.6, 0.3}});
    state_at(f, 2800, NULL, NULL); /* 100 revolutions and more */
    skf_flight_report r = skf_flight_get_report(f);
    check_scaled(r.energy_drift, 0, 1, 1e-12); /* measured: 0 and 2e-14 */
    check_scaled(r.momentum_drift, 0, 1, 1e-12);
    if (skf_integrator_get(i)->order > 8) assert_true(r.energy_drift < 1e-14 * sqrt((double)r.steps));
    assert_true(isnan(r.jacobi_drift));
    skf_flight_free(f);
  }
  skf_world_free(w);
  skf_field_free(field);
}

/* Along the axis of the ring, z'' = -z / (1 + z^2)^(3/2): from rest at z = 1 through the hole, and back. Its period is
   4 times the integral of dz / v from 0 to 1, with v^2 = 2 (1 / sqrt(1 + z^2) - 1 / sqrt 2), by z = sin u. */
static void fall_through_the_hole_returns(void **state) {
  (void)state;
  double quarter = 0;
  int n = 200; /* the integrand is smooth and even about both ends: the midpoint rule converges like a power */
  for (int k = 0; k < n; k++) {
    double u = (k + 0.5) * SKF_PI / 2 / n, z = sin(u), s = sqrt(1 + z * z);
    /* 1/s - 1/sqrt2 = (1 - z^2) / (s sqrt2 (s + sqrt2)) */
    quarter += sqrt(s * sqrt(2) * (s + sqrt(2)) / 2) * SKF_PI / 2 / n;
  }
  skf_element e = ring_of(1, newton, 1);
  skf_field *field;
  skf_world *w = single(&e, 1, 1e3, 1 / TAU, still, &field);
  for (size_t i = 0; i < adaptive_count(); i++) {
    skf_flight *f =
        fly(w, (skf_flight_options){.integrator = skf_integrator_get(i)->name}, (skf_state){0, {0, 0, 1}, {0, 0, 0}});
    skf_state half = state_at(f, 2 * quarter, NULL, NULL);
    skf_state end = state_at(f, 4 * quarter, NULL, NULL); /* sideways the axis is unstable: no more turns */
    check_scaled(half.position.z, -1, 1, 1e-11);
    check_scaled(end.position.z, 1, 1, 1e-11);
    check_scaled(end.velocity.z, 0, 1, 1e-9);
    check_scaled(hypot(end.position.x, end.position.y), 0, 1, 1e-13);
    skf_flight_free(f);
  }
  skf_world_free(w);
  skf_field_free(field);
}

/* A massive segment that turns with omega = 1: x^3 - x = 1, y^2 sqrt(y^2 + 1) = 1 [design/peers.md, exact equations].
   A particle put there turns with it, for as long as the instability lets it. */
static void equilibria_of_a_turning_segment(void **state) {
  (void)state;
  skf_element e = segment_of(v3(-1, 0, 0), v3(1, 0, 0), newton, 1);
  skf_spin spin = {{0, 0, 2}, {0, 0, 0}, 1};
  skf_field *field;
  skf_world *w = single(&e, 1, 1e3, 0.5, spin, &field); /* G rho = mass / length */
  const double x = 1.324717957244746026, y = 0.868836961832709302;
  const skf_state start[] = {{0, {x, 0, 0}, {0, x, 0}}, {0, {0, y, 0}, {-y, 0, 0}}};
  for (int k = 0; k < 2; k++) {
    skf_flight *f = fly(w, (skf_flight_options){0}, start[k]);
    skf_state s = state_at(f, TAU, NULL, NULL);
    skf_vec3 q = skf_world_to_body(w, 0, TAU, s.position);
    check_scaled(v3_dist(q, start[k].position), 0, 1, 1e-10); /* grows by e^(2 pi lambda) from rounding */
    skf_flight_free(f);
  }
  skf_world_free(w);
  skf_field_free(field);
}

static size_t cross(skf_element e[2]) {
  e[0] = segment_of(v3(-2, 0, 0), v3(2, 0, 0), newton, 1);
  e[1] = segment_of(v3(0, -1, 0), v3(0, 1, 0), newton, 1);
  return 2;
}

/* The Jacobi constant around a spinning cross; energy is not kept there. */
static void jacobi_constant_holds(void **state) {
  (void)state;
  skf_element e[2];
  skf_field *field;
  skf_world *w = single(e, cross(e), 1e3, 1.0 / 6, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0.6}, &field);
  for (size_t i = 0; i < adaptive_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    if (info->order <= 8) continue;
    skf_flight *f = fly(w, (skf_flight_options){.integrator = info->name, .tolerance = 1e-13},
                        (skf_state){0, {6, 0, 0.5}, {0, 0.4, 0.05}});
    state_at(f, 90000, NULL, NULL); /* 1,000 revolutions of the particle, 8,600 of the cross */
    skf_flight_report r = skf_flight_get_report(f);
    print_message("%s, %zu steps: %g\n", info->name, r.steps, r.jacobi_drift);
    check_scaled(r.jacobi_drift, 0, 1, 1e-13);
    assert_true(isnan(r.energy_drift) && isnan(r.momentum_drift));
    skf_flight_free(f);
  }
  skf_world_free(w);
  skf_field_free(field);
}

/* A ring that turns about its own axis is a ring that does not turn; and a world seen from a frame that was turned at
   the start is the same world. */
static void frames_agree(void **state) {
  (void)state;
  skf_element ring = ring_of(1, newton, 1), e[2], turned[2];
  skf_field *fields[2];
  const skf_spin about_z = {{0, 0, 1}, {0, 0, 0}, 0.7};
  const skf_state start = {0, {2.5, 0, 0.2}, {0, 0.6, 0.3}};
  skf_world *a = single(&ring, 1, 1e3, 1 / TAU, still, fields),
            *b = single(&ring, 1, 1e3, 1 / TAU, about_z, fields + 1);
  skf_flight *fa = fly(a, (skf_flight_options){0}, start), *fb = fly(b, (skf_flight_options){0}, start);
  skf_state sa = state_at(fa, 100, NULL, NULL), sb = state_at(fb, 100, NULL, NULL);
  check_scaled(v3_dist(sa.position, sb.position), 0, 1, 1e-11);
  check_scaled(skf_flight_get_report(fb).energy_drift, 0, 1, 1e-13);
  skf_flight_free(fa), skf_flight_free(fb);
  skf_world_free(a), skf_world_free(b);
  skf_field_free(fields[0]), skf_field_free(fields[1]);

  /* The spinning cross from t = 3 on, and the same cross drawn as it lies at t = 3 from t = 0 on. */
  size_t n = cross(e);
  skf_spin spin = {{0, 0, 1}, {0.5, 0, 0}, 0.6};
  a = single(e, n, 1e3, 1.0 / 6, spin, fields);
  for (size_t i = 0; i < n; i++) {
    turned[i] = e[i];
    turned[i].primitive.segment.from = skf_world_from_body(a, 0, 3, e[i].primitive.segment.from);
    turned[i].primitive.segment.to = skf_world_from_body(a, 0, 3, e[i].primitive.segment.to);
  }
  b = single(turned, n, 1e3, 1.0 / 6, spin, fields + 1);
  skf_state later = {3, {6, 0, 0.5}, {0, 0.4, 0.05}}, now = later;
  now.t = 0;
  fa = fly(a, (skf_flight_options){0}, later), fb = fly(b, (skf_flight_options){0}, now);
  sa = state_at(fa, 103, NULL, NULL), sb = state_at(fb, 100, NULL, NULL);
  check_scaled(v3_dist(sa.position, sb.position), 0, 6, 1e-12);
  skf_flight_free(fa), skf_flight_free(fb);
  skf_world_free(a), skf_world_free(b);
  skf_field_free(fields[0]), skf_field_free(fields[1]);
}

/* From far outside through fields that end, or vanish in doubles: none is leapt over, and the joins cost no energy. */
static void finite_support_is_not_leapt_over(void **state) {
  (void)state;
  const skf_kernel kernels[] = {{SKF_QUARTIC, 0.5}, {SKF_SOFT_OBJECT, 0.5}, {SKF_METABALL, 0.5}, {SKF_GAUSSIAN, 8}};
  for (int k = 0; k < 4; k++) {
    skf_element e = point_at(0, 0, 0, kernels[k]);
    skf_field *field;
    skf_world *w = single(&e, 1, 1e3, 1, still, &field);
    double first = NAN;
    for (size_t i = 0; i < adaptive_count(); i++) {
      skf_flight *f = fly(w, (skf_flight_options){.integrator = skf_integrator_get(i)->name},
                          (skf_state){0, {-1000, 0.1, 0}, {1, 0, 0}});
      skf_state s = state_at(f, 2000, NULL, NULL);
      skf_flight_report r = skf_flight_get_report(f);
      if (i == 0) first = s.velocity.y;
      assert_true(s.velocity.y < -0.3); /* deflected */
      check_close(s.velocity.y, first, 1e-10);
      check_scaled(r.energy_drift, 0, 1, 1e-12);
      assert_in_range(r.steps + r.rejected, 1, 400);
      skf_flight_free(f);
    }
    skf_world_free(w);
    skf_field_free(field);
  }
}

/* Steps of one length count the joins that they pass: where a kernel ends about the nearest and about the farthest
   point of a primitive, and a metaball's inner one; on a line that is hardly bent, past a body that turns or not. */
static void fixed_steps_count_joins(void **state) {
  (void)state;
  const struct {
    skf_kernel kernel;
    bool segment;
    size_t joins;
  } cases[] = {{{SKF_QUARTIC, 0.5}, false, 2},   {{SKF_SOFT_OBJECT, 0.5}, false, 2}, {{SKF_METABALL, 0.6}, false, 4},
               {{SKF_METABALL, 0.25}, false, 2}, {{SKF_QUARTIC, 0.5}, true, 4},      {{SKF_GAUSSIAN, 8}, false, 0},
               {{SKF_CAUCHY, 8}, false, 0},      {{SKF_QUARTIC, 0.05}, false, 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (int turns = 0; turns < 2; turns++) {
      skf_element e = point_at(0, 0, 0, cases[k].kernel);
      if (cases[k].segment) e = segment_of(v3(0, 0, -0.1), v3(0, 0, 0.2), cases[k].kernel, 1);
      skf_field *field;
      skf_world *w = single(&e, 1, 1e3, 1e-3, (skf_spin){{0, 0, 1}, {0, 0, 0}, turns}, &field);
      for (size_t i = 0; i < skf_integrator_count(); i++) {
        const skf_integrator_info *info = skf_integrator_get(i);
        skf_flight *f = fly(w, (skf_flight_options){.integrator = info->name, .step = info->adaptive ? 0 : 0.015},
                            (skf_state){0, {-1, 0.1, 0}, {1, 0, 0}});
        state_at(f, 2, NULL, NULL);
        assert_int_equal(skf_flight_get_report(f).joins, info->adaptive ? 0 : cases[k].joins);
        skf_flight_free(f);
      }
      skf_world_free(w);
      skf_field_free(field);
    }
}

/* The ball that holds all of a body's force is no join: the second body's is crossed, its kernel is not. */
static void reach_is_no_join(void **state) {
  (void)state;
  const skf_kernel quartic = {SKF_QUARTIC, 0.1};
  const skf_element e[2] = {point_at(0, 9, 0, quartic), segment_of(v3(0, 0, -1), v3(0, 0, 1), quartic, 1)};
  skf_field *fields[2] = {field_of(e, 1), field_of(e + 1, 1)};
  skf_world *w = world_of((const skf_attractor[]){{fields[0], 1e3, 1e-3, still}, {fields[1], 1e3, 1e-3, still}}, 2);
  skf_flight *f =
      fly(w, (skf_flight_options){.integrator = "leapfrog", .step = 0.015}, (skf_state){0, {-2, 0.5, 0}, {1, 0, 0}});
  state_at(f, 4, NULL, NULL);
  assert_int_equal(skf_flight_get_report(f).joins, 0);
  skf_flight_free(f), skf_world_free(w);
  skf_field_free(fields[0]), skf_field_free(fields[1]);
}

/* Scaling lengths by L and times by T = L^(3/2) changes nothing but the scale. */
static void scale_does_not_matter(void **state) {
  (void)state;
  skf_state first = {0};
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), T = L * sqrt(L);
    skf_element e = ring_of(L, newton, 1);
    skf_field *field;
    skf_world *w = single(&e, 1, 1e3, 1 / TAU / L, still, &field);
    skf_flight *f =
        fly(w, (skf_flight_options){0}, (skf_state){0, {2.5 * L, 0, 0.2 * L}, {0, 0.6 * L / T, 0.3 * L / T}});
    skf_state s = state_at(f, 100 * T, NULL, NULL);
    s.position = v3_scale(1 / L, s.position);
    if (k == -7) first = s;
    check_scaled(v3_dist(s.position, first.position), 0, 1, 1e-11);
    skf_flight_free(f);
    skf_world_free(w);
    skf_field_free(field);
  }
}

static void bad_flights_are_refused(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&e, 1, 1e3, 1, still, &field);
  skf_flight *f;
  skf_state s = kepler(0.5), in_the_sun = {0, {0, 0, 0}, {0, 0, 0}};
  assert_int_equal(skf_flight_new(w, &(skf_flight_options){.integrator = "euler"}, &s, &f), SKF_ERR_ARG);
  assert_int_equal(skf_flight_new(w, &(skf_flight_options){.tolerance = 1}, &s, &f), SKF_ERR_ARG);
  skf_flight_options fixed = {.integrator = "leapfrog", .step = 0.1, .max_step = 0.2};
  assert_int_equal(skf_flight_new(w, &fixed, &s, &f), SKF_ERR_ARG);
  fixed = (skf_flight_options){.integrator = "leapfrog", .step = -0.1}; /* time goes forwards: reverse the velocity */
  assert_int_equal(skf_flight_new(w, &fixed, &s, &f), SKF_ERR_ARG);
  assert_int_equal(skf_flight_new(w, &(skf_flight_options){0}, &in_the_sun, &f), SKF_ERR_CONVERGENCE);
  s.velocity.x = NAN;
  assert_int_equal(skf_flight_new(w, &(skf_flight_options){0}, &s, &f), SKF_ERR_RANGE);
  assert_null(f);
  /* Straight into the singularity: the flight ends with a status, near the time of free fall pi / (2 sqrt 2). */
  s = (skf_state){0, {1, 0, 0}, {0, 0, 0}};
  f = fly(w, (skf_flight_options){0}, s);
  skf_status status = SKF_OK;
  double from, to = 0;
  while (!status && to < 2) status = skf_flight_step(f, NULL, NULL), skf_flight_span(f, &from, &to);
  assert_int_equal(status, SKF_ERR_CONVERGENCE);
  check_close(to, SKF_PI / sqrt(8), 1e-6);
  skf_flight_free(f);
  skf_world_free(w);
  skf_field_free(field);
  assert_int_equal(skf_world_new(&(skf_attractor){NULL, 1, 1, still}, 1, &w), SKF_ERR_ARG);
}

/* Saved in the middle and loaded into a flight from elsewhere: the same bits to the end, whatever happens on the way.
 */
static void saved_flights_continue(void **state) {
  (void)state;
  const skf_contact_mode modes[] = {SKF_CONTACT_NONE, SKF_CONTACT_BOUNCE, SKF_CONTACT_STICK};
  size_t contacts = 0;
  skf_element e[2];
  skf_field *field;
  skf_world *w = single(e, cross(e), 3, 1.0 / 6, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0.6}, &field);
  for (size_t i = 0; i < skf_integrator_count(); i++)
    for (int mode = 0; mode < 3; mode++)
      for (double at = 1; at < 30; at += 14) {
        skf_flight_options o = {.integrator = skf_integrator_get(i)->name, .contact = modes[mode]};
        o.restitution = 0.5, o.friction = 0.1, o.step = skf_integrator_get(i)->adaptive ? 0 : 0.05;
        skf_flight *a = fly(w, o, (skf_state){0, {3, 0, 0.5}, {0, 0.1, 0.05}});
        state_at(a, at, NULL, NULL);
        skf_flight *b = fly(w, o, (skf_state){7, {5, 0, 0.5}, {0, 0.4, 0.05}});
        void *bytes = malloc(skf_flight_state_size(a));
        skf_flight_save(a, bytes), skf_flight_load(b, bytes);
        skf_state sa = state_at(a, 31, NULL, NULL), sb = state_at(b, 31, NULL, NULL);
        skf_flight_report ra = skf_flight_get_report(a), rb = skf_flight_get_report(b);
        assert_memory_equal(&sa, &sb, sizeof sa);
        assert_int_equal(ra.evaluations, rb.evaluations);
        assert_int_equal(ra.contacts, rb.contacts);
        contacts += ra.contacts;
        assert_memory_equal(&ra.jacobi_drift, &rb.jacobi_drift, sizeof ra.jacobi_drift);
        free(bytes), skf_flight_free(a), skf_flight_free(b);
      }
  assert_true(contacts > 4);
  skf_world_free(w);
  skf_field_free(field);
}

/* Energy, momentum and the Jacobi constant by their definitions, where they are constant and where they are not. */
static void quantities_are_what_they_are_called(void **state) {
  (void)state;
  const skf_state at = {3, {1.5, 0.3, -0.2}, {0.1, 0.8, 0.4}};
  const skf_vec3 about = {0.25, -0.5, 0}, push = {0.5, -1, 2};
  skf_element e[2];
  skf_field *field = field_of(e, cross(e));
  for (int k = 0; k < 2; k++) { /* with a push or without */
    skf_attractor body = {field, 1e3, 0.25, {{0, 0, 2}, about, 0.6}};
    skf_force force = {.type = SKF_FORCE_PUSH, .push = push};
    skf_world *w;
    assert_int_equal(skf_world_new_with(&body, 1, &force, (size_t)k, &w), SKF_OK);
    skf_quantities q = skf_world_quantities(w, &at);
    double energy = 0.5 * v3_norm2(at.velocity) + skf_world_at(w, at.t, at.position, NULL);
    skf_vec3 L = v3_cross(v3_sub(at.position, about), at.velocity);
    if (k) energy -= v3_dot(push, at.position);
    check_close(q.energy, energy, 1e-15);
    check_close(q.jacobi, energy - 0.6 * L.z, 1e-15);
    check_close(v3_dist(q.angular_momentum, L), 0, 0);
    assert_true(isnan(q.axial_momentum)); /* a cross is not symmetric about its axis */
    skf_invariants c = skf_world_invariants(w, &at);
    assert_true(k ? isnan(c.jacobi) : c.jacobi == q.jacobi);
    assert_true(isnan(c.energy));
    skf_world_free(w);
  }
  skf_field_free(field);
}

/* To the turning frame and back, at any time of a thousand revolutions; what stays in a body stands still there. */
static void frames_round_trip(void **state) {
  (void)state;
  skf_element e[2];
  skf_field *field;
  const skf_vec3 about = {0.3, -0.2, 0.1}, axis = {1, 2, 2};
  skf_world *w = single(e, cross(e), 1e3, 1, (skf_spin){axis, about, 0.37}, &field);
  for (int k = 0; k <= 1000; k++) {
    skf_state s = {(k + 0.123 * k / 1000) * TAU / 0.37, {2.5, -1, 0.7}, {0.3, 0.6, -0.4}};
    skf_state in = skf_world_state_to_body(w, 0, &s), out = skf_world_state_from_body(w, 0, &in);
    check_scaled(v3_dist(out.position, s.position), 0, v3_norm(s.position), 4e-16);
    check_scaled(v3_dist(out.velocity, s.velocity), 0, v3_norm(s.velocity), 1e-15);
    skf_vec3 ground = skf_world_surface_velocity(w, 0, s.position);
    skf_state rider = {s.t, s.position, ground};
    check_scaled(v3_norm(skf_world_state_to_body(w, 0, &rider).velocity), 0, v3_norm(ground), 1e-15);
    check_scaled(v3_dist(in.position, skf_world_to_body(w, 0, s.t, s.position)), 0, 1, 0);
    /* the velocity is the derivative of the position: a particle without forces, by central differences */
    double h = 3e-4, u = v3_norm(s.velocity);
    skf_vec3 a = skf_world_to_body(w, 0, s.t - h, v3_mad(s.position, -h, s.velocity));
    skf_vec3 b = skf_world_to_body(w, 0, s.t + h, v3_mad(s.position, h, s.velocity));
    check_scaled(v3_dist(v3_scale(0.5 / h, v3_sub(b, a)), in.velocity), 0, u, 1e-7);
  }
  skf_world_free(w);
  skf_field_free(field);
}

/* A particle around a spinning cross for a thousand revolutions of it: its states in the turning frame, put back, are
   those of the inertial one, and Jacobi's constant is the turning frame's energy, v^2 / 2 + U - (omega r)^2 / 2. */
static void turning_frames_keep_jacobi(void **state) {
  (void)state;
  skf_element e[2];
  skf_field *field;
  const double omega = 0.6;
  skf_world *w = single(e, cross(e), 1e3, 1.0 / 6, (skf_spin){{0, 0, 1}, {0, 0, 0}, omega}, &field);
  skf_flight *f = fly(w, (skf_flight_options){.tolerance = 1e-13}, (skf_state){0, {6, 0, 0.5}, {0, 0.4, 0.05}});
  double first = NAN;
  for (int k = 0; k <= 100; k++) {
    skf_state s = state_at(f, k * 10 * TAU / omega, NULL, NULL), in = skf_world_state_to_body(w, 0, &s);
    skf_state back = skf_world_state_from_body(w, 0, &in);
    check_scaled(v3_dist(back.position, s.position), 0, v3_norm(s.position), 1e-15);
    check_scaled(v3_dist(back.velocity, s.velocity), 0, omega * v3_norm(s.position), 1e-15);
    double r2 = in.position.x * in.position.x + in.position.y * in.position.y;
    double u = skf_world_at(w, 0, in.position, NULL); /* at t = 0 the frames are one */
    double jacobi = 0.5 * v3_norm2(in.velocity) + u - 0.5 * omega * omega * r2;
    if (k == 0) first = jacobi;
    check_scaled(jacobi, first, 0.5 * omega * omega * r2, 2e-15);
  }
  skf_flight_free(f);
  skf_world_free(w);
  skf_field_free(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(donut_keeps_its_invariants),
      cmocka_unit_test(fall_through_the_hole_returns),
      cmocka_unit_test(equilibria_of_a_turning_segment),
      cmocka_unit_test(jacobi_constant_holds),
      cmocka_unit_test(frames_agree),
      cmocka_unit_test(finite_support_is_not_leapt_over),
      cmocka_unit_test(fixed_steps_count_joins),
      cmocka_unit_test(reach_is_no_join),
      cmocka_unit_test(scale_does_not_matter),
      cmocka_unit_test(bad_flights_are_refused),
      cmocka_unit_test(saved_flights_continue),
      cmocka_unit_test(quantities_are_what_they_are_called),
      cmocka_unit_test(frames_round_trip),
      cmocka_unit_test(turning_frames_keep_jacobi),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
