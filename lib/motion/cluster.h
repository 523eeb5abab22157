/* SPDX-License-Identifier: MIT */
/* Flights of particles that attract each other: they share their steps. */
#ifndef SKF_MOTION_CLUSTER_H
#define SKF_MOTION_CLUSTER_H

#include "motion/integrator.h"

typedef struct skf_cluster skf_cluster;

/* Takes n flights, made with the same options, that stand at the same time; they are borrowed and from now on move by
   skf_cluster_step alone. gm: G times each one's mass, which is borrowed. What the cluster itself knows is kept in the
   flights: one whose flights have been loaded continues with the same bits, see skf_cluster_resume.
   SKF_ERR_UNSUPPORTED for another integrator than gauss-radau, SKF_ERR_CONVERGENCE where two start at one place. */
skf_status skf_cluster_new(const skf_world *world, skf_flight *const *flights, size_t n, const double *gm,
                           double softening, skf_cluster **out);
void skf_cluster_free(skf_cluster *c);
/* To be called when the flights have been loaded. */
void skf_cluster_resume(skf_cluster *c);

/* One step, which ends early at the first contact of any: the listener hears of each contact there. On failure *failed
   is a particle that stands for it, and nothing has moved. */
skf_status skf_cluster_step(skf_cluster *c, const skf_listener *listener, size_t *failed);
/* Until when all flights are known; INFINITY when none flies any more. */
double skf_cluster_time(const skf_cluster *c);
/* Compares the constants of the motion of all particles together with what they were: in the report of the first. */
void skf_cluster_compare(skf_cluster *c);

#endif
