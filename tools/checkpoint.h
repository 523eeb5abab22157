/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checkpoints: a run's state in FILE, what it has made so far in FILE.journal. */
#ifndef SKF_TOOLS_CHECKPOINT_H
#define SKF_TOOLS_CHECKPOINT_H

#include "team.h"

typedef struct checkpoint {
  const char *path;
  const team *crew; /* the first process has the files */
  char journal_path[4096];
  size_t particles;
  uint64_t identity; /* of the scene and what flies in it */
  FILE *journal;
} checkpoint;

/* A number that differs between scenes: of the file's text, the starts and the forces there. */
uint64_t checkpoint_identity(const skf_scene *scene, const char *scene_path, const skf_world *world,
                             const skf_state *starts);

/* All processes call these three. */
/* Begins anew, forgetting what the files held. CLI_DONE, or another status after the message, as all of these. */
int checkpoint_begin(checkpoint *c);
/* Continues where the file says, after checking that it is about this run: fills the runner and cuts the journal to its
   length then. *complete: the run was over and its outputs written; nothing else happens. */
int checkpoint_resume(checkpoint *c, skf_runner *runner, bool *complete);
/* Puts the journal on the disk, then the state, under its name only when it is whole. */
int checkpoint_save(checkpoint *c, const skf_runner *runner);
/* Notes that the outputs are written, and removes the journal. */
int checkpoint_complete(checkpoint *c);
void checkpoint_close(checkpoint *c);

skf_status journal_row(checkpoint *c, double t, const skf_state *states);
skf_status journal_contact(checkpoint *c, const skf_contact *contact);
/* Hands everything in the journal on, in its order. */
skf_status journal_replay(checkpoint *c, const skf_run_sink *sink);

#endif
