/* SPDX-License-Identifier: MIT */
/* A flight's state as bytes, for checkpoints. */
#ifndef SKF_MOTION_FLIGHT_H
#define SKF_MOTION_FLIGHT_H

#include "motion/integrator.h"

/* Everything that skf_flight_step changes: orbit, integrator, contact, report. A flight made by skf_flight_new with the
   same world and options (from any start) continues with the same bits once it has loaded them. They hold no pointers,
   and mean something to the same build of the library only. */
size_t skf_flight_state_size(const skf_flight *flight);
void skf_flight_save(const skf_flight *flight, void *bytes);
void skf_flight_load(skf_flight *flight, const void *bytes);

/* Approaches count up to a time t; without this, up to the end of the last step. */
void skf_flight_watch_until(skf_flight *flight, double t);

/* Whether flights with these options may go on side by side: an integrator that can. */
bool skf_flight_in_flock(const skf_flight *flight);
/* Steps of n such flights through the same world, until each one's span reaches t; those whose status[i] is not SKF_OK
   are passed over, the others' becomes that of skf_flight_step, or of the listener. The same bits as one by one.
   SKF_ERR_NOMEM before anything has moved. */
skf_status skf_flights_pass(skf_flight *const *flights, size_t n, double t, skf_status *status,
                            const skf_listener *listener);

#endif
