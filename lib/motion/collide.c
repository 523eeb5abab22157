/* SPDX-License-Identifier: MIT */
/* Collisions of two solids by cells of space and time. A cell is a cube in the frame of a and an interval of time. It
   is dismissed when its ball lies outside of a; when its ball, swept by the motion, lies outside of b; or when the sum
   of both fields, each over its gradient's length, stays negative: near a touch the gradients are opposite, so that the
   sum hardly changes along the surfaces, and cells of the size of sqrt(gap) suffice. Cells that are not dismissed are
   cut in eight as long as space is what makes them unsure, and then the interval is halved. */
#include "core/alloc.h"
#include "motion/collider.h"
#include <float.h>

#define ROUNDING (64 * DBL_EPSILON) /* of places, relative to their coordinates: a gap below is not known */
#define GRAZE    1e-3               /* of the whole time: no longer piece before a touch is left out for rounding */
#define FINE     0.5 /* a cube whose ball moves by more than its radius over this is not cut before the interval is */

enum { DEPTH = 64, MOST_CELLS = 4000000 };

typedef struct cube {
  skf_vec3 center; /* frame of a */
  double half;     /* edge */
} cube;

typedef struct sweep {
  skf_duel duel;
  double sign;  /* -1 when a and b were exchanged */
  double mean;  /* time */
  double clock; /* rounding of times */
  double slack; /* times closer than this to `until` are not looked at */
  double far;   /* size of coordinates */
  double begin, end;
  double tried;  /* size of the last cube at rest from where the deepest place was looked for */
  double until;  /* an earlier contact is not known to exist */
  skf_kiss kiss; /* at `until`, if sure */
  bool sure;     /* `until` is a touch */
  double doubt;  /* start of the first piece undecided at the floor, or INFINITY */
  skf_vec3 doubt_at;
  cube *stack;
  size_t count, capacity, cells, grazing;
  skf_status status;
} sweep;

static void push(sweep *s, cube c) {
  if (s->count == s->capacity) {
    size_t capacity = 2 * s->capacity + 64;
    cube *more = skf_realloc(s->stack, capacity, sizeof *more);
    if (!more) {
      s->status = SKF_ERR_NOMEM;
      return;
    }
    s->stack = more, s->capacity = capacity;
  }
  s->stack[s->count++] = c;
}

/* How a's material near p moves against b over |t - mean| <= h: bounds. */
typedef struct motion {
  skf_vec3 y;  /* the place in b's frame at the middle */
  skf_vec3 dy; /* its velocity there, b's frame */
  double bend; /* bound of |d2y/dt2| for the center, */
  double mix;  /* of the speed by which places of the ball differ, over their distance */
} motion;

static skf_vec3 velocity_at(const skf_rigid_motion *m, double t) {
  return v3_mad(m->velocity, t - m->t, m->acceleration);
}

/* With Z = X - x_b: y = R_b^T Z, dy = R_b^T (dZ - w_b x Z), |d2y| <= |d2Z| + 2 w_b |dZ| + w_b^2 |Z|. */
static motion follow(const sweep *s, const skf_pose *pa, const skf_pose *pb, double t, double h, skf_vec3 p) {
  const skf_rigid_motion *a = &s->duel.ma, *b = &s->duel.mb;
  skf_vec3 arm = quat_turn(pa->q, 1, p), X = v3_add(pa->position, arm), Z = v3_sub(X, pb->position);
  skf_vec3 dZ = v3_sub(v3_add(velocity_at(a, t), v3_cross(a->angular_velocity, arm)), velocity_at(b, t));
  double wa = v3_norm(a->angular_velocity), wb = v3_norm(b->angular_velocity);
  double ddZ = v3_norm(v3_sub(a->acceleration, b->acceleration)) + wa * wa * v3_norm(arm);
  double V = v3_norm(dZ) + ddZ * h, D = v3_norm(Z) + V * h;
  motion m = {.y = quat_turn(pb->q, -1, Z)};
  m.dy = quat_turn(pb->q, -1, v3_sub(dZ, v3_cross(b->angular_velocity, Z)));
  m.bend = (ddZ + 2 * wb * V + wb * wb * D) * (1 + 1e-12);
  m.mix = v3_norm(v3_sub(a->angular_velocity, b->angular_velocity));
  if (wa > 0 && wb > 0) m.mix += 2 * wa * wb * h; /* the one turns the other's axis */
  return m;
}

typedef enum verdict { DISMISSED, SPACE, TIME } verdict;

static void found(sweep *s, double t, skf_vec3 p) {
  t = fmax(t, s->begin); /* intervals are taken longer by a rounding error */
  if (t >= s->until) return;
  s->until = t, s->sure = false, s->slack = s->clock;
  s->kiss.t = t, s->kiss.p = p;
}

