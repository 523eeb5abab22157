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
  SKF_KERNEL_COUNT,
  SKF_USER_KERNEL /* none of the registry: the caller's own */
} skf_kernel_type;

typedef struct skf_user_kernel skf_user_kernel;

/* A kernel with its parameter: s or a [1/L], R [L]; ignored by inverse, inverse-squared and users' kernels. */
typedef struct skf_kernel {
  skf_kernel_type type;
  double param;
  const skf_user_kernel *user; /* of SKF_USER_KERNEL, ignored by the others */
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

/* Suprema over all r >= a of a kernel and its derivatives. */
typedef struct skf_envelope {
  double value;  /* of h */
  double slope;  /* of |h'| = |dh/dr| */
  double bend;   /* of max(|h''|, |h'| / r): the spectral norm of the Hessian of h(|p|) */
  double fourth; /* of |d^4 h(|p|) / dt^4| along straight lines, where it exists: with w = r^2 and x = t^2 <= w that is
                    12 h_ww + 48 x h_www + 16 x^2 h_wwww */
} skf_envelope;

enum { SKF_USER_BREAKS = 8 };

/* A kernel of the caller's own, for elements with {.type = SKF_USER_KERNEL, .user = &this}. It and what it points to
   stay with the caller, unchanged, for as long as fields that use it live; the callbacks run on several threads at
   once.

   Points are evaluated directly; segments, arcs, triangles and planes by adaptive quadrature: F, gradient and Hessian
   to a relative error of 1e-10, as tests/field/test_user_kernel.c checks (which finds 1e-13 on the kernels of the
   registry); a curve or plane takes 10 to 300 us a point, a triangle 1 to 50 ms. A plane needs a kernel with a finite
   radius or that decays fast enough, else skf_field_new answers SKF_ERR_UNSUPPORTED.

   Without `bound` a field only evaluates. skf_field_bound then answers with infinite bounds, and what would have to
   guess is refused with SKF_ERR_UNSUPPORTED: regions, tracers, meshes and contact (skf_field_has_bound tells
   beforehand); so are planes of users' kernels, always. With `bound` they all work, as certain as `bound` is true.

   A Plummer sphere of core b, 1 / sqrt(r^2 + b^2):

     static void plummer(const void *user, double r2, double d[4]) {
       double b = *(const double *)user, w = r2 + b * b, h = 1 / sqrt(w);
       d[0] = h, d[1] = -h / (2 * w), d[2] = 3 * h / (4 * w * w), d[3] = -15 * h / (8 * w * w * w);
     }
     static const double core = 0.1;
     static const skf_user_kernel kernel = {.name = "plummer", .eval = plummer, .user = &core, .width = 0.1,
                                            .decay = 1}; */
struct skf_user_kernel {
  const char *name;
  /* h and its derivatives with respect to w = r^2 as of skf_kernel_eval, for every finite r2 >= 0; not asked for
     r >= radius. Returns the same for the same r2, always. */
  void (*eval)(const void *user, double r2, double d[4]);
  const void *user; /* handed to the callbacks */
  double width;     /* > 0: length over which h changes near r = 0 [L]; wrong by a factor of 10 it costs time only */
  double radius;    /* h = 0 for r >= radius [L]; 0: it has no end */
  double decay;     /* |h| falls at least like r^-decay for large r; planes need a radius, or at least 2.125 */
  bool singular;    /* infinite at r = 0: then F = +infinity and g = 0 on the primitive itself */
  /* Radii > 0 [L], ascending, where h or one of its first four derivatives jumps, or where it has features that are
     much narrower than the distance from r = 0; the quadrature starts from them. At most SKF_USER_BREAKS. */
  int break_count;
  const double *breaks;
  /* NULL, or suprema over r >= a >= 0, not below the truth, infinite where that is. Only for kernels with h >= 0 that
     do not rise with r (write others as the difference of two elements). `value` is ignored: it is h(a). */
  skf_envelope (*bound)(const void *user, double a);
};

/* A weight along a segment or an arc: F = w integral of profile(t) h(|p - q(t)|) d mu, where t runs by length from 0 at
   `from` or `start` to 1 at the other end. (In Sherstyuk 1999, 3.3.4, profiles scale the finished field; here they are
   in the integral, so that a body keeps its potential, its mass and its smoothness.) Quartic and soft object on
   segments, with all but the sine, are exact sums; everything else is summed by Gauss's rules whose error is bounded
   beforehand. Relative error 1e-12 in F, 1e-11 in the gradient, 1e-10 in the Hessian, against the same integral of the
   weight's absolute value, tests/field/test_profile.c; users' kernels by adaptive quadrature. On the body the singular
   kernels give F = +-infinity by the weight there and the gradient 0; where the weight is 0, F is finite for inverse,
   and of inverse-squared what lies beyond 1e-140 of its length. */
typedef enum skf_profile_type {
  SKF_PROFILE_LINEAR, /* from ends[0] to ends[1] */
  SKF_PROFILE_HAT,    /* 0 - 1 - 0, straight */
  SKF_PROFILE_SINE,   /* sin^2 pi t */
  SKF_PROFILE_CUBIC,  /* Hermite cubics between knots: once continuously differentiable */
  SKF_PROFILE_COUNT
} skf_profile_type;

typedef struct skf_profile_knot {
  double t, value, slope; /* slope: d value / dt; any signs */
} skf_profile_knot;

typedef struct skf_profile {
  skf_profile_type type;
  double ends[2];                /* linear */
  const skf_profile_knot *knots; /* cubic: two or more, t ascending from 0 to 1 */
  size_t knot_count;
  double from, to; /* 0 <= from < to <= 1: which part of the profile this primitive carries; both 0: the whole */
} skf_profile;

/* SKF_OK, SKF_ERR_ARG (type, knots) or SKF_ERR_RANGE (not finite, out of order, zero everywhere); *why, if given, tells
   what is wrong and what was expected. */
SKF_API skf_status skf_profile_check(const skf_profile *profile, const char **why);

/* The weight at a part u in [0, 1] of the primitive that carries it. */
SKF_API double skf_profile_at(const skf_profile *profile, double u);

/* One primitive with its kernel and strength w (any sign, not 0 or non-finite). */
typedef struct skf_element {
  skf_primitive primitive;
  skf_kernel kernel;
  double strength;
  const skf_profile *profile; /* of a segment or an arc; NULL: 1 everywhere */
} skf_element;

/* Integral of the profile over the primitive [1, L, L^2]: its measure where there is no profile; strength is not in it.
 */
SKF_API double skf_element_measure(const skf_element *element);

/* A field that is ready to be evaluated: immutable, safe to share between threads. */
typedef struct skf_field skf_field;

/* Copies the elements and their profiles, solids behind the others, and holds the solids. SKF_ERR_ARG (also a profile
   of something else than a segment or an arc), SKF_ERR_RANGE, SKF_ERR_DEGENERATE, SKF_ERR_UNSUPPORTED (a user's kernel
   that cannot be integrated over a plane, a solid with another kernel than inverse) or SKF_ERR_NOMEM on failure; n = 0
   is the zero field. */
SKF_API skf_status skf_field_new(const skf_element *elements, size_t n, skf_field **out);
SKF_API void skf_field_free(skf_field *field);

/* How a field is evaluated; zeros stand for the defaults.

   accuracy [1] = 0: every element is summed, to rounding. From 1e-12 to 0.01: 4000 or more elements of one kernel,
   inverse, inverse-squared or Cauchy with one s, are summed by expansions (a fast multipole method), of as many
   Gaussians with one s, where these are narrow next to the skeleton, those that matter at the point, and where they are
   wide polynomials on a grid of cells; planes and all others directly. F is then within accuracy times the sum of |w_i|
   F_i(p) of the direct sum, the gradient within accuracy times the sum of |w_i| max(|grad F_i|, F_i / r_i), r_i being
   the distance to the element, and each second derivative within 30 accuracy times the sum of |w_i| max(|Hessian F_i|,
   F_i / r_i^2). Strengths that cancel are not counted out of these sums. F and the gradient of every single element are
   within that (tests/field/test_far.c), so that no arrangement of them is worse; not so of wide Gaussians, of which
   only the sums are, and their second derivatives by measurement alone. tests/field/test_tree.c finds 0.6 of it at
   most, in clouds a thousandth.

   The expansions are made with the field, on OpenMP's threads. tests/bench/bench_tree.c measures time and memory: see
   the numbers there. A point then costs some microseconds however many elements there are; one far outside of all
   elements somewhat more. Elements longer than the cells that the method makes, up to four pieces for each element on
   average, are cut: many long ones in a small room gain less. Elements that form no cloud (all in one place) are summed
   directly. */
typedef struct skf_field_options {
  double accuracy;
} skf_field_options;

/* skf_field_new with options (NULL: defaults); SKF_ERR_RANGE also for an accuracy out of range. */
SKF_API skf_status skf_field_new_with(const skf_element *elements, size_t n, const skf_field_options *options,
                                      skf_field **out);

SKF_API size_t skf_field_size(const skf_field *field);
SKF_API const skf_element *skf_field_element(const skf_field *field, size_t i);

/* Value [per kernel] and gradient with respect to p at one point; g may be NULL. Where at least two elements have the
   same pair, and this pair a vector form, they are evaluated side by side (see skf_field_eval for the differences; with
   SKELFIELD_ISA=scalar they are not); the sum loses nothing and does not depend on the instruction set.
   On a singular set: F = +-infinity and g = 0; see skf_pair_get. F is good to 1e-12, g to 1e-11 of max(|g|, |F| /
   max(size, distance)), the Hessian to 1e-10 of max(|h|, |F| / max(size, distance)^2), or to what eight ulps of p move
   it: at 1e-9 to 1e6 sizes, widths of 1e-4 to 1e4 and supports up to 1e6 sizes, slivers down to 1e-9, at any scale.
   Never NaN for finite p: closer than 1e-50 sizes to a singular set counts as on it where a derivative overflows. */
SKF_API double skf_field_at(const skf_field *field, skf_vec3 p, skf_vec3 *g);

/* Value, gradient and Hessian (xx, xy, xz, yy, yz, zz) at one point. */
SKF_API double skf_field_tensor_at(const skf_field *field, skf_vec3 p, skf_vec3 *g, double h[6]);

/* n points in structure-of-arrays form. p[0..2]: x, y, z. F: n values. g: NULL or three arrays. h: NULL or six arrays
   in the order above. Any output array may be NULL, none may overlap the points. Runs on OpenMP's current number of
   threads; the result does not depend on it, nor on a point's neighbours. SKF_ERR_NOMEM only where fields have
   expansions (skf_field_new_with). F and the gradient of most pairs are evaluated in vectors where the processor has
   AVX2 and FMA. They then differ from skf_field_at by 20 units of 1.1e-16 (segments 60, arcs 200, triangles 1000;
   planes whose normal is along no axis 20 + 4 m, m <= 500 being how many times farther p is from the origin than from
   it: less than what eight ulps of p move) at most, relative to |F| and max(|g|, |F| / distance), times how many
   times the field's own relative change exceeds the point's; in a field of several elements relative to the sum of
   theirs, not more where they cancel. (Eight at a time are added plainly, these sums without loss.) With
   SKELFIELD_ISA=scalar in the environment when the field is made they are the same bits. */
SKF_API skf_status skf_field_eval(const skf_field *field, size_t n, const double *const p[3], double *F,
                                  double *const g[3], double *const h[6]);

/* A field in floats, for pictures: points are given as x = origin + unit * p, so that bodies far from the origin, huge
   or tiny, lose nothing: choose origin and unit [L] so that |p| of the points and the body is about 1. The elements are
   brought into this frame in doubles. */
typedef struct skf_field_f32 skf_field_f32;

/* The field need not live on. SKF_ERR_RANGE (unit, origin) or SKF_ERR_NOMEM on failure. */
SKF_API skf_status skf_field_f32_new(const skf_field *field, skf_vec3 origin, double unit, skf_field_f32 **out);
SKF_API void skf_field_f32_free(skf_field_f32 *field);

/* As skf_field_eval, in the field's own units: the gradient is per length of x, not of p. With AVX2 or AVX-512, all but
   kernels of finite support on arcs up to 0.1 rad, and Gaussian open arcs much longer than the kernel's width is
   evaluated in floats, eight or sixteen points at once; everything else in doubles, then rounded. Error, in units of
   2^-24: 16 (triangles 512) of |F| and of |g|, and what F and g change when the point moves by 4 units of the largest
   |coordinate| of it or of the vertices; in one of 10^4 places or fewer up to twice all this, g next to the centre of a
   Gaussian's circle three times; for sums, of the sum of the magnitudes. What exceeds the range of floats becomes
   infinite or, below 1e-36 of the largest strength, 0. */
SKF_API skf_status skf_field_f32_eval(const skf_field_f32 *field, size_t n, const float *const p[3], float *F,
                                      float *const g[3]);

/* Solids: F to 1e-13, the gradient to 2e-13 of themselves, the Hessian to 1e-12 of max(|h|, F / distance^2), inside,
   outside, on and by faces, edges, vertices, out to 1e7 sizes; boxes 10 (100, 1000) times as long as thick to 3e-13
   (2e-12, 1e-11). A batch gets all in one pass; a point by itself sums in another order. */

/* How one kernel on one shape is evaluated. */
typedef struct skf_pair_info {
  bool closed;          /* closed form or guaranteed expansion; else adaptive quadrature */
  double error;         /* relative error of F aimed at, away from ill-conditioned places */
  const char *singular; /* where F is infinite or the gradient jumps, and what is returned there; NULL: nowhere */
} skf_pair_info;

SKF_API skf_pair_info skf_pair_get(skf_kernel_type kernel, skf_shape shape);

/* Whether every element has bounds: users' kernels may have none. Else *element, if given, is the first without. */
SKF_API bool skf_field_has_bound(const skf_field *field, size_t *element);

/* Enclosure of the field in the ball |p - center| <= radius. Every bound is rigorous up to rounding, none is tight. */
typedef struct skf_bound {
  double lo, hi;   /* of F */
  double gradient; /* upper bound of |grad F| */
  double hessian;  /* upper bound of the spectral norm of the Hessian */
  double fourth;   /* upper bound of |d^4 F / dt^4| along any straight line at unit speed */
} skf_bound;

SKF_API skf_bound skf_field_bound(const skf_field *field, skf_vec3 center, double radius);

/* A box outside of which F < iso everywhere; SKF_ERR_UNBOUNDED when there is none (a plane, iso <= 0), SKF_ERR_EMPTY
   when F < iso everywhere; SKF_ERR_UNSUPPORTED when an element has no bounds. */
SKF_API skf_status skf_field_region(const skf_field *field, double iso, skf_box *out);

#ifdef __cplusplus
}
#endif
#endif
