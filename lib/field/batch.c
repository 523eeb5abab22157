/* SPDX-License-Identifier: MIT */
/* Elements gathered in tiles; blocks of points, and for each block one tile after the other. */
#include "field/batch.h"
#include "core/alloc.h"
#include "core/sum.h"
#include <omp.h>
#include <string.h>

skf_form skf_batch_form_of(const skf_batch_ops *ops, const skf_prepared *e) {
  skf_kernel_type type = e->kernel.type;
  skf_shape at = e->primitive.shape;
  skf_form form = SKF_FORM_COUNT;
  if (e->weight || !e->moderate) return form;
  if (!(fabs(e->strength) < 1e100)) return form; /* its product with a finite value is finite */
#define X(name, kernel, shape, fits)                                                                                   \
  if (form == SKF_FORM_COUNT && type == (kernel) && at == (shape) && fits(e)) form = SKF_FORM_##name;
  SKF_BATCH_FORMS(X)
#undef X
  return form < SKF_FORM_COUNT && ops->form[form].columns ? form : SKF_FORM_COUNT;
}

static void fill(const skf_batch_form *form, const skf_prepared *e, double *column, size_t j) {
  double row[SKF_ROW_MAX];
  size_t columns = (size_t)(form->pack(e, row + 1) - row);
  row[0] = form->inner ? 1 : e->strength;
  for (size_t k = 0; k < columns; k++)
    for (size_t i = j; i < SKF_TILE; i++) column[k * SKF_TILE + i] = k || i == j ? row[k] : 0;
}

/* The reach of each tile and of each group. */
static skf_status reach_out(skf_batch *b) {
  size_t groups = (b->tiles + SKF_GROUP - 1) / SKF_GROUP;
  if (!(b->group = skf_alloc(groups, sizeof *b->group))) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < groups; i++) b->group[i] = box_empty();
  for (size_t i = 0; i < b->tiles; i++) {
    skf_tile *t = b->tile + i;
    t->reach = box_empty();
    for (size_t j = 0; j < t->count; j++) t->reach = box_join(t->reach, skf_sparse_reach(t->element[j]));
    b->group[i / SKF_GROUP] = box_join(b->group[i / SKF_GROUP], t->reach);
  }
  return SKF_OK;
}

/* Within a form the elements keep their order unless their supports are finite. */
skf_status skf_batch_new(const skf_batch_ops *ops, const skf_prepared *elements, size_t count, skf_batch *out) {
  size_t of[SKF_FORM_COUNT + 1] = {0}, tiles = 0, columns = 0;
  for (size_t i = 0; i < count; i++) of[skf_batch_form_of(ops, elements + i)]++;
  for (int f = 0; f <= SKF_FORM_COUNT; f++) {
    size_t n = (of[f] + SKF_TILE - 1) / SKF_TILE;
    tiles += n;
    if (f < SKF_FORM_COUNT) columns += n * ops->form[f].columns * SKF_TILE;
  }
  *out = (skf_batch){
      .ops = ops, .tile = skf_alloc(tiles, sizeof(skf_tile)), .columns = skf_alloc(columns, sizeof(double))};
  if (!out->tile || !out->columns) return skf_batch_free(out), SKF_ERR_NOMEM;
  double *column = out->columns;
  skf_tile *next = out->tile, *open[SKF_FORM_COUNT + 1];
  for (int f = 0; f <= SKF_FORM_COUNT; f++) {
    size_t size = f < SKF_FORM_COUNT ? ops->form[f].columns * SKF_TILE : 0;
    open[f] = next;
    for (size_t n = (of[f] + SKF_TILE - 1) / SKF_TILE; n > 0; n--, column += size)
      *next++ = (skf_tile){.form = (skf_form)f, .column = size ? column : NULL};
  }
  bool sparse;
  skf_sparse_key *order = skf_sparse_order(elements, count, ops != &skf_batch_scalar,
                                           &sparse); /* the closed forms keep the bits of single points */
  if (!order) return skf_batch_free(out), SKF_ERR_NOMEM;
  out->tiles = tiles;
  out->elements = count;
  for (size_t i = 0; i < count; i++) {
    const skf_prepared *e = elements + order[i].index;
    skf_form f = skf_batch_form_of(ops, e);
    skf_tile *t = open[f];
    t->element[t->count] = e;
    if (t->column) fill(ops->form + f, e, t->column, t->count);
    if (++t->count == SKF_TILE) open[f]++;
  }
  skf_free(order);
  skf_status s = sparse ? reach_out(out) : SKF_OK;
  if (s) skf_batch_free(out);
  return s;
}

