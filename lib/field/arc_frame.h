/* SPDX-License-Identifier: MIT */
/* A point seen from an arc. Let psi be the azimuth of q from x about the axis, chi = psi / 2, k and z the cylindrical
   coordinates of x, rho the radius. Then
     r^2 = alpha cos^2 chi + beta sin^2 chi, alpha = (k - rho)^2 + z^2, beta = (k + rho)^2 + z^2,
     k - rho cos psi = (k - rho) cos^2 chi + (k + rho) sin^2 chi,
   so that every integral over the arc is made of terms of one sign. Arc length: dq = 2 rho dchi. */
#ifndef SKF_FIELD_ARC_FRAME_H
#define SKF_FIELD_ARC_FRAME_H

#include "field/kernel.h"

typedef struct skf_arc_frame {
  const skf_arc_plan *plan;
  skf_vec3 e, f, n;
  skf_dd3 d;                  /* x - center, exact */
  double rho, k, z, ux, uy;   /* (ux, uy): unit vector of the azimuth of x in the axes e, f; (1, 0) when k = 0 */
  double inner, outer;        /* k - rho, k + rho */
  double alpha, beta, da, db; /* da, db: their roots, the distances to the nearest and farthest point of the circle */
  double spread;              /* beta - alpha = 4 rho k */
  bool full;                  /* nothing below is set for a full circle */
  bool behind;                /* angles are measured from the antipode of x: chi = b -+ pi/2 */
  double a0, a1;              /* chi (or b) at the ends, a1 - a0 = half the sweep */
  double c0, s0, c1, s1;      /* cos chi, sin chi at the ends */
  double half, sin_half, cos_half; /* (chi1 - chi0) */
  double sin_mid, cos_mid;         /* of chi0 + chi1 */
  double r0, r1, r02, r12;         /* distances to the ends, squared */
  double turn;                     /* (r1^2 - r0^2) / k = 4 rho sin_half sin_mid */
} skf_arc_frame;

void skf_arc_place(const skf_prepared *e, skf_vec3 x, skf_arc_frame *f);

/* Integrals 2 rho int (...) dchi over the arc, with g = h'/r, k = g'/r, c = cos chi, s = sin chi. The second group is
   for the Hessian. */
typedef struct skf_arc_moments {
  double F, g_cc, g_ss;      /* h, g c^2, g s^2 */
  double ends;               /* rho (h(r0) - h(r1)) / k */
  double k_c4, k_c2s2, k_s4; /* k c^4, k c^2 s^2, k s^4 */
  double k_c3s, k_cs3;       /* k c^3 s, k c s^3 */
  double g_ends;             /* rho (g(r0) - g(r1)) / k */
} skf_arc_moments;

/* Gradient and Hessian in the cylindrical frame of x: radial, azimuthal, axial. */
typedef struct skf_arc_terms {
  double F, k, p, z;
  double kk, pp, zz, kp, kz, pz;
} skf_arc_terms;

skf_arc_terms skf_arc_gather(const skf_arc_frame *f, const skf_arc_moments *m, int order);
void skf_arc_result(const skf_arc_frame *f, const skf_arc_terms *t, int order, skf_value *v);

/* The arc cut where chi is a multiple of pi/2 and each piece folded into [0, pi/2]: at most four. a is the end nearer
   to x, b the other. */
typedef struct skf_arc_piece {
  double ca, sa, cb, sb; /* cosines and sines of the folded ends, >= 0 */
  double rise;           /* sb^2 - sa^2, without cancellation */
  double weight;         /* 1; 2 for a full circle, which has one piece */
  double sign;           /* of sin chi cos chi before folding; 0 for a full circle */
  double xa, xb, length; /* the folded angles; set on request */
} skf_arc_piece;

int skf_arc_pieces(const skf_arc_frame *f, bool angles, skf_arc_piece out[4]);

#endif
