/* SPDX-License-Identifier: MIT */
#include "ray/octree.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include "field/some.h"
#include <float.h>
#include <omp.h>
#include <string.h>

/* A leaf is a cell in which the gradient turns by no more than this part of itself, */
#define FLAT 1.2
/* or which is this many halvings smaller than the cube. */
#define LEVELS 14
/* Or there are but few blobs, none of them with R below the cell's edge divided by this. */
#define COARSE 3
/* Rounding of places, relative to a cell's radius, that its bounds allow for. */
#define SLACK 1e-8

/* Of memory; blocks grow from the first size to that of a large page. */
enum { BLOCK = 1 << 16 };

/* Memory that is only ever added to. */
typedef struct block {
  struct block *before;
  size_t used, size;
} block;

struct skf_octree {
  const skf_field *field;
  const skf_source *sources;
  const skf_blob *blobs;
  double iso, noise;
  skf_smooth *smooth; /* or NULL: then cells are examined by the elements' bounds alone */
  uint32_t *place;    /* of the elements' vector forms, or NULL where none is asked for */
  skf_branch *all;    /* whose child 0 is the cube */
  block *memory;
  omp_lock_t lock;
};

static block *next_block(const block *before, size_t bytes) {
  size_t size = before ? 2 * before->size : BLOCK;
  if (bytes > size || size > SKF_LARGE) size = bytes > SKF_LARGE ? bytes : SKF_LARGE;
  size_t large = size / SKF_LARGE + (size % SKF_LARGE > 0);
  block *b = size < SKF_LARGE ? skf_alloc(1, size) : skf_alloc_large(large);
  if (b) *b = (block){.size = size < SKF_LARGE ? size : large * SKF_LARGE};
  return b;
}

/* Zeroed. */
static void *take(skf_octree *t, size_t bytes) {
  bytes = (bytes + 15) / 16 * 16;
  size_t head = (sizeof(block) + 15) / 16 * 16;
  if (!t->memory || t->memory->used + bytes > t->memory->size) {
    block *b = next_block(t->memory, head + bytes);
    if (!b) return NULL;
    b->before = t->memory, b->used = head;
    t->memory = b;
  }
  void *p = (char *)t->memory + t->memory->used;
  t->memory->used += bytes;
  return memset(p, 0, bytes);
}

static double square(double x) { return x * x; }

bool skf_octree_add(const skf_octree *t, uint32_t i, skf_vec3 c, double radius, skf_outlook *o) {
  const skf_source *s = t->sources + i;
  if (v3_norm2(v3_sub(c, s->middle)) * (1 - 1e-12) > square(s->end + radius)) return false;
  double d = skf_source_distance(s, c), w = fmax(fabs(s->least), fabs(s->most));
  skf_grade g = skf_source_grade(s, fmax(d * (1 - 1e-12) - radius, 0), d * (1 + 1e-12) + radius);
  if (s->disc && d < s->reach) g.below = fmax(g.below, skf_source_disc(s, c, radius));
  if (s->sheet && d < s->reach) g.above.slope = fmin(g.above.slope, skf_source_steepness(s, c, radius));
  if (s->bulk && d < s->reach) g.above = skf_source_bulk(s, c, radius);
  if (s->aside) g.above.bend = fmin(g.above.bend, skf_source_aside(s, c, radius, d * (1 - 1e-12) - radius));
  if (!(g.above.value > 0)) return false;
  o->lo += skf_weight_times(s->least, s->least > 0 ? g.below : g.above.value);
  o->hi += skf_weight_times(s->most, s->most > 0 ? g.above.value : g.below);
  o->slope += w * g.above.slope, o->bend += w * g.above.bend, o->fourth += w * g.above.fourth;
  return true;
}

static skf_vec3 center_of(const skf_branch *in, int k) {
  double half = 0.5 * in->half;
  skf_vec3 m = in->middle;
  return v3(m.x + (k & 1 ? half : -half), m.y + (k & 2 ? half : -half), m.z + (k & 4 ? half : -half));
}

/* What is known of F in a cell. */
typedef struct outlook {
  skf_outlook of;
  double least, grain;        /* where all are blobs: the least R; see skf_leaf */
  bool blobs, soft, segments; /* all are blobs; one has c3; one is a segment */
} outlook;

