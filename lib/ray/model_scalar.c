/* SPDX-License-Identifier: MIT */
#include "ray/model_tensor.h"

void skf_model_apply_scalar(const double a[3][SKF_NODES][SKF_NODES], double *c) { apply_all(a, c); }
