/* SPDX-License-Identifier: MIT */
/* The Newtonian field of a homogeneous solid, F = int dV / r. With r from the point to the edge or the face, E the dyad
   of an edge, lambda = int dl / |r| along it and omega the solid angle of a face, positive from inside
   [Werner, Scheeres 1997, eq. 10-15]:
     F = (sum r' E r lambda - sum (n'r)^2 omega) / 2,  grad F = -sum E r lambda + sum n (n'r) omega,
     Hess F = sum E lambda - sum n n' omega.
   One logarithm an edge, one arc tangent a face; the dyads come from double-double normals, so that edges between faces
   nearly in one plane do not cancel. Far away an expansion about the centre of mass takes over (skeleton/solid_far.c).
*/
#ifndef SKF_FIELD_SOLID_H
#define SKF_FIELD_SOLID_H

#include "field/envelope.h"
#include "field/kernel.h"
#include "simd/isa.h"
#include "skeleton/solid.h"

/* Points at once, and what comes out for each: F, the gradient, the Hessian. */
enum { SKF_SOLID_POINTS = 128, SKF_SOLID_OUT = 10 };

typedef struct skf_solid_ops {
  /* n <= SKF_SOLID_POINTS. What comes out at a point depends on this point alone. */
  void (*points)(const skf_solid *s, size_t n, const double *const p[3], bool hessian,
                 double out[SKF_SOLID_OUT][SKF_SOLID_POINTS]);
  void (*point)(const skf_solid *s, skf_vec3 x, bool hessian, double out[SKF_SOLID_OUT]);
} skf_solid_ops;

extern const skf_solid_ops skf_solid_scalar, skf_solid_avx2;

const skf_solid_ops *skf_solid_ops_get(skf_isa isa);

/* The closed form for one point. */
void skf_solid_inverse(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* lambda of an edge from a to b and omega of a face, accurate next to it; 0 on the edge, on the face. Where
   |r_a| + |r_b| - length is below this part of |r_a| + |r_b| the plain form loses digits. */
#define SKF_SOLID_NEAR 0x1p-6
double skf_solid_edge_log(skf_vec3 a, skf_vec3 b, skf_vec3 x);
double skf_solid_face_angle(skf_vec3 a, skf_vec3 b, skf_vec3 c, skf_vec3 x);

/* Where the plain omega, 2 atan2(num, den), does: these parts of the product of the three distances squared, and of the
   sum of their squares for the least one. */
#define SKF_SOLID_FACE_NEAR   0x1p-10
#define SKF_SOLID_CORNER_NEAR 0x1p-14
/* None of that happens farther than this part of the longest edge from a block's box. */
#define SKF_SOLID_CLEAR 0.25

static inline skf_vec3 skf_solid_block_vertex(const skf_solid_block *b, unsigned i) {
  return v3(b->vertex[i], b->vertex[b->vertex_room + i], b->vertex[2 * b->vertex_room + i]);
}

/* Suprema at all places at a distance >= d from the surface, inside or outside, and >= d_out from the solid. */
skf_envelope skf_solid_envelope(double volume, double d, double d_out);
/* Suprema in the ball |p - center| <= radius. */
skf_envelope skf_solid_around(const skf_solid *s, skf_vec3 center, double radius);
/* Supremum of the spectral norm of the Hessian there, when faces but no edges may be inside; else INFINITY. */
double skf_solid_bend(const skf_solid *s, skf_vec3 center, double radius);

#endif
