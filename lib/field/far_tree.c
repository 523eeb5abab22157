/* SPDX-License-Identifier: MIT */
#include "field/far_tree.h"
#include "core/alloc.h"
#include <float.h>
#include <string.h>

const signed char skf_far_around[FAR_NEAR][3] = {
    {-1, -1, -1}, {0, -1, -1}, {1, -1, -1}, {-1, 0, -1}, {0, 0, -1}, {1, 0, -1}, {-1, 1, -1}, {0, 1, -1}, {1, 1, -1},
    {-1, -1, 0},  {0, -1, 0},  {1, -1, 0},  {-1, 0, 0},  {0, 0, 0},  {1, 0, 0},  {-1, 1, 0},  {0, 1, 0},  {1, 1, 0},
    {-1, -1, 1},  {0, -1, 1},  {1, -1, 1},  {-1, 0, 1},  {0, 0, 1},  {1, 0, 1},  {-1, 1, 1},  {0, 1, 1},  {1, 1, 1},
    {-2, 0, 0},   {2, 0, 0},   {0, -2, 0},  {0, 2, 0},   {0, 0, -2}, {0, 0, 2}};

static size_t slot_of(const far_tree *t, int level, int x, int y, int z) {
  unsigned long long h = (unsigned long long)level;
  h = h * 0x9e3779b97f4a7c15u + (unsigned long long)x;
  h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9u + (unsigned long long)y;
  h = (h ^ (h >> 29)) * 0x94d049bb133111ebu + (unsigned long long)z;
  h = (h ^ (h >> 32)) * 0x9e3779b97f4a7c15u;
  return (size_t)(h >> 20) & (t->table_size - 1);
}

int skf_far_tree_find(const far_tree *t, int level, int x, int y, int z) {
  for (size_t i = slot_of(t, level, x, y, z);; i = (i + 1) & (t->table_size - 1)) {
    int k = t->table[i] - 1;
    if (k < 0) return -1;
    const far_source *s = t->source + k;
    if (s->level == level && s->at[0] == x && s->at[1] == y && s->at[2] == z) return k;
  }
}

static void enter(far_tree *t, int k) {
  const far_source *s = t->source + k;
  size_t i = slot_of(t, s->level, s->at[0], s->at[1], s->at[2]);
  while (t->table[i]) i = (i + 1) & (t->table_size - 1);
  t->table[i] = k + 1;
}

static bool grow_table(far_tree *t) {
  if (2 * (t->source_count + 8) < t->table_size) return true;
  size_t size = t->table_size ? 4 * t->table_size : 4096;
  int *table = skf_alloc(size, sizeof *table);
  if (!table) return false;
  skf_free(t->table);
  t->table = table, t->table_size = size;
  for (size_t k = 0; k < t->source_count; k++) enter(t, (int)k);
  return true;
}

static int add_source(far_tree *t, int level, int x, int y, int z) {
  if (!grow_table(t)) return -1;
  if (t->source_count == t->source_capacity) {
    size_t more = t->source_capacity ? 2 * t->source_capacity : 256;
    far_source *s = skf_realloc(t->source, more, sizeof *s);
    if (!s) return -1;
    t->source = s, t->source_capacity = more;
  }
  far_source *s = t->source + t->source_count;
  *s = (far_source){.at = {x, y, z}, .level = level};
  for (int i = 0; i < 8; i++) s->child[i] = -1;
  enter(t, (int)t->source_count);
  return (int)t->source_count++;
}

static far_target *add_target(far_tree *t, int level, int x, int y, int z) {
  if (t->target_count == t->target_capacity) {
    size_t more = t->target_capacity ? 2 * t->target_capacity : 256;
    far_target *p = skf_realloc(t->target, more, sizeof *p);
    if (!p) return NULL;
    t->target = p, t->target_capacity = more;
  }
  t->target[t->target_count] = (far_target){{x, y, z}, level, -1};
  return t->target + t->target_count++;
}

static skf_box child_box(const far_tree *t, const far_source *s, int octant) {
  int at[3];
  for (int k = 0; k < 3; k++) at[k] = 2 * s->at[k] + (octant >> k & 1);
  skf_vec3 c = far_center(t, s->level + 1, at);
  double h = 0.5 * far_side(t, s->level + 1);
  return (skf_box){{c.x - h, c.y - h, c.z - h}, {c.x + h, c.y + h, c.z + h}};
}

typedef struct sorted {
  far_pieces list[8];
} sorted;

