/* SPDX-License-Identifier: MIT */
#include "skeleton/shape.h"

static const char *degenerate(const skf_primitive *p) { return (void)p, NULL; }
static double measure(const skf_primitive *p) { return (void)p, 1; }
static double distance(const skf_primitive *p, skf_vec3 x) { return v3_dist(p->point.at, x); }
static skf_box bounds(const skf_primitive *p) { return (skf_box){p->point.at, p->point.at}; }
static skf_vec3 at(const skf_primitive *p, double s, double t) { return (void)s, (void)t, p->point.at; }

static const skf_param params[] = {
    {"at", "L", "where it is", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, point.at), 0, 0},
};

const skf_shape_ops skf_shape_point = {
    {"point", "one point; its measure is 1", "1", params, 1}, degenerate, measure, distance, distance, bounds, at};