/* Whatever the distance. The rounding, with D the largest distance from the point, is that of m, less than
   24 eps D^2 / R^2, times its slope and what control points of a quadric can be. */
static void add_blob_shape(const skf_blob *b, const skf_cube *c, outlook *o) {
  double s = b->strength * skf_blob_measure(b), per = 1 / b->R, D = 1 + 2 * c->radius * per, far = b->length * per;
  o->of.slope += 1.6 * s * per, o->of.bend += skf_blob_bend(b);
  o->grain += 256 * DBL_EPSILON * s * (1 + D * D + far);
}

static outlook look_out(const skf_octree *t, const skf_cube *c, const skf_branch *in, uint32_t *kept, uint32_t *keep) {
  outlook o = {.least = INFINITY, .blobs = true};
  uint32_t n = 0;
  for (size_t i = 0; i < in->count; i++) {
    uint32_t k = in->list[i];
    const skf_blob *b = t->blobs + k;
    bool blob = b->per > 0;
    bool taken = blob ? skf_blob_range(b, c, &o.of.lo, &o.of.hi) : skf_octree_add(t, k, c->center, c->radius, &o.of);
    if (blob && taken) {
      o.least = b->R < o.least ? b->R : o.least;
      o.soft |= b->c3 > 0, o.segments |= b->length > 0;
    }
    kept[n] = k;
    n += taken;
    o.blobs &= blob || !taken;
  }
  *keep = n;
  return o;
}

/* The shapes of the blobs, for what the values alone do not decide. */
static void look_closer(const skf_octree *t, const skf_cube *c, const uint32_t *kept, uint32_t keep, outlook *o) {
  if (o->blobs) o->of.fourth = INFINITY;
  for (uint32_t i = 0; i < keep; i++) {
    const skf_blob *b = t->blobs + kept[i];
    skf_outlook own = {.lo = 0};
    if (!(b->per > 0)) continue;
    if (o->blobs)
      add_blob_shape(b, c, o);
    else if (skf_octree_add(t, kept[i], c->center, c->radius, &own))
      o->of.slope += own.slope, o->of.bend += own.bend, o->of.fourth += own.fourth;
  }
}

/* By n elements' field in the middle and bounds of its derivatives: whether F - iso has one sign all over a cell. */
static bool decide(const skf_octree *t, const skf_cube *c, const skf_made *middle, uint32_t n, double slope,
                   double bend, skf_leaf *leaf) {
  skf_vec3 g = middle->g;
  double grip = fabs(g.x) + fabs(g.y) + fabs(g.z);
  double rounding = (4 * t->noise + 1e-16 * n) * (middle->size + fabs(t->iso)) + SLACK * c->radius * grip;
  leaf->f = middle->F - t->iso, leaf->g = g;
  leaf->flat = 0.5 * bend * c->radius * c->radius + rounding;
  return fabs(leaf->f) > fmin(c->half * grip + leaf->flat, slope * c->radius + rounding);
}

/* Finds out what the k-th cell of a branch is; a leaf comes without its lists. middle: the field of all of the branch's
   elements there, or NULL where it is not known yet. */
