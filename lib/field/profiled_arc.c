/* SPDX-License-Identifier: MIT */
/* Sums over the arc in the cylindrical frame of x, see arc_frame.h: x - q has the parts (k - rho) cos^2 chi + (k + rho)
   sin^2 chi outward, -2 rho sin chi cos chi around, z upward. */
#include "field/profiled.h"
#include "field/support.h"
#include "field/weight.h"
#include "num/gauss.h"

/* A part of a piece within a quarter turn of chi, folded into 0 <= lo <= chi <= hi <= pi / 2. */
typedef struct stretch {
  double lo, hi, length;
  double u, v;   /* parts of the piece before and after it */
  double gap;    /* compact: chi of the rim minus hi */
  double around; /* sign of sin chi cos chi */
  bool up;       /* chi grows along the arc */
} stretch;

typedef struct job {
  const skf_prepared *e;
  const skf_kernel_ops *row;
  const skf_weight *weight;
  const skf_weight_piece *piece;
  const skf_arc_frame *f;
  const skf_arc_clip *clip; /* NULL: not compact */
  double scale;             /* 1 / half the turn of the piece */
  int order;
  stretch s;
  skf_arc_terms *t;
} job;

static void add_node(void *context, double chi, double u, double v, double dchi) {
  const job *j = context;
  const stretch *s = &j->s;
  const skf_arc_frame *f = j->f;
  double c = cos(chi), sn = sin(chi), cc = c * c, ss = sn * sn, z = f->z, d[4], q = 0;
  double before = (s->up ? u : v) * s->length * j->scale, after = (s->up ? v : u) * s->length * j->scale;
  double p = 2 * f->rho * dchi * skf_weight_at(j->weight, j->piece, s->u + before, s->v + after);
  if (j->clip) q = skf_arc_power(f, j->clip, chi, c, s->gap, v * s->length);
  skf_profiled_law(j->row, j->e->kernel.param, f->alpha * cc + f->beta * ss, q, d);
  double out = f->inner * cc + f->outer * ss, around = -2 * f->rho * s->around * sn * c;
  double g = 2 * p * d[1], k = 4 * p * d[2];
  skf_arc_terms *t = j->t;
  t->F += p * d[0];
  t->k += g * out, t->p += g * around, t->z += g * z;
  if (j->order < 2) return;
  t->kk += g + k * out * out, t->pp += g + k * around * around, t->zz += g + k * z * z;
  t->kp += k * out * around, t->kz += k * out * z, t->pz += k * around * z;
}

static void plain(job *j, int n) { skf_march_plain(&(skf_march){add_node, j}, j->s.lo, j->s.length, n); }

/* The part of the stretch from x to `next`. */
static void part(job *j, double x, double next, int n) {
  stretch whole = j->s;
  double before = x - whole.lo, length = next < whole.hi ? next - x : whole.length - before;
  double after = whole.length - before - length, u = (whole.up ? before : after) * j->scale;
  if (!(next > x)) return;
  j->s.lo = x, j->s.hi = next, j->s.gap += after;
  j->s.length = length; /* together as long as the whole, which is known better than its ends */
  j->s.u += u, j->s.v += (whole.up ? after : before) * j->scale;
  plain(j, n);
  j->s = whole;
}

/* r^2 = alpha + spread sin^2 chi vanishes at sin chi = +-i sqrt(alpha / spread). */
static void powers(job *j) {
  const skf_arc_frame *f = j->f;
  double near2 = f->alpha, s = j->e->kernel.param;
  if (j->e->kernel.type == SKF_CAUCHY) near2 += 1 / (s * s);
  double delta = near2 < 1e6 * f->spread ? asinh(sqrt(near2 / f->spread)) : 10;
  delta = fmax(fmax(delta, 1e-3 * j->s.lo), 1e-140);
  skf_march_graded(&(skf_march){add_node, j}, j->s.lo, j->s.hi, j->s.length, delta);
}

/* Nodes for exp(-range sin^2) and a profile over at most a quarter turn, without what the Hessian asks for. */
static int nodes(double range) {
  return range <= 0.3 ? 14 : range <= 1 ? 16 : range <= 4 ? 18 : range <= 10 ? 22 : range <= 20 ? 26 : SKF_GAUSS_MAX;
}

/* exp(-B sin^2 chi) as far as it matters, until the exponent has grown by 42; for the Hessian by panels over which it
   grows by 8 */
