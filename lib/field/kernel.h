/* SPDX-License-Identifier: MIT */
/* The row that each kernel's file gives to the registry, and what a closed form gets and gives. */
#ifndef SKF_FIELD_KERNEL_H
#define SKF_FIELD_KERNEL_H

#include "skelfield/field.h"
#include "field/plan.h"
#include "field/triangle_plan.h"
#include "field/weight.h"

/* Value, gradient and Hessian (xx, xy, xz, yy, yz, zz) of one primitive at one point; strength is not in them. */
typedef struct skf_value {
  double F;
  skf_vec3 g;
  double h[6];
} skf_value;

/* A primitive made ready for many points, once per field. A shape that has something to keep adds its plan here and
   fills it in skf_prepare. */
typedef struct skf_prepared {
  skf_primitive primitive;
  skf_kernel kernel;
  double strength;
  bool moderate, scalable;  /* see field/extreme.h; whether that serves the pair */
  const skf_weight *weight; /* of a profile; NULL: none */
  union {
    skf_segment_plan segment;
    skf_arc_plan arc;
    skf_plane_plan plane;
    skf_triangle_plan triangle;
    const struct skf_solid_ops *solid; /* how it is evaluated here; what it keeps is in the solid itself */
  } plan;
} skf_prepared;

/* The primitive has been checked; `weight` is left NULL. */
void skf_prepare(const skf_element *element, skf_prepared *out);

/* The pair's closed form, or quadrature. *v arrives zeroed. */
void skf_element_value(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* Value and gradient (order 1), Hessian too (order 2). *v arrives zeroed; order 1 leaves v->h alone. On a singular set
   F = +infinity, the rest stays zero. */
typedef void (*skf_closed)(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

typedef struct skf_kernel_ops {
  skf_kernel_info info;
  /* h and its first three derivatives with respect to w = r^2; d = 0 beyond a compact support */
  void (*eval)(double param, double w, double d[4]);
  /* the same from w and q = R^2 - w, which carries the relative accuracy near the rim; compact kernels only */
  void (*power)(double R, double w, double q, double d[4]);
  skf_closed closed[SKF_SHAPE_COUNT];    /* NULL: quadrature */
  const char *singular[SKF_SHAPE_COUNT]; /* where F is infinite or the gradient jumps, and what is returned */
} skf_kernel_ops;

extern const skf_kernel_ops skf_kernel_cauchy, skf_kernel_gaussian, skf_kernel_inverse, skf_kernel_inverse_squared,
    skf_kernel_metaball, skf_kernel_soft_object, skf_kernel_quartic;
/* Of users' kernels; no `eval`, and what it tells of them is told by the functions below. */
extern const skf_kernel_ops skf_kernel_user;

/* The row of a registered kernel, or the users'. */
const skf_kernel_ops *skf_kernel_row(skf_kernel_type type);

/* What holds for any kernel: whether h(0) is infinite, where h ends (INFINITY: nowhere). */
bool skf_kernel_singular(skf_kernel k);
double skf_kernel_end(skf_kernel k);
/* A length below which a user's kernel does not change; 0 where that is not known. */
double skf_kernel_grain(skf_kernel k);
/* The radii at which it is not smooth, its end among them; returns their number. */
enum { SKF_KERNEL_BREAKS = SKF_USER_BREAKS + 1 };
int skf_kernel_breaks(skf_kernel k, double radii[SKF_KERNEL_BREAKS]);

/* SKF_OK, SKF_ERR_ARG, SKF_ERR_RANGE, or SKF_ERR_UNSUPPORTED for a kernel that cannot be integrated over the shape. */
skf_status skf_kernel_check(skf_kernel k, skf_shape shape);
/* Whether envelopes of the pair are known. */
bool skf_kernel_has_bound(skf_kernel k, skf_shape shape);

#endif
