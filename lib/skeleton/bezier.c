/* SPDX-License-Identifier: MIT */
/* Cubic Bezier curves as chains of arcs: biarcs through the ends and tangents of ever shorter parts [Sharrock 1987].
   The distance to the curve falls with the third power of their length. */
#include "skeleton/shape.h"

typedef struct cutter {
  double tolerance, scale; /* of the curve when its size is about 1; what brings it back */
  skf_primitive *out;
  size_t capacity, count;
} cutter;

static double hull_length(const skf_vec3 q[4]) {
  return v3_dist(q[0], q[1]) + v3_dist(q[1], q[2]) + v3_dist(q[2], q[3]);
}

static void emit(cutter *c, const skf_primitive *p) {
  skf_primitive a = *p;
  if (a.shape == SKF_SEGMENT) {
    a.segment.from = v3_scale(c->scale, a.segment.from), a.segment.to = v3_scale(c->scale, a.segment.to);
    if (skf_primitive_check(&a, NULL)) return; /* a loop smaller than the tolerance */
  } else {
    a.arc.center = v3_scale(c->scale, a.arc.center), a.arc.radius *= c->scale;
  }
  if (c->count < c->capacity) c->out[c->count] = a;
  c->count++;
}

static skf_primitive straight(skf_vec3 a, skf_vec3 b) {
  return (skf_primitive){.shape = SKF_SEGMENT, .segment = {a, b}};
}

/* From a in the direction t to b; a segment where an arc would rise less than `flat`. */
static skf_primitive bow(skf_vec3 a, skf_vec3 t, skf_vec3 b, double flat) {
  skf_vec3 chord = v3_sub(b, a), n = v3_cross(t, chord);
  double length = v3_norm(chord), half = atan2(v3_norm(n), v3_dot(t, chord));
  if (!(0.5 * length * tan(0.5 * half) > flat)) return straight(a, b);
  double radius = 0.5 * length / sin(half);
  skf_vec3 in = v3_unit(v3_cross(n, t));
  return (skf_primitive){.shape = SKF_ARC,
                         .arc = {v3_mad(a, radius, in), v3_unit(n), v3_scale(-1, in), radius, 2 * half}};
}

/* The same curve from its other end, which is b. */
static skf_primitive turned(skf_primitive p, skf_vec3 b) {
  if (p.shape == SKF_SEGMENT) return straight(p.segment.to, p.segment.from);
  p.arc.normal = v3_scale(-1, p.arc.normal);
  p.arc.start = v3_unit(v3_sub(b, p.arc.center));
  return p;
}

/* Direction in which the curve leaves q[0]: to the first control point that is elsewhere. */
static skf_vec3 leaving(const skf_vec3 q[4]) {
  double nothing = 1e-9 * hull_length(q); /* a shorter handle bends less than any tolerance notices */
  int k = 1;
  while (k < 3 && !(v3_dist(q[0], q[k]) > nothing)) k++;
  return v3_unit(v3_sub(q[k], q[0]));
}

/* Two arcs, tangent to the curve at its ends and to each other; the joint is as far along one tangent as along the
   other. */
static void biarc(const skf_vec3 q[4], skf_vec3 t0, skf_vec3 t1, double flat, skf_primitive out[2]) {
  skf_vec3 v = v3_sub(q[3], q[0]), bend = v3_sub(t0, t1);
  double along = v3_dot(v, v3_add(t0, t1)), v2 = v3_norm2(v);
  double d = v2 / (along + sqrt(along * along + v3_norm2(bend) * v2));
  skf_vec3 joint = v3_scale(0.5, v3_add(v3_add(q[0], q[3]), v3_scale(d, bend)));
  out[0] = bow(q[0], t0, joint, flat);
  out[1] = turned(bow(q[3], v3_scale(-1, t1), joint, flat), joint);
}

