/* SPDX-License-Identifier: MIT */
/* A run that several processes share. All of them go through the same windows; after each they agree on how it went,
   and the first one receives the others' rows and contacts (of sinks that have their own rows only the contacts). A run
   of one process sends nothing. */
#include "core/alloc.h"
#include "core/vec3.h"
#include "motion/runner.h"

skf_status skf_contact_log_add(skf_contact_log *log, const skf_contact *c, size_t sequence) {
  if (log->count == log->capacity) {
    size_t capacity = 2 * log->capacity + 16;
    skf_log_entry *more = skf_realloc(log->entries, capacity, sizeof *more);
    if (!more) return SKF_ERR_NOMEM;
    log->entries = more, log->capacity = capacity;
  }
  log->entries[log->count++] = (skf_log_entry){*c, sequence};
  return SKF_OK;
}

void skf_team_worse(skf_status *worst, skf_run_failure *where, skf_status status, skf_run_failure failure) {
  bool first = failure.t < where->t || (failure.t == where->t && failure.particle < where->particle);
  if (status == SKF_ERR_CONVERGENCE && first) *where = failure;
  if (status && (*worst == SKF_OK || *worst == SKF_ERR_CONVERGENCE)) *worst = status;
}

typedef struct word {
  skf_run_failure where;
  uint64_t status;
} word;

skf_status skf_team_agree(const skf_team *t, skf_status status, skf_run_failure *where) {
  word said = {where ? *where : (skf_run_failure){0, INFINITY}, (uint64_t)status}, other;
  skf_status s = SKF_OK;
  if (t->rank > 0) {
    s = t->send(t->user, 0, &said, sizeof said);
    if (!s) s = t->receive(t->user, 0, &said, sizeof said);
  } else {
    for (size_t m = 1; m < t->size && !s; m++) {
      s = t->receive(t->user, m, &other, sizeof other);
      if (!s) skf_team_worse(&status, &said.where, (skf_status)other.status, other.where);
    }
    said.status = (uint64_t)status;
    for (size_t m = 1; m < t->size && !s; m++) s = t->send(t->user, m, &said, sizeof said);
  }
  if (where) *where = said.where;
  return s ? s : (skf_status)said.status;
}

static skf_status send_window(skf_runner *r) {
  const skf_team *t = &r->team;
  skf_status s = SKF_OK;
  for (size_t k = 0; k < skf_runner_rows(r) && r->mine && !r->own && !s; k++)
    s = t->send(t->user, 0, r->rows + k * r->mine, r->mine * sizeof *r->rows);
  for (int i = 0; i < r->threads && !s; i++) {
    uint64_t count = r->logs[i].count;
    s = t->send(t->user, 0, &count, sizeof count);
    for (size_t k = 0; k < count && !s; k++) s = t->send(t->user, 0, r->logs[i].entries + k, sizeof(skf_log_entry));
    r->logs[i].count = 0;
  }
  uint64_t end = UINT64_MAX;
  return s ? s : t->send(t->user, 0, &end, sizeof end);
}

/* Contacts of member m. What does not fit into memory is received all the same: the others must go on. */
static skf_status receive_contacts(skf_runner *r, size_t m) {
  const skf_team *t = &r->team;
  skf_status lost = SKF_OK;
  for (;;) {
    uint64_t count;
    skf_status s = t->receive(t->user, m, &count, sizeof count);
    if (s || count == UINT64_MAX) return s ? s : lost;
    for (uint64_t k = 0; k < count && !s; k++) {
      skf_log_entry e;
      s = t->receive(t->user, m, &e, sizeof e);
      if (!s && !lost) lost = skf_contact_log_add(r->logs, &e.contact, e.sequence);
    }
    if (s) return s;
  }
}

static skf_status receive_window(skf_runner *r, size_t m) {
  const skf_team *t = &r->team;
  size_t share = skf_team_share(t, m, r->run.count);
  skf_status s = SKF_OK;
  for (size_t k = 0; k < skf_runner_rows(r) && share && !r->own && !s; k++) {
    s = t->receive(t->user, m, r->arrived, share * sizeof *r->arrived);
    for (size_t i = 0; i < share && !s; i++) r->rows[k * r->width + m + i * t->size] = r->arrived[i];
  }
  return s ? s : receive_contacts(r, m);
}

skf_status skf_runner_collect(skf_runner *r) {
  if (r->team.rank > 0) return send_window(r);
  skf_status worst = SKF_OK;
  for (size_t m = 1; m < r->team.size; m++) {
    skf_status s = receive_window(r, m);
    if (s) worst = s;
  }
  return worst;
}

skf_status skf_runner_approaches(const skf_runner *r, skf_approach *out) {
  const skf_team *t = &r->team;
  const skf_approach none = {NAN, {NAN, NAN, NAN}, NAN, NAN};
  size_t bodies = r->world->n;
  skf_status s = r->run.flight.approach ? SKF_OK : SKF_ERR_ARG;
  for (size_t i = 0; i < r->mine && !s; i++)
    for (size_t b = 0; b < bodies && !s; b++) {
      skf_approach a;
      if (skf_flight_approach(r->flights[i], b, &a)) a = none;
      if (t->rank > 0)
        s = t->send(t->user, 0, &a, sizeof a);
      else
        out[i * t->size * bodies + b] = a;
    }
  for (size_t i = 0; i < r->run.count && t->rank == 0 && !s; i++)
    for (size_t b = 0; b < bodies && i % t->size && !s; b++)
      s = t->receive(t->user, i % t->size, out + i * bodies + b, sizeof *out);
  return s;
}

skf_status skf_runner_reports(const skf_runner *r, skf_flight_report *reports) {
  const skf_team *t = &r->team;
  skf_status s = SKF_OK;
  for (size_t i = 0; i < r->mine && !s; i++) {
    skf_flight_report report = skf_flight_get_report(r->flights[i]);
    if (t->rank > 0)
      s = t->send(t->user, 0, &report, sizeof report);
    else
      reports[i * t->size] = report;
  }
  for (size_t i = 0; i < r->run.count && t->rank == 0 && !s; i++)
    if (i % t->size) s = t->receive(t->user, i % t->size, reports + i, sizeof *reports);
  return s;
}