static int examine(const skf_octree *t, const skf_branch *in, int k, const skf_made *middle, uint32_t *kept,
                   uint32_t *keep, skf_leaf *leaf) {
  double half = 0.5 * in->half;
  skf_made own;
  skf_cube c = {center_of(in, k), half * (1 + SLACK), 1.7320508075688773 * half * (1 + SLACK)};
  if (middle && decide(t, &c, middle, in->count, in->slope, in->bend, leaf))
    return leaf->f < 0 ? SKF_CELL_OUTSIDE : SKF_CELL_INSIDE;
  outlook o = look_out(t, &c, in, kept, keep);
  leaf->center = c.center, leaf->slope = leaf->bend = INFINITY;
  if (o.of.hi < t->iso) return SKF_CELL_OUTSIDE;
  if (o.of.lo > t->iso) return SKF_CELL_INSIDE;
  bool last = in->level == LEVELS;
  if (o.blobs && in->half > COARSE * o.least && !last) return SKF_CELL_BRANCH;
  look_closer(t, &c, kept, *keep, &o);
  leaf->slope = o.of.slope, leaf->bend = o.of.bend, leaf->fourth = o.of.fourth;
  leaf->patch = NULL, leaf->soft = o.soft, leaf->segments = o.segments,
  leaf->grain = o.grain + 4 * DBL_EPSILON * fabs(t->iso);
  if (o.blobs && *keep <= SKF_LEAF_BLOBS) return SKF_CELL_BLOBS;
  if (!middle) own.F = skf_field_some(t->field, kept, *keep, c.center, &own.g, &own.size), middle = &own;
  if (decide(t, &c, middle, in->count, o.of.slope, o.of.bend, leaf))
    return leaf->f < 0 ? SKF_CELL_OUTSIDE : SKF_CELL_INSIDE;
  bool flat = o.of.bend * c.radius <= FLAT * v3_norm(leaf->g);
  return flat || last ? SKF_CELL_LEAF : SKF_CELL_BRANCH;
}

static const skf_blob *gather(skf_octree *t, const uint32_t *list, uint32_t n) {
  skf_blob *b = take(t, n * sizeof *b);
  double share = 1 / sqrt(n);
  for (uint32_t i = 0; b && i < n; i++) b[i] = t->blobs[list[i]], b[i].quiet *= share;
  return b;
}

static skf_cell make(skf_octree *t, int kind, const skf_branch *in, const uint32_t *kept, uint32_t keep,
                     const skf_leaf *leaf) {
  if (kind < SKF_CELL_BRANCH) return (skf_cell)kind;
  const uint32_t *list = in->list; /* shared where nothing was dropped */
  if (keep < in->count) {
    uint32_t *own = take(t, keep * sizeof *own);
    if (!own) return 0;
    list = memcpy(own, kept, keep * sizeof *own);
  }
  void *what = take(t, kind == SKF_CELL_BRANCH ? sizeof(skf_branch) : sizeof(skf_leaf));
  if (!what) return 0;
  if (kind == SKF_CELL_BRANCH) {
    skf_branch *b = what;
    b->middle = leaf->center, b->half = 0.5 * in->half;
    b->list = list, b->count = keep, b->level = in->level + 1;
    b->slope = leaf->slope, b->bend = leaf->bend;
  } else {
    skf_leaf *l = what;
    *l = *leaf, l->list = list, l->count = keep;
    if (kind == SKF_CELL_BLOBS && !(l->blobs = gather(t, list, keep))) return 0;
  }
  return (skf_cell)what + (skf_cell)kind;
}

/* What the powers of a patch tell without the rays. */
static void set_shape(skf_patch *p, skf_leaf *l) {
  const double *c = p->c;
  l->patch = p, l->f = c[0], l->flat = 0, l->slope = 0, l->bend = 0, p->beyond = 0;
  for (int i = 0; i <= p->degree; i++)
    for (int j = 0; i + j <= p->degree; j++)
      for (int m = 0; i + j + m <= p->degree; m++, c++) {
        int n = i + j + m;
        double size = fabs(*c) * p->per;
        if (n == 1) *(i ? &l->g.x : j ? &l->g.y : &l->g.z) = *c * p->per, p->lean[i ? 0 : j ? 1 : 2] = *c;
        if (n == 2 && (i == 2 || j == 2 || m == 2)) p->bow[i ? 0 : j ? 1 : 2] = *c;
        if (n == 2 && (i == 1 || j == 1)) p->bow[!m ? 3 : !j ? 4 : 5] = 0.5 * *c;
        if (n > 1) l->flat += fabs(*c);
        if (n > 2) p->beyond += fabs(*c);
        l->slope += n * size, l->bend += n * (n - 1) * size * p->per;
      }
  l->flat += p->off.value + SLACK * (fabs(p->lean[0]) + fabs(p->lean[1]) + fabs(p->lean[2]));
  l->slope += p->off.slope, l->bend += p->off.bend;
  l->fourth = p->off.fourth, l->slope = l->slope < INFINITY ? l->slope : INFINITY;
}