static void halve(const skf_vec3 q[4], skf_vec3 left[4], skf_vec3 right[4]) {
  skf_vec3 a = v3_scale(0.5, v3_add(q[0], q[1])), b = v3_scale(0.5, v3_add(q[1], q[2]));
  skf_vec3 c = v3_scale(0.5, v3_add(q[2], q[3]));
  skf_vec3 ab = v3_scale(0.5, v3_add(a, b)), bc = v3_scale(0.5, v3_add(b, c)), m = v3_scale(0.5, v3_add(ab, bc));
  left[0] = q[0], left[1] = a, left[2] = ab, left[3] = m;
  right[0] = m, right[1] = bc, right[2] = c, right[3] = q[3];
}

static skf_vec3 point_of(const skf_vec3 q[4], double t) {
  double u = 1 - t;
  skf_vec3 a = v3_add(v3_scale(u * u * u, q[0]), v3_scale(3 * u * u * t, q[1]));
  return v3_add(a, v3_add(v3_scale(3 * u * t * t, q[2]), v3_scale(t * t * t, q[3])));
}

/* Half of the tolerance at 15 points leaves the other half for what is between them. */
static bool follows(const skf_vec3 q[4], const skf_primitive arcs[2], double tolerance) {
  for (int k = 1; k < 16; k++) {
    skf_vec3 x = point_of(q, k / 16.0);
    if (!(fmin(skf_primitive_distance(arcs, x), skf_primitive_distance(arcs + 1, x)) <= 0.5 * tolerance)) return false;
  }
  return true;
}

static void cut(cutter *c, const skf_vec3 q[4]) {
  skf_primitive line = straight(q[0], q[3]), arcs[2];
  if (hull_length(q) <= c->tolerance) return emit(c, &line);
  const skf_vec3 back[4] = {q[3], q[2], q[1], q[0]};
  skf_vec3 v = v3_sub(q[3], q[0]), t0 = leaving(q), t1 = v3_scale(-1, leaving(back));
  /* it runs forward all the way, so what is near the curve is also near to the right part of it */
  if (v3_dot(v, t0) > 0 && v3_dot(v, t1) > 0 && v3_dot(t0, t1) > 0 && v3_dot(v, v3_sub(q[2], q[1])) >= 0) {
    double flat = 0.125 * c->tolerance;
    if (skf_primitive_distance(&line, q[1]) <= flat && skf_primitive_distance(&line, q[2]) <= flat)
      return emit(c, &line);
    biarc(q, t0, t1, flat, arcs);
    if (follows(q, arcs, c->tolerance)) return emit(c, arcs), emit(c, arcs + 1);
  }
  skf_vec3 left[4], right[4];
  halve(q, left, right);
  cut(c, left), cut(c, right);
}

skf_status skf_bezier_cut(const skf_vec3 p[4], double tolerance, skf_primitive *pieces, size_t capacity,
                          size_t *count) {
  skf_box box = box_empty();
  *count = 0;
  for (int k = 0; k < 4; k++) {
    if (!v3_finite(p[k])) return SKF_ERR_RANGE;
    box = box_add(box, p[k]);
  }
  int power;
  double extent = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
  if (!(extent > 0)) return SKF_ERR_DEGENERATE;
  frexp(extent, &power);
  if (!isfinite(extent) || power < -1000 || power > 1000) return SKF_ERR_RANGE;
  skf_vec3 q[4];
  for (int k = 0; k < 4; k++) q[k] = v3_scale(ldexp(1, -power), p[k]);
  cutter c = {ldexp(tolerance, -power), ldexp(1, power), pieces, capacity, 0};
  double size = hull_length(q);
  if (tolerance == 0) c.tolerance = SKF_BEZIER_TOLERANCE * size;
  if (!(c.tolerance >= 1e-10 * size && c.tolerance <= 0.1 * size)) return SKF_ERR_RANGE;
  cut(&c, q);
  *count = c.count;
  return c.count > capacity && pieces ? SKF_ERR_CAPACITY : SKF_OK;
}
