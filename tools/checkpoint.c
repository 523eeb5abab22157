/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows and contacts go to a journal while the run lasts, and from there to the outputs when it ends: so the outputs of
   an interrupted run are the bytes of one that was not. */
#include "checkpoint.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char magic[16] = "skelfield ckpt 1";

/* What the file begins with; the runner's state and the sum of all of it follow. */
typedef struct head {
  char magic[16], version[32];
  uint64_t identity, journal; /* bytes */
  uint64_t complete;
} head;

/* A file with the sum of its bytes so far. */
typedef struct summed {
  FILE *file;
  uint64_t sum;
} summed;

static uint64_t add(uint64_t h, const void *bytes, size_t n) {
  const unsigned char *p = bytes;
  for (; n >= 8; n -= 8, p += 8) {
    uint64_t word;
    memcpy(&word, p, 8);
    h = (h ^ word) * 0x9e3779b97f4a7c15u, h ^= h >> 32;
  }
  for (size_t i = 0; i < n; i++) h = (h ^ p[i]) * 0x9e3779b97f4a7c15u, h ^= h >> 32;
  return h;
}

static skf_status put(void *user, const void *bytes, size_t n) {
  summed *f = user;
  f->sum = add(f->sum, bytes, n);
  return fwrite(bytes, 1, n, f->file) == n ? SKF_OK : SKF_ERR_IO;
}

static skf_status get(void *user, void *bytes, size_t n) {
  summed *f = user;
  if (fread(bytes, 1, n, f->file) != n) return SKF_ERR_IO;
  f->sum = add(f->sum, bytes, n);
  return SKF_OK;
}

static skf_status save_runner(const void *run, skf_status (*write)(void *, const void *, size_t), void *user) {
  return skf_runner_save(run, write, user);
}
static skf_status load_runner(void *run, skf_status (*read)(void *, void *, size_t), void *user) {
  return skf_runner_load(run, read, user);
}
const checkpoint_kind checkpoint_of_runner = {save_runner, load_runner};

uint64_t checkpoint_identity(const skf_scene *scene, const char *scene_path, const skf_world *world,
                             const skf_state *starts) {
  enum { PROBES = 1000 };
  const skf_simulation *s = &scene->simulation;
  const double numbers[] = {s->t_end, s->output_every, s->tolerance, s->contact, s->restitution, s->friction};
  uint64_t h = add(1, numbers, sizeof numbers);
  char block[4096];
  FILE *f = fopen(scene_path, "rb");
  for (size_t n; f && (n = fread(block, 1, sizeof block, f)) > 0;) h = add(h, block, n);
  if (f) fclose(f);
  h = add(h, starts, scene->particle_count * sizeof *starts);
  for (size_t i = 0; i < scene->particle_count && i < PROBES; i++) { /* meshes are in other files */
    double u = skf_world_at(world, 0, starts[i].position, NULL);
    h = add(h, &u, sizeof u);
  }
  return h;
}

static int broken(const char *what) { return cli_fail(CLI_FAILED, "%s: %s", what, strerror(errno)); }

static int name_journal(checkpoint *c) {
  int n = snprintf(c->journal_path, sizeof c->journal_path, "%s.journal", c->path);
  if (n < (int)sizeof c->journal_path) return CLI_DONE;
  return cli_fail(CLI_BAD, "%s: expected a shorter name", c->path);
}

int checkpoint_options(checkpoint *c, const cli *line) {
  const char *keep = cli_value(line, "checkpoint"), *resume = cli_value(line, "resume");
  struct stat about;
  if (keep && resume && strcmp(keep, resume) != 0)
    return cli_fail(CLI_BAD, "--checkpoint %s and --resume %s, expected the same file", keep, resume);
  c->path = keep ? keep : resume, c->every = 60;
  if (!c->path)
    return cli_given(line, "every-seconds") ? cli_fail(CLI_BAD, "--every-seconds needs --checkpoint FILE") : CLI_DONE;
  c->anew = !resume || (keep && stat(resume, &about) != 0);
  int status = name_journal(c);
  if (status) return status;
  if (cli_names(line, c->path) || cli_names(line, c->journal_path))
    return cli_fail(CLI_BAD, "--checkpoint and another argument name the same file");
  return cli_number(line, "every-seconds", 0, &c->every);
}

