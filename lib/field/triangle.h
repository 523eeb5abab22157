/* SPDX-License-Identifier: MIT */
/* Fields of triangles, for every kernel: F, gradient and Hessian, the integral over the area.
   All are sums over the edges from the planar divergence theorem about the projection of the point; where such a sum
   cancels, a quadrature of the integrand, all of one sign, takes over. */
#ifndef SKF_FIELD_TRIANGLE_H
#define SKF_FIELD_TRIANGLE_H

#include "field/kernel.h"

/* 1 / (1 + s^2 r^2)^2. Smooth everywhere. */
void skf_triangle_cauchy(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* exp(-a^2 r^2). Smooth everywhere. */
void skf_triangle_gaussian(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* 1 / r. F is finite everywhere. Inside the triangle the normal part of the gradient jumps by 4 pi and its mean, 0, is
   returned. On an edge or a corner the gradient is infinite along the surface: the edge's own term is left out. */
void skf_triangle_inverse(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* The solid angle of a triangle, positive where its vertices run clockwise, that is from behind; 0 on its plane. */
double skf_triangle_angle(const skf_triangle *triangle, skf_vec3 x);

/* 1 / r^2. On the closed triangle F = +infinity, gradient and Hessian 0. */
void skf_triangle_inverse_squared(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* Metaball, 3/2 k_R - 1/2 k_{R/3} with k_R = (1 - r/R)^2; soft object and quartic, polynomials in r^2 up to R. Exactly
   0 from R on; the Hessian is continuous, its slope is not at the rims. */
void skf_triangle_metaball(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);
void skf_triangle_soft_object(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);
void skf_triangle_quartic(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

#endif
