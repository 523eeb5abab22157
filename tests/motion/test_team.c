/* SPDX-License-Identifier: MIT */
/* A run that is shared: the same bits for any number of members, here threads that talk through pipes. */
#include "motion/record.h"
#include <pthread.h>
#include <unistd.h>
#include <omp.h>

enum { MOST = COUNT + 1 };

typedef struct member {
  skf_team team;
  int to[MOST][2], from[MOST][2]; /* ends of the pipes to and from each of the others */
  const skf_run *run;
  record *made; /* of the first; of all with `own`, each its particles' part */
  bool own;
  size_t own_rows;
  bytes *kept; /* of the first, with `load` to begin with */
  bool load;
  long patience; /* steps until it asks to stop, 0: never */
  skf_flight_report *reports;
  skf_run_failure where;
  skf_status status, saved;
} member;

static skf_status put_all(int fd, const void *data, size_t n) {
  for (const char *p = data; n > 0;) {
    ssize_t k = write(fd, p, n);
    if (k <= 0) return SKF_ERR_IO;
    p += k, n -= (size_t)k;
  }
  return SKF_OK;
}

static skf_status get_all(int fd, void *data, size_t n) {
  for (char *p = data; n > 0;) {
    ssize_t k = read(fd, p, n);
    if (k <= 0) return SKF_ERR_IO;
    p += k, n -= (size_t)k;
  }
  return SKF_OK;
}

/* Messages, not a stream: one call takes what one call has sent. */
static skf_status send_to(void *user, size_t to, const void *data, size_t n) {
  int fd = ((member *)user)->to[to][1];
  return put_all(fd, &n, sizeof n) || put_all(fd, data, n) ? SKF_ERR_IO : SKF_OK;
}

static skf_status receive_from(void *user, size_t from, void *data, size_t n) {
  int fd = ((member *)user)->from[from][0];
  size_t sent;
  return get_all(fd, &sent, sizeof sent) || sent != n || get_all(fd, data, n) ? SKF_ERR_PARSE : SKF_OK;
}

static int patient(void *user, double done) {
  member *m = user;
  (void)done;
  return m->patience > 0 && --m->patience == 0;
}

static skf_status own_row(void *user, double t, const skf_state *states) {
  member *m = user;
  size_t k = m->own_rows++;
  for (size_t i = m->team.rank; i < COUNT; i += m->team.size) m->made->states[k][i] = *states++;
  if (m->team.rank == 0) m->made->t[k] = t, m->made->rows = k + 1;
  return SKF_OK;
}

static skf_status own_contact(void *user, const skf_contact *c) {
  member *m = user;
  return m->team.rank == 0 ? contact(m->made, c) : SKF_ERR_ARG;
}

static void *take_part(void *user) {
  member *m = user;
  skf_run run = *m->run;
  skf_runner *r;
  run.team = &m->team;
  omp_set_num_threads(1 + (int)m->team.rank % 2);
  m->status = skf_runner_new(world, &run, &r, &m->where);
  if (m->status) return NULL;
  if (m->load) m->status = skf_runner_load(r, get, m->kept);
  if (m->kept) m->kept->n = m->kept->at = 0;
  const skf_run_sink gathered = {row, contact, m->made}, own = {own_row, own_contact, m, true};
  const skf_run_sink *sink = m->own ? &own : m->made ? &gathered : NULL;
  if (!m->status) m->status = skf_runner_fly(r, sink, &(skf_progress){patient, m}, &m->where);
  m->saved = m->status == SKF_ERR_CANCELLED ? skf_runner_save(r, put, m->kept) : SKF_OK;
  if (!m->saved) m->saved = skf_runner_reports(r, m->reports);
  skf_runner_free(r);
  return NULL;
}

/* All of them together; the status that they share. */
static skf_status meet(member *first, size_t n) {
  static member all[MOST];
  pthread_t threads[MOST];
  for (size_t i = 0; i < n; i++) {
    all[i] = (member){.run = first->run, .load = first->load};
    if (first->own) all[i].own = true, all[i].made = first->made;
    if (i == 0) all[i] = *first;
    all[i].patience = i == n / 2 ? first->patience : 0;
    all[i].team = (skf_team){i, n, send_to, receive_from, all + i};
  }
  for (size_t i = 1; i < n; i++) {
    assert_int_equal(pipe(all[0].to[i]) | pipe(all[0].from[i]), 0);
    memcpy(all[i].from[0], all[0].to[i], sizeof all[i].from[0]);
    memcpy(all[i].to[0], all[0].from[i], sizeof all[i].to[0]);
  }
  for (size_t i = 0; i < n; i++) assert_int_equal(pthread_create(threads + i, NULL, take_part, all + i), 0);
  for (size_t i = 0; i < n; i++) assert_int_equal(pthread_join(threads[i], NULL), 0);
  for (size_t i = 0; i < n; i++) {
    assert_int_equal(all[i].status, all[0].status);
    assert_int_equal(all[i].saved, SKF_OK);
    for (int end = 0; end < 2 && i > 0; end++) close(all[0].to[i][end]), close(all[0].from[i][end]);
  }
  first->where = all[0].where;
  return all[0].status;
}

static void same_reports(const skf_flight_report *want, const skf_flight_report *got) {
  for (int i = 0; i < COUNT; i++) {
    assert_int_equal(want[i].steps, got[i].steps);
    assert_int_equal(want[i].evaluations, got[i].evaluations);
    assert_int_equal(want[i].contacts, got[i].contacts);
    assert_memory_equal(&want[i].energy_drift, &got[i].energy_drift, sizeof want[i].energy_drift);
  }
}

