/* SPDX-License-Identifier: MIT */
/* A run as bytes: the same for any number of processes that share it, and for any to go on with. The first of them
   writes and reads, the others send it their particles and get them from it. */
#include "core/alloc.h"
#include "core/vec3.h"
#include "motion/runner.h"
#include <string.h>

typedef skf_status (*writer)(void *user, const void *bytes, size_t n);
typedef skf_status (*reader)(void *user, void *bytes, size_t n);

/* What a saved run begins with. */
typedef struct place {
  uint64_t count, row_count, window, first, state_size, contacts;
} place;

static uint64_t contacts_in(const skf_runner *r) {
  uint64_t n = 0;
  for (int t = 0; t < r->threads; t++) n += r->logs[t].count;
  return n;
}

static size_t state_size(const skf_runner *r) { return r->mine ? skf_flight_state_size(r->flights[0]) : 0; }

/* The first member has a particle, if anybody has. */
static place place_of(const skf_runner *r, uint64_t contacts) {
  return (place){r->run.count, r->row_count, r->window, r->first, state_size(r), contacts};
}

/* Most bytes of a particle: its flight, what it waits with, its rows. */
static size_t most_bytes(const skf_runner *r) {
  return state_size(r) + sizeof(skf_pending) + r->window * sizeof(skf_state);
}

static size_t pack(const skf_runner *r, size_t i, char *bytes) {
  char *to = bytes;
  skf_flight_save(r->flights[i], to), to += state_size(r);
  memcpy(to, r->waiting + i, sizeof *r->waiting), to += sizeof *r->waiting;
  for (size_t k = 0; k < r->waiting[i].row; k++, to += sizeof *r->rows)
    memcpy(to, skf_runner_cell(r, i, k), sizeof *r->rows);
  return (size_t)(to - bytes);
}

static void unpack(skf_runner *r, size_t i, const char *bytes) {
  const char *from = bytes;
  skf_flight_load(r->flights[i], from), from += state_size(r);
  memcpy(r->waiting + i, from, sizeof *r->waiting), from += sizeof *r->waiting;
  for (size_t k = 0; k < r->waiting[i].row; k++, from += sizeof *r->rows)
    memcpy(skf_runner_cell(r, i, k), from, sizeof *r->rows);
  r->flown += r->waiting[i].row;
}

/* A particle's bytes from a file. */
static skf_status read_packed(const skf_runner *r, char *bytes, size_t *n, reader read, void *user) {
  size_t size = state_size(r);
  skf_pending wait;
  skf_status s = read(user, bytes, size);
  if (!s) s = read(user, &wait, sizeof wait);
  if (s) return s;
  if (wait.row > skf_runner_rows(r)) return SKF_ERR_PARSE;
  memcpy(bytes + size, &wait, sizeof wait), size += sizeof wait;
  *n = size + wait.row * sizeof *r->rows;
  return read(user, bytes + size, *n - size);
}

static skf_status send_packed(const skf_team *t, size_t to, const char *bytes, size_t n) {
  skf_status s = t->send(t->user, to, &n, sizeof n);
  return s ? s : t->send(t->user, to, bytes, n);
}

static skf_status receive_packed(const skf_team *t, size_t from, char *bytes, size_t *n, size_t most) {
  skf_status s = t->receive(t->user, from, n, sizeof *n);
  if (!s && *n > most) s = SKF_ERR_PARSE;
  return s ? s : t->receive(t->user, from, bytes, *n);
}

/* What the other members send. */
static skf_status send_saved(const skf_runner *r, char *bytes) {
  const skf_team *t = &r->team;
  uint64_t contacts = contacts_in(r);
  skf_status s = t->send(t->user, 0, &contacts, sizeof contacts);
  for (size_t i = 0; i < r->mine && !s; i++) s = send_packed(t, 0, bytes, pack(r, i, bytes));
  for (int k = 0; k < r->threads && !s; k++)
    for (size_t c = 0; c < r->logs[k].count && !s; c++)
      s = t->send(t->user, 0, r->logs[k].entries + c, sizeof(skf_log_entry));
  return s;
}

/* The contacts that wait; `counts`: how many each of the others has. */
static skf_status write_contacts(const skf_runner *r, const uint64_t *counts, writer write, void *user,
                                 skf_status before) {
  const skf_team *t = &r->team;
  skf_status s = before, lost = SKF_OK;
  for (int k = 0; k < r->threads && !s; k++)
    if (r->logs[k].count) s = write(user, r->logs[k].entries, r->logs[k].count * sizeof(skf_log_entry));
  for (size_t m = 1; m < t->size && !lost; m++)
    for (uint64_t k = 0; k < counts[m] && !lost; k++) {
      skf_log_entry e;
      lost = t->receive(t->user, m, &e, sizeof e);
      if (!s && !lost) s = write(user, &e, sizeof e);
    }
  return lost ? lost : s;
}

