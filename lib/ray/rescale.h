/* SPDX-License-Identifier: MIT */
/* Fields whose lengths are huge or tiny, brought to lengths about 1. */
#ifndef SKF_RAY_RESCALE_H
#define SKF_RAY_RESCALE_H

#include "skelfield/field.h"

/* A copy of the field, all lengths times 2^*power and all values times another power of two, so that it is *copied_iso
   where the field is iso. *power = 0 and no copy: none is needed, or none can be: solids, users' kernels, planes of the
   inverse-squared kernel, whose potential is relative to a length, strengths that would leave the range of doubles.
   SKF_ERR_NOMEM. */
skf_status skf_rescale(const skf_field *field, double iso, int *power, double *copied_iso, skf_field **copy);

#endif
