/* SPDX-License-Identifier: MIT */
/* Bodies that lean on each other: steps of the free motion, corrected by the forces that keep them apart. A step begins
   with the impulses of those that approach faster than a hop, one after another, and of the others at once. Then come
   forces, taken as constant over the step: what they change of the velocities obeys Signorini's and Coulomb's laws at
   the step's end, half of it times the step changes the places [Moreau 1988; Stewart and Trinkle 1996]. A step ends
   where another place touches. What is left of overlaps is undone by displacements. That costs energy, once, for the
   gaps: it is left out of what must not grow, see keep.c. */
#include "motion/swarm.h"
#include "core/alloc.h"
#include <float.h>
#include <string.h>

#define STEP 0.02 /* of the time in which a body moves by its size, turns, or falls by its size */
/* Gaps, over the size: up to BAND two are said to touch; the gap is kept above LOW, and goes to AIM in steps that take
   SOFT of what is missing. */
#define BAND   1e-6
#define AIM    4e-9
#define LOW    1e-9
#define SOFT   0.5
#define GENTLE 1e-4 /* of the size: deeper overlaps, from the start, are undone little by little */
#define NEAR   0.05 /* once no two are closer than that, steps are free again */
#define FAST   1e-9 /* of the speed of a fall by its size: below, a body does not move */
enum { STRIKES = 200, ROUNDS = 8, TRIES = 40 };

static const skf_mover *mover(const skf_swarm *s, size_t i) { return s->bodies + i; }

static skf_vec3 speed(const skf_swarm *s, const double *y, size_t i, skf_vec3 x) {
  skf_attitude a = skf_mover_at(s, y, i);
  return mover(s, i)->free ? v3_add(a.v, v3_cross(a.w, v3_sub(x, a.x))) : v3(0, 0, 0);
}

/* The speed by which the two part at a place. */
static double parting(const skf_swarm *s, const double *y, const skf_bond *b, const skf_spot *at) {
  return v3_dot(v3_sub(speed(s, y, b->b, at->at), speed(s, y, b->a, at->at)), at->normal);
}

/* What rounding hides of a gap. */
static double haze(const skf_swarm *s, const skf_bond *b) {
  const double *p = s->y + b->a * SKF_MOVER_STATE, *q = s->y + b->b * SKF_MOVER_STATE;
  double far = fabs(p[0]) + fabs(p[1]) + fabs(p[2]) + fabs(q[0]) + fabs(q[1]) + fabs(q[2]) + 2 * b->size;
  return 64 * DBL_EPSILON * far;
}
static double low(const skf_swarm *s, const skf_bond *b) { return LOW * b->size + haze(s, b); }
static double aim(const skf_swarm *s, const skf_bond *b) { return AIM * b->size + 4 * haze(s, b); }
static double band(const skf_swarm *s, const skf_bond *b) { return BAND * b->size + 16 * haze(s, b); }

/* Whether the solver keeps them apart there: they touch, and do not hop. Who comes fast has the rest of the way to go.
 */
static bool held(const skf_swarm *s, const skf_bond *b, const skf_spot *at) {
  if (at->lost || at->gap > band(s, b)) return false;
  double out = parting(s, s->y, b, at), hop = skf_swarm_hop(s, s->slope, b->a, b->b);
  return out <= hop && (out >= -hop || at->gap <= 2 * aim(s, b));
}

bool skf_rest_touch(const skf_swarm *s, size_t k, int i) {
  const skf_bond *b = s->here.bond + k;
  const skf_spot *end = s->there.bond[k].spot + i;
  return (i < b->n && held(s, b, b->spot + i)) || (!end->lost && end->gap <= 2 * aim(s, b));
}

/* ---- The impulses at the start ---- */

