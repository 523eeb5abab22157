/* SPDX-License-Identifier: MIT */
#include "field/sparse.h"
#include "core/alloc.h"
#include <stdlib.h>
#include <string.h>

static const skf_box everywhere = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};

skf_box skf_sparse_reach(const skf_prepared *e) {
  const skf_kernel_info *k = skf_kernel_get(e->kernel.type);
  const bool gaussian = e->kernel.type == SKF_GAUSSIAN; /* exp(-800) is 0 */
  if (!k || !(k->compact || gaussian) || e->primitive.shape == SKF_PLANE) return everywhere;
  skf_box b = skf_primitive_bounds(&e->primitive);
  double R = gaussian ? sqrt(800) / e->kernel.param : e->kernel.param, size = 0;
  for (int i = 0; i < 3; i++) size = fmax(size, fmax(fabs(v3_get(b.lo, i)), fabs(v3_get(b.hi, i))));
  return box_grow(b, R + 1e-9 * (R + size));
}

static int by_code(const void *a, const void *b) {
  const skf_sparse_key *x = a, *y = b;
  if (x->code != y->code) return x->code < y->code ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

/* By bytes of the code from the lowest, each pass keeping the order of the one before [Knuth, vol. 3, sec. 5.2.5]. */
static void by_bytes(skf_sparse_key *keys, skf_sparse_key *room, size_t n) {
  enum { BYTES = sizeof keys->code };
  size_t count[BYTES][256] = {{0}};
  skf_sparse_key *from = keys, *to = room;
  for (size_t i = 0; i < n; i++)
    for (int b = 0; b < BYTES; b++) count[b][keys[i].code >> 8 * b & 255]++;
  for (int b = 0; b < BYTES; b++) {
    size_t at = 0;
    if (count[b][from->code >> 8 * b & 255] == n) continue; /* all the same */
    for (int k = 0; k < 256; k++) {
      size_t here = count[b][k];
      count[b][k] = at, at += here;
    }
    for (size_t i = 0; i < n; i++) to[count[b][from[i].code >> 8 * b & 255]++] = from[i];
    skf_sparse_key *swap = from;
    from = to, to = swap;
  }
  if (from != keys) memcpy(keys, from, n * sizeof *keys);
}

void skf_sparse_sort(skf_sparse_key *keys, size_t n) {
  skf_sparse_key *room = n < 256 ? NULL : skf_alloc(n, sizeof *room);
  if (room)
    by_bytes(keys, room, n);
  else
    qsort(keys, n, sizeof *keys, by_code);
  skf_free(room);
}

/* Two zero bits behind each of 21. */
static uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

double skf_sparse_share(const skf_box *reach, const skf_box *box) {
  double share = 1;
  for (int k = 0; k < 3; k++) {
    double lo = v3_get(box->lo, k), hi = v3_get(box->hi, k);
    double common = fmin(hi, v3_get(reach->hi, k)) - fmax(lo, v3_get(reach->lo, k));
    share *= common < 0 ? 0 : hi > lo ? common / (hi - lo) : 1;
  }
  return share;
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
  double lo[3], hi[3], sum = 0;
  for (int k = 0; k < 3; k++) {
    const double *x = p[k];
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < n; i++) {
      least = x[i] < least ? x[i] : least, most = x[i] > most ? x[i] : most;
      sum += 0 * x[i];
    }
    lo[k] = least, hi[k] = most;
  }
  return sum == 0 ? (skf_box){v3(lo[0], lo[1], lo[2]), v3(hi[0], hi[1], hi[2])} : everywhere;
}
