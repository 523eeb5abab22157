/* SPDX-License-Identifier: MIT */
enum { VECTORS = 2 };
#include "ray/packet_loop.h"

void skf_packet_scalar(skf_packet *p) { through(p); }
