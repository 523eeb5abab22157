/* SPDX-License-Identifier: MIT */
/* Particles that attract each other: closed forms, periodic orbits, sums that stay, contacts, the same bits always. */
#include "motion/cluster.h"
#include "motion/pairs.h"
#include "motion/bytes.h"
#include "motion/worlds.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* A body that pulls nothing, nor is in anybody's way. */
static skf_world *empty(skf_field **field) {
  skf_element e = point_at(0, 0, 0, newton);
  return single(&e, 1, 1e3, 0, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0}, field);
}

enum { ROWS = 64 };

/* All rows of a run. */
typedef struct tape {
  size_t n, rows, contacts;
  skf_state *state; /* of row k, particle i: k n + i */
  skf_contact contact[8];
} tape;

static skf_status take_row(void *user, double t, const skf_state *states) {
  tape *p = user;
  (void)t;
  assert_true(p->rows < ROWS);
  memcpy(p->state + p->rows++ * p->n, states, p->n * sizeof *states);
  return SKF_OK;
}

static skf_status take_contact(void *user, const skf_contact *c) {
  tape *p = user;
  if (p->contacts < 8) p->contact[p->contacts] = *c;
  p->contacts++;
  return SKF_OK;
}

static skf_run run_of(size_t n, const skf_state *start, const double *gm, double t_end, double every) {
  return (skf_run){.count = n, .start = start, .t_end = t_end, .every = every, .gm = gm};
}

static tape fly_all(const skf_world *w, const skf_run *run, skf_flight_report *reports) {
  tape p = {.n = run->count, .state = malloc(ROWS * run->count * sizeof(skf_state))};
  skf_run_failure where = {0, 0};
  skf_status s = skf_run_all(w, run, &(skf_run_sink){take_row, take_contact, &p}, NULL, reports, &where);
  if (s) fail_msg("%s: particle %zu at %g", skf_status_text(s), where.particle, where.t);
  return p;
}

/* Two masses about their center, eccentricity 0.6, which flies off slowly: where each is after whole
   revolutions is known. */
static void two_bodies_are_keplers(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = empty(&field);
  const double gm[2] = {0.75, 0.25}, e = 0.6;
  const skf_vec3 drift = {0.01, 0.02, 0.03};
  skf_state k = kepler(e), start[2];
  for (int i = 0; i < 2; i++) {
    double share = i == 0 ? gm[1] : -gm[0];
    start[i] = (skf_state){0, v3_scale(share, k.position), v3_mad(drift, share, k.velocity)};
  }
  skf_run run = run_of(2, start, gm, 100 * TAU, 50 * TAU);
  run.flight.tolerance = 1e-13;
  skf_flight_report r[2];
  tape p = fly_all(w, &run, r);
  assert_int_equal(p.rows, 3);
  for (size_t row = 0; row < 3; row++)
    for (size_t i = 0; i < 2; i++) {
      const skf_state *s = p.state + 2 * row + i;
      check_scaled(v3_dist(s->position, v3_mad(start[i].position, s->t, drift)), 0, 1 + s->t, 1e-12);
      check_scaled(v3_dist(s->velocity, start[i].velocity), 0, 1, 1e-10);
    }
  print_message("100 revolutions, e = 0.6: %zu steps, energy %g\n", r[0].steps, r[0].energy_drift);
  check_scaled(r[0].energy_drift, 0, 1, 1e-14);
  assert_true(isnan(r[1].energy_drift));
  free(p.state);
  skf_world_free(w), skf_field_free(field);
}

/* A softening far below the distance of the two turns their ellipse by some 1e-11; that each lies in its own softened
   hollow is no noise. */
static void slight_softening_changes_nothing(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = empty(&field);
  const double gm[2] = {0.75, 0.25};
  skf_state k = kepler(0.6), start[2];
  for (int i = 0; i < 2; i++) {
    double share = i == 0 ? gm[1] : -gm[0];
    start[i] = (skf_state){0, v3_scale(share, k.position), v3_scale(share, k.velocity)};
  }
  skf_run run = run_of(2, start, gm, 10 * TAU, 0);
  run.softening = 1e-7;
  skf_flight_report r[2];
  tape p = fly_all(w, &run, r);
  print_message("softening 1e-7: %zu steps, energy %g\n", r[0].steps, r[0].energy_drift);
  for (size_t i = 0; i < 2; i++) check_scaled(v3_dist(p.state[2 + i].position, start[i].position), 0, 1, 1e-10);
  check_scaled(r[0].energy_drift, 0, 1, 1e-14);
  free(p.state);
  skf_world_free(w), skf_field_free(field);
}

