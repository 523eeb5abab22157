/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SKF_TOOLS_SAME_SHAPE_H
#define SKF_TOOLS_SAME_SHAPE_H

#include "skelfield/rigid.h"
#include "skelfield/scene.h"

/* Whether b is a, turned and moved elsewhere, to 1e-10 of its size; then the mass properties of a give those of b. */
bool same_shape(const skf_body *a, const skf_body *b, const skf_mass *of_a, skf_mass *of_b);

#endif
