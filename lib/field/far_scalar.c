/* SPDX-License-Identifier: MIT */
#include "field/far_loop.h"

const far_ops skf_far_scalar = FAR_OPS;
