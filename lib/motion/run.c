/* SPDX-License-Identifier: MIT */
/* Many particles: windows of output rows, particles in parallel within each. A run can stop between any two steps, and
   go on with the same bits. */
#include "core/alloc.h"
#include "core/vec3.h"
#include "motion/runner.h"
#include <stdlib.h>
#include <string.h>

/* At most about this many states (56 bytes each) are held at a time: what is interrupted loses little. */
#define HELD 65536
/* A run is cut into about this many windows, so that it can be watched, and what is done is written. */
#define WINDOWS 64
/* Particles that fly side by side are handed to a thread in flocks of this many, or fewer where threads would starve.
 */
#define FLOCK 256

/* Rows at start + k every, and one at t_end; a multiple that is t_end up to rounding is t_end. */
static size_t count_rows(const skf_run *run, double start) {
  double span = run->t_end - start;
  if (!(span > 0)) return 1;
  if (!(run->every > 0) || run->every >= span) return 2;
  double k = span / run->every, whole = floor(k);
  if (k - whole > 4e-16 * k) return (size_t)whole + 2; /* 4e-16: the rounding of the quotient */
  return (size_t)whole + 1;
}

static double row_time(const skf_runner *r, size_t k) {
  if (k + 1 == r->row_count) return r->row_count == 1 ? r->start : r->run.t_end;
  return r->start + (double)k * r->run.every;
}

static bool stopped(skf_runner *r) {
  int stop;
#pragma omp atomic read
  stop = r->stop;
  return stop != 0;
}

/* Tells how much is done, `part` of a row more than is counted; the thread that finds nobody else telling does. */
static void watch(skf_runner *r, double part) {
  if (!r->progress || !r->progress->report || !omp_test_lock(&r->watching)) return;
  size_t flown;
#pragma omp atomic read
  flown = r->flown;
  double n = (double)r->mine, done = ((double)r->first * n + (double)flown + part) / ((double)r->row_count * n);
  if (r->progress->report(r->progress->user, fmin(done, 1))) {
#pragma omp atomic write
    r->stop = 1;
  }
  omp_unset_lock(&r->watching);
}

/* Flies one particle to time t; contacts up to then go to the log. */
static skf_status fly_to(skf_runner *r, size_t i, double t, skf_contact_log *log) {
  skf_pending *wait = r->waiting + i;
  double from, to, begin = NAN;
  for (;;) {
    skf_flight_span(r->flights[i], &from, &to);
    if (wait->held && wait->contact.t <= t) {
      skf_status s = skf_contact_log_add(log, &wait->contact, wait->sequence++);
      if (s) return s;
      wait->held = false;
    }
    if (to >= t) return SKF_OK;
    if (isnan(begin)) begin = to;
    watch(r, (to - begin) / (t - begin));
    if (stopped(r)) return SKF_ERR_CANCELLED;
    skf_status s = skf_flight_step(r->flights[i], &wait->contact, &wait->held);
    if (s) return r->failed_at[i] = to, s;
    wait->contact.particle = skf_team_particle(&r->team, i);
  }
}

/* The state at row k of the window, once the flight is there. */
static skf_status take_row(skf_runner *r, size_t i, size_t k) {
  double t = row_time(r, r->first + k);
  skf_status s = skf_flight_at(r->flights[i], t, skf_runner_cell(r, i, k));
  if (s) return s;
  r->waiting[i].row++;
#pragma omp atomic update
  r->flown++;
  return SKF_OK;
}

static skf_status fly_window(skf_runner *r, size_t i) {
  skf_contact_log *log = r->logs + omp_get_thread_num();
  for (size_t k; (k = r->waiting[i].row) < skf_runner_rows(r);) {
    skf_status s = fly_to(r, i, row_time(r, r->first + k), log);
    if (!s) s = take_row(r, i, k);
    if (s) return s;
  }
  return SKF_OK;
}

/* The row that the slowest of m particles comes to next. */
static size_t slowest(const skf_runner *r, size_t i, size_t m) {
  size_t row = SIZE_MAX;
  for (size_t j = i; j < i + m; j++) row = r->waiting[j].row < row ? r->waiting[j].row : row;
  return row;
}

/* Contacts of m particles that have waited for time t go to the log. */
static skf_status log_held(skf_runner *r, size_t first, size_t m, double t) {
  skf_status s = SKF_OK;
  for (size_t i = first; i < first + m && !s; i++) {
    skf_pending *wait = r->waiting + i;
    if (!wait->held || wait->contact.t > t) continue;
    wait->held = false;
    s = skf_contact_log_add(r->logs + omp_get_thread_num(), &wait->contact, wait->sequence++);
  }
  return s;
}

