/* SPDX-License-Identifier: MIT */
enum { VECTORS = 2 };
#include "ray/packet_board.h"
#include "ray/packet_loop.h"
#include "ray/packet_settle.h"

void skf_packet_scalar(skf_packet *p) { through(p); }

bool skf_packet_board_scalar(skf_packet *p, const skf_ray *rays) { return board_all(p, rays); }

void skf_room_settle_scalar(const skf_tracer *tracer, skf_room *r, size_t m, const skf_sights *at, bool *done) {
  settle_all(tracer, r, m, at, done);
}
