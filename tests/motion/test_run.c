/* SPDX-License-Identifier: MIT */
/* Runs of many particles: rows, order of contacts, threads, failures. */
#include "motion/record.h"
#include <omp.h>
#include <string.h>

static record *run_on(int threads, double t_end, double every) {
  record *r = calloc(1, sizeof *r);
  assert_non_null(r);
  int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  skf_run run = {COUNT, start, t_end, every, bounce};
  assert_int_equal(skf_run_all(world, &run, &(skf_run_sink){row, contact, r}, NULL, NULL, NULL), SKF_OK);
  omp_set_num_threads(before);
  return r;
}

static void rows_fall_on_multiples_and_the_end(void **state) {
  (void)state;
  const struct {
    double t_end, every;
    size_t rows;
  } cases[] = {{0.3, 0.1, 4}, {0.35, 0.1, 5}, {1, 1, 2}, {1, 3, 2}, {0, 1, 1}, {7, 0.7, 11}, {0.5, 0, 2}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    record *r = run_on(1, cases[i].t_end, cases[i].every);
    assert_int_equal(r->rows, cases[i].rows);
    assert_true(r->t[0] == 0 && r->t[r->rows - 1] == cases[i].t_end);
    for (size_t k = 0; k + 1 < r->rows; k++) assert_true(r->t[k] == (double)k * cases[i].every);
    for (size_t k = 0; k < r->rows; k++) assert_true(r->states[k][3].t == r->t[k]);
    assert_memory_equal(r->states[0], start, sizeof start);
    free(r);
  }
}

static void contacts_come_in_order(void **state) {
  (void)state;
  record *r = run_on(2, 15, 0.1);
  assert_in_range(r->contacts, COUNT / 2, LOG);
  for (size_t i = 0; i < r->contacts; i++) {
    const skf_contact *c = r->log + i;
    size_t k = r->row_of[i]; /* the next row is the first at or after the contact */
    assert_true(c->t <= r->t[k] && (k == 0 || c->t > r->t[k - 1]));
    if (i) assert_true(c[-1].t < c->t || (c[-1].t == c->t && c[-1].particle <= c->particle));
    check_scaled(v3_norm(c->normal), 1, 1, 1e-14);
    check_scaled(skf_world_level(world, 0, c->t, c->position), 0, 9, 1e-12);
  }
  free(r);
}

static void threads_change_nothing(void **state) {
  (void)state;
  record *a = run_on(1, 15, 0.1), *b = run_on(2, 15, 0.1), *c = run_on(3, 15, 0.1);
  assert_memory_equal(a, b, sizeof *a);
  assert_memory_equal(a, c, sizeof *a);
  free(a), free(b), free(c);
}

/* Output times do not steer the steps: other rows, the same end to the last bit. */
static void output_does_not_steer(void **state) {
  (void)state;
  record *a = run_on(2, 15, 0.1), *b = run_on(2, 15, 15);
  assert_memory_equal(a->states[a->rows - 1], b->states[b->rows - 1], sizeof a->states[0]);
  assert_int_equal(a->contacts, b->contacts);
  assert_memory_equal(a->log, b->log, sizeof a->log);
  free(a), free(b);
}

/* Particles side by side, through bodies that spin, that end, and that are many: each flies as it does alone, to the
   last bit. */