/* A flock's contacts up to the time of its next row go to the log, later ones wait. */
typedef struct ear {
  skf_runner *r;
  size_t first;
  double t;
} ear;

static skf_status hear(void *user, size_t i, const skf_contact *c) {
  const ear *e = user;
  skf_runner *r = e->r;
  skf_pending *wait = r->waiting + e->first + i;
  skf_contact of = *c;
  of.particle = skf_team_particle(&r->team, e->first + i);
  if (c->t <= e->t) return skf_contact_log_add(r->logs + omp_get_thread_num(), &of, wait->sequence++);
  wait->contact = of, wait->held = true;
  return SKF_OK;
}

/* Flies m particles side by side to row k of the window. */
static skf_status fly_together(skf_runner *r, size_t i, size_t m, size_t k) {
  size_t pieces = WINDOWS / r->row_count + 1; /* so that it can be stopped */
  double t = row_time(r, r->first + k), before = r->first + k > 0 ? row_time(r, r->first + k - 1) : r->start;
  ear e = {r, i, t};
  skf_status held = log_held(r, i, m, t);
  if (held) return held;
  for (size_t p = 1; p <= pieces; p++) {
    double part = (double)p / (double)pieces, until = p < pieces ? before + (t - before) * part : t;
    skf_status s = skf_flights_pass(r->flights + i, m, until, r->status + i, &(skf_listener){hear, &e});
    watch(r, (double)m * part);
    if (s) return s;
    if (stopped(r)) return SKF_ERR_CANCELLED;
  }
  return SKF_OK;
}

/* The same as fly_window for m particles from i on. */
static void fly_flock(skf_runner *r, size_t i, size_t m) {
  for (size_t j = i; j < i + m; j++) r->status[j] = SKF_OK;
  for (size_t k = slowest(r, i, m); k < skf_runner_rows(r); k++) {
    double from, to;
    skf_status s = fly_together(r, i, m, k);
    for (size_t j = i; j < i + m; j++) {
      skf_flight_span(r->flights[j], &from, &to);
      if (r->status[j] == SKF_ERR_CONVERGENCE) r->failed_at[j] = to;
      if (s) r->status[j] = s;
      if (!r->status[j] && r->waiting[j].row == k) r->status[j] = take_row(r, j, k);
    }
    if (s) return;
  }
}

/* A contact of the cluster waits until the rows before it are taken. */
static skf_status hold(void *user, size_t i, const skf_contact *c) {
  skf_pending *wait = ((skf_runner *)user)->waiting + i;
  wait->contact = *c, wait->contact.particle = i, wait->held = true;
  return SKF_OK;
}

/* All particles to time t. */
static skf_status fly_cluster_to(skf_runner *r, double t, size_t *failed) {
  double begin = skf_cluster_time(r->cluster), now;
  skf_status s = log_held(r, 0, r->mine, t);
  while (!s && (now = skf_cluster_time(r->cluster)) < t) {
    watch(r, (double)r->mine * (now - begin) / (t - begin));
    if (stopped(r)) return SKF_ERR_CANCELLED;
    s = skf_cluster_step(r->cluster, &(skf_listener){hold, r}, failed);
    if (!s) s = log_held(r, 0, r->mine, t);
  }
  return s;
}

/* Particles that attract each other to the end of the window. */
static void fly_cluster(skf_runner *r) {
  size_t failed = 0;
  skf_status s = SKF_OK;
  for (size_t i = 0; i < r->mine; i++) r->status[i] = SKF_OK;
  for (size_t k = slowest(r, 0, r->mine); k < skf_runner_rows(r) && !s; k++) {
    s = fly_cluster_to(r, row_time(r, r->first + k), &failed);
    if (!s) skf_cluster_compare(r->cluster);
    for (size_t i = 0; i < r->mine && !s; i++)
      if (r->waiting[i].row == k) s = take_row(r, i, k);
  }
  r->status[failed] = s, r->failed_at[failed] = skf_cluster_time(r->cluster);
}