static skf_status strike_all(skf_swarm *s, skf_status (*told)(void *, const skf_rigid_hit *), void *user) {
  for (int hits = 0; hits < STRIKES; hits++) {
    skf_rigid_hit hit = {.t = s->t};
    double fastest = 1;
    for (size_t k = 0; k < s->here.n; k++) {
      const skf_bond *b = s->here.bond + k;
      double hop = skf_swarm_hop(s, s->slope, b->a, b->b);
      for (int i = 0; i < b->n; i++) {
        double in = -parting(s, s->y, b, b->spot + i);
        if (b->spot[i].gap > 2 * aim(s, b) || !(in > fastest * hop)) continue;
        bool swap = b->a > b->b;
        hit.a = swap ? b->b : b->a, hit.b = swap ? b->a : b->b;
        hit.at = b->spot[i].at, hit.normal = v3_scale(swap ? -1 : 1, b->spot[i].normal);
        fastest = in / hop;
      }
    }
    if (fastest == 1) return SKF_OK;
    skf_status bad = SKF_OK;
    if (!skf_swarm_strike(s, &hit, skf_swarm_hop(s, s->slope, hit.a, hit.b))) return SKF_OK;
    if (told && (bad = told(user, &hit))) return bad;
  }
  return SKF_OK;
}

/* ---- Pressing ---- */

static size_t count_of(const skf_bonds *b) {
  size_t n = 0;
  for (size_t k = 0; k < b->n; k++) n += (size_t)b->bond[k].n;
  return n;
}

/* The places that are held, seen from `at`, which has the same as here; h: the coming step, or 0. */
static size_t gather(const skf_swarm *s, const skf_bonds *at, double h, skf_press *p) {
  size_t n = 0;
  for (size_t k = 0; k < s->here.n; k++)
    for (int i = 0; i < s->here.bond[k].n; i++) {
      const skf_bond *b = s->here.bond + k;
      const skf_spot *here = b->spot + i, *there = at->bond[k].spot + i;
      if (!held(s, b, here)) continue;
      if (there->lost) there = here;
      double room = fmax(0, here->gap - aim(s, b)), step = h > 0 ? h : s->lull;
      p[n++] = (skf_press){.a = b->a,
                           .b = b->b,
                           .at = there->at,
                           .normal = there->normal,
                           .want = -SOFT * room / step,
                           .friction = s->options.friction,
                           .rolling = s->options.rolling,
                           .impulse = v3_scale(h, here->push),
                           .twist = v3_scale(h, here->twist)};
    }
  return n;
}

static void velocities(const skf_swarm *s, const double *y, double *v) {
  for (size_t i = 0; i < s->n; i++)
    for (int k = 0; k < 3; k++)
      v[6 * i + k] = y[i * SKF_MOVER_STATE + 3 + k], v[6 * i + 3 + k] = y[i * SKF_MOVER_STATE + 10 + k];
}

/* Ends what approach is left at the start. */
static skf_status soften(skf_swarm *s) {
  double *v = s->speeds;
  size_t n = gather(s, &s->here, 0, s->press);
  velocities(s, s->y, v);
  skf_status bad = n ? skf_press_solve(s, s->y, s->press, n, v) : SKF_OK;
  for (size_t i = 0; i < s->n && n; i++)
    for (int k = 0; k < 3; k++)
      s->y[i * SKF_MOVER_STATE + 3 + k] = v[6 * i + k], s->y[i * SKF_MOVER_STATE + 10 + k] = v[6 * i + 3 + k];
  return bad;
}

/* The end of a step of length h from that of the free motion, with the geometry of `at`, in the poses of y. */
static skf_status lean(skf_swarm *s, const double *free_end, double h, const skf_bonds *at, const double *y,
                       double *to) {
  double *v = s->speeds;
  size_t n = gather(s, at, h, s->press), next = 0;
  velocities(s, free_end, v);
  skf_status bad = n ? skf_press_solve(s, y, s->press, n, v) : SKF_OK;
  if (bad) return bad;
  for (size_t k = 0; k < s->here.n; k++)
    for (int i = 0; i < s->here.bond[k].n; i++) {
      skf_spot *here = s->here.bond[k].spot + i;
      bool does = held(s, s->here.bond + k, here);
      here->push = does ? v3_scale(1 / h, s->press[next].impulse) : v3(0, 0, 0);
      here->twist = does ? v3_scale(1 / h, s->press[next].twist) : v3(0, 0, 0);
      next += does;
    }
  memmove(to, free_end, s->n * SKF_MOVER_STATE * sizeof *to);
  for (size_t i = 0; i < s->n && n; i++) {
    if (!mover(s, i)->free) continue;
    double *p = to + i * SKF_MOVER_STATE;
    const double *f = free_end + i * SKF_MOVER_STATE;
    skf_vec3 L = v3(v[6 * i + 3] - f[10], v[6 * i + 4] - f[11], v[6 * i + 5] - f[12]);
    for (int k = 0; k < 3; k++) {
      p[k] += 0.5 * h * (v[6 * i + k] - f[3 + k]);
      p[3 + k] = v[6 * i + k], p[10 + k] = v[6 * i + 3 + k];
    }
    skf_attitude a = skf_mover_at(s, free_end, i);
    quat_rotate(p + 6, v3_scale(0.5 * h, skf_mover_spin(mover(s, i), a.q, L)));
  }
  return SKF_OK;
}