static void company_changes_nothing(void **state) {
  (void)state;
  skf_element e[3] = {ring_of(1, newton, 1), point_at(0, 0.3, 0, (skf_kernel){SKF_METABALL, 0.6}),
                      segment_of(v3(-1, 0, 0), v3(1, 0.2, 0), (skf_kernel){SKF_CAUCHY, 2}, 1)};
  skf_field *f[3];
  skf_attractor bodies[3];
  for (int i = 0; i < 3; i++)
    bodies[i] = (skf_attractor){f[i] = field_of(e + i, 1), 1e3, 0.2, {{1, 0, 0}, {0, 0, 0}, 0.3 * i}};
  const char *alike = "yoshida4 mclachlan4 yoshida6 kahan-li6 yoshida8"; /* leapfrog's code, with other weights */
  for (size_t i = 0; i < skf_integrator_count(); i++)
    for (size_t n = 1; n <= 3 && !strstr(alike, skf_integrator_get(i)->name); n++) {
      skf_world *w = world_of(bodies, n);
      skf_flight_options o = {
          .integrator = skf_integrator_get(i)->name, .tolerance = 1e-10, .contact = SKF_CONTACT_NONE};
      o.step = skf_integrator_get(i)->adaptive ? 0 : 0.05;
      skf_flight_report reports[COUNT];
      record *r = calloc(1, sizeof *r);
      assert_non_null(r);
      skf_run run = {COUNT, start, 11, 0.7, o};
      assert_int_equal(skf_run_all(w, &run, &(skf_run_sink){row, NULL, r}, NULL, reports, NULL), SKF_OK);
      for (int p = 0; p < COUNT; p++) {
        skf_flight *alone = fly(w, o, start[p]);
        for (size_t k = 0; k < r->rows; k++) {
          skf_state s = state_at(alone, r->t[k], NULL, NULL);
          assert_memory_equal(&s, &r->states[k][p], sizeof s);
        }
        skf_flight_report was = skf_flight_get_report(alone);
        assert_memory_equal(&was, reports + p, sizeof was);
        skf_flight_free(alone);
      }
      free(r);
      skf_world_free(w);
    }
  for (int i = 0; i < 3; i++) skf_field_free(f[i]);
}

/* The same with what happens at a surface: states and contacts are those of each particle alone, with drag, too. */
static void company_touches_alike(void **state) {
  (void)state;
  const skf_force drag = {.type = SKF_FORCE_DRAG, .k = 0.05, .body = 0};
  skf_attractor body = {field, 9, 1 / TAU, {{1, 0, 0}, {0, 0, 0}, 0.3}};
  for (int mode = SKF_CONTACT_STOP; mode < 2 * SKF_CONTACT_COUNT; mode++) {
    skf_world *w;
    assert_int_equal(skf_world_new_with(&body, 1, &drag, mode >= SKF_CONTACT_COUNT, &w), SKF_OK);
    skf_flight_options o = {.contact = (skf_contact_mode)(mode % SKF_CONTACT_COUNT), .restitution = 0.9};
    skf_flight_report reports[COUNT];
    record *r = calloc(1, sizeof *r);
    assert_non_null(r);
    skf_run run = {COUNT, start, 11, 0.7, o};
    assert_int_equal(skf_run_all(w, &run, &(skf_run_sink){row, contact, r}, NULL, reports, NULL), SKF_OK);
    assert_int_equal(r->contacts > 0, o.contact != SKF_CONTACT_NONE);
    for (size_t p = 0; p < COUNT; p++) {
      skf_flight *alone = fly(w, o, start[p]);
      double from, to;
      size_t row = 0, next = 0;
      do { /* rows of the step, then its contact */
        skf_contact c;
        bool touched = false;
        skf_flight_span(alone, &from, &to);
        if (to < 11) assert_int_equal(skf_flight_step(alone, &c, &touched), SKF_OK);
        skf_flight_span(alone, &from, &to);
        for (; row < r->rows && r->t[row] <= to; row++) {
          skf_state s;
          if (touched && r->t[row] >= c.t) break;
          assert_int_equal(skf_flight_at(alone, r->t[row], &s), SKF_OK);
          assert_memory_equal(&s, &r->states[row][p], sizeof s);
        }
        if (!touched || c.t > 11) continue;
        while (next < r->contacts && r->log[next].particle != p) next++;
        assert_true(next < r->contacts);
        c.particle = p;
        assert_memory_equal(&c, r->log + next, offsetof(skf_contact, outcome));
        assert_int_equal(c.outcome, r->log[next++].outcome);
      } while (row < r->rows);
      while (next < r->contacts && r->log[next].particle != p) next++;
      assert_int_equal(next, r->contacts); /* no more of them */
      skf_flight_report was = skf_flight_get_report(alone);
      assert_memory_equal(&was, reports + p, sizeof was);
      skf_flight_free(alone);
    }
    free(r);
    skf_world_free(w);
  }
}

