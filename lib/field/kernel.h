/* SPDX-License-Identifier: MIT */
/* The row that each kernel's file gives to the registry. */
#ifndef SKF_FIELD_KERNEL_H
#define SKF_FIELD_KERNEL_H

#include "skelfield/field.h"
#include "core/vec3.h"

/* Value and gradient of one primitive at one point. */
typedef struct skf_value {
  double F;
  skf_vec3 g;
} skf_value;

typedef skf_value (*skf_closed)(double param, const skf_primitive *p, skf_vec3 x);

typedef struct skf_kernel_ops {
  skf_kernel_info info;
  /* h and its first three derivatives with respect to w = r^2; d = 0 beyond a compact support */
  void (*eval)(double param, double w, double d[4]);
  skf_closed closed[SKF_SHAPE_COUNT]; /* NULL: quadrature */
} skf_kernel_ops;

extern const skf_kernel_ops skf_kernel_cauchy, skf_kernel_gaussian, skf_kernel_inverse, skf_kernel_inverse_squared,
    skf_kernel_metaball, skf_kernel_soft_object, skf_kernel_quartic;

const skf_kernel_ops *skf_kernel_row(skf_kernel_type type);

#endif