/* One cube over |time - mean| <= h. SPACE, TIME: which of both to halve. */
static verdict examine(sweep *s, const skf_pose *pa, const skf_pose *pb, double t, double h, const cube *c) {
  double r = 0.8660254037844387 * 2 * c->half * (1 + 1e-12), far = s->far + v3_norm(c->center);
  s->cells++;
  skf_guess a = skf_collider_guess(s->duel.a, c->center, r, far);
  if (a.side < 0) return DISMISSED;
  motion m = follow(s, pa, pb, t, h, c->center);
  double bow = 0.5 * m.bend * h * h + m.mix * h * r, moved = v3_norm(m.dy) * h + bow;
  skf_guess b = skf_collider_guess(s->duel.b, m.y, r + moved, far);
  if (b.side < 0) return DISMISSED;
  bool floor = r < 64 * DBL_EPSILON * far;
  if (floor && h == 0) return s->grazing++, DISMISSED;
  bool fine = floor || r < FINE * moved; /* in the time it is swept over what is not near it */
  verdict larger = r > moved && !floor ? SPACE : TIME;
  if (a.side > 0 && b.side > 0) return found(s, t - h, c->center), DISMISSED; /* nothing earlier is wanted here */
  if (a.vague || b.vague) return larger;
  double na = v3_norm(a.g), nb = v3_norm(b.g);
  if (a.side > 0 || b.side > 0) {
    bool inside = a.side > 0 ? b.f > b.rough : a.f > a.rough;
    if (inside) found(s, t, c->center);
    return larger;
  }
  if (a.f > a.rough && b.f > b.rough) found(s, t, c->center);
  if (!(na > 0 && nb > 0)) return larger;
  skf_vec3 gb = quat_turn(pa->q, -1, quat_turn(pb->q, 1, b.g));
  double rho = r + moved, rough = a.rough / na + b.rough / nb;
  double space = v3_norm(v3_add(v3_scale(1 / na, a.g), v3_scale(1 / nb, gb))) * r + 0.5 * a.bend / na * r * r +
                 0.5 * b.bend / nb * r * r;
  double time = fabs(v3_dot(b.g, m.dy)) / nb * h + b.slope / nb * bow + 0.5 * b.bend / nb * (rho * rho - r * r);
  if (a.f / na + b.f / nb + space + time + rough < 0) return DISMISSED;
  if (h == 0 && space < rough) return s->grazing++, DISMISSED;
  return fine || space < fmax(time, h > 0 ? rough : 0) ? TIME : SPACE;
}

/* At rest: looks for a common place from a cube that holds one for all that is known. */
static void dive(sweep *s, double t, const cube *c) {
  skf_kiss k;
  if (c->half > 0.6 * s->tried || c->half > 0.25 * s->duel.a->radius) return;
  s->tried = c->half;
  if (!skf_kiss_at(&s->duel, t, c->center, 8 * c->half, &k) || !(k.depth > 0)) return;
  skf_pose pb = skf_rigid_at(&s->duel.mb, t);
  double far = s->far;
  skf_guess a = skf_collider_guess(s->duel.a, k.p, 0, far),
            b = skf_collider_guess(s->duel.b, skf_pose_inverse(&pb, k.at), 0, far);
  if (a.side > 0 && b.side > 0) found(s, t, k.p);
}

/* Cuts a cube until time is what makes its parts unsure; those go onto the stack. */
static void refine(sweep *s, const skf_pose *pa, const skf_pose *pb, double t, double h, cube c) {
  if (s->status || s->cells > MOST_CELLS || (h == 0 && s->until <= t)) return;
  verdict v = examine(s, pa, pb, t, h, &c);
  if (h == 0 && s->grazing && s->doubt == INFINITY) s->doubt = t, s->doubt_at = c.center;
  if (v == TIME && h > 0) return push(s, c);
  if (v == DISMISSED) return;
  if (h == 0) dive(s, t, &c);
  double half = 0.5 * c.half;
  for (int k = 0; k < 8; k++) {
    skf_vec3 at = v3(c.center.x + (k & 1 ? half : -half), c.center.y + (k & 2 ? half : -half),
                     c.center.z + (k & 4 ? half : -half));
    refine(s, pa, pb, t, h, (cube){at, half});
  }
}

/* A touch near the cubes that are left, by Newton's method. */
static void guess_touch(sweep *s, double t, double h, size_t from) {
  for (size_t i = from; i < s->count && i < from + 4; i++) {
    skf_kiss k;
    cube c = s->stack[i];
    if (!skf_kiss_in_time(&s->duel, t, c.center, 4 * c.half, 4 * h, &k)) continue;
    if (!(k.approach > 0) || k.t < s->begin || k.t > fmin(s->end, s->until)) continue;
    s->until = k.t, s->sure = true, s->kiss = k;
    /* before it, rounding could hide the gap; where they graze, that is no reason not to look elsewhere */
    s->slack = fmax(s->clock, fmin(ROUNDING * s->far / k.approach, GRAZE * (s->end - s->begin)));
    return;
  }
}

