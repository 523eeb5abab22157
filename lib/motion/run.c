/* SPDX-License-Identifier: MIT */
/* Many particles: windows of output rows, particles in parallel within each. */
#include "motion/flight.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <stdlib.h>
#include <string.h>
#include <omp.h>

/* At most about this many states (56 bytes each) are held at a time: what is interrupted loses little. */
#define HELD 65536
/* A run is cut into about this many windows, so that it can be watched, and what is done is written. */
#define WINDOWS 64
/* Particles that fly side by side are handed to a thread in flocks of this many, or fewer where threads would starve.
 */
#define FLOCK 256

typedef struct log_entry {
  skf_contact contact;
  size_t sequence; /* of the particle's contacts */
} log_entry;

/* Contacts that one thread has seen in this window. */
typedef struct contact_log {
  log_entry *entries;
  size_t count, capacity;
} contact_log;

/* What a particle waits with: a contact later than the window. */
typedef struct pending {
  skf_contact contact;
  bool held;
  size_t sequence;
} pending;

typedef struct runner {
  const skf_world *world;
  const skf_run *run;
  const skf_run_sink *sink;
  const skf_progress *progress;
  double start;
  size_t row_count;
  skf_flight **flights;
  pending *waiting;
  skf_state *rows; /* rows of the window, each of run->count states */
  contact_log *logs;
  int threads;
  skf_status *status; /* of each particle in this window */
  double *failed_at;
  int stop;
} runner;

/* Rows at start + k every, and one at t_end; a multiple that is t_end up to rounding is t_end. */
static size_t count_rows(const skf_run *run, double start) {
  double span = run->t_end - start;
  if (!(span > 0)) return 1;
  if (!(run->every > 0) || run->every >= span) return 2;
  double k = span / run->every, whole = floor(k);
  if (k - whole > 4e-16 * k) return (size_t)whole + 2; /* 4e-16: the rounding of the quotient */
  return (size_t)whole + 1;
}

static double row_time(const runner *r, size_t k) {
  if (k + 1 == r->row_count) return r->row_count == 1 ? r->start : r->run->t_end;
  return r->start + (double)k * r->run->every;
}

static skf_status keep(contact_log *log, const skf_contact *c, size_t sequence) {
  if (log->count == log->capacity) {
    size_t capacity = 2 * log->capacity + 16;
    log_entry *more = skf_realloc(log->entries, capacity, sizeof *more);
    if (!more) return SKF_ERR_NOMEM;
    log->entries = more, log->capacity = capacity;
  }
  log->entries[log->count++] = (log_entry){*c, sequence};
  return SKF_OK;
}

static bool stopped(runner *r) {
  int stop;
#pragma omp atomic read
  stop = r->stop;
  return stop != 0;
}

/* Flies one particle to time t; contacts up to then go to the log. */
static skf_status fly_to(runner *r, size_t i, double t, contact_log *log) {
  pending *wait = r->waiting + i;
  double from, to;
  for (;;) {
    skf_flight_span(r->flights[i], &from, &to);
    if (wait->held && wait->contact.t <= t) {
      skf_status s = keep(log, &wait->contact, wait->sequence++);
      if (s) return s;
      wait->held = false;
    }
    if (to >= t) return SKF_OK;
    if (stopped(r)) return SKF_ERR_CANCELLED;
    skf_status s = skf_flight_step(r->flights[i], &wait->contact, &wait->held);
    if (s) return r->failed_at[i] = to, s;
    wait->contact.particle = i;
  }
}

static void watch(runner *r, double done) {
  if (omp_get_thread_num() != 0 || !r->progress || !r->progress->report) return;
  if (r->progress->report(r->progress->user, done)) {
#pragma omp atomic write
    r->stop = 1;
  }
}

