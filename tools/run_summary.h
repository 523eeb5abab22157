/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run tells when it is over. */
#ifndef SKF_TOOLS_RUN_SUMMARY_H
#define SKF_TOOLS_RUN_SUMMARY_H

#include "cli.h"

typedef struct run_summary {
  size_t rows, contacts;
  double t; /* of the last row */
} run_summary;

/* Costs, drifts and warnings on stderr; with json also one object on stdout. */
void run_summary_tell(const run_summary *sum, const skf_scene *scene, const skf_flight_report *reports, bool json);

#endif
