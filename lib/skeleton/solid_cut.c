/* SPDX-License-Identifier: MIT */
/* A solid cut into blocks of faces, each with its vertices and edges, ready for sums over them. */
#include "core/alloc.h"
#include "num/exact.h"
#include "skeleton/solid.h"

/* Unit normal to twice double precision: where two faces are nearly in one plane the difference of theirs counts. */
static skf_dd3 normal_of(const skf_solid *s, unsigned face, double *twice) {
  const unsigned *t = s->faces[face];
  skf_dd3 n = dd3_cross(dd3_diff(s->vertices[t[1]], s->vertices[t[0]]), dd3_diff(s->vertices[t[2]], s->vertices[t[1]]));
  skf_dd n2 = dd3_dot(n, n);
  double r = sqrt(n2.hi);
  /* 1 / |n| by one step of Newton's method */
  skf_dd y = {1 / r, 0}, rest = dd_sub((skf_dd){1, 0}, dd_mul(n2, dd_mul(y, y)));
  y = dd_add(y, dd_mul((skf_dd){0.5 * y.hi, 0}, rest));
  *twice = r;
  return (skf_dd3){dd_mul(n.x, y), dd_mul(n.y, y), dd_mul(n.z, y)};
}

static skf_dd3 sum3(skf_dd3 a, skf_dd3 b) { return (skf_dd3){dd_add(a.x, b.x), dd_add(a.y, b.y), dd_add(a.z, b.z)}; }

/* With the dihedral's bisector s, q perpendicular to it and to the edge, and the angle theta between the normals:
   n mA' + n mB' = sin(theta) (q q' - s s'), positive for an edge that stands out. False when it is zero. */
static bool find_dyad(const skf_solid *s, const skf_dd3 *normals, const skf_solid_pair *p, double e[SKF_EDGE_COLUMNS]) {
  skf_dd3 nA = normals[p->along / 3], nB = normals[p->against / 3];
  skf_dd3 minus = {dd_neg(nB.x), dd_neg(nB.y), dd_neg(nB.z)};
  skf_vec3 S = dd3_round(sum3(nA, nB)), Q = dd3_round(sum3(nA, minus)),
           along = v3_sub(s->vertices[p->hi], s->vertices[p->lo]);
  double sine = 0.5 * v3_norm(S) * v3_norm(Q);
  if (v3_dot(v3_cross(along, S), Q) < 0) sine = -sine;
  skf_vec3 u = v3_unit(S), q = v3_unit(Q);
  e[SKF_EDGE_LENGTH] = v3_norm(along);
  e[SKF_EDGE_XX] = sine * (q.x * q.x - u.x * u.x), e[SKF_EDGE_XY] = sine * (q.x * q.y - u.x * u.y);
  e[SKF_EDGE_XZ] = sine * (q.x * q.z - u.x * u.z), e[SKF_EDGE_YY] = sine * (q.y * q.y - u.y * u.y);
  e[SKF_EDGE_YZ] = sine * (q.y * q.z - u.y * u.z);
  return sine != 0;
}

/* While the blocks are filled: the number of each vertex within the block `stamp` says, the places behind the last
   block's columns. */
typedef struct filling {
  skf_dd3 *normals;
  double *twice;
  unsigned *stamp;
  unsigned short *number, *numbers;
  double *columns;
} filling;

static size_t padded(size_t n) { return (n + SKF_SOLID_PAD - 1) / SKF_SOLID_PAD * SKF_SOLID_PAD; }

static unsigned short number_of(skf_solid_block *b, filling *f, unsigned id, unsigned v, unsigned *list) {
  if (f->stamp[v] != id) {
    f->stamp[v] = id;
    f->number[v] = (unsigned short)b->vertices;
    list[b->vertices++] = v;
  }
  return f->number[v];
}

static void set_vertices(const skf_solid *s, skf_solid_block *b, const unsigned *list, filling *f) {
  b->vertex_room = padded(b->vertices);
  b->vertex = f->columns, f->columns += 3 * b->vertex_room;
  b->box = box_empty();
  for (size_t i = 0; i < b->vertex_room; i++) {
    skf_vec3 v = s->vertices[list[i < b->vertices ? i : 0]];
    b->box = box_add(b->box, v);
    for (size_t k = 0; k < 3; k++) b->vertex[k * b->vertex_room + i] = v3_get(v, (int)k);
  }
}

