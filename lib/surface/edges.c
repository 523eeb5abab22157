/* SPDX-License-Identifier: MIT */
#include "surface/edges.h"
#include <stdlib.h>

static int by_edge(const void *a, const void *b) {
  const skf_side *x = a, *y = b;
  if (x->hi != y->hi) return x->hi < y->hi ? -1 : 1;
  return x->side < y->side ? -1 : x->side > y->side;
}

/* Buckets by the lower vertex, then each bucket sorted: it holds few sides. */
skf_status skf_sides_sorted(const skf_mesh *mesh, skf_side **out) {
  size_t n = 3 * mesh->triangle_count, nv = mesh->vertex_count;
  skf_side *sides = *out = skf_alloc(n, sizeof *sides);
  size_t *start = skf_alloc(nv + 2, sizeof *start);
  if (!sides || !start) return skf_free(sides), skf_free(start), *out = NULL, SKF_ERR_NOMEM;
  const unsigned *v = (const unsigned *)mesh->triangles;
  for (size_t s = 0; s < n; s++) {
    unsigned a = v[s], b = v[s % 3 == 2 ? s - 2 : s + 1];
    start[(size_t)(a < b ? a : b) + 2]++;
  }
  for (size_t i = 2; i < nv + 2; i++) start[i] += start[i - 1];
  for (size_t s = 0; s < n; s++) {
    unsigned a = v[s], b = v[s % 3 == 2 ? s - 2 : s + 1], lo = a < b ? a : b;
    sides[start[(size_t)lo + 1]++] = (skf_side){lo, a < b ? b : a, s, a < b};
  }
  for (size_t i = 0; i < nv; i++) qsort(sides + start[i], start[i + 1] - start[i], sizeof *sides, by_edge);
  skf_free(start);
  return SKF_OK;
}

size_t skf_root_of(unsigned *parent, size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

void skf_join(unsigned *parent, size_t a, size_t b) {
  a = skf_root_of(parent, a), b = skf_root_of(parent, b);
  if (a < b)
    parent[b] = (unsigned)a;
  else
    parent[a] = (unsigned)b;
}