/* All particles to the end of the window. */
static void fly_all(skf_runner *r) {
  size_t n = r->mine, share = n / (4 * (size_t)r->threads) + 1, flock = share < FLOCK ? share : FLOCK;
  if (n == 0) return;
  if (r->cluster) {
    fly_cluster(r);
    return;
  }
  if (n > 1 && skf_flight_in_flock(r->flights[0])) {
#pragma omp parallel for schedule(dynamic, 1) num_threads(r->threads) if (n > 1)
    for (size_t i = 0; i < n; i += flock) fly_flock(r, i, n - i < flock ? n - i : flock);
  } else {
#pragma omp parallel for schedule(dynamic, 1) num_threads(r->threads) if (n > 1)
    for (size_t i = 0; i < n; i++) r->status[i] = fly_window(r, i);
  }
}

static int by_time(const void *a, const void *b) {
  const skf_log_entry *x = a, *y = b;
  if (x->contact.t != y->contact.t) return x->contact.t < y->contact.t ? -1 : 1;
  if (x->contact.particle != y->contact.particle) return x->contact.particle < y->contact.particle ? -1 : 1;
  return (x->sequence > y->sequence) - (x->sequence < y->sequence);
}

/* All threads' contacts of the window in one list, in order. */
static skf_status merge(skf_runner *r, skf_contact_log *all) {
  *all = (skf_contact_log){0};
  for (int t = 0; t < r->threads; t++) {
    for (size_t k = 0; k < r->logs[t].count; k++) {
      skf_status s = skf_contact_log_add(all, &r->logs[t].entries[k].contact, r->logs[t].entries[k].sequence);
      if (s) return s;
    }
    r->logs[t].count = 0;
  }
  if (all->count) qsort(all->entries, all->count, sizeof *all->entries, by_time);
  return SKF_OK;
}

/* Hands contacts and rows on, in order of time, up to but not including the time `before`; s: whether they are here. */
static skf_status deliver(skf_runner *r, skf_status s, double before) {
  skf_contact_log all = {0};
  if (!s) s = merge(r, &all);
  if (r->own) s = skf_team_agree(&r->team, s, NULL); /* all hand on the same rows, or none does */
  size_t c = 0;
  for (size_t k = 0; k < skf_runner_rows(r) && !s; k++) {
    double t = row_time(r, r->first + k);
    if (t >= before) break;
    for (; c < all.count && all.entries[c].contact.t <= t && !s; c++)
      if (r->sink->contact) s = r->sink->contact(r->sink->user, &all.entries[c].contact);
    if (!s && r->sink->row) s = r->sink->row(r->sink->user, t, r->rows + k * r->width);
  }
  skf_free(all.entries);
  return s;
}

/* The worst of a window, of all members: cancelled, out of memory, or the particle that failed first. */
static skf_status verdict(const skf_runner *r, skf_status before, skf_run_failure *where) {
  skf_status worst = before;
  *where = (skf_run_failure){0, INFINITY};
  for (size_t i = 0; i < r->mine; i++)
    skf_team_worse(&worst, where, r->status[i], (skf_run_failure){skf_team_particle(&r->team, i), r->failed_at[i]});
  return skf_team_agree(&r->team, worst, where);
}

skf_status skf_runner_fly(skf_runner *r, const skf_run_sink *sink, const skf_progress *progress,
                          skf_run_failure *failure) {
  skf_run_failure where;
  skf_status s = SKF_OK; /* of this member's sink, if it has one */
  r->sink = sink, r->progress = progress, r->stop = 0;
  if (sink && sink->own) r->own = true, r->width = r->mine, r->stride = 1;
  while (r->first < r->row_count) {
    if (!s) fly_all(r);
    skf_status bad = verdict(r, s, &where);
    if (bad == SKF_ERR_CONVERGENCE && failure) *failure = where;
    if (bad && bad != SKF_ERR_CONVERGENCE) return bad;
    s = skf_runner_collect(r);
    if (r->own || r->team.rank == 0) s = deliver(r, s, where.t);
    if (bad) return skf_team_agree(&r->team, s ? s : bad, NULL);
    r->first += skf_runner_rows(r), r->flown = 0;
    for (size_t i = 0; i < r->mine; i++) r->waiting[i].row = 0;
  }
  return skf_team_agree(&r->team, s, NULL);
}

