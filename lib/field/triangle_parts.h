/* SPDX-License-Identifier: MIT */
/* What the triangle's kernels share: the triangle seen from a point, integrals along its edges, sums over them, and
   quadratures over its area. Private to triangle_*.c.

   With p' the projection of the point p onto the plane, z the height of p over it, rho the distance from p', r^2 =
   rho^2
   + z^2, and along edge i: d the distance of p' from its line (> 0 on the inner side), l the abscissa from the foot of
   p:
     H-form  int h dA = sum_i int d (H(rho) / rho^2) dl,               H = int_0^rho h rho' drho'
     G-form  int h dA = Omega G(0) - sum_i int d (G(rho) / rho^2) dl,  G = int_rho^inf h rho' drho'
   Omega is the angle of the triangle about p', 0 when p' is outside. The H-form has terms of one sign when p' is
   inside; the G-form serves points outside that are farther than the kernel's own width. */
#ifndef SKF_FIELD_TRIANGLE_PARTS_H
#define SKF_FIELD_TRIANGLE_PARTS_H

#include "field/kernel.h"
#include "field/triangle.h"
#include "num/gauss.h"

/* A triangle seen from a point. */
typedef struct skf_triangle_view {
  const skf_triangle_plan *T;
  skf_dd3 a2[3]; /* vertices less the point, exactly */
  skf_vec3 a[3]; /* the same, rounded */
  double r[3];   /* their lengths */
  int nearest;   /* vertex */
  double dist;   /* to the triangle */
  double reach;  /* to its farthest vertex */
  /* from here on filled in by skf_triangle_look */
  double z;                  /* height over the plane, along the normal */
  double d[3], l1[3], l2[3]; /* edge by edge: distance of its line from p', abscissae of its ends */
  bool inside;               /* p' is in the closed triangle */
  double lat;                /* from p' to the triangle */
} skf_triangle_view;

/* Vertices, distances. */
void skf_triangle_face(const skf_triangle_plan *T, skf_vec3 x, skf_triangle_view *g);
/* The rest. */
void skf_triangle_look(skf_triangle_view *g);

/* After skf_triangle_face: surely farther than `distance`, which g->dist is not in plain arithmetic. */
bool skf_triangle_clear(const skf_triangle_view *g, double distance);

/* Abscissa of the third vertex along the longest edge. */
double skf_triangle_apex(const skf_triangle_view *g);

/* Distance from the origin to the triangle of three vertices [Ericson, Real-Time Collision Detection, 5.1.5]. */
double skf_triangle_distance(const skf_vec3 a[3]);

/* Smallest |l| on [l1, l2]. */
static inline double skf_edge_nearest(double l1, double l2) {
  return l1 <= 0 && l2 >= 0 ? 0 : fmin(fabs(l1), fabs(l2));
}

/* int dl / sqrt(c2 + l^2), r1 and r2 being the root at the ends; infinite when c2 = 0 and 0 is within. */
double skf_edge_log(double l1, double l2, double c2, double r1, double r2);

/* int d dl / (d^2 + l^2): the angle that the edge subtends at p'. */
double skf_edge_angle(double d, double l1, double l2);

/* int d dl / (r (r + |z|)), r^2 = c2 + l^2, c2 = d^2 + z^2: the edge's part of the solid angle. */
double skf_edge_solid(double d, double z, double c2, double l1, double r1, double l2, double r2);

/* out[k] = int dl / (E^2 + s^2 l^2)^(k + 1), k < count <= 3, for E > 0. */
void skf_edge_powers(double E, double s, double l1, double l2, int count, double out[3]);

/* Composite Gauss-Legendre after l = delta sinh t, for integrands whose nearest complex singularity is l = +-i delta or
   farther. */
#define SKF_PANEL_NODES 14
typedef struct skf_panels {
  int count;
  bool plain; /* one short panel, in l itself */
  double start, step, delta;
} skf_panels;