/* A particle that meets a singularity ends the run: rows before that time have been delivered. */
static void failures_say_who_and_when(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *f;
  skf_world *w = single(&e, 1, 1, 1, (skf_spin){0}, &f);
  skf_state two[COUNT];
  for (int i = 0; i < COUNT; i++) two[i] = (skf_state){0, {1 + i, 0, 0}, {0, i == 7 ? 0 : 1 / sqrt(1 + i), 0}};
  for (size_t i = 0; i < adaptive_count(); i++) {
    record *r = calloc(1, sizeof *r);
    assert_non_null(r);
    skf_run run = {COUNT, two, 100, 1, {.integrator = skf_integrator_get(i)->name, .contact = SKF_CONTACT_NONE}};
    skf_run_failure where;
    assert_int_equal(skf_run_all(w, &run, &(skf_run_sink){row, contact, r}, NULL, NULL, &where), SKF_ERR_CONVERGENCE);
    assert_int_equal(where.particle, 7);
    check_close(where.t, SKF_PI / sqrt(8) * pow(8, 1.5), 1e-6);
    assert_int_equal(r->rows, 1 + (size_t)where.t);
    free(r);
  }
  skf_world_free(w);
  skf_field_free(f);
}

/* Asks to stop after so many calls. */
static int countdown(void *user, double done) {
  assert_true(done >= 0 && done <= 1);
  return --*(long *)user <= 0;
}

/* Stopped again and again, between any two steps, each time saved and loaded into a new runner on another number of
   threads: the same rows, contacts and reports to the last bit. */
static void interrupted(double t_end, double every, const skf_flight_options *options, bool touching) {
  record *whole = calloc(1, sizeof *whole), *parts = calloc(1, sizeof *parts);
  skf_flight_report want[COUNT], got[COUNT];
  skf_run run = {COUNT, start, t_end, every, *options};
  assert_int_equal(skf_run_all(world, &run, &(skf_run_sink){row, contact, whole}, NULL, want, NULL), SKF_OK);
  assert_int_equal(whole->contacts > 0, touching);
  int before = omp_get_max_threads(), stops = 0;
  skf_runner *r;
  assert_int_equal(skf_runner_new(world, &run, &r, NULL), SKF_OK);
  for (long patience = 1;; patience = 1 + (patience * 7 + 3) % 499, stops++) {
    long left = patience;
    skf_status s = skf_runner_fly(r, &(skf_run_sink){row, contact, parts}, &(skf_progress){countdown, &left}, NULL);
    if (!s) break;
    assert_int_equal(s, SKF_ERR_CANCELLED);
    bytes b = {0};
    assert_int_equal(skf_runner_save(r, put, &b), SKF_OK);
    skf_runner_free(r);
    omp_set_num_threads(1 + stops % 3);
    assert_int_equal(skf_runner_new(world, &run, &r, NULL), SKF_OK);
    assert_int_equal(skf_runner_load(r, get, &b), SKF_OK);
    assert_int_equal(b.at, b.n);
    free(b.data);
  }
  omp_set_num_threads(before);
  skf_runner_reports(r, got);
  skf_runner_free(r);
  assert_true(stops > 1);
  assert_memory_equal(whole, parts, sizeof *whole);
  for (int i = 0; i < COUNT; i++) {
    assert_int_equal(want[i].steps, got[i].steps);
    assert_int_equal(want[i].evaluations, got[i].evaluations);
    assert_true(want[i].energy_drift == got[i].energy_drift ||
                (isnan(want[i].energy_drift) && isnan(got[i].energy_drift)));
  }
  free(whole), free(parts);
}

static void interruptions_change_nothing(void **state) {
  (void)state;
  for (size_t i = 0; i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    if (!info->adaptive) continue; /* those ask for a step */
    skf_flight_options o = bounce, free = {.contact = SKF_CONTACT_NONE};
    o.integrator = free.integrator = info->name;
    interrupted(6, 0.1, &o, true);
    interrupted(6, 6, &o, true);
    interrupted(0.8, 0.01, &free, false);
    interrupted(0.8, 0.8, &free, false);
  }
}

