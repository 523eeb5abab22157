/* SPDX-License-Identifier: MIT */
#include "motion/nystrom.h"

typedef skf_nystrom_one one_lanes;
typedef skf_nystrom_many many_lanes;

#define LANES   1
#define NAME(x) one_##x
#include "motion/nystrom_loop.h"
#undef LANES
#undef NAME
#define LANES   SKF_FLOCK
#define NAME(x) many_##x
#include "motion/nystrom_loop.h"

const skf_nystrom_ops skf_nystrom_base = {one_attempt, many_attempt};
