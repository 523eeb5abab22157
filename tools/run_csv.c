/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `skelfield simulate` wrote, read back for pictures. */
#include "run_csv.h"
#include "core/number.h"
#include "core/vec3.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIELDS = 16 };

typedef struct table {
  const char *path, *header;
  char *line;
  size_t capacity;
  long number;
  char *fields[FIELDS];
  int field_count;
} table;

static int bad(const table *t, const char *what) {
  return cli_fail(CLI_BAD, "%s:%ld: %s, expected the columns %s", t->path, t->number, what, t->header);
}

/* The same of a row whose columns are in order. */
static int odd(const table *t, const char *what, const char *wanted) {
  return cli_fail(CLI_BAD, "%s:%ld: %s, expected %s", t->path, t->number, what, wanted);
}

/* Cuts the line at its commas; a field in double quotes may hold commas and doubled quotes. */
static void split(table *t) {
  char *in = t->line;
  for (t->field_count = 0; t->field_count < FIELDS;) {
    bool quoted = *in == '"';
    char *out = in += quoted;
    t->fields[t->field_count++] = out;
    while (*in && (quoted || *in != ',')) {
      if (quoted && *in == '"' && *++in != '"')
        quoted = false;
      else
        *out++ = *in++;
    }
    bool more = *in == ',';
    *out = 0;
    if (!more) return;
    in++;
  }
}

/* 1: a row is in fields; 0: the end; -1 after the message. */
static int next_row(table *t, FILE *f, int columns) {
  for (;;) {
    ssize_t n = getline(&t->line, &t->capacity, f);
    if (n < 0) return ferror(f) ? cli_fail(-1, "%s: %s", t->path, strerror(errno)) : 0;
    t->number++;
    while (n > 0 && (t->line[n - 1] == '\n' || t->line[n - 1] == '\r')) t->line[--n] = 0;
    if (n == 0) continue;
    if (memchr(t->line, 0, (size_t)n)) return bad(t, "a NUL byte"), -1;
    split(t);
    if (t->field_count < columns) return bad(t, "too few columns"), -1;
    return 1;
  }
}

static bool numbers(const table *t, int first, int count, double *out) {
  for (int i = 0; i < count; i++) {
    size_t used;
    const char *text = t->fields[first + i];
    if (skf_number_read(text, &used, out + i) != SKF_OK || text[used]) return false;
  }
  return true;
}

static bool state_of(const table *t, int x, int v, run_state *out) {
  double a[7];
  if (!numbers(t, 0, 1, a) || !numbers(t, x, 3, a + 1) || !numbers(t, v, 3, a + 4)) return false;
  *out = (run_state){a[0], {a[1], a[2], a[3]}, {a[4], a[5], a[6]}};
  return true;
}

static size_t find(const run_data *run, const char *name) {
  size_t i = 0;
  while (i < run->particle_count && strcmp(run->particles[i].name, name) != 0) i++;
  return i;
}

/* Makes room for one more after n items, doubling at powers of two. */
static void *room(void *items, size_t n, size_t size) {
  if (n & (n - 1)) return items;
  return realloc(items, (n ? 2 * n : 1) * size);
}

static int add_state(const table *t, void *to) {
  run_data *run = to;
  run_state state;
  if (!state_of(t, 2, 5, &state)) return bad(t, "malformed, missing or non-finite number");
  size_t i = find(run, t->fields[1]);
  if (i == run->particle_count) {
    run_particle *more = room(run->particles, i, sizeof *more);
    if (!more) return cli_fail(CLI_FAILED, "%s: out of memory", t->path);
    run->particles = more;
    run->particles[run->particle_count++] = (run_particle){.states = NULL};
    snprintf(run->particles[i].name, sizeof run->particles[i].name, "%s", t->fields[1]);
    if (strlen(t->fields[1]) >= sizeof run->particles[i].name)
      return odd(t, "a name of more than 63 bytes", "a shorter one");
  }
  run_particle *p = run->particles + i;
  run_state *more = room(p->states, p->count, sizeof *more);
  if (!more) return cli_fail(CLI_FAILED, "%s: out of memory", t->path);
  p->states = more;
  p->states[p->count++] = state;
  return CLI_DONE;
}

