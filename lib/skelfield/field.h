/* SPDX-License-Identifier: MIT */
/* Fields of skeletons: F(p) = sum_i w_i integral over S_i of h_i(|p - q|) d mu(q), its gradient and its Hessian. */
#ifndef SKELFIELD_FIELD_H
#define SKELFIELD_FIELD_H

#include "skelfield/skeleton.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum skf_kernel_type {
  SKF_CAUCHY,
  SKF_GAUSSIAN,
  SKF_INVERSE,
  SKF_INVERSE_SQUARED,
  SKF_METABALL,
  SKF_SOFT_OBJECT,
  SKF_QUARTIC,
  SKF_KERNEL_COUNT
} skf_kernel_type;

/* A kernel with its parameter: s or a [1/L], R [L]; ignored by inverse and inverse-squared. */
typedef struct skf_kernel {
  skf_kernel_type type;
  double param;
} skf_kernel;

/* A registered kernel. */
typedef struct skf_kernel_info {
  const char *name, *formula, *doc;
  const char *param, *param_unit, *param_doc; /* param is NULL when there is none */
  bool compact;                               /* vanishes for r >= R */
  bool singular;                              /* infinite at r = 0 */
} skf_kernel_info;

SKF_API const skf_kernel_info *skf_kernel_get(skf_kernel_type type);
/* By name ("inverse-squared"); SKF_KERNEL_COUNT when there is none. */
SKF_API skf_kernel_type skf_kernel_find(const char *name);

/* h(r) and its derivatives with respect to w = r^2, up to the third: d[0] = h, d[1] = dh/dw, ... */
SKF_API void skf_kernel_eval(skf_kernel kernel, double r2, double d[4]);

/* One primitive with its kernel and strength w (any sign, not 0 or non-finite). */
typedef struct skf_element {
  skf_primitive primitive;
  skf_kernel kernel;
  double strength;
} skf_element;

/* A field that is ready to be evaluated: immutable, safe to share between threads. */
typedef struct skf_field skf_field;

/* Copies the elements. SKF_ERR_ARG, SKF_ERR_RANGE, SKF_ERR_DEGENERATE or SKF_ERR_NOMEM on failure; n = 0 is the zero
   field. */
SKF_API skf_status skf_field_new(const skf_element *elements, size_t n, skf_field **out);
SKF_API void skf_field_free(skf_field *field);

SKF_API size_t skf_field_size(const skf_field *field);
SKF_API const skf_element *skf_field_element(const skf_field *field, size_t i);

/* Value [per kernel] and gradient with respect to p at one point; g may be NULL.
   On a singular set: F = +-infinity and g = 0; see skf_pair_get. */
SKF_API double skf_field_at(const skf_field *field, skf_vec3 p, skf_vec3 *g);

/* Value, gradient and Hessian (xx, xy, xz, yy, yz, zz) at one point. */
SKF_API double skf_field_tensor_at(const skf_field *field, skf_vec3 p, skf_vec3 *g, double h[6]);

/* n points in structure-of-arrays form. p[0..2]: x, y, z. F: n values. g: NULL or three arrays. h: NULL or six arrays
   in the order above. Any output array may be NULL. Runs on OpenMP's current number of threads; the result does not
   depend on it, nor on a point's neighbours.
   F and the gradient of the commonest pairs are evaluated four points at a time where the processor has AVX2 and FMA.
   They then differ from skf_field_at by 20 units of 1.1e-16 (segments 60, arcs 100, triangles 1000) at most, relative
   to |F| and max(|g|, |F| / distance), times how many times the field's own relative change exceeds the point's. With
   SKELFIELD_ISA=scalar in the environment when the field is made they are the same bits. */
SKF_API skf_status skf_field_eval(const skf_field *field, size_t n, const double *const p[3], double *F,
                                  double *const g[3], double *const h[6]);

/* How one kernel on one shape is evaluated. */
typedef struct skf_pair_info {
  bool closed;          /* closed form or guaranteed expansion; else adaptive quadrature */
  double error;         /* relative error of F aimed at, away from ill-conditioned places */
  const char *singular; /* where F is infinite or the gradient jumps, and what is returned there; NULL: nowhere */
} skf_pair_info;

SKF_API skf_pair_info skf_pair_get(skf_kernel_type kernel, skf_shape shape);

/* Enclosure of the field in the ball |p - center| <= radius. Every bound is rigorous up to rounding, none is tight. */
typedef struct skf_bound {
  double lo, hi;   /* of F */
  double gradient; /* upper bound of |grad F| */
  double hessian;  /* upper bound of the spectral norm of the Hessian */
  double fourth;   /* upper bound of |d^4 F / dt^4| along any straight line at unit speed */
} skf_bound;

SKF_API skf_bound skf_field_bound(const skf_field *field, skf_vec3 center, double radius);

/* A box outside of which F < iso everywhere; SKF_ERR_UNBOUNDED when there is none (a plane, iso <= 0), SKF_ERR_EMPTY
   when F < iso everywhere. */
SKF_API skf_status skf_field_region(const skf_field *field, double iso, skf_box *out);

#ifdef __cplusplus
}
#endif
#endif