static int begin(checkpoint *c) {
  if (unlink(c->path) && errno != ENOENT) return broken(c->path); /* it is about another journal */
  c->journal = fopen(c->journal_path, "w+b");
  return c->journal ? CLI_DONE : broken(c->journal_path);
}

static int foreign(const checkpoint *c, const char *what, const char *wanted) {
  return cli_fail(CLI_BAD, "%s: %s, expected %s", c->path, what, wanted);
}

static int read_head(checkpoint *c, summed *f, head *h) {
  if (get(f, h, sizeof *h) || memcmp(h->magic, magic, sizeof magic) != 0)
    return foreign(c, "this is no checkpoint", "one that skelfield simulate --checkpoint wrote");
  h->version[sizeof h->version - 1] = 0;
  if (strcmp(h->version, skf_version()) != 0)
    return foreign(c, "a checkpoint of another version of skelfield", skf_version());
  if (h->identity != c->identity)
    return foreign(c, "a checkpoint of another scene",
                   "the scene that it was written for, unchanged, and --approach as then");
  return CLI_DONE;
}

/* After the runner's part, which ended with s. */
static int end_state(checkpoint *c, summed *f, skf_status s) {
  uint64_t sum = f->sum, kept;
  if (s == SKF_ERR_NOMEM) return cli_fail(CLI_FAILED, "out of memory");
  if (s || get(f, &kept, sizeof kept) || kept != sum) return foreign(c, "the checkpoint is damaged", "a whole one");
  return CLI_DONE;
}

static int open_state(checkpoint *c, summed *f, head *h) {
  f->file = fopen(c->path, "rb");
  if (!f->file) return cli_fail(CLI_BAD, "%s: %s, expected a checkpoint", c->path, strerror(errno));
  int status = read_head(c, f, h);
  return status == CLI_DONE && h->complete ? end_state(c, f, SKF_OK) : status;
}

static int open_journal(checkpoint *c, const head *h) {
  c->journal = fopen(c->journal_path, "r+b");
  if (!c->journal)
    return cli_fail(CLI_BAD, "%s: %s, expected it beside the checkpoint", c->journal_path, strerror(errno));
  if (fseeko(c->journal, 0, SEEK_END) || (uint64_t)ftello(c->journal) < h->journal)
    return cli_fail(CLI_BAD, "%s: shorter than the checkpoint says, expected the journal that belongs to it",
                    c->journal_path);
  if (ftruncate(fileno(c->journal), (off_t)h->journal) || fseeko(c->journal, 0, SEEK_END))
    return broken(c->journal_path);
  return CLI_DONE;
}

static int resume(checkpoint *c, void *run, bool *complete) {
  head h = {.complete = 0};
  summed f = {NULL, 1};
  bool leads = team_leads(c->crew);
  int status = team_agree(c->crew, leads ? open_state(c, &f, &h) : CLI_DONE);
  *complete = status == CLI_DONE && team_agree(c->crew, h.complete != 0);
  if (status == CLI_DONE && !*complete) {
    skf_status s = c->kind->load(run, get, &f);
    if (leads) status = end_state(c, &f, s);
    if (leads && status == CLI_DONE) status = open_journal(c, &h);
    status = team_agree(c->crew, status);
  }
  if (f.file) fclose(f.file);
  if (leads && *complete) unlink(c->journal_path); /* a kill may have left it */
  return status;
}

static head head_of(const checkpoint *c, uint64_t journal, bool complete) {
  head h = {.identity = c->identity, .journal = journal, .complete = complete};
  memcpy(h.magic, magic, sizeof magic);
  snprintf(h.version, sizeof h.version, "%s", skf_version());
  return h;
}

/* A file beside the checkpoint, which gets its name when all of it is on the disk. */
static void temp_name(const checkpoint *c, char name[4096 + 8]) { snprintf(name, 4096 + 8, "%s.new", c->path); }

static int begin_writing(checkpoint *c, summed *f, const head *h) {
  char temp[4096 + 8];
  temp_name(c, temp);
  f->file = fopen(temp, "wb");
  if (!f->file || put(f, h, sizeof *h)) return broken(temp);
  return CLI_DONE;
}

