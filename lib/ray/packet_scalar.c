/* SPDX-License-Identifier: MIT */
#include "ray/packet_loop.h"

void skf_packet_scalar(skf_packet *p) { through(p); }