/* ---- Touches within the step ---- */

/* The first part of the step after which a gap with the values and rates of its ends has come down to `target`; 1 when
   it does not get below `floor`. */
static double descent(double g0, double g1, double r0, double r1, double floor, double target) {
  enum { SAMPLES = 16 };
  double before = g0, c2 = 3 * (g1 - g0) - 2 * r0 - r1, c3 = 2 * (g0 - g1) + r0 + r1;
  for (int i = 1; i <= SAMPLES; i++) {
    double u = (double)i / SAMPLES, g = i < SAMPLES ? g0 + u * (r0 + u * (c2 + u * c3)) : g1;
    if (before >= floor && g < floor) {
      double a = u - 1.0 / SAMPLES, b = u;
      for (int k = 0; k < 50; k++) {
        double m = 0.5 * (a + b);
        if (g0 + m * (r0 + m * (c2 + m * c3)) > target)
          a = m;
        else
          b = m;
      }
      return a;
    }
    before = g;
  }
  return 1;
}

/* The part of the step that is free of other touches than those at its start. */
static double undisturbed(const skf_swarm *s, const double *to, double h) {
  double part = 1;
  for (size_t k = 0; k < s->here.n; k++)
    for (int i = 0; i < s->here.bond[k].n; i++) {
      const skf_bond *b = s->here.bond + k, *c = s->there.bond + k;
      const skf_spot *here = b->spot + i, *there = c->spot + i;
      if (there->lost || held(s, b, here)) continue;
      double r0 = h * parting(s, s->y, b, here), r1 = h * parting(s, to, c, there);
      part = fmin(part, descent(here->gap, there->gap, r0, r1, low(s, b), aim(s, b)));
    }
  return part;
}

/* ---- What is left ---- */

/* Displacements after which no gap is below its least. */
static skf_status separate(skf_swarm *s, double *to) {
  for (int round = 0; round < ROUNDS; round++) {
    size_t n = 0;
    bool fine = true;
    for (size_t k = 0; k < s->there.n; k++)
      for (int i = 0; i < s->there.bond[k].n; i++) {
        const skf_bond *b = s->there.bond + k;
        const skf_spot *at = b->spot + i;
        if (at->lost || at->gap > 100 * band(s, b)) continue;
        if (at->gap < low(s, b) && (round == 0 || at->gap > -GENTLE * b->size)) fine = false;
        double want = at->gap < low(s, b) ? fmin(aim(s, b) - at->gap, GENTLE * b->size) : low(s, b) - at->gap;
        s->press[n++] = (skf_press){.a = b->a, .b = b->b, .at = at->at, .normal = at->normal, .want = want};
      }
    if (fine) return SKF_OK;
    double *v = s->speeds;
    memset(v, 0, 6 * s->n * sizeof *v);
    skf_status bad = skf_press_solve(s, to, s->press, n, v);
    if (bad) return bad;
    for (size_t i = 0; i < s->n; i++) {
      if (!mover(s, i)->free) continue;
      double *p = to + i * SKF_MOVER_STATE;
      skf_attitude a = skf_mover_at(s, to, i);
      for (int k = 0; k < 3; k++) p[k] += v[6 * i + k];
      quat_rotate(p + 6, skf_mover_spin(mover(s, i), a.q, v3(v[6 * i + 3], v[6 * i + 4], v[6 * i + 5])));
    }
    if (!skf_bonds_room(&s->spare, s->there.n)) return SKF_ERR_NOMEM;
    skf_bonds_follow(s, &s->there, -1, to, &s->spare);
    skf_bonds corrected = s->spare;
    s->spare = s->there, s->there = corrected;
  }
  return SKF_OK;
}