static void gaussian(job *j) {
  double B = j->e->kernel.param * j->e->kernel.param * j->f->spread, x = j->s.lo, hi = j->s.hi;
  double low = sin(x) * sin(x), from = low, range = B * sin(j->s.length) * sin(hi + x);
  double step = j->order < 2 ? 42 : 8;
  if (range <= step) {
    plain(j, j->order < 2 ? nodes(range) : 20);
    return;
  }
  while (x < hi && B * (from - low) < 42) {
    double level = from + step / B, next = level < 1 ? fmin(hi, asin(sqrt(level))) : hi;
    if (!(next > x)) break;
    part(j, x, next, j->order < 2 ? SKF_GAUSS_MAX : 20);
    x = next, from = level;
  }
}

static void compact(job *j) {
  const skf_arc_frame *f = j->f;
  double R = j->e->kernel.param, s = R / 3;
  if (j->clip->cut && j->s.lo >= j->clip->chi) return;
  if (j->clip->cut) {
    double lost = fmax(0, j->s.hi - j->clip->chi);
    j->s.gap = fmax(0, j->clip->chi - j->s.hi);
    if (lost > 0) {
      j->s.hi = j->clip->chi, j->s.length = j->s.hi - j->s.lo;
      *(j->s.up ? &j->s.v : &j->s.u) += lost * j->scale;
    }
  }
  if (j->e->kernel.type != SKF_METABALL) {
    plain(j, 20);
    return;
  }
  double core = f->da >= s   ? -1
                : f->db <= s ? 4
                             : atan2(sqrt((s - f->da) * (s + f->da)), sqrt((f->db - s) * (f->db + s)));
  core = fmin(fmax(core, j->s.lo), j->s.hi);
  part(j, j->s.lo, core, 20);
  part(j, core, j->s.hi, 32); /* r has branch points where the rule's error is 1.98^-64 at worst */
}

static void go(job *j) {
  if (j->clip)
    compact(j);
  else if (j->e->kernel.type == SKF_GAUSSIAN)
    gaussian(j);
  else
    powers(j);
}

/* The piece in each quarter turn of the angle c, which is chi, or chi -+ pi / 2 when the arc is seen from behind. */
static void add_piece(job *j, double a0, double a1, double half) {
  const skf_weight_piece *p = j->piece;
  const double q = SKF_PI / 2;
  double ca = p->a > 0 ? a0 + p->a * half : a0, cb = p->b < 1 ? a0 + p->b * half : a1, length = (p->b - p->a) * half;
  j->scale = 1 / length;
  for (int m = -1; m < 3; m++) {
    double lo = fmax(ca, m * q), hi = fmin(cb, (m + 1) * q), base = m > 0 ? SKF_PI : 0;
    if (!(lo < hi)) continue;
    bool up = !(m & 1), behind = j->f->behind;
    double x = up ? lo - base : base - hi, y = up ? hi - base : base - lo;
    j->s = (stretch){.lo = fmax(0, behind ? q - y : x),
                     .hi = fmin(q, behind ? q - x : y),
                     .length = lo == ca && hi == cb ? length : hi - lo,
                     .u = (lo - ca) / length,
                     .v = (cb - hi) / length,
                     .around = up != behind ? 1 : -1,
                     .up = up != behind};
    go(j);
  }
}

/* The sum of the weights at the nearest point of the circle, where x is on the arc. */
static double weight_here(const skf_prepared *e, const skf_arc_frame *f, double a0, double a1) {
  const double at[2] = {f->behind ? SKF_PI / 2 : 0, f->behind ? -SKF_PI / 2 : SKF_PI};
  double sum = 0;
  for (int i = 0; i < 2; i++)
    if (a0 <= at[i] && at[i] <= a1) sum += skf_profile_at(&e->weight->profile, (at[i] - a0) / (a1 - a0));
  return sum;
}

void skf_profiled_arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_clip c;
  skf_arc_terms t = {.F = 0};
  skf_arc_place(e, x, &f);
  const skf_arc_plan *plan = &e->plan.arc;
  if (f.full) f.behind = false; /* the frame leaves it */
  double a0 = f.full ? -0.5 * atan2(f.uy, f.ux) : f.a0, a1 = f.full ? a0 + SKF_PI : f.a1;
  job j = {.e = e, .row = skf_kernel_row(e->kernel.type), .weight = e->weight, .f = &f, .order = order, .t = &t};
  bool touched = j.row->info.singular && f.alpha == 0;
  if (touched) {
    double w = weight_here(e, &f, a0, a1);
    if (w != 0) {
      v->F = copysign(INFINITY, w);
      return;
    }
  }
  if (j.row->info.compact) {
    if (!skf_arc_support(&f, e->kernel.param, &c)) return;
    j.clip = &c;
  }
  for (size_t i = 0; i < e->weight->n; i++) {
    j.piece = e->weight->piece + i;
    add_piece(&j, a0, a1, plan->half);
  }
  skf_arc_result(&f, &t, order, v);
  if (touched) *v = (skf_value){.F = v->F}; /* at a zero of the weight */
}