/* The figure of eight [Chenciner and Montgomery 2000]: initial values and period to 8 digits; a third of a period later
   each is where the next one was. */
static void three_bodies_dance_an_eight(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = empty(&field);
  const double x = 0.97000436, y = -0.24308753, u = 0.466203685, v = 0.43236573;
  const double gm[3] = {1, 1, 1}, T = 6.32591398;
  const skf_state start[3] = {
      {0, {x, y, 0}, {u, v, 0}}, {0, {-x, -y, 0}, {u, v, 0}}, {0, {0, 0, 0}, {-2 * u, -2 * v, 0}}};
  skf_run run = run_of(3, start, gm, T, T / 3);
  skf_flight_report r[3];
  tape p = fly_all(w, &run, r);
  double off = 0, turned[2] = {0, 0};
  for (size_t i = 0; i < 3; i++) off = fmax(off, v3_dist(p.state[9 + i].position, start[i].position));
  for (size_t i = 0; i < 3; i++) /* one way round or the other */
    for (size_t d = 1; d < 3; d++)
      turned[d - 1] = fmax(turned[d - 1], v3_dist(p.state[3 + i].position, start[(i + d) % 3].position));
  print_message("eight: %g after a period, %g after a third; energy %g\n", off, fmin(turned[0], turned[1]),
                r[0].energy_drift);
  check_scaled(off, 0, 1, 2e-7);
  check_scaled(fmin(turned[0], turned[1]), 0, 1, 2e-7);
  check_scaled(r[0].energy_drift, 0, 1, 1e-14);
  check_scaled(r[0].momentum_drift, 0, 1, 1e-14);
  free(p.state);
  skf_world_free(w), skf_field_free(field);
}

/* Masses 3, 4, 5 at rest on a triangle of these sides [Burrau 1913]: after many close encounters the lightest is thrown
   out of a pair of the others, near t = 60 [Szebehely and Peters 1967]; reversed at t = 40 they come back to rest. */
static void the_pythagorean_problem(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = empty(&field);
  const double gm[3] = {3, 4, 5};
  const skf_state start[3] = {{0, {1, 3, 0}, {0, 0, 0}}, {0, {-2, -1, 0}, {0, 0, 0}}, {0, {1, -1, 0}, {0, 0, 0}}};
  skf_run run = run_of(3, start, gm, 70, 10);
  skf_flight_report r[3];
  tape p = fly_all(w, &run, r);
  print_message("Pythagoras to t = 70: %zu steps, energy %g\n", r[0].steps, r[0].energy_drift);
  check_scaled(r[0].energy_drift, 0, 1, 1e-10);
  check_scaled(r[0].momentum_drift, 0, 1, 1e-14);
  const skf_state *end = p.state + 7 * 3;
  assert_true(v3_norm(end[0].position) > 20 && v3_dot(end[0].position, end[0].velocity) > 0);
  assert_true(v3_dist(end[1].position, end[2].position) < 2);
  free(p.state);
  skf_state back[3];
  run = run_of(3, start, gm, 20, 0);
  p = fly_all(w, &run, NULL);
  for (int i = 0; i < 3; i++) back[i] = (skf_state){0, p.state[3 + i].position, v3_scale(-1, p.state[3 + i].velocity)};
  free(p.state);
  run.start = back;
  p = fly_all(w, &run, NULL);
  for (int i = 0; i < 3; i++) check_scaled(v3_dist(p.state[3 + i].position, start[i].position), 0, 1, 1e-6);
  free(p.state);
  skf_world_free(w), skf_field_free(field);
}

static double random_in(unsigned *seed, double lo, double hi) {
  *seed = *seed * 1664525u + 1013904223u;
  return lo + (hi - lo) * (*seed / 4294967296.0);
}