static skf_cell make_smooth(skf_octree *t, skf_smooth_kind kind, const skf_branch *in, const skf_smooth_cell *cell,
                            const skf_patch *patch, const skf_model *model, const uint32_t *kept, uint32_t keep) {
  if (kind == SKF_SMOOTH_LOST) return 0;
  if (kind < SKF_SMOOTH_BARE) return kind == SKF_SMOOTH_OUTSIDE ? SKF_CELL_OUTSIDE : SKF_CELL_INSIDE;
  if (kind == SKF_SMOOTH_BRANCH) {
    skf_branch *b = take(t, sizeof *b);
    skf_far_part *far = take(t, sizeof *far + keep * sizeof *kept);
    if (!b || !far) return 0;
    far->model = *model, far->count = keep;
    memcpy(far->list, kept, keep * sizeof *kept);
    b->middle = cell->center, b->half = 0.5 * in->half, b->level = in->level + 1;
    b->list = in->list, b->count = in->count, b->far = far;
    return (skf_cell)b + SKF_CELL_BRANCH;
  }
  skf_leaf *l = take(t, sizeof *l);
  skf_patch *own = kind == SKF_SMOOTH_LEAF ? take(t, sizeof *own) : NULL;
  if (!l || (kind == SKF_SMOOTH_LEAF && !own)) return 0;
  *l = (skf_leaf){.center = cell->center, .flat = INFINITY, .slope = INFINITY, .bend = INFINITY, .fourth = INFINITY};
  l->list = in->list, l->count = in->count;
  if (own) *own = *patch, set_shape(own, l);
  return (skf_cell)l + SKF_CELL_LEAF;
}

/* With the lock. */
static void publish(skf_branch *in, int k, skf_cell c) {
  atomic_store_explicit(in->child + k, c, memory_order_release);
  if (c == SKF_CELL_OUTSIDE) atomic_fetch_or_explicit(&in->outside, 1u << k, memory_order_relaxed);
}

static skf_cell explore_smooth(skf_octree *t, skf_branch *in, int k) {
  double half = 0.5 * in->half;
  skf_smooth_cell cell = {center_of(in, k), half * (1 + SLACK), k, in->level == LEVELS};
  uint32_t *kept = skf_alloc(in->far->count, sizeof *kept), keep = 0;
  skf_patch patch;
  skf_model model;
  if (!kept) return 0;
  skf_smooth_kind kind = skf_smooth_examine(t->smooth, &cell, in->far, &patch, &model, kept, &keep);
  omp_set_lock(&t->lock);
  skf_cell c = atomic_load_explicit(in->child + k, memory_order_relaxed);
  if (!c) {
    c = make_smooth(t, kind, in, &cell, &patch, &model, kept, keep);
    publish(in, k, c);
  }
  omp_unset_lock(&t->lock);
  skf_free(kept);
  return c;
}

/* The field in the middles of a branch's cells, where vector forms tell all of them sooner than closed forms would
   some: whether they did. Blobs alone need it seldom; the top has one cell. */
static bool look_at_all(const skf_octree *t, const skf_branch *in, skf_made middle[8]) {
  bool blobs = true;
  skf_vec3 p[8];
  if (!t->place || !in->level) return false;
  for (size_t i = 0; i < in->count; i++) {
    if (t->place[in->list[i]] == SKF_NOWHERE) return false;
    blobs &= t->blobs[in->list[i]].per > 0;
  }
  if (blobs) return false;
  for (int k = 0; k < 8; k++) p[k] = center_of(in, k);
  skf_field_some_eight(t->field, t->place, in->list, in->count, p, middle);
  return true;
}

static skf_cell explore_one(skf_octree *t, skf_branch *in, int k, const skf_made *middle, uint32_t *kept) {
  uint32_t keep = 0;
  skf_leaf leaf;
  leaf.f = leaf.flat = 0, leaf.g = v3(0, 0, 0), leaf.blobs = NULL;
  int kind = examine(t, in, k, middle, kept, &keep, &leaf);
  omp_set_lock(&t->lock);
  skf_cell c = atomic_load_explicit(in->child + k, memory_order_relaxed); /* somebody else may have been here */
  if (!c) {
    c = make(t, kind, in, kept, keep, &leaf);
    publish(in, k, c);
  }
  omp_unset_lock(&t->lock);
  return c;
}

