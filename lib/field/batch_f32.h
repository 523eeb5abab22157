/* SPDX-License-Identifier: MIT */
/* Sums of elements at many points, in floats: the forms that pictures need most. */
#ifndef SKF_FIELD_BATCH_F32_H
#define SKF_FIELD_BATCH_F32_H

#include "field/batch.h"

/* Points are padded to SKF_F32_PAD, a multiple of every instruction set's lanes; points in a block; tiles whose sums
   are added in floats. */
enum { SKF_F32_PAD = 16, SKF_F32_BATCH = 256, SKF_F32_TILES = 8 };

typedef struct skf_f32_ops {
  skf_batch_ops pack; /* columns and pack only */
  /* Strength times F and the gradient, summed over the tile; `more`: onto the sum, of SKF_F32_BATCH points at most. Of
     a tile of one element by scale[0] and scale[1] unless `scale` is NULL. */
  void (*add[SKF_FORM_COUNT])(const skf_tile *t, size_t n, const float *const p[3], const double scale[2],
                              float *const sum[4], bool more);
  /* out = v times by[v is not F], but 0 where F is not finite and v is not F */
  void (*keep)(size_t n, const double by[2], const float *F, const float *v, float *out);
  /* sum += by part */
  void (*gather)(size_t n, double by, const float *part, double *sum);
} skf_f32_ops;

extern const skf_f32_ops skf_f32_avx2, skf_f32_avx512;

#endif