/* The first tile from the i-th on whose elements may not be 0 all over a box. */
static size_t next_tile(const skf_batch *b, size_t i, const skf_box *box) {
  while (b->group && i < b->tiles) {
    if (i % SKF_GROUP == 0 && skf_sparse_apart(b->group + i / SKF_GROUP, box))
      i += SKF_GROUP;
    else if (skf_sparse_apart(&b->tile[i].reach, box))
      i++;
    else
      break;
  }
  return i < b->tiles ? i : b->tiles;
}

void skf_batch_free(skf_batch *b) {
  skf_free(b->tile);
  skf_free(b->columns);
  skf_free(b->group);
  *b = (skf_batch){.tiles = 0};
}

static void closed(const skf_prepared *e, skf_vec3 x, double out[4]) {
  skf_value v = {.F = 0};
  skf_element_value(e, x, 1, &v);
  out[0] = e->strength * v.F, out[1] = e->strength * v.g.x, out[2] = e->strength * v.g.y, out[3] = e->strength * v.g.z;
}

static void add_closed(const skf_tile *t, size_t n, const double *const p[3], skf_batch_sum *sum) {
  for (size_t j = 0; j < t->count; j++)
    for (size_t i = 0; i < n; i++) {
      double part[4];
      closed(t->element[j], v3(p[0][i], p[1][i], p[2][i]), part);
      for (int k = 0; k < 4; k++) sum_add_to(sum->s[k] + i, sum->low[k] + i, part[k]);
    }
}

static void total(size_t n, const skf_batch_sum *sum, int k, double *out) {
  const double *F = sum->s[0], *s = sum->s[k], *low = sum->low[k];
  for (size_t i = 0; i < n; i++) {
    double all = s[i] + low[i], kept = s[i] - s[i] == 0 ? all : s[i];
    out[i] = k == 0 || F[i] - F[i] == 0 ? kept : 0;
  }
}

const skf_batch_ops skf_batch_scalar = {.total = total};

const skf_batch_ops *skf_batch_get(skf_isa isa) {
#ifdef SKF_HAVE_AVX512
  if (isa == SKF_ISA_AVX512) return &skf_batch_avx512;
#endif
#ifdef SKF_HAVE_AVX2
  if (isa == SKF_ISA_AVX2) return &skf_batch_avx2;
#endif
  (void)isa;
  return &skf_batch_scalar;
}

typedef struct job {
  const skf_batch *batch;
  const double *const *p;
  double *out[4]; /* any may be NULL */
} job;

/* The last few points, fewer than SKF_BATCH_PAD, the last one again as padding. (No memcpy: its call would take
   longer.) */
static void pad(const job *j, size_t from, size_t n, double room[3][SKF_BATCH_PAD], const double *p[3]) {
  for (int k = 0; k < 3; k++) {
    for (size_t i = 0; i < SKF_BATCH_PAD; i++) room[k][i] = j->p[k][from + (i < n ? i : n - 1)];
    p[k] = room[k];
  }
}

void skf_batch_add(const skf_batch *b, size_t n, size_t all, const double *const p[3], skf_batch_sum *sum, bool first) {
  skf_box box = b->group ? skf_sparse_around(n, p) : (skf_box){{0, 0, 0}, {0, 0, 0}};
  size_t i = next_tile(b, 0, &box);
  if (first && (i == b->tiles || !b->tile[i].column)) memset(sum, 0, sizeof *sum), first = false;
  for (; i < b->tiles; i = next_tile(b, i + 1, &box), first = false) {
    const skf_tile *t = b->tile + i;
    if (t->column)
      b->ops->form[t->form].add(t, all, p, sum, first);
    else
      add_closed(t, n, p, sum);
  }
}

