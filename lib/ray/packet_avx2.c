/* SPDX-License-Identifier: MIT */
enum { VECTORS = 2 };
#include "ray/packet_loop.h"

void skf_packet_avx2(skf_packet *p) { through(p); }
