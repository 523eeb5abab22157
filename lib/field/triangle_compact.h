/* SPDX-License-Identifier: MIT */
/* Kernels of finite support on triangles. Private to triangle_{compact,cone,polar,transverse}.c.
   At height z the support cuts the plane in a disc of radius rm about p'. Each edge has a part in the disc; what is out
   of it sees the disc as sectors. */
#ifndef SKF_FIELD_TRIANGLE_COMPACT_H
#define SKF_FIELD_TRIANGLE_COMPACT_H

#include "field/triangle_parts.h"

typedef enum skf_compact_kind { SKF_COMPACT_QUARTIC, SKF_COMPACT_SOFT, SKF_COMPACT_CONE } skf_compact_kind;

/* R^2 - |a_k|^2 by vertex, right to its last digit: from there the rim is found to the rounding of the triangle's size
   where that is smaller than R. */
typedef struct skf_disc {
  double R, power[3], rm;
  bool all; /* the triangle is within the support */
} skf_disc;

/* Needs |z| < R. */
skf_disc skf_disc_at(const skf_triangle_view *g, double R);

/* Square of half the chord that the disc cuts from an edge's line; negative when it misses. */
double skf_disc_chord2(const skf_disc *disc, const skf_triangle_view *g, int edge);

/* An edge's part in the disc: abscissae b1 < b2 of its ends when `in`, half the chord of its line. Lengths and gaps are
   known without cancellation, so that R^2 - r^2 = (gap1 + x) (gap2 + length - x) at x from b1 is exact. */
typedef struct skf_edge_clip {
  bool in;
  double b1, b2, chord, length;
  double gap1, gap2;    /* chord + b1, chord - b2 */
  double before, after; /* lengths of the edge's parts out of the disc; 0 unless `in` */
  double out;           /* angle of the rest */
} skf_edge_clip;

skf_edge_clip skf_edge_cut(const skf_triangle_view *g, int edge, const skf_disc *disc);

/* Panels over the part, and R^2 - r^2 at a panel's node with abscissa l. */
skf_panels skf_clip_panels(const skf_edge_clip *e, double delta);
double skf_clip_power(const skf_edge_clip *e, const skf_panels *p, int node, double l);

/* A node: h, h'/r and (h'/r)'/r for y = 1 - r^2 / R^2 in (0, 1]; only the cone looks at r. */
typedef struct skf_compact_node {
  double h, g, k;
} skf_compact_node;

skf_compact_node skf_compact_at(skf_compact_kind kind, double y, double r, double R);

/* n x n conical product rule over a triangle within the support. y is taken from the nearest vertex, so that it stays
   accurate at the rim. */
void skf_compact_cubature(skf_compact_kind kind, const skf_disc *disc, const skf_triangle_view *g, int n, int order,
                          skf_value *v);

/* Rays from the nearest point of the triangle: a sum of positive terms. */
void skf_compact_polar(skf_compact_kind kind, const skf_disc *disc, const skf_triangle_view *g, int order,
                       skf_value *v);

/* The gradient's part along m[longest] of the cone (1 - r/R)^2, next to a thin triangle: an integral of the difference
   of h across it. */
double skf_cone_transverse(const skf_triangle_view *g, double R);

/* Largest condition of a sum over clipped edges that is kept. */
#define SKF_COMPACT_COND 30

#endif