skf_cell skf_octree_explore(skf_octree *t, skf_branch *in, int k) {
  if (t->smooth) return explore_smooth(t, in, k);
  enum { FEW = 256 };
  uint32_t few[FEW], *kept = few;
  if (in->count > FEW && !(kept = skf_alloc(in->count, sizeof *kept))) return 0;
  skf_made middle[8];
  bool all = look_at_all(t, in, middle);
  for (int i = 0; all && i < 8; i++)
    if (i != k && !atomic_load_explicit(in->child + i, memory_order_relaxed)) explore_one(t, in, i, middle + i, kept);
  skf_cell c = explore_one(t, in, k, all ? middle + k : NULL, kept);
  if (kept != few) skf_free(kept);
  return c;
}

skf_branch *skf_octree_top(const skf_octree *t) { return t->all; }

int skf_octree_beyond(const skf_octree *t) { return t->iso < 0 ? 1 : -1; }

const skf_chebyshev *skf_octree_table(const skf_octree *t) { return &t->smooth->table; }

double skf_octree_least(const skf_octree *t) { return t->all->half / (1 << LEVELS); }

static bool is_smooth(const skf_octree *t, size_t n) {
  bool smooth = skf_field_is_direct(t->field);
  for (size_t i = 0; i < n && smooth; i++) smooth = skf_source_is_smooth(t->sources + i);
  return smooth;
}

enum { FEW = 32 }; /* elements that are summed in no time */

/* The top's part: no polynomial, all elements. */
static bool open_smooth(skf_octree *t, size_t n) {
  skf_far_part *far = take(t, sizeof *far + n * sizeof *far->list);
  skf_smooth *s = take(t, sizeof *s);
  if (!far || !s) return false;
  memset(&far->model, 0, sizeof far->model);
  far->count = (uint32_t)n;
  memcpy(far->list, t->all->list, n * sizeof *far->list);
  *s = (skf_smooth){.field = t->field, .sources = t->sources, .iso = t->iso, .noise = t->noise, .few = n <= FEW};
  skf_chebyshev_init(&s->table, skf_isa_pick(), SLACK);
  t->smooth = s, t->all->far = far;
  return true;
}

skf_status skf_octree_new(const skf_field *field, const skf_source *sources, const skf_blob *blobs, size_t n,
                          double iso, double noise, skf_box region, skf_octree **out) {
  *out = NULL;
  skf_octree *t = skf_alloc(1, sizeof *t);
  if (!t) return SKF_ERR_NOMEM;
  skf_vec3 d = v3_sub(region.hi, region.lo);
  t->field = field, t->sources = sources, t->blobs = blobs, t->iso = iso, t->noise = noise;
  double size = fmax(d.x, fmax(d.y, d.z)) * (1 + SLACK);
  omp_init_lock(&t->lock);
  t->all = take(t, sizeof *t->all);
  uint32_t *all = t->all ? take(t, n * sizeof *all) : NULL;
  if (!all) return skf_octree_free(t), SKF_ERR_NOMEM;
  for (size_t i = 0; i < n; i++) all[i] = (uint32_t)i;
  t->all->list = all, t->all->count = (uint32_t)n;
  t->all->half = size, t->all->middle = v3_mad(box_center(region), 0.5 * size, v3(1, 1, 1));
  bool smooth = is_smooth(t, n), plain = true;
  for (size_t i = 0; i < n && plain; i++) plain = blobs[i].per > 0;
  if (smooth && !open_smooth(t, n)) return skf_octree_free(t), SKF_ERR_NOMEM;
  if (!smooth && !plain) {
    if (!(t->place = take(t, n * sizeof *t->place))) return skf_octree_free(t), SKF_ERR_NOMEM;
    skf_field_places(field, t->place);
  }
  return *out = t, SKF_OK;
}

void skf_octree_free(skf_octree *t) {
  if (!t) return;
  for (block *b = t->memory, *before; b; b = before) {
    before = b->before;
    skf_free(b);
  }
  omp_destroy_lock(&t->lock);
  skf_free(t);
}