static const size_t sizes[] = {1, 2, 3, 7, COUNT, MOST};

/* Nor do sinks of their own. */
static void shares_change_nothing(void **state) {
  (void)state;
  const skf_flight_options free_flight = {.contact = SKF_CONTACT_NONE};
  const skf_run runs[] = {{COUNT, start, 5, 0.1, bounce}, {COUNT, start, 0.8, 0.8, free_flight}};
  for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
    record *whole = calloc(1, sizeof *whole);
    skf_flight_report want[COUNT], got[COUNT];
    assert_int_equal(skf_run_all(world, runs + i, &(skf_run_sink){row, contact, whole}, NULL, want, NULL), SKF_OK);
    assert_int_equal(whole->contacts > 0, i == 0);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
      member first = {.run = runs + i, .made = calloc(1, sizeof *whole), .reports = got};
      assert_int_equal(meet(&first, sizes[k]), SKF_OK);
      assert_memory_equal(whole, first.made, sizeof *whole);
      same_reports(want, got);
      memset(first.made, 0, sizeof *whole);
      first.own = true;
      assert_int_equal(meet(&first, sizes[k]), SKF_OK);
      assert_memory_equal(whole, first.made, sizeof *whole);
      free(first.made);
    }
    free(whole);
  }
}

/* Stopped by one of them again and again, each time saved, and gone on with by another number of members. */
static void stops_change_nothing(void **state) {
  (void)state;
  const skf_run run = {COUNT, start, 5, 0.1, bounce};
  record *whole = calloc(1, sizeof *whole);
  skf_flight_report want[COUNT], got[COUNT];
  bytes kept = {0};
  assert_int_equal(skf_run_all(world, &run, &(skf_run_sink){row, contact, whole}, NULL, want, NULL), SKF_OK);
  member first = {.run = &run, .made = calloc(1, sizeof *whole), .reports = got, .kept = &kept};
  size_t stops = 0;
  for (;; stops++) {
    first.load = stops > 0, first.patience = 1 + (long)(stops * 37 % 101);
    skf_status s = meet(&first, sizes[stops % 4]);
    if (!s) break;
    assert_int_equal(s, SKF_ERR_CANCELLED);
  }
  assert_true(stops > 4);
  assert_memory_equal(whole, first.made, sizeof *whole);
  same_reports(want, got);
  free(first.made), free(whole), free(kept.data);
}

static skf_status full(void *user, double t, const skf_state *states) {
  (void)states;
  return t > *(double *)user ? SKF_ERR_IO : SKF_OK;
}

static void *fly_into_full(void *user) {
  member *m = user;
  skf_run run = *m->run;
  double most = 2;
  run.team = &m->team;
  m->status = skf_run_all(world, &run, &(skf_run_sink){.row = full, .user = &most}, NULL, NULL, NULL);
  return NULL;
}

/* What fails in one of them ends the run of all: a sink, a flight that cannot begin, a file that is cut. */
static void failures_are_shared(void **state) {
  (void)state;
  skf_run run = {COUNT, start, 5, 0.1, bounce};
  member pair[2] = {{.run = &run, .team = {0, 2, send_to, receive_from, pair}},
                    {.run = &run, .team = {1, 2, send_to, receive_from, pair + 1}}};
  assert_int_equal(pipe(pair[0].to[1]) | pipe(pair[0].from[1]), 0);
  memcpy(pair[1].from[0], pair[0].to[1], sizeof pair[1].from[0]);
  memcpy(pair[1].to[0], pair[0].from[1], sizeof pair[1].to[0]);
  pthread_t other;
  assert_int_equal(pthread_create(&other, NULL, fly_into_full, pair + 1), 0);
  fly_into_full(pair);
  assert_int_equal(pthread_join(other, NULL), 0);
  assert_int_equal(pair[0].status, SKF_ERR_IO);
  assert_int_equal(pair[1].status, SKF_ERR_IO);

  bytes kept = {0};
  member first = {.run = &run, .made = calloc(1, sizeof *first.made), .kept = &kept, .patience = 50};
  skf_flight_report reports[COUNT];
  first.reports = reports;
  assert_int_equal(meet(&first, 3), SKF_ERR_CANCELLED);
  kept.n -= kept.n / 2, first.load = true;
  assert_int_equal(meet(&first, 3), SKF_ERR_IO);
  free(first.made), free(kept.data);

  skf_state late[COUNT];
  memcpy(late, start, sizeof late);
  late[4].t = 1;
  run.start = late;
  first = (member){.run = &run, .reports = reports};
  assert_int_equal(meet(&first, 3), SKF_ERR_ARG);
  run.start = start, first.run = &run, run.team = &(skf_team){2, 2, send_to, receive_from, NULL};
  skf_runner *r;
  assert_int_equal(skf_runner_new(world, &run, &r, NULL), SKF_ERR_ARG);
}

/* Of several that fail at once the first is told, whoever has it. */
static void the_first_failure_is_told(void **state) {
  (void)state;
  skf_state on_ring[COUNT];
  const skf_run run = {COUNT, on_ring, 5, 0.1, bounce};
  memcpy(on_ring, start, sizeof on_ring);
  on_ring[5].position = on_ring[6].position = on_ring[7].position = v3(1, 0, 0); /* the force is infinite */
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    member first = {.run = &run};
    assert_int_equal(meet(&first, sizes[k]), SKF_ERR_CONVERGENCE);
    assert_int_equal(first.where.particle, 5);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shares_change_nothing),
      cmocka_unit_test(stops_change_nothing),
      cmocka_unit_test(failures_are_shared),
      cmocka_unit_test(the_first_failure_is_told),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