/* What has been put is whole, or the old file stays. */
static int end_writing(checkpoint *c, summed *f, bool good) {
  char temp[4096 + 8];
  temp_name(c, temp);
  uint64_t sum = f->sum;
  good = good && !put(f, &sum, sizeof sum) && fflush(f->file) == 0 && fsync(fileno(f->file)) == 0;
  if (fclose(f->file) || !good || rename(temp, c->path)) {
    int status = broken(c->path);
    unlink(temp);
    return status;
  }
  return CLI_DONE;
}

static int begin_saving(checkpoint *c, summed *f) {
  if (fflush(c->journal) || fsync(fileno(c->journal))) return broken(c->journal_path);
  head h = head_of(c, (uint64_t)ftello(c->journal), false);
  return begin_writing(c, f, &h);
}

int checkpoint_start(checkpoint *c, void *run, bool *complete) {
  bool leads = team_leads(c->crew);
  *complete = false;
  if (!team_agree(c->crew, leads && c->anew)) {
    c->last = cli_seconds();
    return resume(c, run, complete);
  }
  int status = team_agree(c->crew, leads ? begin(c) : CLI_DONE);
  return status == CLI_DONE ? checkpoint_save(c, run) : status;
}

bool checkpoint_due(const checkpoint *c) { return c->path && cli_seconds() - c->last >= c->every; }

int checkpoint_save(checkpoint *c, const void *run) {
  summed f = {NULL, 1};
  int status = team_agree(c->crew, team_leads(c->crew) ? begin_saving(c, &f) : CLI_DONE);
  bool good = status == CLI_DONE && c->kind->save(run, put, &f) == SKF_OK;
  if (f.file) {
    int ended = end_writing(c, &f, good);
    if (status == CLI_DONE) status = ended;
  }
  c->last = cli_seconds();
  return team_agree(c->crew, status);
}

int checkpoint_complete(checkpoint *c) {
  head h = head_of(c, 0, true);
  summed f = {NULL, 1};
  int status = begin_writing(c, &f, &h);
  if (f.file) status = end_writing(c, &f, status == CLI_DONE);
  if (status == CLI_DONE && unlink(c->journal_path)) status = broken(c->journal_path);
  return status;
}

void checkpoint_close(checkpoint *c) {
  if (c->journal) fclose(c->journal);
  c->journal = NULL;
}

/* An entry: 'r', t, six numbers a particle; or 'c' and a contact. */

skf_status journal_put(checkpoint *c, char kind, const void *bytes, size_t n) {
  bool good = putc(kind, c->journal) != EOF && fwrite(bytes, 1, n, c->journal) == n;
  if (!good) broken(c->journal_path);
  return good ? SKF_OK : SKF_ERR_IO;
}

skf_status journal_row(checkpoint *c, double t, const skf_state *states) {
  skf_status s = journal_put(c, 'r', &t, sizeof t);
  for (size_t i = 0; i < c->particles && !s; i++)
    if (fwrite(&states[i].position, sizeof(skf_vec3), 2, c->journal) != 2) broken(c->journal_path), s = SKF_ERR_IO;
  return s;
}

skf_status journal_contact(checkpoint *c, const skf_contact *contact) {
  return journal_put(c, 'c', contact, sizeof *contact);
}

static skf_status replay_row(checkpoint *c, skf_state *states, const skf_run_sink *sink) {
  double t;
  bool good = fread(&t, sizeof t, 1, c->journal) == 1;
  for (size_t i = 0; i < c->particles && good; i++) {
    states[i].t = t;
    good = fread(&states[i].position, sizeof(skf_vec3), 2, c->journal) == 2;
  }
  return good ? sink->row(sink->user, t, states) : SKF_ERR_IO;
}

skf_status journal_replay(checkpoint *c, const skf_run_sink *sink) {
  skf_state *states = calloc(c->particles, sizeof *states);
  if (!states) return SKF_ERR_NOMEM;
  skf_status s = fflush(c->journal) || fseeko(c->journal, 0, SEEK_SET) ? SKF_ERR_IO : SKF_OK;
  for (int kind; !s && (kind = getc(c->journal)) != EOF;) {
    skf_contact contact;
    if (kind == 'r')
      s = replay_row(c, states, sink);
    else if (kind == 'c' && fread(&contact, sizeof contact, 1, c->journal) == 1)
      s = sink->contact(sink->user, &contact);
    else
      s = SKF_ERR_IO;
  }
  free(states);
  return s;
}