/* The first member's part: a failed write does not keep it from receiving what the others send. */
static skf_status write_saved(const skf_runner *r, char *bytes, uint64_t *counts, writer write, void *user) {
  const skf_team *t = &r->team;
  skf_status lost = SKF_OK;
  uint64_t contacts = contacts_in(r);
  for (size_t m = 1; m < t->size && !lost; m++) {
    lost = t->receive(t->user, m, counts + m, sizeof *counts);
    contacts += counts[m];
  }
  place p = place_of(r, contacts);
  skf_status s = lost ? lost : write(user, &p, sizeof p);
  for (size_t i = 0; i < r->run.count && !lost; i++) {
    size_t n = 0;
    if (i % t->size)
      lost = receive_packed(t, i % t->size, bytes, &n, most_bytes(r));
    else
      n = pack(r, i / t->size, bytes);
    if (!s && !lost) s = write(user, bytes, n);
  }
  return lost ? lost : write_contacts(r, counts, write, user, s);
}

skf_status skf_runner_save(const skf_runner *r, writer write, void *user) {
  char *bytes = skf_alloc(most_bytes(r), 1);
  uint64_t *counts = skf_alloc(r->team.size, sizeof *counts);
  skf_status s = skf_team_agree(&r->team, bytes && counts ? SKF_OK : SKF_ERR_NOMEM, NULL);
  if (!s) {
    s = r->team.rank > 0 ? send_saved(r, bytes) : write_saved(r, bytes, counts, write, user);
    s = skf_team_agree(&r->team, s, NULL);
  }
  skf_free(bytes), skf_free(counts);
  return s;
}

static skf_status read_place(const skf_runner *r, place *p, reader read, void *user) {
  place mine = place_of(r, 0);
  skf_status s = read(user, p, sizeof *p);
  if (s) return s;
  bool same = p->count == mine.count && p->row_count == mine.row_count && p->window == mine.window;
  return same && p->state_size == mine.state_size && p->first <= p->row_count ? SKF_OK : SKF_ERR_PARSE;
}

static skf_status receive_saved(skf_runner *r, char *bytes) {
  const skf_team *t = &r->team;
  size_t n;
  skf_status s = SKF_OK;
  for (size_t i = 0; i < r->mine && !s; i++) {
    s = receive_packed(t, 0, bytes, &n, most_bytes(r));
    if (!s) unpack(r, i, bytes);
  }
  return s;
}

/* The first member's part: where a read fails, the others get zeros, until all agree that it has failed. It keeps the
   contacts of all. */
static skf_status read_saved(skf_runner *r, char *bytes, uint64_t contacts, reader read, void *user) {
  const skf_team *t = &r->team;
  skf_status s = SKF_OK, lost = SKF_OK;
  for (size_t i = 0; i < r->run.count && !lost; i++) {
    size_t n = 0;
    if (!s) s = read_packed(r, bytes, &n, read, user);
    if (s) n = state_size(r) + sizeof(skf_pending), memset(bytes, 0, n);
    if (i % t->size)
      lost = send_packed(t, i % t->size, bytes, n);
    else if (!s)
      unpack(r, i / t->size, bytes);
  }
  for (uint64_t k = 0; k < contacts && !s && !lost; k++) {
    skf_log_entry e;
    s = read(user, &e, sizeof e);
    if (!s) s = skf_contact_log_add(r->logs, &e.contact, e.sequence);
  }
  return lost ? lost : s;
}

skf_status skf_runner_load(skf_runner *r, reader read, void *user) {
  const skf_team *t = &r->team;
  place p = {0};
  char *bytes = skf_alloc(most_bytes(r), 1);
  skf_status s = bytes ? SKF_OK : SKF_ERR_NOMEM;
  if (!s && t->rank == 0) s = read_place(r, &p, read, user);
  s = skf_team_agree(t, s, NULL);
  for (size_t m = 1; m < t->size && t->rank == 0 && !s; m++) s = t->send(t->user, m, &p, sizeof p);
  if (!s && t->rank > 0) s = t->receive(t->user, 0, &p, sizeof p);
  if (!s) {
    r->first = p.first, r->flown = 0;
    s = t->rank > 0 ? receive_saved(r, bytes) : read_saved(r, bytes, p.contacts, read, user);
    s = skf_team_agree(t, s, NULL);
  }
  if (!s && r->cluster) skf_cluster_resume(r->cluster);
  skf_free(bytes);
  return s;
}
