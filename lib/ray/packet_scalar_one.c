/* SPDX-License-Identifier: MIT */
enum { VECTORS = 1 };
#include "ray/packet_loop.h"

void skf_packet_scalar_one(skf_packet *p) { through(p); }