/* Counts the steps in which nothing has moved, and notes whether bodies still are near each other. */
static void judge(skf_swarm *s) {
  bool still = true, near = false;
  for (size_t i = 0; i < s->n; i++) {
    if (!mover(s, i)->free) continue;
    const double *d = s->slope + i * SKF_MOVER_STATE + 3;
    skf_attitude a = skf_mover_at(s, s->y, i);
    double size = mover(s, i)->hull->radius, fall = sqrt(v3_norm(v3(d[0], d[1], d[2])) * size);
    still = still && v3_norm(a.v) + size * v3_norm(a.w) < FAST * fall;
  }
  for (size_t k = 0; k < s->here.n; k++)
    for (int i = 0; i < s->here.bond[k].n; i++)
      near = near || s->here.bond[k].spot[i].gap < NEAR * s->here.bond[k].size;
  s->still = still ? s->still + 1 : 0;
  for (size_t i = 0; i < s->n && skf_swarm_is_still(s); i++)
    for (int k = 0; k < 3; k++) s->y[i * SKF_MOVER_STATE + 3 + k] = s->y[i * SKF_MOVER_STATE + 10 + k] = 0;
  s->leaning = near;
  if (!near) skf_bonds_clear(&s->here);
}

static skf_status room(skf_swarm *s) {
  if (!skf_bonds_room(&s->there, s->here.n)) return SKF_ERR_NOMEM;
  size_t n = count_of(&s->here);
  if (n <= s->presses) return SKF_OK;
  skf_press *more = skf_realloc(s->press, 2 * n, sizeof *more);
  if (!more) return SKF_ERR_NOMEM;
  s->press = more, s->presses = 2 * n;
  return SKF_OK;
}

/* Up to where something else touches; *h is what was taken. */
static skf_status advance(skf_swarm *s, double *h, double *to) {
  double *ideal = s->ideal;
  for (int tries = 1;; tries++) {
    skf_status bad = skf_swarm_extrapolate(s, *h, ideal, h);
    if (!bad) bad = lean(s, ideal, *h, &s->here, s->y, to);
    if (bad) return bad;
    bool clear = skf_bonds_follow(s, &s->here, *h, to, &s->there);
    if (clear) {
      bad = lean(s, ideal, *h, &s->there, to, to);
      if (bad) return bad;
      clear = skf_bonds_follow(s, &s->here, *h, to, &s->there);
    }
    double part = clear ? undisturbed(s, to, *h) : 0.5, least = INFINITY;
    if (part == 1) bad = skf_bonds_check(s, to, &s->there, &least);
    if (bad) return bad;
    if (least < LOW) part = 0.5; /* it came into being within the step */
    if (part == 1 || tries == TRIES || *h * part < 64 * DBL_EPSILON * fabs(s->t)) return SKF_OK;
    *h *= part;
  }
}

skf_status skf_rest_step(skf_swarm *s, double most, skf_status (*told)(void *, const skf_rigid_hit *), void *user) {
  double *to = s->y + s->n * SKF_MOVER_STATE;
  if (!skf_swarm_slope(s, s->y, s->slope)) return SKF_ERR_CONVERGENCE;
  double h = fmin(most, STEP * skf_swarm_pace(s, s->slope));
  s->lull = h;
  skf_status bad = skf_bonds_make(s, s->slope, h);
  if (!bad) bad = room(s);
  if (!bad) bad = strike_all(s, told, user);
  if (!bad) bad = soften(s);
  if (!bad) bad = advance(s, &h, to);
  double start = skf_swarm_energy(s, s->y), before = bad ? 0 : skf_swarm_energy(s, to);
  if (!bad) bad = separate(s, to);
  if (bad) return bad;
  skf_rest_group(s);
  skf_rest_keep(s, s->ideal, start + fmax(0, skf_swarm_energy(s, to) - before), to);
  memcpy(s->y, to, s->n * SKF_MOVER_STATE * sizeof *to);
  skf_bonds_tidy(&s->there);
  skf_bonds last = s->here;
  s->here = s->there, s->there = last;
  s->t += h;
  judge(s);
  return SKF_OK;
}