/* Gives the piece to the child where its middle is, cut until it fits. */
static bool place(const far_tree *t, const far_source *s, const far_piece *piece, int depth, sorted *out) {
  skf_box b = skf_primitive_bounds(&piece->primitive);
  skf_vec3 m = box_center(b), c = far_center(t, s->level, s->at);
  int octant = (m.x >= c.x) | (m.y >= c.y) << 1 | (m.z >= c.z) << 2, axis = 0;
  skf_box cell = child_box(t, s, octant);
  double most = 0, where = 0;
  for (int k = 0; k < 3; k++) {
    double under = v3_get(cell.lo, k) - v3_get(b.lo, k), over = v3_get(b.hi, k) - v3_get(cell.hi, k);
    if (under > most) most = under, axis = k, where = v3_get(cell.lo, k);
    if (over > most) most = over, axis = k, where = v3_get(cell.hi, k);
  }
  far_piece part = *piece;
  skf_primitive parts[3];
  int n = 0;
  if (depth < 64 && most > 1e-9 * far_side(t, s->level + 1))
    n = skf_far_piece_cut(&piece->primitive, axis, where, parts);
  if (!n) return skf_far_piece_add(out->list + octant, piece);
  for (int i = 0; i < n; i++) {
    part.primitive = parts[i];
    if (!place(t, s, &part, depth + 1, out)) return false;
  }
  return true;
}

static bool split_source(far_tree *t, int k, const far_pieces *from, far_pieces *to, sorted *work) {
  far_source s = t->source[k];
  for (int i = 0; i < 8; i++) work->list[i].count = 0;
  for (size_t i = 0; i < s.count; i++)
    if (!place(t, &s, from->at + s.first + i, 0, work)) return false;
  for (int i = 0; i < 8; i++) {
    const far_pieces *mine = work->list + i;
    if (!mine->count) continue;
    int c = add_source(t, s.level + 1, 2 * s.at[0] + (i & 1), 2 * s.at[1] + (i >> 1 & 1), 2 * s.at[2] + (i >> 2));
    if (c < 0) return false;
    t->source[k].child[i] = c;
    t->source[c].first = to->count, t->source[c].count = mine->count;
    for (size_t j = 0; j < mine->count; j++)
      if (!skf_far_piece_add(to, mine->at + j)) return false;
  }
  return true;
}

/* Marks the targets of the level that have too many pieces around them, and those pieces' cells; how many targets, and
   how many pieces they have. */
static size_t mark(far_tree *t, int level, size_t near, unsigned char *split, double *pieces) {
  size_t first = t->target_level[level], n = 0;
  *pieces = 0;
  for (size_t i = first; i < t->target_count; i++) {
    const int *at = t->target[i].at;
    int around[FAR_NEAR], found = 0;
    size_t count = 0;
    for (int k = 0; k < t->around; k++) {
      const signed char *d = skf_far_around[k];
      int s = skf_far_tree_find(t, level, at[0] + d[0], at[1] + d[1], at[2] + d[2]);
      if (s >= 0) count += t->source[s].count, around[found++] = s;
    }
    if ((split[i - first] = count > near) == 0) continue;
    n++, *pieces += (double)count;
    for (int k = 0; k < found; k++) t->source[around[k]].split = true;
  }
  return n;
}

static bool split_level(far_tree *t, int level, const unsigned char *split, far_pieces *now, far_pieces *next,
                        far_pieces *rest, sorted *work) {
  size_t sources = t->source_count, targets = t->target_count, first = t->target_level[level];
  t->source_level[level + 1] = sources, t->target_level[level + 1] = targets;
  for (size_t k = t->source_level[level]; k < sources; k++) {
    far_source *s = t->source + k;
    if (s->split) {
      if (!split_source(t, (int)k, now, next, work)) return false;
    } else {
      size_t from = s->first;
      s->first = rest->count;
      for (size_t i = 0; i < s->count; i++)
        if (!skf_far_piece_add(rest, now->at + from + i)) return false;
    }
  }
  for (size_t i = first; i < targets; i++) {
    if (!split[i - first]) continue;
    far_target p = t->target[i];
    t->target[i].child = (int)t->target_count;
    for (int k = 0; k < 8; k++)
      if (!add_target(t, level + 1, 2 * p.at[0] + (k & 1), 2 * p.at[1] + (k >> 1 & 1), 2 * p.at[2] + (k >> 2)))
        return false;
  }
  return true;
}

/* The pieces of the leaves below a cell, in order. */
static bool gather(far_tree *t, int k, const far_pieces *rest) {
  far_source *s = t->source + k;
  size_t first = t->pieces.count;
  for (int i = 0; i < 8; i++)
    if (s->child[i] >= 0 && !gather(t, s->child[i], rest)) return false;
  for (size_t i = 0; i < s->count && !s->split; i++)
    if (!skf_far_piece_add(&t->pieces, rest->at + s->first + i)) return false;
  s->first = first, s->count = t->pieces.count - first;
  return true;
}

/* How many times smaller cells would be that have as many pieces as they may where there are so many in n of them,
   below twice; as far as `room` more of them allow. */
