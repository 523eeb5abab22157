/* SPDX-License-Identifier: MIT */
/* The body-centred cubic lattice and the table of its sampled nodes. */
#include "surface/mesher.h"
#include <string.h>

const signed char skf_star[14][3] = {
    {2, 0, 0},  {-2, 0, 0}, {0, 2, 0},   {0, -2, 0}, {0, 0, 2},   {0, 0, -2},  {1, 1, 1},
    {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}, {1, 1, -1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, -1},
};

/* Around each long neighbour (0..5) four short ones, counter-clockwise from outside. */
const unsigned char skf_star_faces[24][3] = {
    {0, 12, 10}, {0, 10, 6}, {0, 6, 8}, {0, 8, 12}, {1, 11, 13}, {1, 13, 9},  {1, 9, 7},   {1, 7, 11},
    {2, 10, 11}, {2, 11, 7}, {2, 7, 6}, {2, 6, 10}, {3, 8, 9},   {3, 9, 13},  {3, 13, 12}, {3, 12, 8},
    {4, 6, 7},   {4, 7, 9},  {4, 9, 8}, {4, 8, 6},  {5, 12, 13}, {5, 13, 11}, {5, 11, 10}, {5, 10, 12},
};

/* Mean edge length of the triangles that the improved mesh has, in units of the cube's side: measured on spheres and
   tori. */
static const double edge_per_side = 0.77;

skf_status skf_lattice_set(skf_lattice *l, skf_box region, double edge) {
  double side = edge / edge_per_side;
  skf_vec3 d = v3_sub(region.hi, region.lo);
  double width = fmax(d.x, fmax(d.y, d.z)) + 8 * side;
  int depth = 3;
  while (depth < 19 && ldexp(side, depth) < width) depth++;
  if (!(ldexp(side, depth) >= width)) return SKF_ERR_CAPACITY;
  /* Off the centre by shares of a side without meaning, so that symmetric bodies do not meet nodes everywhere. */
  skf_vec3 c = v3_add(box_center(region), v3(0.3819 * side, 0.2361 * side, 0.4427 * side));
  double r = ldexp(side, depth - 1);
  *l = (skf_lattice){v3_sub(c, v3(r, r, r)), 0.5 * side, depth};
  return SKF_OK;
}

skf_vec3 skf_lattice_at(const skf_lattice *l, skf_key key) {
  int x[3];
  skf_key_get(key, x);
  return v3(l->origin.x + l->half * x[0], l->origin.y + l->half * x[1], l->origin.z + l->half * x[2]);
}

static size_t hash(skf_key k) {
  k *= 0x9e3779b97f4a7c15u;
  return (size_t)(k ^ k >> 32);
}

unsigned skf_nodes_find(const skf_nodes *n, skf_key key) {
  if (!n->table) return SKF_NONE;
  for (size_t h = hash(key) & n->mask; n->table[h]; h = (h + 1) & n->mask)
    if (n->key[n->table[h] - 1] == key) return n->table[h] - 1;
  return SKF_NONE;
}

static bool grow(void *array, size_t count, size_t size) {
  void *old;
  memcpy(&old, array, sizeof old);
  void *p = skf_realloc(old, count, size);
  if (p) memcpy(array, &p, sizeof p);
  return p;
}

static bool reserve(skf_nodes *n) {
  size_t capacity = n->capacity ? 2 * n->capacity : 4096, slots = 2 * capacity;
  if (capacity >= SKF_NONE / 8) return false;
  if (!grow(&n->key, capacity, sizeof *n->key) || !grow(&n->F, capacity, sizeof *n->F) ||
      !grow(&n->at, capacity, sizeof *n->at) || !grow(&n->sign, capacity, 1) || !grow(&n->zero, capacity, 1))
    return false;
  unsigned *table = skf_alloc(slots, sizeof *table);
  if (!table) return false;
  skf_free(n->table);
  n->table = table, n->mask = slots - 1, n->capacity = capacity;
  for (size_t i = 0; i < n->count; i++) {
    size_t h = hash(n->key[i]) & n->mask;
    while (table[h]) h = (h + 1) & n->mask;
    table[h] = (unsigned)i + 1;
  }
  return true;
}

unsigned skf_nodes_add(skf_nodes *n, const skf_lattice *l, skf_key key) {
  unsigned old = skf_nodes_find(n, key);
  if (old != SKF_NONE) return old;
  if (n->count == n->capacity && !reserve(n)) return SKF_NONE;
  size_t h = hash(key) & n->mask;
  while (n->table[h]) h = (h + 1) & n->mask;
  unsigned i = (unsigned)n->count++;
  n->table[h] = i + 1;
  n->key[i] = key, n->F[i] = NAN, n->at[i] = skf_lattice_at(l, key), n->sign[i] = -1, n->zero[i] = 0;
  return i;
}

void skf_nodes_free(skf_nodes *n) {
  skf_free(n->table), skf_free(n->key), skf_free(n->F), skf_free(n->at), skf_free(n->sign), skf_free(n->zero);
  *n = (skf_nodes){0};
}

size_t skf_edge_slot(const skf_nodes *n, unsigned a, unsigned b) {
  int x[3], y[3], d[3];
  skf_key_get(n->key[a], x);
  skf_key_get(n->key[b], y);
  for (int i = 0; i < 3; i++) d[i] = y[i] - x[i];
  int first = d[0] == 0 || d[0] == 2 || d[0] == -2 ? d[0] + d[1] + d[2] : d[2]; /* > 0: the edge belongs to a */
  unsigned owner = first > 0 ? a : b;
  if (first < 0)
    for (int i = 0; i < 3; i++) d[i] = -d[i];
  int slot = d[0] == 2 ? 0 : d[1] == 2 ? 1 : d[2] == 2 ? 2 : 3 + (d[0] > 0) + 2 * (d[1] > 0);
  return 7 * (size_t)owner + (size_t)slot;
}