/* n points at p, padded to m for the vector forms */
static void sum_block(const job *j, size_t from, size_t n, size_t m, const double *const p[3]) {
  skf_batch_sum sum;
  const skf_batch *b = j->batch;
  skf_batch_add(b, n, m, p, &sum, true);
  for (int k = 0; k < 4; k++)
    if (j->out[k]) b->ops->total(n, &sum, k, j->out[k] + from);
}

static void sum_range(const job *j, size_t from, size_t n) {
  double room[3][SKF_BATCH_PAD];
  const double *p[3];
  size_t end = from + n, step;
  for (; end - from >= SKF_BATCH_PAD; from += step) {
    step = end - from < SKF_BATCH ? (end - from) / SKF_BATCH_PAD * SKF_BATCH_PAD : SKF_BATCH;
    const double *const at[3] = {j->p[0] + from, j->p[1] + from, j->p[2] + from};
    sum_block(j, from, step, step, at);
  }
  if (from == end) return;
  pad(j, from, end - from, room, p);
  sum_block(j, from, end - from, SKF_BATCH_PAD, p);
}

/* One element: no sum, straight into the outputs but for those that are missing and the last few points. */
static void one_range(const job *j, size_t from, size_t n) {
  const skf_tile *t = j->batch->tile;
  void (*const one)(const skf_tile *, size_t, const double *const[3], double *const[4]) =
      j->batch->ops->form[t->form].one;
  double room[3][SKF_BATCH_PAD], spare[4][SKF_BATCH], *out[4];
  const double *p[3];
  size_t end = from + n, step, most = j->out[0] && j->out[1] && j->out[2] && j->out[3] ? n : SKF_BATCH;
  for (; end - from >= SKF_BATCH_PAD; from += step) {
    step = end - from < most ? (end - from) / SKF_BATCH_PAD * SKF_BATCH_PAD : most / SKF_BATCH_PAD * SKF_BATCH_PAD;
    for (int k = 0; k < 3; k++) p[k] = j->p[k] + from;
    for (int k = 0; k < 4; k++) out[k] = j->out[k] ? j->out[k] + from : spare[k];
    one(t, step, p, out);
  }
  if (from == end) return;
  pad(j, from, end - from, room, p);
  for (int k = 0; k < 4; k++) out[k] = spare[k];
  one(t, SKF_BATCH_PAD, p, out);
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < SKF_BATCH_PAD && j->out[k]; i++)
      if (i < end - from) j->out[k][from + i] = spare[k][i];
}

void skf_batch_at(const skf_batch *b, skf_vec3 p, bool exact, double out[4]) {
  skf_point_sum sum;
  skf_box box = {p, p};
  memset(&sum, 0, sizeof sum);
  for (size_t i = next_tile(b, 0, &box); i < b->tiles; i = next_tile(b, i + 1, &box)) {
    const skf_tile *t = b->tile + i;
    if (exact ? skf_batch_full(t) : t->column != NULL) {
      b->ops->form[t->form].at(t, p, exact, &sum);
      continue;
    }
    for (size_t j = 0; j < t->count; j++) {
      closed(t->element[j], p, out);
      for (int k = 0; k < 4; k++) sum_add_to(sum.s[k], sum.low[k], out[k]);
    }
  }
  for (int k = 0; k < 4; k++) {
    double s = sum.s[k][0], low = sum.low[k][0];
    for (int i = 1; exact && i < SKF_TILE; i++) sum_add_to(&s, &low, sum.s[k][i]), low += sum.low[k][i];
    sum.s[k][0] = s;
    out[k] = s - s == 0 ? s + low : s;
    if (k > 0 && sum.s[0][0] - sum.s[0][0] != 0) out[k] = 0;
  }
}