/* A cloud; every third particle has no mass. */
static void cloud(size_t n, skf_state *start, double *gm) {
  unsigned seed = 7;
  for (size_t i = 0; i < n; i++) {
    double z[6];
    for (int k = 0; k < 6; k++) z[k] = random_in(&seed, -1, 1);
    start[i] = (skf_state){0, {z[0], z[1], z[2]}, {0.3 * z[3], 0.3 * z[4], 0.3 * z[5]}};
    gm[i] = i % 3 == 2 ? 0 : random_in(&seed, 0.5, 1.5) / (double)n;
  }
}

/* Momentum, angular momentum and energy of a softened cloud, by sums of its own; nothing depends on the threads, nor on
   what has no mass. */
static void clouds_keep_their_sums(void **state) {
  (void)state;
  enum { N = 120 };
  skf_field *field;
  skf_world *w = empty(&field);
  skf_state start[N];
  double gm[N], eps = 0.05;
  cloud(N, start, gm);
  skf_run run = run_of(N, start, gm, 2, 0);
  run.softening = eps;
  skf_flight_report r[N];
  omp_set_num_threads(1);
  tape p = fly_all(w, &run, r);
  omp_set_num_threads(3);
  tape q = fly_all(w, &run, NULL);
  assert_memory_equal(p.state, q.state, 2 * N * sizeof *p.state);
  double energy[2] = {0, 0}, scale = 0;
  skf_vec3 momentum[2] = {{0, 0, 0}, {0, 0, 0}}, L[2] = {{0, 0, 0}, {0, 0, 0}};
  for (int end = 0; end < 2; end++)
    for (size_t i = 0; i < N; i++) {
      const skf_state *s = p.state + end * N + i;
      momentum[end] = v3_mad(momentum[end], gm[i], s->velocity);
      L[end] = v3_mad(L[end], gm[i], v3_cross(s->position, s->velocity));
      energy[end] += 0.5 * gm[i] * v3_norm2(s->velocity);
      scale += 0.5 * gm[i] * v3_norm2(s->velocity);
      for (size_t j = 0; j < i; j++) {
        double u = gm[i] * gm[j] / sqrt(v3_norm2(v3_sub(p.state[end * N + j].position, s->position)) + eps * eps);
        energy[end] -= u, scale += u;
      }
    }
  print_message("cloud: momentum %g, angular %g, energy %g (told: %g)\n", v3_dist(momentum[0], momentum[1]),
                v3_dist(L[0], L[1]), energy[1] - energy[0], r[0].energy_drift);
  check_scaled(v3_dist(momentum[0], momentum[1]), 0, 1, 1e-15);
  check_scaled(v3_dist(L[0], L[1]), 0, 1, 1e-15);
  check_scaled(energy[1], energy[0], scale / 2, 1e-14);
  check_scaled(r[0].energy_drift, 0, 1, 1e-14);
  skf_state heavy[N];
  double heavy_gm[N];
  size_t n = 0;
  for (size_t i = 0; i < N; i++)
    if (gm[i] > 0) heavy[n] = start[i], heavy_gm[n++] = gm[i];
  run.count = n, run.start = heavy, run.gm = heavy_gm;
  tape alone = fly_all(w, &run, NULL);
  for (size_t i = 0, k = 0; i < N; i++) /* the others' steps may be shorter for the sake of one without mass */
    if (gm[i] > 0) check_scaled(v3_dist(p.state[N + i].position, alone.state[n + k++].position), 0, 1, 1e-12);
  free(p.state), free(q.state), free(alone.state);
  skf_world_free(w), skf_field_free(field);
}