static skf_status launch(skf_runner *r, skf_run_failure *failure) {
  size_t n = r->mine;
#pragma omp parallel for schedule(static) num_threads(r->threads) if (n > 1000)
  for (size_t i = 0; i < n; i++) {
    const skf_state *start = r->run.start + skf_team_particle(&r->team, i);
    r->status[i] = skf_flight_new(r->world, &r->run.flight, start, r->flights + i);
    if (!r->status[i]) skf_flight_watch_until(r->flights[i], r->run.t_end);
    r->failed_at[i] = r->start;
    if (!r->status[i] && start->t != r->start) r->status[i] = SKF_ERR_ARG;
  }
  skf_run_failure where;
  skf_status s = verdict(r, SKF_OK, &where);
  if (s == SKF_ERR_CONVERGENCE && failure) *failure = where;
  return s;
}

static bool allocate(skf_runner *r) {
  size_t n = r->mine, most = r->run.count / r->team.size + 1;
  r->flights = skf_alloc(n, sizeof *r->flights);
  r->waiting = skf_alloc(n, sizeof *r->waiting);
  r->status = skf_alloc(n, sizeof *r->status);
  r->failed_at = skf_alloc(n, sizeof *r->failed_at);
  r->rows = skf_alloc(r->width * r->window, sizeof *r->rows);
  r->arrived = skf_alloc(r->team.size > 1 ? most : 0, sizeof *r->arrived);
  r->logs = skf_alloc((size_t)r->threads, sizeof *r->logs);
  return r->flights && r->waiting && r->status && r->failed_at && r->rows && r->arrived && r->logs;
}

void skf_runner_free(skf_runner *r) {
  if (!r) return;
  skf_cluster_free(r->cluster);
  for (size_t i = 0; r->flights && i < r->mine; i++) skf_flight_free(r->flights[i]);
  for (int t = 0; r->logs && t < r->threads; t++) skf_free(r->logs[t].entries);
  skf_free(r->flights);
  skf_free(r->waiting);
  skf_free(r->status);
  skf_free(r->failed_at);
  skf_free(r->rows);
  skf_free(r->arrived);
  skf_free(r->logs);
  omp_destroy_lock(&r->watching);
  skf_free(r);
}

skf_status skf_runner_new(const skf_world *world, const skf_run *run, skf_runner **out, skf_run_failure *failure) {
  *out = NULL;
  double start = run->count ? run->start[0].t : run->t_end;
  if (!isfinite(run->t_end) || run->t_end < start || !(run->every >= 0)) return SKF_ERR_ARG;
  const skf_team team = run->team ? *run->team : (skf_team){.size = 1};
  if (team.rank >= team.size || (team.size > 1 && (!team.send || !team.receive))) return SKF_ERR_ARG;
  skf_runner *r = skf_alloc(1, sizeof *r);
  if (!r) return skf_team_agree(&team, SKF_ERR_NOMEM, NULL);
  omp_init_lock(&r->watching);
  r->world = world, r->run = *run, r->start = start, r->team = team;
  r->mine = skf_team_share(&r->team, r->team.rank, run->count);
  r->width = r->team.rank ? r->mine : run->count, r->stride = r->team.rank ? 1 : r->team.size;
  r->row_count = run->count ? count_rows(run, start) : 0;
  size_t most = run->count ? HELD / run->count + 1 : 1;
  r->window = r->row_count / WINDOWS + 1;
  if (r->window > most) r->window = most;
  r->threads = omp_get_max_threads();
  skf_status s = skf_team_agree(&team, allocate(r) ? SKF_OK : SKF_ERR_NOMEM, NULL);
  if (!s) s = launch(r, failure);
  if (!s && run->gm && run->count) {
    s = team.size > 1 || run->flight.approach
            ? SKF_ERR_UNSUPPORTED
            : skf_cluster_new(world, r->flights, r->mine, run->gm, run->softening, &r->cluster);
    if (s == SKF_ERR_CONVERGENCE && failure) *failure = (skf_run_failure){0, start};
  }
  if (s) return skf_runner_free(r), s;
  return *out = r, SKF_OK;
}

skf_status skf_run_all(const skf_world *world, const skf_run *run, const skf_run_sink *sink,
                       const skf_progress *progress, skf_flight_report *reports, skf_run_failure *failure) {
  skf_runner *r;
  if (run->count == 0) return SKF_OK;
  if (reports) memset(reports, 0, run->count * sizeof *reports);
  skf_status s = skf_runner_new(world, run, &r, failure);
  if (!s) s = skf_runner_fly(r, sink, progress, failure);
  if (r && reports) {
    skf_status told = skf_runner_reports(r, reports);
    if (!s) s = told;
  }
  skf_runner_free(r);
  return s;
}