static skf_status fly_window(runner *r, size_t i, size_t first, size_t count) {
  contact_log *log = r->logs + omp_get_thread_num();
  size_t n = r->run->count;
  for (size_t k = 0; k < count; k++) {
    double t = row_time(r, first + k);
    skf_status s = fly_to(r, i, t, log);
    if (!s) s = skf_flight_at(r->flights[i], t, r->rows + k * n + i);
    if (s) return s;
    double share = ((double)i + ((double)k + 1) / (double)count) / (double)n;
    watch(r, ((double)first + (double)count * share) / (double)r->row_count);
  }
  return SKF_OK;
}

/* The same for m particles from i on, side by side. */
static void fly_flock(runner *r, size_t i, size_t m, size_t first, size_t count) {
  size_t n = r->run->count, pieces = WINDOWS / r->row_count + 1; /* so that it can be stopped */
  skf_status *status = r->status + i;
  double before = r->row_count > 1 && first > 0 ? row_time(r, first - 1) : r->start;
  for (size_t j = 0; j < m; j++) status[j] = SKF_OK;
  for (size_t k = 0; k < count; k++) {
    double t = row_time(r, first + k), from, to;
    skf_status s = SKF_OK;
    for (size_t p = 1; p <= pieces && !s; p++) {
      double share = ((double)i + (double)m * ((double)k + (double)p / (double)pieces) / (double)count) / (double)n;
      double until = p < pieces ? before + (t - before) * (double)p / (double)pieces : t;
      s = skf_flights_pass(r->flights + i, m, until, status);
      watch(r, ((double)first + (double)count * share) / (double)r->row_count);
      if (stopped(r)) s = SKF_ERR_CANCELLED;
    }
    for (size_t j = 0; j < m; j++) {
      skf_flight_span(r->flights[i + j], &from, &to);
      if (status[j] == SKF_ERR_CONVERGENCE) r->failed_at[i + j] = to;
      if (s) status[j] = s;
      if (!status[j]) status[j] = skf_flight_at(r->flights[i + j], t, r->rows + k * n + i + j);
    }
    before = t;
  }
}

static int by_time(const void *a, const void *b) {
  const log_entry *x = a, *y = b;
  if (x->contact.t != y->contact.t) return x->contact.t < y->contact.t ? -1 : 1;
  if (x->contact.particle != y->contact.particle) return x->contact.particle < y->contact.particle ? -1 : 1;
  return (x->sequence > y->sequence) - (x->sequence < y->sequence);
}

/* All threads' contacts of the window in one list, in order. */
static skf_status merge(runner *r, contact_log *all) {
  *all = (contact_log){0};
  for (int t = 0; t < r->threads; t++) {
    for (size_t k = 0; k < r->logs[t].count; k++) {
      skf_status s = keep(all, &r->logs[t].entries[k].contact, r->logs[t].entries[k].sequence);
      if (s) return s;
    }
    r->logs[t].count = 0;
  }
  if (all->count) qsort(all->entries, all->count, sizeof *all->entries, by_time);
  return SKF_OK;
}

/* Hands contacts and rows on, in order of time, up to but not including the time `before`. */
static skf_status deliver(runner *r, size_t first, size_t count, double before) {
  contact_log all;
  skf_status s = merge(r, &all);
  size_t c = 0;
  for (size_t k = 0; k < count && !s; k++) {
    double t = row_time(r, first + k);
    if (t >= before) break;
    for (; c < all.count && all.entries[c].contact.t <= t && !s; c++)
      if (r->sink->contact) s = r->sink->contact(r->sink->user, &all.entries[c].contact);
    if (!s && r->sink->row) s = r->sink->row(r->sink->user, t, r->rows + k * r->run->count);
  }
  skf_free(all.entries);
  return s;
}

/* The worst of a window: cancelled, out of memory, or the particle that failed first. */
static skf_status verdict(const runner *r, skf_run_failure *failure) {
  skf_status worst = SKF_OK;
  skf_run_failure first = {0, INFINITY};
  for (size_t i = 0; i < r->run->count; i++) {
    skf_status s = r->status[i];
    if (s == SKF_ERR_CONVERGENCE && r->failed_at[i] < first.t) first = (skf_run_failure){i, r->failed_at[i]};
    if (s && (worst == SKF_OK || worst == SKF_ERR_CONVERGENCE)) worst = s;
  }
  if (worst == SKF_ERR_CONVERGENCE && failure) *failure = first;
  return worst;
}

