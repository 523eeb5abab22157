/* SPDX-License-Identifier: MIT */
/* Segments and arcs whose weight varies along them. */
#ifndef SKF_FIELD_PROFILED_H
#define SKF_FIELD_PROFILED_H

#include "field/kernel.h"

/* Value, gradient (order 1), Hessian (order 2) of an element with a weight; *v arrives zeroed. The kernels are the
   seven. */
void skf_profiled(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* Gauss rules on the way from x = lo to hi > lo, on one side of the closest approach at 0; length = hi - lo, known
   without cancellation. `at` gets x, x - lo and hi - x as parts of the length, and dx. */
typedef struct skf_march {
  void (*at)(void *context, double x, double u, double v, double dx);
  void *context;
} skf_march;

/* n nodes for the whole way. */
void skf_march_plain(const skf_march *m, double lo, double length, int n);
/* For functions of hypot(x, delta) and slower ones, to rounding: panels that grow with x. */
void skf_march_graded(const skf_march *m, double lo, double hi, double length, double delta);

void skf_profiled_segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);
void skf_profiled_arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* h and its derivatives by w = r^2, from w and for compact kernels from q = R^2 - w. */
static inline void skf_profiled_law(const skf_kernel_ops *row, double param, double w, double q, double d[4]) {
  if (row->power)
    row->power(param, w, q, d);
  else
    row->eval(param, w, d);
}

#endif
