/* SPDX-License-Identifier: MIT */
/* Particles that fly through fields, and where they touch. */
#ifndef SKELFIELD_MOTION_H
#define SKELFIELD_MOTION_H

#include "skelfield/ray.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Uniform rotation about a fixed axis; the body's frame is the inertial frame at t = 0. */
typedef struct skf_spin {
  skf_vec3 axis, about; /* axis need not be a unit vector */
  double rate;          /* [rad/T]; 0: no rotation */
} skf_spin;

typedef enum skf_contact_mode {
  SKF_CONTACT_NONE,
  SKF_CONTACT_STOP,
  SKF_CONTACT_BOUNCE,
  SKF_CONTACT_STICK
} skf_contact_mode;

#ifdef __cplusplus
}
#endif
#endif
