/* SPDX-License-Identifier: MIT */
/* Several rays side by side through the octree. What a ray meets does not depend on its neighbours, not in a bit. */
#ifndef SKF_RAY_PACKET_H
#define SKF_RAY_PACKET_H

#include "ray/room.h"
#include "simd/isa.h"

enum { SKF_PACKET = 8 };

/* Where the answer to a question about first crossings goes. */
typedef struct skf_answer {
  skf_hit *hit; /* NULL: only whether there is one */
  bool *found;
  skf_room *room;
} skf_answer;

/* Rays whose directions have the same signs. Lanes that are not `alive` are finished or were never there. */
typedef struct skf_packet {
  const skf_tracer *tracer;
  double o[3][SKF_PACKET], d[3][SKF_PACKET], per[3][SKF_PACKET]; /* origins, unit directions, 1 / directions */
  double from[SKF_PACKET], to[SKF_PACKET];
  double shift[SKF_PACKET];     /* by which rounding may move places */
  unsigned alive, below, above; /* below, above: the sign of f just before the current cell, where it is known */
  int backwards;                /* a bit for each negative coordinate of the directions */
  unsigned crossed;             /* lanes whose last crossing in a leaf with segments went inwards */
  unsigned walking;             /* lanes whose `walk` and `knot` are in use */
  skf_walk walk[SKF_PACKET];
  skf_knot knot[SKF_PACKET]; /* at the end of the last leaf without blobs */
  bool first, exact; /* crossings beyond a lane's first are of no interest; each user is an skf_answer, with exact
                        one that wants the hit */
  skf_crossing_fn *found;
  void *user[SKF_PACKET];
  size_t cells, looks;
} skf_packet;

typedef void skf_packet_fn(skf_packet *p);
typedef bool skf_packet_board_fn(skf_packet *p, const skf_ray *rays);

/* All lanes that are alive, through the whole octree; the first four, or all. */
skf_packet_fn skf_packet_scalar_one, skf_packet_scalar, skf_packet_avx2_one, skf_packet_avx2;

skf_packet_fn *skf_packet_get(skf_isa isa, int lanes);

/* Takes eight rays on board, with the bits that each has alone: lanes are alive that go through the octree, the others
   miss it. False: a number is wrong, a ray is too far off or they go different ways, and nothing is set. */
skf_packet_board_fn skf_packet_board_scalar, skf_packet_board_avx2;
bool skf_packet_board(skf_packet *p, const skf_ray *rays);

/* The lane's walk, made ready where it is not in use yet. */
skf_walk *skf_packet_lane(skf_packet *p, int lane);

/* One lane through [a, b] of a leaf (or of a cell that is not known, NULL) by the walk; updates its sign. */
void skf_packet_walk(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b);

/* Hands out a crossing between two places in a leaf. */
void skf_packet_found(skf_packet *p, int lane, const skf_leaf *leaf, const skf_knot *a, const skf_knot *b,
                      double guess);

/* One lane through [a, b] of a leaf with a patch: the patch's Bernstein coefficients along it, and how far F - iso may
   be from them. */
void skf_packet_patch(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b, const double c[SKF_DEGREE + 1],
                      double off);

/* One lane through [a, b] of a leaf of blobs. */
void skf_packet_blobs(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b);

#endif
