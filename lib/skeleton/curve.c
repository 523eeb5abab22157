/* SPDX-License-Identifier: MIT */
/* Curves as chains of arcs: biarcs through the ends and tangents of ever shorter parts [Sharrock 1987]. The distance to
   the curve falls with the third power of their length. */
#include "skeleton/curve.h"

/* A part is looked at in so many places; half of the tolerance there leaves the other half for what is between them. */
enum { STEPS = 16, DEPTH = 40 };

typedef struct cutter {
  const skf_curve *curve;
  double tolerance, in, scale; /* of the curve times `in`, when its size is about 1; what brings pieces back */
  skf_primitive *out;
  size_t capacity, count;
} cutter;

typedef struct part {
  skf_vec3 at[STEPS + 1], along[STEPS + 1]; /* places, unit tangents: those of the ends point inwards and outwards */
  double length;
} part;

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

/* Two arcs, tangent to the curve at its ends and to each other; the joint is as far along one tangent as along the
   other. */
static void biarc(const part *p, double flat, skf_primitive out[2]) {
  skf_vec3 a = p->at[0], b = p->at[STEPS], t0 = p->along[0], t1 = p->along[STEPS], v = v3_sub(b, a);
  skf_vec3 bend = v3_sub(t0, t1);
  double along = v3_dot(v, v3_add(t0, t1)), v2 = v3_norm2(v);
  double d = v2 / (along + sqrt(along * along + v3_norm2(bend) * v2));
  skf_vec3 joint = v3_scale(0.5, v3_add(v3_add(a, b), v3_scale(d, bend)));
  out[0] = bow(a, t0, joint, flat);
  out[1] = turned(bow(b, v3_scale(-1, t1), joint, flat), joint);
}

static void look(const cutter *c, double from, double to, part *p) {
  p->length = 0;
  for (int k = 0; k <= STEPS; k++) {
    double t = k == STEPS ? to : from + k * ((to - from) / STEPS);
    c->curve->at(c->curve->user, t, k == STEPS ? -1 : 1, p->at + k, p->along + k);
    p->at[k] = v3_scale(c->in, p->at[k]), p->along[k] = v3_unit(p->along[k]);
    if (k) p->length += v3_dist(p->at[k - 1], p->at[k]);
  }
}

/* It runs forward all the way, so what is near the curve is also near to the right part of it. */
static bool runs_forward(const part *p) {
  skf_vec3 v = v3_sub(p->at[STEPS], p->at[0]);
  bool ends = v3_dot(p->along[0], p->along[STEPS]) > 0 && v3_dot(v, p->along[0]) > 0 && v3_dot(v, p->along[STEPS]) > 0;
  for (int k = 1; k < STEPS && ends; k++)
    if (!(v3_dot(v, p->along[k]) >= 0 && v3_dot(v, v3_sub(p->at[k], p->at[k - 1])) > 0)) ends = false;
  return ends;
}

static bool follows(const part *p, const skf_primitive *pieces, int n, double within) {
  for (int k = 1; k < STEPS; k++) {
    double d = skf_primitive_distance(pieces, p->at[k]);
    if (n > 1) d = fmin(d, skf_primitive_distance(pieces + 1, p->at[k]));
    if (!(d <= within)) return false;
  }
  return true;
}

static void cut(cutter *c, double from, double to, int depth) {
  part p;
  look(c, from, to, &p);
  skf_primitive line = straight(p.at[0], p.at[STEPS]), arcs[2];
  double middle = from + 0.5 * (to - from), flat = 0.125 * c->tolerance;
  if (p.length <= 0.5 * c->tolerance || depth == 0 || !(from < middle && middle < to)) return emit(c, &line);
  if (runs_forward(&p)) {
    if (follows(&p, &line, 1, flat)) return emit(c, &line);
    biarc(&p, flat, arcs);
    if (follows(&p, arcs, 2, 0.5 * c->tolerance)) return emit(c, arcs), emit(c, arcs + 1);
  }
  cut(c, from, middle, depth - 1), cut(c, middle, to, depth - 1);
}

static skf_status run(cutter *c, size_t *count) {
  int parts = c->curve->parts > 1 ? c->curve->parts : 1;
  for (int k = 0; k < parts; k++) cut(c, (double)k / parts, (k + 1.0) / parts, DEPTH);
  *count = c->count;
  return c->count > c->capacity && c->out ? SKF_ERR_CAPACITY : SKF_OK;
}

skf_status skf_curve_cut_scaled(const skf_curve *curve, double tolerance, int power, skf_primitive *pieces,
                                size_t capacity, size_t *count) {
  return run(&(cutter){curve, tolerance, 1, ldexp(1, power), pieces, capacity, 0}, count);
}

skf_status skf_curve_cut(const skf_curve *curve, double tolerance, skf_primitive *pieces, size_t capacity,
                         size_t *count) {
  int parts = curve->parts > 1 ? curve->parts : 1, power;
  skf_box box = box_empty();
  *count = 0;
  for (int k = 0; k <= parts * STEPS; k++) {
    skf_vec3 x, t;
    curve->at(curve->user, fmin(1, (double)k / (parts * STEPS)), k == parts * STEPS ? -1 : 1, &x, &t);
    if (!v3_finite(x)) return SKF_ERR_RANGE;
    box = box_add(box, x);
  }
  double size = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
  if (!(size > 0)) return SKF_ERR_DEGENERATE;
  frexp(size, &power);
  if (!isfinite(size) || power < -1000 || power > 1000) return SKF_ERR_RANGE;
  if (tolerance == 0) tolerance = SKF_CURVE_TOLERANCE * size;
  if (!(tolerance >= 1e-10 * size && tolerance <= 0.1 * size)) return SKF_ERR_RANGE;
  return run(&(cutter){curve, ldexp(tolerance, -power), ldexp(1, -power), ldexp(1, power), pieces, capacity, 0}, count);
}
