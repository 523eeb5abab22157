/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Processes that an MPI launcher has started together. MPI itself stands in a module, which is opened only then. */
#ifndef SKF_TOOLS_TEAM_H
#define SKF_TOOLS_TEAM_H

#include "cli.h"
#include <stdint.h>

/* What the module calls while it waits for the others. */
typedef struct team_hooks {
  bool (*stop)(void *user); /* this process wants the round of flight to end */
  bool (*interrupted)(void);
  void *user;
} team_hooks;

typedef struct team_module {
  void *(*join)(int *rank, int *size, const team_hooks *hooks); /* NULL when MPI fails */
  skf_status (*send)(void *self, size_t to, const void *bytes, size_t n);
  skf_status (*receive)(void *self, size_t from, void *bytes, size_t n);
  bool (*poll)(void *self, bool stop);       /* tells the others, once; true when this or another one wants to stop */
  void (*calm)(void *self);                  /* all of them, after the round: forgets it */
  bool (*lost)(const void *self);            /* another one does not answer */
  void (*hurry)(void *self, double seconds); /* from now on one that does not answer for so long is lost */
  void (*leave)(void *self);                 /* frees self */
} team_module;

typedef struct team {
  int rank, size;
  skf_team link; /* for skf_run; of size 1 for a process by itself */
  const team_module *module;
  void *self;
  team_hooks hooks;
  bool (*stop)(void *user); /* set while the processes fly: whether this one wants to stop */
  void *user;
} team;

/* Rank and number of the processes that the launcher's environment tells; 0 and 1 without a launcher, and where
   SKELFIELD_MPI is "off". */
int team_launched(int *rank);
/* How many of them run on this machine; at least 1. */
int team_neighbours(void);

/* Joins the others. CLI_DONE, or another status after the message. */
int team_join(team *t);
void team_leave(team *t);
bool team_leads(const team *t);

/* The worst status of all, the same for all of them. */
int team_agree(const team *t, int status);
/* The same, before the work begins; the first process says what was wrong with another one. `identity` must be that of
   all. */
int team_meet(const team *t, int status, uint64_t identity);

/* Between them all processes fly. */
void team_begin(team *t, bool (*stop)(void *user), void *user);
void team_end(team *t);
/* Called while flying, now and then: whether to stop, as this one or another wants to. */
bool team_poll(const team *t, bool stop);
bool team_lost(const team *t);
/* From now on another one that does not answer for so long is lost; of 0 seconds all are. */
void team_hurry(const team *t, double seconds);

#endif