/* The direct sum of every instruction set and length against long double. */
static void sums_are_sums(void **state) {
  (void)state;
  enum { N = 37 };
  skf_state at[N];
  double gm[N], x[3][N], a[2][3][N], rough[2][N];
  unsigned same[2][N];
  cloud(N, at, gm);
  for (size_t i = 0; i < N; i++) x[0][i] = at[i].position.x, x[1][i] = at[i].position.y, x[2][i] = at[i].position.z;
  for (int soft = 0; soft < 2; soft++)
    for (size_t m = 1; m <= N; m++) {
      skf_pullers s = {N, {x[0], x[1], x[2]}, gm, soft ? 0.01 : 0};
      for (int isa = 0; isa < 2; isa++) {
        memset(a[isa], 0, sizeof a[isa]), memset(rough[isa], 0, sizeof rough[isa]);
        memset(same[isa], 0, sizeof same[isa]);
        skf_pairs_pick(isa ? skf_isa_pick() : SKF_ISA_SCALAR)(&s, m, (const double *const[]){x[0], x[1], x[2]},
                                                              (double *const[]){a[isa][0], a[isa][1], a[isa][2]},
                                                              rough[isa], same[isa]);
      }
      assert_memory_equal(a[0], a[1], sizeof a[0]);
      assert_memory_equal(rough[0], rough[1], sizeof rough[0]);
      for (size_t i = 0; i < m; i++) {
        long double sum[3] = {0, 0, 0};
        assert_int_equal(same[0][i], soft ? 0 : 1);
        for (size_t j = 0; j < N; j++) {
          long double d[3], r2 = s.softening2;
          for (int k = 0; k < 3; k++) d[k] = (long double)x[k][j] - x[k][i], r2 += d[k] * d[k];
          for (int k = 0; k < 3 && i != j; k++) sum[k] += gm[j] * d[k] / (r2 * sqrtl(r2));
        }
        for (int k = 0; k < 3; k++) check_scaled(a[0][k][i], (double)sum[k], rough[0][i], 1e-15);
      }
    }
}

/* A wall that a pair falls on, and what happens then: each is told, the other one goes on, pulled by what lies there.
 */
static void contacts_of_one_do_not_stop_the_other(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&e, 1, 1, 1, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0}, &field); /* radius 1, G M = 1 */
  const skf_state start[3] = {{0, {2, 0, 0}, {0, 0, 0}}, {0, {0, 4, 0}, {-0.5, 0, 0}}, {0, {-2, 0, 0}, {0, 0, 0}}};
  const double gm[3] = {1e-3, 1e-3, 1e-3};
  const skf_contact_mode modes[] = {SKF_CONTACT_STOP, SKF_CONTACT_ABSORB, SKF_CONTACT_BOUNCE, SKF_CONTACT_STICK};
  for (int m = 0; m < 4; m++) {
    skf_run run = run_of(3, start, gm, 6, 1);
    run.flight.contact = modes[m], run.flight.restitution = 0.5;
    skf_flight_report r[3];
    tape p = fly_all(w, &run, r);
    assert_int_equal(p.rows, 7);
    assert_true(modes[m] == SKF_CONTACT_BOUNCE ? p.contacts > 4 : p.contacts == 2);
    for (size_t c = 0; c < 2; c++) {
      assert_in_range(p.contact[c].t * 1000, 2000, 3000); /* about sqrt(8) (1 + pi / 2) / 2 / sqrt 2 = 2.57 */
      check_scaled(v3_norm(p.contact[c].position), 1, 1, 1e-13);
      assert_true(v3_dot(p.contact[c].before, p.contact[c].normal) < 0);
    }
    const skf_state *end = p.state + 6 * 3;
    assert_true(modes[m] == SKF_CONTACT_ABSORB ? isnan(end[0].position.x) : v3_norm(end[0].position) < 1.5);
    assert_true(v3_norm(end[1].position) > 1 && v3_norm(end[1].velocity) > 0.1);
    check_scaled(r[0].energy_drift, 0, 1, 1e-13);
    free(p.state);
  }
  skf_world_free(w), skf_field_free(field);
}

/* Once nobody flies there is no motion whose constants could drift. */
static void constants_end_with_the_last_flight(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&e, 1, 1, 1, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0}, &field);
  const skf_state start[2] = {{0, {2, 0, 0}, {0, 0, 0}}, {0, {0, 3, 0}, {0, 0, 0}}};
  const double gm[2] = {1e-3, 2e-3};
  const skf_contact_mode modes[] = {SKF_CONTACT_STOP, SKF_CONTACT_ABSORB, SKF_CONTACT_STICK};
  for (int m = 0; m < 3; m++) {
    skf_run run = run_of(2, start, gm, 8, 1);
    run.flight.contact = modes[m];
    skf_flight_report r[2];
    tape p = fly_all(w, &run, r);
    assert_int_equal(p.contacts, 2);
    check_scaled(r[0].energy_drift, 0, 1, 1e-13);
    check_scaled(r[0].momentum_drift, 0, 1, 1e-13);
    free(p.state);
  }
  skf_world_free(w), skf_field_free(field);
}

