/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "team.h"
#include "adapt/module.h"
#include "cli_private.h"
#include <stdlib.h>
#include <string.h>

/* What launchers tell the processes that they start. */
static const struct {
  const char *size, *rank, *neighbours;
} launchers[] = {
    {"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_LOCAL_SIZE"}, /* Open MPI */
    {"PMI_SIZE", "PMI_RANK", "MPI_LOCALNRANKS"},                                    /* MPICH, Slurm with PMI-2 */
    {"SLURM_STEP_NUM_TASKS", "PMIX_RANK", NULL},                                    /* Slurm with PMIx */
};

/* A number >= 0 of the environment, or `none`. */
static int number(const char *name, int none) {
  const char *text = name ? getenv(name) : NULL;
  if (!text) return none;
  char *end;
  long n = strtol(text, &end, 10);
  return *text && !*end && n >= 0 && n < 1 << 24 ? (int)n : none;
}

static size_t launcher(void) {
  const char *off = getenv("SKELFIELD_MPI");
  size_t i = 0, n = sizeof launchers / sizeof *launchers;
  if (off && strcmp(off, "off") == 0) return n;
  while (i < n && (number(launchers[i].size, 0) < 1 || number(launchers[i].rank, -1) < 0)) i++;
  return i;
}

int team_launched(int *rank) {
  size_t i = launcher();
  if (i == sizeof launchers / sizeof *launchers) return *rank = 0, 1;
  *rank = number(launchers[i].rank, 0);
  return number(launchers[i].size, 1);
}

int team_neighbours(void) {
  size_t i = launcher();
  int n = i < sizeof launchers / sizeof *launchers ? number(launchers[i].neighbours, 1) : 1;
  return n > 0 ? n : 1;
}

static bool wants_stop(void *user) {
  const team *t = user;
  return t->stop && t->stop(t->user);
}

static skf_status send_to(void *user, size_t to, const void *bytes, size_t n) {
  const team *t = user;
  return t->module->send(t->self, to, bytes, n);
}

static skf_status receive_from(void *user, size_t from, void *bytes, size_t n) {
  const team *t = user;
  return t->module->receive(t->self, from, bytes, n);
}

int team_join(team *t) {
  *t = (team){.link = {.size = 1}, .size = 1};
  int rank, size = team_launched(&rank);
  if (size == 1) return CLI_DONE;
#ifdef SKF_HAVE_MPI
  char error[256];
  t->module = skf_module_symbol("skelfield-mpi.so", "team_module_mpi", error);
  if (!t->module) return cli_fail(CLI_BAD, "one of %d processes of an MPI launcher: %s", size, error);
#else
  return cli_fail(CLI_BAD,
                  "one of %d processes of an MPI launcher, but this build has no MPI, expected one process "
                  "(SKELFIELD_MPI=off lets each work by itself)",
                  size);
#endif
  t->hooks = (team_hooks){wants_stop, cli_interrupted, t};
  t->self = t->module->join(&t->rank, &t->size, &t->hooks);
  if (!t->self || t->size != size || t->rank != rank)
    return cli_fail(CLI_BAD, "one of %d processes of an MPI launcher that is not the one of this build's MPI", size);
  t->link = (skf_team){(size_t)rank, (size_t)size, send_to, receive_from, t};
  return CLI_DONE;
}

void team_leave(team *t) {
  if (t->self) t->module->leave(t->self);
  t->self = NULL;
}

bool team_leads(const team *t) { return t->rank == 0; }

/* One message from each to the first process, then one from that to each; `take` sees what arrives. */
static int exchange(const team *t, void *said, size_t n, void (*take)(void *said, const void *heard, int from)) {
  const skf_team *l = &t->link;
  char heard[512];
  skf_status s = SKF_OK;
  if (t->rank > 0) {
    s = l->send(l->user, 0, said, n);
    return s || l->receive(l->user, 0, said, n) ? CLI_FAILED : CLI_DONE;
  }
  for (size_t m = 1; m < l->size && !s; m++) {
    s = l->receive(l->user, m, heard, n);
    if (!s) take(said, heard, (int)m);
  }
  for (size_t m = 1; m < l->size && !s; m++) s = l->send(l->user, m, said, n);
  return s ? CLI_FAILED : CLI_DONE;
}

static void take_status(void *said, const void *heard, int from) {
  (void)from;
  const int *other = heard;
  int *worst = said;
  if (*other > *worst) *worst = *other;
}

int team_agree(const team *t, int status) {
  int broken = exchange(t, &status, sizeof status, take_status);
  return broken ? broken : status;
}

typedef struct greeting {
  uint64_t identity;
  int status;
  char text[400]; /* of the last message, which only the first process prints */
} greeting;

static void take_greeting(void *said, const void *heard, int from) {
  greeting *mine = said;
  const greeting *other = heard;
  if (mine->status != CLI_DONE) return;
  if (other->status != CLI_DONE)
    mine->status = cli_fail(other->status, "process %d: %.*s", from, (int)sizeof other->text - 1, other->text);
  else if (other->identity != mine->identity)
    mine->status = cli_fail(CLI_BAD,
                            "process %d flies another scene, or on another kind of processor, expected the same for "
                            "all (SKELFIELD_MPI=off lets each work by itself)",
                            from);
}

int team_meet(const team *t, int status, uint64_t identity) {
  greeting g = {.identity = identity, .status = status};
  snprintf(g.text, sizeof g.text, "%s", cli_muted());
  int broken = exchange(t, &g, sizeof g, take_greeting);
  return broken ? broken : g.status;
}

void team_begin(team *t, bool (*stop)(void *user), void *user) { t->stop = stop, t->user = user; }

void team_end(team *t) {
  t->stop = NULL;
  if (t->self && !team_lost(t)) t->module->calm(t->self);
}

bool team_poll(const team *t, bool stop) { return t->self ? t->module->poll(t->self, stop) : stop; }

bool team_lost(const team *t) { return t->self && t->module->lost(t->self); }

void team_hurry(const team *t, double seconds) {
  if (t->self) t->module->hurry(t->self, seconds);
}
