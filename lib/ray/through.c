/* SPDX-License-Identifier: MIT */
/* Single rays through leaves without blobs. */
#include "core/vec3.h"
#include "ray/packet.h"

skf_packet_fn *skf_packet_get(skf_isa isa, int lanes) {
#ifdef SKF_HAVE_AVX2
  if (isa != SKF_ISA_SCALAR) return lanes > 4 ? skf_packet_avx2 : skf_packet_avx2_one;
#endif
  (void)isa;
  return lanes > 4 ? skf_packet_scalar : skf_packet_scalar_one;
}

bool skf_packet_board(skf_packet *p, const skf_ray *rays) {
#ifdef SKF_HAVE_AVX2
  if (p->tracer->isa != SKF_ISA_SCALAR) return skf_packet_board_avx2(p, rays);
#endif
  return skf_packet_board_scalar(p, rays);
}

skf_walk *skf_packet_lane(skf_packet *p, int lane) {
  skf_walk *w = p->walk + lane;
  if (p->walking >> lane & 1) return w;
  p->walking |= 1u << lane;
  *w = (skf_walk){.tracer = p->tracer,
                  .origin = {p->o[0][lane], p->o[1][lane], p->o[2][lane]},
                  .direction = {p->d[0][lane], p->d[1][lane], p->d[2][lane]}};
  p->knot[lane].known = false;
  return w;
}

static void set_last(skf_packet *p, int lane, int sign) {
  unsigned bit = 1u << lane;
  p->below = sign < 0 ? p->below | bit : p->below & ~bit;
  p->above = sign > 0 ? p->above | bit : p->above & ~bit;
}

static void walk(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b) {
  skf_walk *w = skf_packet_lane(p, lane);
  skf_knot k = p->knot[lane].known && p->knot[lane].t == a ? p->knot[lane] : (skf_knot){.t = a};
  w->leaf = leaf, w->last = (int)(p->above >> lane & 1) - (int)(p->below >> lane & 1);
  if (!skf_walk_piece(w, &k, b, p->found, p->user[lane])) p->alive &= ~(1u << lane);
  w->leaf = NULL;
  set_last(p, lane, w->last);
  p->knot[lane] = k;
}

/* The linear model tells most rays from the surface. */
void skf_packet_walk(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b) {
  if (!leaf || leaf->blobs) {
    walk(p, lane, leaf, a, b);
    return;
  }
  skf_walk *w = skf_packet_lane(p, lane);
  double fa = leaf->f + v3_dot(leaf->g, v3_sub(v3_mad(w->origin, a, w->direction), leaf->center));
  double fb = fa + (b - a) * v3_dot(leaf->g, w->direction);
  if ((fa > leaf->flat && fb > leaf->flat) || (fa < -leaf->flat && fb < -leaf->flat)) {
    w->report.cells++;
    set_last(p, lane, fa > 0 ? 1 : -1);
    return;
  }
  walk(p, lane, leaf->bend < INFINITY || leaf->fourth < INFINITY ? leaf : NULL, a, b);
}