/* pairs: those of this block, whose faces begin at `first` */
static void fill_block(skf_solid *s, unsigned id, size_t first, const skf_solid_pair *pairs, size_t count, filling *f) {
  skf_solid_block *b = s->blocks + id - 1;
  unsigned list[3 * SKF_SOLID_BLOCK];
  b->face_room = padded(b->faces), b->edge_room = padded(count);
  b->face = f->columns, f->columns += SKF_FACE_COLUMNS * b->face_room;
  b->edge = f->columns, f->columns += SKF_EDGE_COLUMNS * b->edge_room;
  b->corners = f->numbers, f->numbers += 3 * b->face_room;
  b->ends = f->numbers, f->numbers += 2 * b->edge_room;
  for (size_t i = 0; i < b->faces; i++) {
    skf_vec3 n = dd3_round(f->normals[first + i]);
    const double row[SKF_FACE_COLUMNS] = {n.x, n.y, n.z, f->twice[first + i]};
    for (size_t k = 0; k < SKF_FACE_COLUMNS; k++) b->face[k * b->face_room + i] = row[k];
    for (size_t k = 0; k < 3; k++) b->corners[k * b->face_room + i] = number_of(b, f, id, s->faces[first + i][k], list);
  }
  for (size_t i = 0; i < count; i++) {
    double row[SKF_EDGE_COLUMNS];
    if (!find_dyad(s, f->normals, pairs + i, row)) continue;
    s->sharp[pairs[i].along / 3] |= (unsigned char)(1 << pairs[i].along % 3);
    s->sharp[pairs[i].against / 3] |= (unsigned char)(1 << pairs[i].against % 3);
    for (size_t k = 0; k < SKF_EDGE_COLUMNS; k++) b->edge[k * b->edge_room + b->edges] = row[k];
    b->ends[b->edges] = number_of(b, f, id, pairs[i].lo, list);
    b->ends[b->edge_room + b->edges++] = number_of(b, f, id, pairs[i].hi, list);
    b->longest = fmax(b->longest, row[SKF_EDGE_LENGTH]);
  }
  for (size_t i = 0; i < 3 * b->faces; i++) { /* edges without a dyad count here, too */
    const unsigned *t = s->faces[first + i / 3];
    b->longest = fmax(b->longest, v3_dist(s->vertices[t[i % 3]], s->vertices[t[(i + 1) % 3]]));
  }
  set_vertices(s, b, list, f);
}

/* The block that takes the edge */
static size_t block_of(const skf_solid_pair *p) {
  return (p->along < p->against ? p->along : p->against) / 3 / SKF_SOLID_BLOCK;
}

static void fill(skf_solid *s, const skf_solid_pair *pairs, size_t count, skf_solid_pair *sorted, size_t *start,
                 filling *f) {
  for (unsigned i = 0; i < s->face_count; i++) f->normals[i] = normal_of(s, i, f->twice + i);
  for (size_t i = 0; i < count; i++) start[block_of(pairs + i) + 2]++;
  for (size_t k = 2; k < s->block_count + 2; k++) start[k] += start[k - 1];
  for (size_t i = 0; i < count; i++) sorted[start[block_of(pairs + i) + 1]++] = pairs[i];
  for (size_t k = 0; k < s->block_count; k++) {
    size_t first = k * SKF_SOLID_BLOCK, left = s->face_count - first;
    s->blocks[k].faces = left < SKF_SOLID_BLOCK ? left : SKF_SOLID_BLOCK;
    fill_block(s, (unsigned)k + 1, first, sorted + start[k], start[k + 1] - start[k], f);
  }
}

skf_status skf_solid_cut(skf_solid *s, const skf_solid_pair *pairs, size_t count) {
  size_t n = s->face_count, nb = s->block_count = (n + SKF_SOLID_BLOCK - 1) / SKF_SOLID_BLOCK;
  size_t faces = n + nb * SKF_SOLID_PAD, edges = count + nb * SKF_SOLID_PAD, vertices = 3 * n + nb * SKF_SOLID_PAD;
  s->blocks = skf_alloc(nb, sizeof *s->blocks);
  s->columns = skf_alloc(3 * vertices + SKF_EDGE_COLUMNS * edges + SKF_FACE_COLUMNS * faces, sizeof *s->columns);
  s->numbers = skf_alloc(2 * edges + 3 * faces, sizeof *s->numbers);
  s->sharp = skf_alloc(n, 1);
  skf_solid_pair *sorted = skf_alloc(count, sizeof *sorted);
  size_t *start = skf_alloc(nb + 2, sizeof *start);
  filling f = {skf_alloc(n, sizeof *f.normals),
               skf_alloc(n, sizeof *f.twice),
               skf_alloc(s->vertex_count, sizeof *f.stamp),
               skf_alloc(s->vertex_count, sizeof *f.number),
               s->numbers,
               s->columns};
  bool room = s->blocks && s->columns && s->numbers && s->sharp && sorted && start && f.normals && f.twice && f.stamp &&
              f.number;
  if (room) fill(s, pairs, count, sorted, start, &f);
  skf_free(sorted), skf_free(start), skf_free(f.normals), skf_free(f.twice), skf_free(f.stamp), skf_free(f.number);
  return room ? SKF_OK : SKF_ERR_NOMEM;
}
