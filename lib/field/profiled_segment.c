/* SPDX-License-Identifier: MIT */
/* F = int p(t) h dt over the abscissae t of q - x; with x - q = w - t a, g = h'/r, k = g'/r:
     grad F = w int p g dt - a int p g t dt
     Hess F = int p g dt I + w w^T int p k dt - (a w^T + w a^T) int p k t dt + a a^T int p k t^2 dt. */
#include "field/profiled.h"
#include "field/support.h"
#include "field/weight.h"

typedef struct sums {
  double h, g0, g1, k0, k1, k2;
} sums;

/* A stretch lo <= t <= hi of a piece. */
typedef struct stretch {
  double lo, hi, length;
  double u, v;           /* parts of the piece before lo and after hi */
  double gap_lo, gap_hi; /* compact: T + lo, T - hi, where R^2 - r^2 = (T - t)(T + t) */
} stretch;

typedef struct job {
  const skf_prepared *e;
  const skf_kernel_ops *row;
  const skf_weight *weight;
  const skf_weight_piece *piece;
  const skf_segment_frame *f;
  double scale; /* 1 / length of the piece */
  stretch s;
  double sign; /* -1: x = -t */
  sums *sum;
} job;

static void add_node(void *context, double x, double u, double v, double dx) {
  const job *j = context;
  const stretch *s = &j->s;
  double t = j->sign * x, before = (j->sign > 0 ? u : v) * s->length, after = (j->sign > 0 ? v : u) * s->length, d[4];
  double q = (s->gap_hi + after) * (s->gap_lo + before);
  double p = dx * skf_weight_at(j->weight, j->piece, s->u + before * j->scale, s->v + after * j->scale);
  skf_profiled_law(j->row, j->e->kernel.param, j->f->h2 + t * t, q, d);
  double g = 2 * p * d[1], k = 4 * p * d[2];
  j->sum->h += p * d[0];
  j->sum->g0 += g, j->sum->g1 += g * t;
  j->sum->k0 += k, j->sum->k1 += k * t, j->sum->k2 += k * t * t;
}

static void plain(job *j, int n) {
  j->sign = 1;
  skf_march_plain(&(skf_march){add_node, j}, j->s.lo, j->s.length, n);
}

/* Both parts of a stretch that is cut `left` after its start. */
static void cut(const stretch *s, double at, double left, double right, double scale, stretch *a, stretch *b) {
  *a = (stretch){s->lo, at, left, s->u, s->v + right * scale, s->gap_lo, s->gap_hi + right};
  *b = (stretch){at, s->hi, right, s->u + left * scale, s->v, s->gap_lo + left, s->gap_hi};
}

typedef void (*one_sided)(job *j, double lo, double hi);

/* Calls `go` for one or both sides of the foot. */
static void from_foot(job *j, one_sided go) {
  stretch whole = j->s, a, b;
  if (whole.lo < 0 && whole.hi > 0) {
    /* abscissae may be rounded to the distance, lengths are not */
    double before = -whole.lo < whole.hi ? -whole.lo : whole.length - whole.hi;
    cut(&whole, 0, before, -whole.lo < whole.hi ? whole.length - before : whole.hi, j->scale, &a, &b);
    j->s = a, j->sign = -1;
    go(j, 0, a.length);
    j->s = b, j->sign = 1;
    go(j, 0, b.length);
  } else {
    j->sign = whole.lo < 0 ? -1 : 1;
    go(j, fmin(fabs(whole.lo), fabs(whole.hi)), fmax(fabs(whole.lo), fabs(whole.hi)));
  }
}

/* Powers of h^2 + t^2, with the width added where the kernel has one. */
static double delta_of(const job *j, double lo) {
  double h = j->f->h;
  if (j->e->kernel.type == SKF_CAUCHY) h = hypot(h, 1 / j->e->kernel.param);
  return fmax(fmax(h, 1e-3 * lo), 1e-140 * j->f->L);
}

static void graded(job *j, double lo, double hi) {
  skf_march_graded(&(skf_march){add_node, j}, lo, hi, j->s.length, delta_of(j, lo));
}

static void powers(job *j) {
  if (j->s.length <= delta_of(j, 0))
    plain(j, 16);
  else
    from_foot(j, graded);
}

/* exp(-a^2 t^2): by panels over which the exponent grows by 8, as far as it matters */
static void falling(job *j, double lo, double hi) {
  double a2 = j->e->kernel.param * j->e->kernel.param, x = lo, length = j->s.length;
  if (a2 * length * (hi + lo) <= 8) {
    skf_march_plain(&(skf_march){add_node, j}, lo, length, 20);
    return;
  }
  stretch whole = j->s;
  while (x < hi && a2 * (x - lo) * (x + lo) < 42) {
    double next = fmin(hi, sqrt(x * x + 8 / a2)), before = x - lo, after = hi - next;
    if (!(next > x)) break;
    bool up = j->sign > 0;
    double lost_lo = up ? before : after, lost_hi = up ? after : before;
    j->s = (stretch){whole.lo + lost_lo,
                     whole.hi - lost_hi,
                     next - x,
                     whole.u + lost_lo * j->scale,
                     whole.v + lost_hi * j->scale,
                     0,
                     0};
    skf_march_plain(&(skf_march){add_node, j}, x, next - x, 20);
    x = next;
  }
}