/* Certifies [a, b], as far as it lies before the earliest contact known, from the cubes first .. last - 1. */
static void scan(sweep *s, double a, double b, size_t first, size_t last, int depth) {
  if (a >= s->until - s->slack || s->status || s->cells > MOST_CELLS) return;
  double t = 0.5 * (a + b), h = 0.5 * (b - a) * (1 + 4 * DBL_EPSILON);
  skf_pose pa = skf_rigid_at(&s->duel.ma, t), pb = skf_rigid_at(&s->duel.mb, t);
  size_t base = s->count;
  for (size_t i = first; i < last && !s->status; i++) refine(s, &pa, &pb, t, h, s->stack[i]);
  if (s->cells > MOST_CELLS) { /* given up: from here on nothing is certified */
    if (s->doubt == INFINITY) s->doubt = a, s->doubt_at = s->stack[first].center;
    s->count = base;
    return;
  }
  size_t end = s->count;
  if (end == base || s->status) return;
  guess_touch(s, t, h, base);
  if (depth == 0 || h < 0.25 * s->slack) {
    s->grazing++;
    if (s->doubt == INFINITY) s->doubt = a, s->doubt_at = s->stack[base].center;
  } else {
    scan(s, a, t, base, end, depth - 1);
    scan(s, t, b, base, end, depth - 1);
  }
  s->count = base;
}

static skf_status enter(sweep *s, const skf_collider *a, const skf_rigid_motion *ma, const skf_collider *b,
                        const skf_rigid_motion *mb, skf_meet *out) {
  *out = (skf_meet){.meeting = SKF_MEETING_APART};
  if (!a->bounded && !b->bounded) return SKF_ERR_UNSUPPORTED;
  bool swap = !a->bounded || (b->bounded && b->radius < a->radius);
  s->duel = swap ? (skf_duel){b, a, *mb, *ma} : (skf_duel){a, b, *ma, *mb};
  s->sign = swap ? -1 : 1;
  for (int k = 0; k < 2; k++) {
    const skf_rigid_motion *m = k ? mb : ma;
    const double *q = m->pose.q;
    double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    bool fine = v3_finite(m->pose.position) && v3_finite(m->velocity) && v3_finite(m->acceleration) &&
                v3_finite(m->angular_velocity) && isfinite(m->t) && fabs(n - 1) < 1e-9;
    if (!fine) return SKF_ERR_RANGE;
    quat_normalize(k == (swap ? 0 : 1) ? s->duel.mb.pose.q : s->duel.ma.pose.q);
  }
  s->until = s->doubt = INFINITY;
  return SKF_OK;
}

/* The largest coordinate during |time - t| <= h. */
static double reach_of(const skf_collider *c, const skf_rigid_motion *m, double t, double h) {
  double way = v3_norm(velocity_at(m, t)) * h + 0.5 * v3_norm(m->acceleration) * h * h;
  return v3_norm(skf_rigid_at(m, t).position) + way + (c->bounded ? v3_dist(c->center, c->origin) + c->radius : 0);
}

static cube whole(const skf_collider *c) {
  skf_vec3 d = v3_sub(c->box.hi, c->box.lo);
  return (cube){v3_sub(box_center(c->box), c->origin), 0.5 * fmax(d.x, fmax(d.y, d.z)) * (1 + 1e-12)};
}

/* Depths of a place in both solids to first order, and the inertial directions in which they grow. */
typedef struct depths {
  double a, b;
  skf_vec3 x, up_a, up_b;
} depths;

static depths depths_at(const skf_duel *d, const skf_pose *pa, const skf_pose *pb, skf_vec3 p) {
  depths s = {.x = skf_pose_point(pa, p)};
  skf_vec3 ga, gb;
  double fa = skf_field_at(d->a->field, v3_add(p, d->a->origin), &ga) - d->a->iso, na = v3_norm(ga);
  double fb = skf_field_at(d->b->field, v3_add(skf_pose_inverse(pb, s.x), d->b->origin), &gb) - d->b->iso,
         nb = v3_norm(gb);
  s.a = na > 0 ? fa / na : fa > 0 ? INFINITY : -INFINITY, s.b = nb > 0 ? fb / nb : fb > 0 ? INFINITY : -INFINITY;
  s.up_a = v3_unit(quat_turn(pa->q, 1, ga)), s.up_b = v3_unit(quat_turn(pb->q, 1, gb));
  return s;
}

