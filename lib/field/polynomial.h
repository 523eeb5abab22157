/* SPDX-License-Identifier: MIT */
/* Kernels h = m^2 (c2 + c3 m), m = 1 - r^2/R^2 inside R: quartic and soft object. Gauss rules integrate them exactly
   along a segment, with every term positive, where differences of antiderivatives lose up to 1e-3. */
#ifndef SKF_FIELD_POLYNOMIAL_H
#define SKF_FIELD_POLYNOMIAL_H

#include "field/kernel.h"

typedef struct skf_polynomial {
  double c2, c3;
} skf_polynomial;

/* h and its derivatives with respect to w = r^2 from q = R^2 - w. */
void skf_polynomial_eval(skf_polynomial p, double R, double q, double d[4]);

void skf_polynomial_point(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v);
void skf_polynomial_segment(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v);
void skf_polynomial_arc(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v);
void skf_polynomial_plane(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

#endif