static void gaussian(job *j) {
  double a = j->e->kernel.param, half = 0.5 * j->s.length;
  if (a * a * half * (half + fabs(j->s.lo + half)) <= 2)
    plain(j, 20);
  else
    from_foot(j, falling);
}

/* The metaball's shell, R/3 < r < R, on one side of the foot: the branch points of r are no nearer than R/3 beside an
   end, which leaves 2.4^-48. */
static void shell(job *j, double lo, double hi) {
  (void)hi;
  skf_march_plain(&(skf_march){add_node, j}, lo, j->s.length, 24);
}

static void compact(job *j) {
  int exact = j->weight->sine ? 16 : 6; /* nodes for polynomials of degree 11 */
  double R = j->e->kernel.param, h = j->f->h, T3 = h < R / 3 ? sqrt((R / 3 - h) * (R / 3 + h)) : 0;
  stretch left, core = j->s, right;
  if (j->e->kernel.type != SKF_METABALL) {
    plain(j, exact);
    return;
  }
  if (!(T3 > 0) || core.lo >= T3 || core.hi <= -T3) {
    from_foot(j, shell);
    return;
  }
  if (core.hi > T3) {
    double out = fmin(core.length, core.hi - T3);
    cut(&core, T3, core.length - out, out, j->scale, &left, &right);
    core = left, j->s = right;
    from_foot(j, shell);
  }
  if (core.lo < -T3) {
    double out = fmin(core.length, -T3 - core.lo);
    cut(&core, -T3, out, core.length - out, j->scale, &left, &right);
    core = right, j->s = left;
    from_foot(j, shell);
  }
  j->s = core;
  plain(j, exact);
}

/* The piece from its nearer end, as a stretch; false where all of it is beyond a finite support. */
static bool place(job *j, const skf_segment_clip *c) {
  const skf_segment_frame *f = j->f;
  const skf_weight_piece *p = j->piece;
  double past = p->a * f->L, rest = (1 - p->b) * f->L, length = (p->b - p->a) * f->L;
  j->s = (stretch){f->t0 + past, f->t1 - rest, length, 0, 0, 0, 0};
  j->scale = 1 / length;
  if (!c) return true;
  /* lengths, none by a difference of abscissae: out of the support at both ends of the segment and of the piece; in it
     before and after the piece */
  double out0 = c->q0 > 0 ? 0 : -c->q0 / (c->T - f->t0), out1 = c->q1 > 0 ? 0 : -c->q1 / (c->T + f->t1);
  double before = fmax(0, out0 - past), after = fmax(0, out1 - rest);
  double in0 = fmax(0, past - out0), in1 = fmax(0, rest - out1);
  if (before > 0) j->s.lo = c->lo;
  if (after > 0) j->s.hi = c->hi;
  if (before > 0 || after > 0) j->s.length = c->length - in0 - in1;
  j->s.u = before / length, j->s.v = after / length;
  j->s.gap_lo = c->gap_lo + in0, j->s.gap_hi = c->gap_hi + in1;
  return j->s.length > 0;
}

static void result(const skf_segment_frame *f, const sums *s, int order, skf_value *v) {
  skf_vec3 a = f->a, w = f->w;
  v->F = s->h;
  v->g = v3_mad(v3_scale(s->g0, w), -s->g1, a);
  if (order < 2) return;
  v->h[0] = s->g0 + s->k0 * w.x * w.x - 2 * s->k1 * a.x * w.x + s->k2 * a.x * a.x;
  v->h[1] = s->k0 * w.x * w.y - s->k1 * (a.x * w.y + a.y * w.x) + s->k2 * a.x * a.y;
  v->h[2] = s->k0 * w.x * w.z - s->k1 * (a.x * w.z + a.z * w.x) + s->k2 * a.x * a.z;
  v->h[3] = s->g0 + s->k0 * w.y * w.y - 2 * s->k1 * a.y * w.y + s->k2 * a.y * a.y;
  v->h[4] = s->k0 * w.y * w.z - s->k1 * (a.y * w.z + a.z * w.y) + s->k2 * a.y * a.z;
  v->h[5] = s->g0 + s->k0 * w.z * w.z - 2 * s->k1 * a.z * w.z + s->k2 * a.z * a.z;
}

void skf_profiled_segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_clip c;
  sums sum = {0, 0, 0, 0, 0, 0};
  skf_segment_place(e, x, &f);
  job j = {.e = e, .row = skf_kernel_row(e->kernel.type), .weight = e->weight, .f = &f, .sum = &sum};
  bool limited = j.row->info.compact, touched = j.row->info.singular && f.h == 0 && f.t0 <= 0 && f.t1 >= 0;
  double here = touched ? skf_profile_at(&e->weight->profile, -f.t0 / f.L) : 0;
  if (here != 0) {
    v->F = copysign(INFINITY, here);
    return;
  }
  if (limited && !skf_segment_support(&f, e->kernel.param, &c)) return;
  for (size_t i = 0; i < e->weight->n; i++) {
    j.piece = e->weight->piece + i;
    if (!place(&j, limited ? &c : NULL)) continue;
    (limited ? compact : e->kernel.type == SKF_GAUSSIAN ? gaussian : powers)(&j);
  }
  result(&f, &sum, order, v);
  if (touched) *v = (skf_value){.F = v->F}; /* at a zero of the weight */
}
