/* SPDX-License-Identifier: MIT */
/* Where the surface is: a box around all of it, and boxes around parts that are far from each other. */
#include "field/envelope.h"
#include "surface/edges.h"
#include "surface/mesher.h"
#include <string.h>

skf_status skf_surface_region(const skf_field *field, double iso, skf_box *out, bool *around) {
  bool turned = iso < 0; /* far away F is 0, which is inside then */
  if (around) *around = turned;
  if (!turned) return skf_field_region(field, iso, out);
  skf_field *f;
  skf_status s = skf_field_negative(field, &f);
  if (s) return s;
  s = skf_field_region(f, -iso, out);
  skf_field_free(f);
  return s;
}

enum { DEPTH = 5, MOST_PARTS = 1024 }; /* cells along an axis: 2^DEPTH */

/* How far apart two boxes are along the axis where that is most. */
static double gap(const skf_box *a, const skf_box *b) {
  double most = -INFINITY;
  for (int i = 0; i < 3; i++)
    most = fmax(most, fmax(v3_get(a->lo, i) - v3_get(b->hi, i), v3_get(b->lo, i) - v3_get(a->hi, i)));
  return most;
}

/* Far enough for meshes of their own: these stay within two cubes of their boxes, and a cube is a small share of a
   part's size, or `edge` long. */
static bool are_apart(const skf_box *a, const skf_box *b, double edge) {
  double da = box_diagonal(*a), db = box_diagonal(*b);
  return gap(a, b) >= fmax(fmax(fmin(da, db), 0.25 * (da + db)), 20 * edge);
}

/* Joins boxes until all that are left are apart. */
static size_t join_near(size_t n, skf_box *boxes, double edge) {
  for (bool again = true; again;) {
    again = false;
    for (size_t i = 0; i < n; i++)
      for (size_t j = i + 1; j < n;)
        if (are_apart(boxes + i, boxes + j, edge))
          j++;
        else
          boxes[i] = box_join(boxes[i], boxes[j]), boxes[j] = boxes[--n], again = true;
  }
  return n;
}

/* The cells of a coarse octree that may hold the surface within `whole`; boxes of those that touch, at most `capacity`:
   SKF_ERR_CAPACITY beyond. */
static skf_status coarse_boxes(skf_mesher *m, skf_box whole, size_t capacity, skf_box *boxes, size_t *count) {
  skf_vec3 d = v3_sub(whole.hi, whole.lo), c = box_center(whole);
  double r = 0.5 * fmax(d.x, fmax(d.y, d.z)) * (1 + 1e-9), side = ldexp(2 * r, -DEPTH);
  m->region = whole, m->limit = SIZE_MAX;
  m->lattice = (skf_lattice){v3_sub(c, v3(r, r, r)), 0.5 * side, DEPTH};
  skf_status s = skf_mesher_cells(m);
  size_t n = m->cube_count;
  unsigned *parent = skf_alloc(n, sizeof *parent);
  unsigned *at = skf_alloc((size_t)1 << 3 * DEPTH, sizeof *at); /* 1 + the cube at a place */
  if (!s && !(parent && at)) s = SKF_ERR_NOMEM;
  for (unsigned i = 0; i < n && !s; i++) {
    int x[3];
    skf_key_get(m->cubes[i], x);
    parent[i] = i;
    at[x[0] / 2 + ((x[1] / 2 + (x[2] / 2 << DEPTH)) << DEPTH)] = i + 1;
  }
  for (size_t i = 0; i < n && !s; i++) {
    int x[3], y[3];
    skf_key_get(m->cubes[i], x);
    for (int k = 0; k < 13; k++) { /* half of the 26 around it */
      bool in = true;
      for (int j = 0, q = k; j < 3; j++, q /= 3) y[j] = x[j] / 2 + q % 3 - 1, in &= y[j] >= 0 && y[j] < 1 << DEPTH;
      unsigned other = in ? at[y[0] + ((y[1] + (y[2] << DEPTH)) << DEPTH)] : 0;
      if (other) skf_join(parent, i, other - 1);
    }
  }
  *count = 0;
  /* a root is the first of its set, so its box is there before the others come */
  for (size_t i = 0; i < n && !s; i++) {
    size_t root = skf_root_of(parent, i);
    skf_vec3 p = skf_lattice_at(&m->lattice, m->cubes[i]);
    skf_box cell = box_grow((skf_box){p, p}, 0.5 * side * (1 + 1e-9));
    if (root == i && *count == capacity) s = SKF_ERR_CAPACITY;
    if (s) break;
    if (root == i) at[i] = (unsigned)*count, boxes[(*count)++] = cell;
    boxes[at[root]] = box_join(boxes[at[root]], cell);
  }
  for (size_t i = 0; i < *count && !s; i++)
    for (int j = 0; j < 3; j++) {
      *v3_at(&boxes[i].lo, j) = fmax(v3_get(boxes[i].lo, j), v3_get(whole.lo, j));
      *v3_at(&boxes[i].hi, j) = fmin(v3_get(boxes[i].hi, j), v3_get(whole.hi, j));
    }
  skf_free(parent), skf_free(at), skf_free(m->cubes);
  m->cubes = NULL, m->cube_count = 0;
  return s;
}

/* Divides boxes until none divides or shrinks to half any more. */
static skf_status divide(skf_mesher *m, double edge, skf_box *boxes, size_t *count) {
  skf_box *found = skf_alloc(MOST_PARTS, sizeof *found);
  skf_status s = found ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < *count && !s;) {
    size_t n;
    s = coarse_boxes(m, boxes[i], MOST_PARTS, found, &n);
    if (s) break;
    n = join_near(n, found, edge);
    if (*count + n > MOST_PARTS + 1) {
      s = SKF_ERR_CAPACITY;
      break;
    }
    bool same = n == 1 && box_diagonal(found[0]) > 0.5 * box_diagonal(boxes[i]);
    if (same) { /* the box it had is looser, but known */
      i++;
      continue;
    }
    /* In place of it, in their order; none: nothing is in it. */
    memmove(boxes + i + n, boxes + i + 1, (*count - i - 1) * sizeof *boxes);
    memcpy(boxes + i, found, n * sizeof *boxes);
    *count += n - 1;
  }
  skf_free(found);
  return s;
}

skf_status skf_mesher_parts(const skf_mesher *like, double edge, skf_box **boxes, size_t *count) {
  skf_mesher m = {.field = like->field, .iso = like->iso, .progress = like->progress};
  skf_box *b = *boxes = skf_alloc(MOST_PARTS, sizeof *b);
  if (!b) return SKF_ERR_NOMEM;
  b[0] = like->region, *count = 1;
  skf_status s = divide(&m, edge, b, count);
  if (!s) *count = join_near(*count, b, edge); /* of different boxes, that have shrunk */
  /* Too many to be worth it, one, or none that bounds can tell from it: the whole. */
  if (s == SKF_ERR_CAPACITY || (!s && *count <= 1)) b[0] = like->region, *count = 1, s = SKF_OK;
  if (s) skf_free(b), *boxes = NULL, *count = 0;
  return s;
}

skf_status skf_surface_parts(const skf_field *field, double iso, skf_box **boxes, size_t *count) {
  skf_mesher m = {.field = field, .iso = iso};
  *boxes = NULL, *count = 0;
  skf_status s = skf_surface_region(field, iso, &m.region, NULL);
  return s ? s : skf_mesher_parts(&m, 0, boxes, count);
}

void skf_surface_parts_free(skf_box *boxes) { skf_free(boxes); }