static double smaller(double pieces, size_t n, size_t near, size_t room) {
  double wish = pow(pieces / (double)n / (double)near, 0.4), can = cbrt((double)room / (1.3 * (double)n));
  return fmin(1.9, fmin(wish, can));
}

/* ratio: 0, or where there were too many targets how many times smaller the cells of the last level had better be. */
static bool grow(far_tree *t, size_t near, size_t most, double fine, size_t pieces, far_pieces level[2],
                 far_pieces *rest, sorted *work, int deepest, double *ratio) {
  *ratio = 0;
  for (int l = 0;; l++) {
    size_t targets = t->target_count - t->target_level[l];
    unsigned char *split = skf_alloc(targets, 1);
    if (!split) return false;
    double counted;
    size_t n = mark(t, l, near, split, &counted);
    bool coarse = far_side(t, l) > fine, full = t->target_count + 8 * n > most;
    bool last = (n == 0 && !coarse) || l == deepest || full || level[l % 2].count + rest->count > pieces;
    for (size_t k = t->source_level[l]; k < t->source_count && coarse; k++) t->source[k].split = true;
    if (full && n && l < deepest && most > t->target_count) *ratio = smaller(counted, n, near, most - t->target_count);
    if (last) {
      memset(split, 0, targets);
      for (size_t k = t->source_level[l]; k < t->source_count; k++) t->source[k].split = false;
    }
    level[(l + 1) % 2].count = 0;
    bool ok = split_level(t, l, split, level + l % 2, level + (l + 1) % 2, rest, work);
    skf_free(split);
    t->levels = l + 1;
    if (!ok || last) return ok && gather(t, 0, rest);
  }
}

static bool frame(const skf_prepared *e, size_t n, double times, far_tree *t, int *deepest) {
  skf_box b = box_empty();
  for (size_t i = 0; i < n; i++) b = box_join(b, skf_primitive_bounds(&e[i].primitive));
  skf_vec3 d = v3_sub(b.hi, b.lo), c = box_center(b);
  double wide = fmax(d.x, fmax(d.y, d.z)), away = fmax(fabs(c.x), fmax(fabs(c.y), fabs(c.z))) + wide;
  t->side = times * wide * (1 + 1e-9);
  t->lo = v3(c.x - 0.5 * t->side, c.y - 0.5 * t->side, c.z - 0.5 * t->side);
  *deepest = 0;
  while (*deepest < FAR_DEPTH && ldexp(t->side, -*deepest - 1) > 4096 * DBL_EPSILON * away) (*deepest)++;
  return wide > 1e-280 && wide < 1e140 && *deepest > 0;
}

/* In a cube `wide` times as wide as it must be */
static bool build(const skf_prepared *e, size_t n, int around, size_t near, size_t most, double fine, double wide,
                  far_tree *t, double *ratio) {
  *t = (far_tree){.around = around};
  far_pieces level[2] = {{NULL, 0, 0}, {NULL, 0, 0}}, rest = {NULL, 0, 0};
  sorted work = {{{NULL, 0, 0}}};
  int deepest;
  bool ok = frame(e, n, wide, t, &deepest) && add_source(t, 0, 1, 1, 1) == 0;
  for (int k = 0; k < 27 && ok; k++) ok = add_target(t, 0, k % 3, k / 3 % 3, k / 9) != NULL;
  for (size_t i = 0; i < n && ok; i++) ok = skf_far_piece_add(level, &(far_piece){e[i].primitive, i});
  if (ok) t->source[0].count = n;
  ok = ok && grow(t, near, most, fine, 4 * n + 4096, level, &rest, &work, deepest, ratio);
  for (int i = 0; i < 8; i++) skf_free(work.list[i].at);
  skf_free(level[0].at), skf_free(level[1].at), skf_free(rest.at);
  if (!ok) skf_far_tree_free(t);
  return ok;
}

/* Cells are halved. Where that would be too many targets, they are made somewhat smaller with another cube instead. */
bool skf_far_tree_build(const skf_prepared *e, size_t n, int around, size_t near, size_t most, double fine,
                        far_tree *t) {
  far_tree other;
  double ratio, again;
  if (!build(e, n, around, near, most, fine, 1, t, &ratio)) return false;
  if (ratio < 1.05 || isfinite(fine)) return true;
  if (!build(e, n, around, near, most, fine, 2 / ratio, &other, &again)) return true;
  bool better = other.target_count > t->target_count;
  skf_far_tree_free(better ? t : &other);
  if (better) *t = other;
  return true;
}

void skf_far_tree_free(far_tree *t) {
  skf_free(t->source), skf_free(t->target), skf_free(t->pieces.at), skf_free(t->table);
  *t = (far_tree){.levels = 0};
}