/* Few points: elements are the lanes; where they make one tile, that costs a call. */
static void few(const job *j, size_t n) {
  const skf_batch *b = j->batch;
  const bool alone = b->tiles == 1 && b->tile->column;
  for (size_t i = 0; i < n; i++) {
    const skf_vec3 at = v3(j->p[0][i], j->p[1][i], j->p[2][i]);
    double out[4];
    if (alone)
      b->ops->form[b->tile->form].lone(b->tile, &at, out);
    else
      skf_batch_at(b, at, false, out);
    for (int k = 0; k < 4; k++)
      if (j->out[k]) j->out[k][i] = out[k];
  }
}

static void range(const job *j, size_t from, size_t n) {
  if (j->batch->elements == 1 && j->batch->tile->column)
    one_range(j, from, n);
  else
    sum_range(j, from, n);
}

void skf_batch_serial(const skf_batch *b, size_t n, const double *const p[3], double *const out[4]) {
  job j = {b, p, {out[0], out[1], out[2], out[3]}};
  range(&j, 0, n);
}

static void eval(const skf_batch *b, size_t n, const double *const p[3], double *F, double *const g[3]) {
  job j = {b, p, {F, g ? g[0] : NULL, g ? g[1] : NULL, g ? g[2] : NULL}};
  if (n * b->tiles * SKF_TILE <= SKF_BATCH_PAD * b->elements) {
    few(&j, n);
    return;
  }
  /* waking threads would cost more than the work, even to find one thread only: 0.4 us */
  if (n * b->elements < 2048) {
    range(&j, 0, n);
    return;
  }
  /* two shares for each thread, of whole blocks if they are that long; they change no result */
  size_t share = n / (2 * (size_t)omp_get_max_threads()), unit = share < SKF_BATCH ? SKF_BATCH_PAD : SKF_BATCH;
  size_t step = share < unit ? unit : share / unit * unit;
#pragma omp parallel for schedule(dynamic)
  for (size_t from = 0; from < n; from += step) range(&j, from, n - from < step ? n - from : step);
}

/* Points in any order reach all tiles in each block, sorted ones those at the point: whether the elements passed over
   at each are worth the sorting, some 150 cycles. */
static bool worth_sorting(const skf_batch *b, const skf_box *box) {
  size_t step = b->tiles / 64 + 1, samples = 0;
  double met = 0;
  for (size_t i = 0; i < b->tiles; i += step, samples++) met += skf_sparse_share(&b->tile[i].reach, box);
  return (1 - met / (double)samples) * (double)b->elements > 32;
}

/* Neighbours come side by side, so that a block of points reaches few tiles. */
static bool eval_sorted(const skf_batch *b, size_t n, const double *const p[3], double *F, double *const g[3]) {
  skf_box box = skf_sparse_around(n, p);
  if (!worth_sorting(b, &box)) return false;
  skf_sparse_key *keys = skf_alloc(n, sizeof *keys);
  double *room = skf_alloc(n, 7 * sizeof *room), *out[4] = {F, g ? g[0] : NULL, g ? g[1] : NULL, g ? g[2] : NULL};
  if (keys && room) {
    const double *const in[3] = {room, room + n, room + 2 * n};
    double *const to[4] = {room + 3 * n, room + 4 * n, room + 5 * n, room + 6 * n};
    for (size_t i = 0; i < n; i++) keys[i] = (skf_sparse_key){skf_sparse_code(v3(p[0][i], p[1][i], p[2][i]), &box), i};
    skf_sparse_sort(keys, n);
    for (int k = 0; k < 3; k++)
      for (size_t i = 0; i < n; i++) room[k * n + i] = p[k][keys[i].index];
    eval(b, n, in, to[0], to + 1);
    for (int k = 0; k < 4; k++)
      for (size_t i = 0; i < n && out[k]; i++) out[k][keys[i].index] = to[k][i];
  }
  bool done = keys && room;
  skf_free(keys), skf_free(room);
  return done;
}

void skf_batch_eval(const skf_batch *b, size_t n, const double *const p[3], double *F, double *const g[3]) {
  /* where memory is out the order stays, too: it changes no result */
  if (b->group && n >= 2 * SKF_BATCH && eval_sorted(b, n, p, F, g)) return;
  eval(b, n, p, F, g);
}
