/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checkpoints: a run's state in FILE, what it has made so far in FILE.journal. */
#ifndef SKF_TOOLS_CHECKPOINT_H
#define SKF_TOOLS_CHECKPOINT_H

#include "team.h"

/* How a run is saved and loaded, see skf_runner_save and skf_runner_load. */
typedef struct checkpoint_kind {
  skf_status (*save)(const void *run, skf_status (*write)(void *user, const void *bytes, size_t n), void *user);
  skf_status (*load)(void *run, skf_status (*read)(void *user, void *bytes, size_t n), void *user);
} checkpoint_kind;

extern const checkpoint_kind checkpoint_of_runner; /* an skf_runner */

typedef struct checkpoint {
  const checkpoint_kind *kind;
  const char *path;   /* NULL: nothing is kept */
  bool anew;          /* forgets what the file held */
  double every, last; /* seconds between two; the clock when the last one was written */
  const team *crew;   /* the first process has the files */
  char journal_path[4096];
  size_t particles;
  uint64_t identity; /* of the scene and what flies in it */
  FILE *journal;
} checkpoint;

/* A number that differs between scenes: of the file's text, the starts and the forces there. */
uint64_t checkpoint_identity(const skf_scene *scene, const char *scene_path, const skf_world *world,
                             const skf_state *starts);

/* From --checkpoint, --resume and --every-seconds: paths, anew and every. Refuses the names of the scene and of what
   these options write. CLI_DONE, or another status after the message, as all of these. */
int checkpoint_options(checkpoint *c, const cli *line);

/* All processes call these two. */
/* Begins, or continues where the file says, after checking that it is about this run: fills the run and cuts the
   journal to its length then. *complete: the run was over and its outputs written; nothing else happens. */
int checkpoint_start(checkpoint *c, void *run, bool *complete);
/* Puts the journal on the disk, then the state, under its name only when it is whole. */
int checkpoint_save(checkpoint *c, const void *run);
/* Whether it is time for that. */
bool checkpoint_due(const checkpoint *c);
/* Notes that the outputs are written, and removes the journal. */
int checkpoint_complete(checkpoint *c);
void checkpoint_close(checkpoint *c);

/* An entry of another kind than those of particles, 'r' and 'c'. */
skf_status journal_put(checkpoint *c, char kind, const void *bytes, size_t n);
skf_status journal_row(checkpoint *c, double t, const skf_state *states);
skf_status journal_contact(checkpoint *c, const skf_contact *contact);
/* Hands everything in the journal on, in its order. */
skf_status journal_replay(checkpoint *c, const skf_run_sink *sink);

#endif