/* The deepest place near p, where Newton's method gets there, or p itself; walks a bit towards it first. */
static skf_kiss settle(const sweep *s, double t, skf_vec3 p) {
  const skf_duel *d = &s->duel;
  skf_kiss k;
  double step = 0.1 * d->a->radius;
  if (skf_kiss_at(d, t, p, step, &k) && k.depth >= 0) return k;
  skf_pose pa = skf_rigid_at(&d->ma, t), pb = skf_rigid_at(&d->mb, t);
  skf_vec3 q = p;
  for (int i = 0; i < 60; i++, step *= 0.93) {
    depths w = depths_at(d, &pa, &pb, q);
    q = v3_mad(q, step, quat_turn(pa.q, -1, w.a < w.b ? w.up_a : w.up_b));
    if (i % 20 == 19 && skf_kiss_at(d, t, q, 10 * step, &k) && k.depth >= 0) return k;
  }
  depths w = depths_at(d, &pa, &pb, p);
  double depth = (isfinite(w.a) ? fmax(w.a, 0) : 0) + (isfinite(w.b) ? fmax(w.b, 0) : 0);
  return (skf_kiss){t, p, w.x, v3_unit(v3_sub(w.up_b, w.up_a)), 0, depth};
}

static void tell(const sweep *s, skf_meeting meeting, const skf_kiss *k, skf_meet *out) {
  *out = (skf_meet){meeting, k->t, k->at, v3_scale(s->sign, k->normal), k->depth, s->cells, s->grazing};
}

/* At rest at time t. */
static void rest(sweep *s, double t, skf_meet *out) {
  skf_pose pa = skf_rigid_at(&s->duel.ma, t), pb = skf_rigid_at(&s->duel.mb, t);
  s->far = reach_of(s->duel.a, &s->duel.ma, t, 0) + reach_of(s->duel.b, &s->duel.mb, t, 0);
  s->begin = s->end = t;
  s->tried = INFINITY;
  refine(s, &pa, &pb, t, 0, whole(s->duel.a));
  bool over = s->cells > MOST_CELLS, met = s->until <= t;
  skf_kiss k = {.t = t};
  if (met || s->grazing) k = settle(s, t, met ? s->kiss.p : s->doubt_at);
  tell(s, met ? SKF_MEETING_OVERLAP : s->grazing || over ? SKF_MEETING_UNDECIDED : SKF_MEETING_APART, &k, out);
}

skf_status skf_collide(const skf_collider *a, const skf_pose *pa, const skf_collider *b, const skf_pose *pb,
                       skf_meet *out) {
  sweep s = {.sign = 1};
  skf_rigid_motion ma = {.pose = *pa}, mb = {.pose = *pb};
  skf_status bad = enter(&s, a, &ma, b, &mb, out);
  if (bad) return bad;
  rest(&s, 0, out);
  skf_free(s.stack);
  return s.status;
}

static void first(sweep *s, double t0, double t1, skf_meet *out) {
  double t = 0.5 * (t0 + t1), h = 0.5 * (t1 - t0);
  s->begin = t0, s->end = t1, s->until = s->doubt = INFINITY, s->grazing = 0;
  s->far = reach_of(s->duel.a, &s->duel.ma, t, h) + reach_of(s->duel.b, &s->duel.mb, t, h);
  s->clock = s->slack = 16 * DBL_EPSILON * fmax(fabs(t0), fabs(t1));
  push(s, whole(s->duel.a));
  if (!s->status) scan(s, t0, t1, 0, 1, DEPTH);
  skf_kiss k = {.t = t1};
  bool over = s->cells > MOST_CELLS, met = s->until <= t1 && !over;
  if (met && !s->sure && s->doubt < s->until) s->kiss.t = s->doubt; /* the start of what could not be told apart */
  if (met) k = s->sure ? s->kiss : settle(s, s->kiss.t, s->kiss.p);
  if (!met && s->doubt < INFINITY) k = settle(s, s->doubt, s->doubt_at);
  tell(s, met ? SKF_MEETING_OVERLAP : s->doubt < INFINITY || over ? SKF_MEETING_UNDECIDED : SKF_MEETING_APART, &k, out);
  if (met) out->depth = 0;
}

skf_status skf_collide_first(const skf_collider *a, const skf_rigid_motion *ma, const skf_collider *b,
                             const skf_rigid_motion *mb, double t0, double t1, skf_meet *out) {
  sweep s = {.sign = 1};
  skf_status bad = enter(&s, a, ma, b, mb, out);
  if (bad) return bad;
  if (!isfinite(t0) || !isfinite(t1) || !(t0 <= t1)) return SKF_ERR_RANGE;
  rest(&s, t0, out);
  if (!s.status && out->meeting == SKF_MEETING_APART && t1 > t0) first(&s, t0, t1, out);
  skf_free(s.stack);
  return s.status;
}
