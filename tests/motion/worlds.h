/* SPDX-License-Identifier: MIT */
/* Small worlds and flights for the tests of motion. */
#ifndef SKF_TESTS_MOTION_WORLDS_H
#define SKF_TESTS_MOTION_WORLDS_H

#include "check.h"
#include "core/vec3.h"
#include "skelfield/motion.h"

#define TAU 6.283185307179586

static inline skf_element point_at(double x, double y, double z, skf_kernel kernel) {
  return (skf_element){{.shape = SKF_POINT, .point = {{x, y, z}}}, kernel, 1};
}

static inline skf_element segment_of(skf_vec3 from, skf_vec3 to, skf_kernel kernel, double strength) {
  return (skf_element){{.shape = SKF_SEGMENT, .segment = {from, to}}, kernel, strength};
}

static inline skf_element ring_of(double radius, skf_kernel kernel, double strength) {
  return (skf_element){
      {.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, radius, 2 * SKF_PI}}, kernel, strength};
}

static const skf_kernel newton = {SKF_INVERSE, 0};
static const skf_spin still = {{0, 0, 1}, {0, 0, 0}, 0};

static inline skf_field *field_of(const skf_element *e, size_t n) {
  skf_field *f;
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  return f;
}

static inline skf_world *world_of(const skf_attractor *bodies, size_t n) {
  skf_world *w;
  assert_int_equal(skf_world_new(bodies, n, &w), SKF_OK);
  return w;
}

/* A world of one body; *field is the caller's to free. */
static inline skf_world *single(const skf_element *e, size_t n, double iso, double gain, skf_spin spin,
                                skf_field **field) {
  *field = field_of(e, n);
  return world_of(&(skf_attractor){*field, iso, gain, spin}, 1);
}

static inline void drop_world(skf_world *w, skf_field *field) {
  skf_world_free(w);
  skf_field_free(field);
}

static inline skf_flight *fly(const skf_world *w, skf_flight_options o, skf_state start) {
  skf_flight *f;
  assert_int_equal(skf_flight_new(w, &o, &start, &f), SKF_OK);
  return f;
}

/* Integrators that choose their steps: the first of the registry. */
static inline size_t adaptive_count(void) {
  size_t n = 0;
  while (n < skf_integrator_count() && skf_integrator_get(n)->adaptive) n++;
  return n;
}

/* Steps until t and gives the state there; contacts are counted, and the last one kept if asked for. */
static inline skf_state state_at(skf_flight *f, double t, size_t *contacts, skf_contact *last) {
  double from, to;
  skf_state s;
  for (skf_flight_span(f, &from, &to); to < t; skf_flight_span(f, &from, &to)) {
    skf_contact c;
    bool touched;
    assert_int_equal(skf_flight_step(f, &c, &touched), SKF_OK);
    if (touched && c.t <= t) {
      if (contacts) ++*contacts;
      if (last) *last = c;
    }
  }
  assert_int_equal(skf_flight_at(f, t, &s), SKF_OK);
  return s;
}

/* From periapsis at distance 1 - e on the x axis: G M = 1, semi-major axis 1, period 2 pi. */
static inline skf_state kepler(double e) { return (skf_state){0, {1 - e, 0, 0}, {0, sqrt((1 + e) / (1 - e)), 0}}; }

#endif
