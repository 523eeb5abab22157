/* SPDX-License-Identifier: MIT */
enum { VECTORS = 2 };
#include "ray/packet_board.h"
#include "ray/packet_loop.h"

void skf_packet_scalar(skf_packet *p) { through(p); }

bool skf_packet_board_scalar(skf_packet *p, const skf_ray *rays) { return board_all(p, rays); }