skf_panels skf_panels_over(double l1, double l2, double delta);
void skf_panel_nodes(const skf_panels *p, int panel, double l[SKF_PANEL_NODES], double w[SKF_PANEL_NODES]);
/* delta for an integrand singular at distance d. */
double skf_panel_scale(double d, double l1, double l2);

/* What a kernel's edge sums give. */
typedef struct skf_triangle_sum {
  double F, absF;
  double J[3];      /* int h dl */
  double Z, absZ;   /* dF/dz */
  double K[3];      /* int h'/r dl */
  double jump[3];   /* h at the edge's end less h at its start */
  double zz, abszz; /* d2F/dz2 */
} skf_triangle_sum;

static inline void skf_sum_F(skf_triangle_sum *s, double x) { s->F += x, s->absF += fabs(x); }
static inline void skf_sum_Z(skf_triangle_sum *s, double x) { s->Z += x, s->absZ += fabs(x); }
static inline void skf_sum_zz(skf_triangle_sum *s, double x) { s->zz += x, s->abszz += fabs(x); }

/* Sum of |terms| over |sum|. */
typedef struct skf_triangle_cond {
  double F, g, h;
} skf_triangle_cond;

/* grad F = -sum m_i J_i + n Z. Hessian: sum m_i m_i' d_i K_i + sym(m_i t_i') jump_i - 2 sym(m_i n') z K_i + n n' zz. */
skf_triangle_cond skf_triangle_assemble(const skf_triangle_view *g, const skf_triangle_sum *s, int order, skf_value *v);

/* A symmetric tensor in the frame (t, m, n) of the longest edge, order tt, tm, tn, mm, mn, nn, in x, y, z. */
void skf_triangle_rotate(const skf_triangle_plan *T, const double b[6], double h[6]);

typedef void (*skf_kernel_eval_fn)(double param, double w, double d[4]);

/* Adds w times the kernel's value, gradient and Hessian at the offset q - p = X, for the kernel derivatives d. */
void skf_quad_add(skf_value *v, double w, const double d[4], skf_vec3 X, int order);

/* Nodes per direction for a kernel whose nearest complex singularity is `far` away from a triangle of diameter diam. */
int skf_quad_order(double far, double diam);

/* n x n conical product rule over the triangle of vertices a (relative to the point). */
void skf_quad_conical(skf_kernel_eval_fn eval, double param, const skf_vec3 a[3], double area, int n, int order,
                      skf_value *v);

/* A complex singularity at x +- i y. */
typedef struct skf_place {
  double x, y;
} skf_place;

/* Calls f(context, x, weight) for the nodes of Gauss rules over [lo, hi], bisected until each part is as short as it is
   far from the singularities. */
void skf_quad_graded(const skf_place *at, int count, double lo, double hi,
                     void (*f)(void *context, double x, double weight), void *context);

/* The kernel vanishes at `radius` from p' on: in abscissae of the longest side where that circle meets the edges, its
   middle and its ends, as it may be all within the triangle. */
typedef struct skf_rim {
  double radius, at[9];
  int count;
} skf_rim;

/* Slices across the longest side: a sum of positive terms. width: distance of the kernel's complex singularity at r = 0
   (1/s for cauchy, else 0). rim: NULL, or where the support ends; not for points next to it. */
void skf_quad_across(skf_kernel_eval_fn eval, double param, double width, const skf_triangle_view *g,
                     const skf_rim *rim, int order, skf_value *v);

/* Largest condition of an edge sum that is kept: of F and a tenth of the gradient's, and of the Hessian's. The Hessian
   of a sliver next to it costs its aspect ratio in digits; the limit keeps 1e-11. */
#define SKF_TRIANGLE_COND         400
#define SKF_TRIANGLE_COND_HESSIAN 1e4

/* The edge sum where it is well conditioned, else skf_quad_across with the arguments above. */
void skf_triangle_settle(skf_kernel_eval_fn eval, double param, double width, const skf_triangle_view *g,
                         const skf_triangle_sum *s, int order, skf_value *v);

#endif