static int stop_soon(void *user, double done) {
  (void)done;
  return --*(int *)user == 0;
}

static void saved_clusters_continue(void **state) {
  (void)state;
  enum { N = 20 };
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&e, 1, 2, 0.3, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0}, &field);
  skf_state start[N];
  double gm[N];
  cloud(N, start, gm);
  for (size_t i = 0; i < N; i++) start[i].position.x += 1.7, start[i].velocity.x -= 0.8; /* from outside of the body */
  skf_run run = run_of(N, start, gm, 3, 0.25);
  run.softening = 0.02, run.flight.contact = SKF_CONTACT_STICK;
  skf_flight_report whole[N], resumed[N];
  tape p = fly_all(w, &run, whole), q = {.n = N, .state = malloc(ROWS * N * sizeof(skf_state))};
  assert_true(p.contacts > 0);
  const skf_run_sink sink = {take_row, take_contact, &q};
  bytes s = {0};
  int left = 40, legs = 0;
  for (skf_status ended = SKF_ERR_CANCELLED; ended == SKF_ERR_CANCELLED; legs++, left = 40) {
    skf_runner *r;
    assert_int_equal(skf_runner_new(w, &run, &r, NULL), SKF_OK);
    if (legs) assert_int_equal(skf_runner_load(r, get, &s), SKF_OK);
    ended = skf_runner_fly(r, &sink, &(skf_progress){stop_soon, &left}, NULL);
    assert_true(ended == SKF_OK || ended == SKF_ERR_CANCELLED);
    s.n = s.at = 0;
    assert_int_equal(skf_runner_save(r, put, &s), SKF_OK);
    if (!ended) skf_runner_reports(r, resumed);
    skf_runner_free(r);
  }
  assert_true(legs > 3);
  assert_int_equal(p.rows, q.rows), assert_int_equal(p.contacts, q.contacts);
  assert_memory_equal(p.state, q.state, p.rows * N * sizeof *p.state);
  assert_memory_equal(&whole[0].energy_drift, &resumed[0].energy_drift, sizeof(double));
  free(p.state), free(q.state), free(s.data);
  skf_world_free(w), skf_field_free(field);
}

static void bad_clusters_are_refused(void **state) {
  (void)state;
  skf_field *field;
  skf_world *w = empty(&field);
  skf_state start[2] = {{0, {1, 0, 0}, {0, 0, 0}}, {0, {1, 0, 0}, {0, 1, 0}}};
  double gm[2] = {1, 1};
  skf_run run = run_of(2, start, gm, 1, 0);
  skf_runner *r;
  assert_int_equal(skf_runner_new(w, &run, &r, NULL), SKF_ERR_CONVERGENCE); /* two at one place */
  assert_null(r);
  run.softening = 0.1;
  assert_int_equal(skf_runner_new(w, &run, &r, NULL), SKF_OK);
  skf_runner_free(r);
  run.softening = -1;
  assert_int_equal(skf_runner_new(w, &run, &r, NULL), SKF_ERR_ARG);
  run.softening = 0.1, run.flight.integrator = "rkn12";
  assert_int_equal(skf_runner_new(w, &run, &r, NULL), SKF_ERR_UNSUPPORTED);
  run.flight.integrator = NULL, gm[1] = NAN;
  assert_int_equal(skf_runner_new(w, &run, &r, NULL), SKF_ERR_RANGE);
  skf_world_free(w), skf_field_free(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_bodies_are_keplers),
      cmocka_unit_test(slight_softening_changes_nothing),
      cmocka_unit_test(three_bodies_dance_an_eight),
      cmocka_unit_test(the_pythagorean_problem),
      cmocka_unit_test(clouds_keep_their_sums),
      cmocka_unit_test(sums_are_sums),
      cmocka_unit_test(contacts_of_one_do_not_stop_the_other),
      cmocka_unit_test(constants_end_with_the_last_flight),
      cmocka_unit_test(saved_clusters_continue),
      cmocka_unit_test(bad_clusters_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