static void a_run_is_not_another_one(void **state) {
  (void)state;
  skf_run run = {COUNT, start, 6, 0.1, bounce}, other = {COUNT - 1, start, 6, 0.1, bounce};
  skf_runner *r, *q;
  bytes b = {0};
  assert_int_equal(skf_runner_new(world, &run, &r, NULL), SKF_OK);
  assert_int_equal(skf_runner_new(world, &other, &q, NULL), SKF_OK);
  assert_int_equal(skf_runner_save(r, put, &b), SKF_OK);
  assert_int_equal(skf_runner_load(q, get, &b), SKF_ERR_PARSE);
  b.at = 0, b.n -= 1;
  assert_int_equal(skf_runner_load(r, get, &b), SKF_ERR_IO);
  skf_runner_free(q), skf_runner_free(r);
  free(b.data);
}

/* Stopped, saved and loaded in between, with and without company: the closest approaches are those of each particle
   alone, but not of what comes after t_end, and no place before its contact is closer. */
static void approaches_of_a_run(void **state) {
  (void)state;
  enum { PLACES = 500 };
  const double end = 4.3;
  for (int k = 0; k < 4; k++) {
    skf_flight_options o = {.contact = k / 2 ? SKF_CONTACT_STOP : SKF_CONTACT_NONE, .approach = true};
    o.integrator = k % 2 ? "dop853" : "gauss-radau";
    skf_run run = {COUNT, start, end, 0.7, o};
    skf_runner *r, *again;
    skf_approach got[COUNT];
    long calls = 40;
    bytes b = {0};
    assert_int_equal(skf_runner_new(world, &run, &r, NULL), SKF_OK);
    skf_status s = skf_runner_fly(r, &(skf_run_sink){0}, &(skf_progress){countdown, &calls}, NULL);
    assert_true(s == SKF_ERR_CANCELLED || s == SKF_OK);
    assert_int_equal(skf_runner_save(r, put, &b), SKF_OK);
    assert_int_equal(skf_runner_new(world, &run, &again, NULL), SKF_OK);
    assert_int_equal(skf_runner_load(again, get, &b), SKF_OK);
    assert_int_equal(skf_runner_fly(again, &(skf_run_sink){0}, NULL, NULL), SKF_OK);
    assert_int_equal(skf_runner_approaches(again, got), SKF_OK);
    skf_runner_free(r), skf_runner_free(again);
    free(b.data);
    size_t later = 0;
    for (size_t p = 0; p < COUNT; p++) {
      skf_flight *alone = fly(world, o, start[p]);
      size_t n = 0;
      skf_contact c = {0};
      double to = 0, from;
      while (to < end) {
        bool touched;
        assert_int_equal(skf_flight_step(alone, &c, &touched), SKF_OK);
        n += touched && c.t <= end;
        skf_flight_span(alone, &from, &to);
        double last = fmin(to, end);
        for (int j = 0; j <= PLACES && n == 0; j++) {
          skf_state at;
          assert_int_equal(skf_flight_at(alone, fmin(last, from + (last - from) * j / PLACES), &at), SKF_OK);
          assert_true(fmin(skf_world_level(world, 0, at.t, at.position), 0) <= got[p].level + 1e-13);
        }
      }
      skf_approach want;
      assert_int_equal(skf_flight_approach(alone, 0, &want), SKF_OK);
      assert_true(got[p].t <= end);
      bool settled = want.t <= end && want.level <= 0; /* inside any place will do */
      if (settled) check_scaled(want.level, got[p].level, 9, 1e-14);
      if (settled) check_scaled(v3_dist(want.position, got[p].position), 0, 1, 1e-7); /* F is that flat there */
      if (n) assert_true(got[p].t == c.t);
      later += want.t > end;
      skf_flight_free(alone);
    }
    assert_in_range(later, 0, COUNT / 2);
  }
  skf_runner *r;
  skf_run run = {COUNT, start, end, 0.7, bounce};
  assert_int_equal(skf_runner_new(world, &run, &r, NULL), SKF_OK);
  assert_int_equal(skf_runner_approaches(r, NULL), SKF_ERR_ARG);
  skf_runner_free(r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_fall_on_multiples_and_the_end),
      cmocka_unit_test(contacts_come_in_order),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(output_does_not_steer),
      cmocka_unit_test(company_changes_nothing),
      cmocka_unit_test(company_touches_alike),
      cmocka_unit_test(failures_say_who_and_when),
      cmocka_unit_test(interruptions_change_nothing),
      cmocka_unit_test(a_run_is_not_another_one),
      cmocka_unit_test(approaches_of_a_run),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