static int add_contact(const table *t, void *to) {
  run_data *run = to;
  run_contact contact = {.particle = find(run, t->fields[1])};
  if (!state_of(t, 3, 9, &contact.state)) return bad(t, "malformed, missing or non-finite number");
  snprintf(contact.outcome, sizeof contact.outcome, "%.15s", t->fields[12]);
  run_contact *more = room(run->contacts, run->contact_count, sizeof *more);
  if (!more) return cli_fail(CLI_FAILED, "%s: out of memory", t->path);
  run->contacts = more;
  run->contacts[run->contact_count++] = contact;
  return CLI_DONE;
}

/* add: takes a row. */
static int read_table(const char *path, const char *header, int columns, int (*add)(const table *, void *), void *to) {
  FILE *f = fopen(path, "r");
  if (!f) return cli_fail(CLI_BAD, "%s: %s", path, strerror(errno));
  table t = {.path = path, .header = header};
  int status = CLI_DONE, got = next_row(&t, f, 1);
  if (got == 0) t.number = 1;
  if (got >= 0) {
    char line[256] = "";
    for (int i = 0; got && i < columns && i < t.field_count; i++)
      snprintf(line + strlen(line), sizeof line - strlen(line), "%s%.30s", i ? "," : "", t.fields[i]);
    if (strcmp(line, header) != 0) status = bad(&t, "this is not its header");
  }
  while (!status && got > 0 && (got = next_row(&t, f, columns)) > 0) status = add(&t, to);
  free(t.line);
  fclose(f);
  return got < 0 ? CLI_BAD : status;
}

int run_read(const char *path, const char *contacts, run_data *out) {
  *out = (run_data){NULL, 0, NULL, 0};
  int status = path ? read_table(path, "t,particle,x,y,z,vx,vy,vz", 8, add_state, out) : CLI_DONE;
  if (!status && contacts)
    status = read_table(contacts, "t,particle,body,x,y,z,nx,ny,nz,vx,vy,vz,outcome", 13, add_contact, out);
  if (status) run_free(out);
  return status;
}

void run_free(run_data *run) {
  for (size_t i = 0; i < run->particle_count; i++) free(run->particles[i].states);
  free(run->particles), free(run->contacts);
  *run = (run_data){NULL, 0, NULL, 0};
}

typedef struct bodies_reader {
  const skf_scene *scene;
  run_bodies_data *run;
} bodies_reader;

static int add_pose(const table *t, void *to) {
  const bodies_reader *r = to;
  run_bodies_data *run = r->run;
  double a[14];
  if (!numbers(t, 0, 1, a) || !numbers(t, 2, 13, a + 1)) return bad(t, "malformed, missing or non-finite number");
  run_pose p = {a[0], {a[1], a[2], a[3]}, {a[4], a[5], a[6], a[7]}, {a[8], a[9], a[10]}, {a[11], a[12], a[13]}};
  double norm = sqrt(p.q[0] * p.q[0] + p.q[1] * p.q[1] + p.q[2] * p.q[2] + p.q[3] * p.q[3]);
  if (!(fabs(norm - 1) < 1e-6)) return odd(t, "an attitude that is no unit quaternion", "norm 1");
  size_t body = 0, i = 0;
  while (body < r->scene->body_count && strcmp(r->scene->bodies[body].name, t->fields[1]) != 0) body++;
  if (body == r->scene->body_count) return odd(t, "a body that the scene does not have", "a run of this scene");
  while (i < run->count && run->bodies[i].body != body) i++;
  if (i == run->count) {
    run_body *more = room(run->bodies, i, sizeof *more);
    if (!more) return cli_fail(CLI_FAILED, "%s: out of memory", t->path);
    run->bodies = more, run->bodies[run->count++] = (run_body){.body = body};
  }
  run_body *b = run->bodies + i;
  if (b->count && !(b->poses[b->count - 1].t < p.t))
    return odd(t, "a time that is not after the body's last row", "rows by time");
  run_pose *more = room(b->poses, b->count, sizeof *more);
  if (!more) return cli_fail(CLI_FAILED, "%s: out of memory", t->path);
  b->poses = more, b->poses[b->count++] = p;
  return CLI_DONE;
}

int run_bodies_read(const char *path, const skf_scene *scene, run_bodies_data *out) {
  *out = (run_bodies_data){NULL, 0};
  if (!path) return CLI_DONE;
  int status =
      read_table(path, "t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz", 15, add_pose, &(bodies_reader){scene, out});
  if (status) run_bodies_free(out);
  return status;
}

void run_bodies_free(run_bodies_data *run) {
  for (size_t i = 0; i < run->count; i++) free(run->bodies[i].poses);
  free(run->bodies);
  *run = (run_bodies_data){NULL, 0};
}
