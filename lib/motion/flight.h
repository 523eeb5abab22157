/* SPDX-License-Identifier: MIT */
/* A flight's state as bytes, for checkpoints. */
#ifndef SKF_MOTION_FLIGHT_H
#define SKF_MOTION_FLIGHT_H

#include "skelfield/motion.h"

/* Everything that skf_flight_step changes: orbit, integrator, contact, report. A flight made by skf_flight_new with the
   same world and options (from any start) continues with the same bits once it has loaded them. They hold no pointers,
   and mean something to the same build of the library only. */
size_t skf_flight_state_size(const skf_flight *flight);
void skf_flight_save(const skf_flight *flight, void *bytes);
void skf_flight_load(skf_flight *flight, const void *bytes);

#endif
