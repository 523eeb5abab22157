/* SPDX-License-Identifier: MIT */
/* Sums of elements at many points, in floats: the forms that pictures need most. */
#ifndef SKF_FIELD_BATCH_F32_H
#define SKF_FIELD_BATCH_F32_H

#include "field/batch.h"

enum { SKF_F32_PAD = 16 }; /* points are padded to this, a multiple of every instruction set's lanes */

typedef struct skf_f32_ops {
  skf_batch_ops pack; /* columns and pack only */
  /* strength times F and the gradient, summed over the tile, by scale[0] and scale[1], or not if `scale` is NULL */
  void (*add[SKF_FORM_COUNT])(const skf_tile *t, size_t n, const float *const p[3], const double scale[2],
                              float *const sum[4]);
  /* out = v, but 0 where F is not finite and v is not F */
  void (*keep)(size_t n, const float *F, const float *v, float *out);
} skf_f32_ops;

extern const skf_f32_ops skf_f32_avx2, skf_f32_avx512;

#endif
