/* SPDX-License-Identifier: MIT */
/* The direct sum for one instruction set: two vectors of targets at once, one puller after the other. */
#include "motion/pairs.h"
#include "simd/vec.h"

enum { ABREAST = 2, BLOCK = ABREAST * SKF_LANES };

typedef struct block {
  double x[3][BLOCK], a[3][BLOCK], rough[BLOCK], same[BLOCK];
} block;

static void pull_block(const skf_pullers *s, block *t) {
  skf_vd x[3][ABREAST], a[3][ABREAST], rough[ABREAST], same[ABREAST], soft = vd_set(s->softening2);
  for (int u = 0; u < ABREAST; u++) {
    for (int k = 0; k < 3; k++) x[k][u] = vd_load(t->x[k] + u * SKF_LANES), a[k][u] = vd_set(0);
    rough[u] = same[u] = vd_set(0);
  }
  for (size_t j = 0; j < s->n; j++) {
    skf_vd px = vd_set(s->x[0][j]), py = vd_set(s->x[1][j]), pz = vd_set(s->x[2][j]), gm = vd_set(s->gm[j]);
    for (int u = 0; u < ABREAST; u++) {
      skf_vd dx = px - x[0][u], dy = py - x[1][u], dz = pz - x[2][u];
      skf_vd r2 = dx * dx + dy * dy + dz * dz + soft;
      skf_vi here = r2 == vd_set(0);
      skf_vd r = vd_sqrt(r2), w = vd_select(here, vd_set(0), gm / (r2 * r));
      a[0][u] += w * dx, a[1][u] += w * dy, a[2][u] += w * dz;
      rough[u] += vd_abs(w) * (vd_abs(dx) + vd_abs(dy) + vd_abs(dz)); /* not w r: a softened one pulls itself by 0 */
      same[u] += vd_select(here, vd_set(1), vd_set(0));
    }
  }
  for (int u = 0; u < ABREAST; u++) {
    for (int k = 0; k < 3; k++) vd_store(t->a[k] + u * SKF_LANES, a[k][u]);
    vd_store(t->rough + u * SKF_LANES, rough[u]);
    vd_store(t->same + u * SKF_LANES, same[u]);
  }
}

void SKF_PAIRS_PULL(const skf_pullers *s, size_t m, const double *const x[3], double *const a[3], double *rough,
                    unsigned *same) {
  for (size_t from = 0; from < m; from += BLOCK) {
    block t;
    for (size_t i = 0; i < BLOCK; i++) {
      size_t at = from + i < m ? from + i : m - 1;
      for (int k = 0; k < 3; k++) t.x[k][i] = x[k][at];
    }
    pull_block(s, &t);
    for (size_t i = 0; i < BLOCK && from + i < m; i++) {
      for (int k = 0; k < 3; k++) a[k][from + i] += t.a[k][i];
      rough[from + i] += t.rough[i];
      same[from + i] += (unsigned)t.same[i];
    }
  }
}
