/* SPDX-License-Identifier: MIT */
#include "field/sparse.h"
#include "core/alloc.h"
#include <stdlib.h>

static const skf_box everywhere = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};

skf_box skf_sparse_reach(const skf_prepared *e) {
  const skf_kernel_info *k = skf_kernel_get(e->kernel.type);
  if (!k || !k->compact || e->primitive.shape == SKF_PLANE) return everywhere;
  skf_box b = skf_primitive_bounds(&e->primitive);
  double R = e->kernel.param, size = 0;
  for (int i = 0; i < 3; i++) size = fmax(size, fmax(fabs(v3_get(b.lo, i)), fabs(v3_get(b.hi, i))));
  return box_grow(b, R + 1e-9 * (R + size));
}

static int by_code(const void *a, const void *b) {
  const skf_sparse_key *x = a, *y = b;
  if (x->code != y->code) return x->code < y->code ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

void skf_sparse_sort(skf_sparse_key *keys, size_t n) { qsort(keys, n, sizeof *keys, by_code); }

/* Two zero bits behind each of 21. */
static uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

uint64_t skf_sparse_code(skf_vec3 p, const skf_box *box) {
  uint64_t code = 0;
  for (int i = 0; i < 3; i++) {
    double lo = v3_get(box->lo, i), q = (v3_get(p, i) - lo) / (v3_get(box->hi, i) - lo) * 0x1p21;
    code |= spread(q > 0 ? q < 0x1p21 ? (uint64_t)q : 0x1fffff : 0) << i;
  }
  return code;
}

skf_sparse_key *skf_sparse_order(const skf_prepared *elements, size_t n, bool sorted, bool *sparse) {
  skf_sparse_key *keys = skf_alloc(n, sizeof *keys);
  skf_box all = box_empty();
  size_t finite = 0;
  for (size_t i = 0; i < n && keys; i++) {
    skf_box b = skf_sparse_reach(elements + i);
    keys[i].index = i;
    if (b.hi.x < INFINITY) all = box_join(all, b), finite++;
  }
  *sparse = finite >= SKF_SPARSE_LEAST;
  if (!keys || !*sparse || !sorted) return keys;
  for (size_t i = 0; i < n; i++) {
    skf_box b = skf_sparse_reach(elements + i);
    if (b.hi.x < INFINITY) keys[i].code = skf_sparse_code(box_center(b), &all);
  }
  skf_sparse_sort(keys, n);
  return keys;
}

skf_box skf_sparse_around(size_t n, const double *const p[3]) {
  skf_box b = box_empty();
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    b = box_add(b, v3(p[0][i], p[1][i], p[2][i]));
    sum += 0 * (p[0][i] + p[1][i] + p[2][i]);
  }
  return sum == 0 ? b : everywhere;
}