static skf_status fly_all(runner *r, size_t window, skf_run_failure *failure) {
  size_t n = r->run->count;
  for (size_t first = 0; first < r->row_count; first += window) {
    size_t count = window < r->row_count - first ? window : r->row_count - first;
    if (skf_flight_in_flock(r->flights[0])) {
      size_t share = n / (4 * (size_t)r->threads) + 1, flock = share < FLOCK ? share : FLOCK;
#pragma omp parallel for schedule(dynamic, 1) if (n > 1)
      for (size_t i = 0; i < n; i += flock) fly_flock(r, i, n - i < flock ? n - i : flock, first, count);
    } else {
#pragma omp parallel for schedule(dynamic, 1) if (n > 1)
      for (size_t i = 0; i < n; i++) r->status[i] = fly_window(r, i, first, count);
    }
    skf_run_failure where = {0, INFINITY};
    skf_status bad = verdict(r, &where);
    if (bad == SKF_ERR_CONVERGENCE && failure) *failure = where;
    if (bad && bad != SKF_ERR_CONVERGENCE) return bad;
    skf_status s = deliver(r, first, count, where.t);
    if (s || bad) return s ? s : bad;
  }
  return SKF_OK;
}

static skf_status launch(runner *r, skf_run_failure *failure) {
  for (size_t i = 0; i < r->run->count; i++) {
    const skf_state *at = r->run->start + i;
    if (at->t != r->start) return SKF_ERR_ARG;
    skf_status s = skf_flight_new(r->world, &r->run->flight, at, r->flights + i);
    if (s == SKF_ERR_CONVERGENCE && failure) *failure = (skf_run_failure){i, r->start};
    if (s) return s;
  }
  return SKF_OK;
}

static bool allocate(runner *r, size_t window) {
  size_t n = r->run->count;
  r->threads = omp_get_max_threads();
  r->flights = skf_alloc(n, sizeof *r->flights);
  r->waiting = skf_alloc(n, sizeof *r->waiting);
  r->status = skf_alloc(n, sizeof *r->status);
  r->failed_at = skf_alloc(n, sizeof *r->failed_at);
  r->rows = skf_alloc(n * window, sizeof *r->rows);
  r->logs = skf_alloc((size_t)r->threads, sizeof *r->logs);
  return r->flights && r->waiting && r->status && r->failed_at && r->rows && r->logs;
}

static void release(runner *r) {
  for (size_t i = 0; r->flights && i < r->run->count; i++) skf_flight_free(r->flights[i]);
  for (int t = 0; r->logs && t < r->threads; t++) skf_free(r->logs[t].entries);
  skf_free(r->flights);
  skf_free(r->waiting);
  skf_free(r->status);
  skf_free(r->failed_at);
  skf_free(r->rows);
  skf_free(r->logs);
}

skf_status skf_run_all(const skf_world *world, const skf_run *run, const skf_run_sink *sink,
                       const skf_progress *progress, skf_flight_report *reports, skf_run_failure *failure) {
  size_t n = run->count;
  if (n == 0) return SKF_OK;
  runner r = {.world = world, .run = run, .sink = sink, .progress = progress, .start = run->start[0].t};
  if (!isfinite(run->t_end) || run->t_end < r.start || !(run->every >= 0)) return SKF_ERR_ARG;
  r.row_count = count_rows(run, r.start);
  size_t window = r.row_count / WINDOWS + 1, most = HELD / n + 1;
  if (window > most) window = most;
  skf_status s = allocate(&r, window) ? launch(&r, failure) : SKF_ERR_NOMEM;
  if (!s) s = fly_all(&r, window, failure);
  for (size_t i = 0; i < n && reports && r.flights; i++)
    reports[i] = r.flights[i] ? skf_flight_get_report(r.flights[i]) : (skf_flight_report){0};
  release(&r);
  return s;
}
