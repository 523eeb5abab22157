/* SPDX-License-Identifier: MIT */
#include "field/weight.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include "num/span.h"
#include <stdint.h>
#include <string.h>

static const char *wrong_knots(const skf_profile *p) {
  const skf_profile_knot *k = p->knots;
  bool zero = true;
  if (!k || p->knot_count < 2) return "less than two knots in a profile, expected two or more";
  for (size_t i = 0; i < p->knot_count; i++) {
    if (!isfinite(k[i].t) || !isfinite(k[i].value) || !isfinite(k[i].slope))
      return "a knot that is not finite in a profile, expected finite numbers";
    if (i && !(k[i].t > k[i - 1].t)) return "knots of a profile out of order, expected ascending t";
    if (k[i].value != 0 || k[i].slope != 0) zero = false;
  }
  if (k[0].t != 0 || k[p->knot_count - 1].t != 1)
    return "knots that do not go from 0 to 1, expected t = 0 first and t = 1 last";
  return zero ? "a profile that is zero everywhere, expected another one" : NULL;
}

skf_status skf_profile_check(const skf_profile *p, const char **why) {
  const char *wrong = NULL;
  skf_status s = SKF_ERR_RANGE;
  if ((unsigned)p->type >= SKF_PROFILE_COUNT)
    s = SKF_ERR_ARG, wrong = "an unknown profile, expected linear, hat, sine or cubic";
  else if (!(p->from == 0 && p->to == 0) && !(p->from >= 0 && p->from < p->to && p->to <= 1))
    wrong = "a part of a profile that is none, expected 0 <= from < to <= 1";
  else if (p->type == SKF_PROFILE_LINEAR && !(isfinite(p->ends[0]) && isfinite(p->ends[1])))
    wrong = "a weight that is not finite, expected finite numbers";
  else if (p->type == SKF_PROFILE_LINEAR && p->ends[0] == 0 && p->ends[1] == 0)
    wrong = "a profile that is zero everywhere, expected another one";
  else if (p->type == SKF_PROFILE_CUBIC)
    wrong = wrong_knots(p);
  if (why) *why = wrong;
  return wrong ? s : SKF_OK;
}

/* The profile between t0 and t1 as a cubic. */
static void hermite(skf_profile_knot p, skf_profile_knot q, double c[4]) {
  double h = (q.t - p.t) / 3;
  c[0] = p.value, c[1] = p.value + h * p.slope, c[2] = q.value - h * q.slope, c[3] = q.value;
}

static double bernstein(const double c[4], double u, double v) {
  return v * v * (v * c[0] + 3 * u * c[1]) + u * u * (3 * v * c[2] + u * c[3]);
}

static skf_profile_knot knot_at(skf_profile_knot p, skf_profile_knot q, double t) {
  double c[4], h = q.t - p.t, u = (t - p.t) / h, v = (q.t - t) / h;
  if (t <= p.t) return p;
  if (t >= q.t) return q;
  hermite(p, q, c);
  double slope = 3 / h * (v * v * (c[1] - c[0]) + 2 * u * v * (c[2] - c[1]) + u * u * (c[3] - c[2]));
  return (skf_profile_knot){t, bernstein(c, u, v), slope};
}

/* The i-th stretch of a profile, by the knots at its ends. */
static void stretch(const skf_profile *p, size_t i, skf_profile_knot *a, skf_profile_knot *b) {
  if (p->type == SKF_PROFILE_CUBIC) {
    *a = p->knots[i], *b = p->knots[i + 1];
  } else if (p->type == SKF_PROFILE_HAT) {
    *a = i ? (skf_profile_knot){0.5, 1, -2} : (skf_profile_knot){0, 0, 2};
    *b = i ? (skf_profile_knot){1, 0, -2} : (skf_profile_knot){0.5, 1, 2};
  } else {
    double slope = p->ends[1] - p->ends[0];
    *a = (skf_profile_knot){0, p->ends[0], slope}, *b = (skf_profile_knot){1, p->ends[1], slope};
  }
}

static size_t stretches(const skf_profile *p) {
  return p->type == SKF_PROFILE_CUBIC ? p->knot_count - 1 : p->type == SKF_PROFILE_HAT ? 2 : 1;
}

static double end_of(const skf_profile *p) { return p->to > 0 ? p->to : 1; }

/* The piece that the i-th stretch leaves to the primitive; false when none. */
static bool piece_of(const skf_profile *p, size_t i, skf_weight_piece *out) {
  skf_profile_knot a, b;
  double from = p->from, to = end_of(p), whole = to - from;
  stretch(p, i, &a, &b);
  if (!(a.t < to && b.t > from)) return false;
  skf_profile_knot c = knot_at(a, b, from), d = knot_at(a, b, to);
  out->a = a.t <= from ? 0 : (c.t - from) / whole;
  out->b = b.t >= to ? 1 : (d.t - from) / whole;
  hermite(c, d, out->c);
  return true;
}

skf_status skf_weight_new(const skf_profile *p, skf_weight **out) {
  bool sine = p->type == SKF_PROFILE_SINE;
  size_t most = sine ? 1 : stretches(p), knots = p->type == SKF_PROFILE_CUBIC ? p->knot_count : 0;
  skf_weight *w = *out = skf_alloc(1, sizeof *w + most * sizeof(skf_weight_piece) + knots * sizeof(skf_profile_knot));
  if (!w) return SKF_ERR_NOMEM;
  w->piece = (skf_weight_piece *)(w + 1);
  skf_profile_knot *copy = (skf_profile_knot *)(w->piece + most);
  if (knots) memcpy(copy, p->knots, knots * sizeof *copy);
  w->profile = *p;
  w->profile.knots = knots ? copy : NULL;
  w->sine = sine, w->from = p->from, w->to = end_of(p);
  if (sine) w->piece[w->n++] = (skf_weight_piece){.a = 0, .b = 1};
  for (size_t i = 0; i < most && !sine; i++)
    if (piece_of(p, i, w->piece + w->n)) w->n++;
  return SKF_OK;
}

void skf_weight_free(const skf_weight *w) { skf_free((void *)(uintptr_t)w); }

/* sin^2 pi t at a part u of [from, to] */
static double sine_at(double from, double to, double u, double v) {
  double t = u < v ? from + (to - from) * u : (1 - to) + (to - from) * v, s = sin(SKF_PI * t);
  return s * s;
}

double skf_weight_at(const skf_weight *w, const skf_weight_piece *p, double u, double v) {
  return w->sine ? sine_at(w->from, w->to, u, v) : bernstein(p->c, u, v);
}

double skf_profile_at(const skf_profile *p, double u) {
  if (p->type == SKF_PROFILE_SINE) return sine_at(p->from, end_of(p), u, 1 - u);
  size_t n = stretches(p);
  skf_weight_piece piece;
  for (size_t i = 0; i < n; i++)
    if (piece_of(p, i, &piece) && (u <= piece.b || piece.b >= 1)) {
      double width = piece.b - piece.a;
      return bernstein(piece.c, (u - piece.a) / width, (piece.b - u) / width);
    }
  return 0;
}

static double mean_of(const skf_profile *p) {
  double sum = 0;
  if (p->type == SKF_PROFILE_SINE) {
    double d = SKF_PI * (end_of(p) - p->from), s = sine_at(p->from, end_of(p), 0.5, 0.5);
    return s * sin(d) / d + 0.5 * skf_sine_gap3(d) / d;
  }
  for (size_t i = 0, n = stretches(p); i < n; i++) {
    skf_weight_piece piece;
    if (piece_of(p, i, &piece)) sum += 0.25 * (piece.b - piece.a) * (piece.c[0] + piece.c[1] + piece.c[2] + piece.c[3]);
  }
  return sum;
}

double skf_element_measure(const skf_element *e) {
  double mu = skf_primitive_measure(&e->primitive);
  return e->profile ? mu * mean_of(e->profile) : mu;
}

static void include(skf_weight_range *r, double x) { r->lo = fmin(r->lo, x), r->hi = fmax(r->hi, x); }

/* Extremes of one cubic: its ends and where its slope vanishes. */
static void include_piece(skf_weight_range *r, const double c[4]) {
  double d0 = c[1] - c[0], d1 = c[2] - c[1], d2 = c[3] - c[2]; /* a u^2 - 2 b u + d0 = 0 */
  double a = d0 - 2 * d1 + d2, b = d0 - d1, q = b * b - a * d0;
  double size = fmax(fmax(fabs(c[0]), fabs(c[1])), fmax(fabs(c[2]), fabs(c[3])));
  skf_weight_range mine = {fmin(c[0], c[3]), fmax(c[0], c[3])};
  if (q >= 0) {
    double s = b + copysign(sqrt(q), b), u[2] = {s / a, d0 / s};
    for (int i = 0; i < 2; i++)
      if (u[i] > 0 && u[i] < 1) include(&mine, bernstein(c, u[i], 1 - u[i]));
  }
  bool plus = fmin(fmin(c[0], c[1]), fmin(c[2], c[3])) >= 0, minus = fmax(fmax(c[0], c[1]), fmax(c[2], c[3])) <= 0;
  mine.lo -= 1e-14 * size, mine.hi += 1e-14 * size; /* rounding; it cannot change the sign of all coefficients */
  include(r, plus ? fmax(mine.lo, 0) : mine.lo);
  include(r, minus ? fmin(mine.hi, 0) : mine.hi);
}

static skf_weight_range range_of(const skf_profile *p) {
  skf_weight_range r = {INFINITY, -INFINITY};
  if (p->type == SKF_PROFILE_SINE) {
    include(&r, sine_at(p->from, end_of(p), 0, 1) * (1 - 1e-14));
    include(&r, sine_at(p->from, end_of(p), 1, 0) * (1 - 1e-14));
    r.hi = fmax(p->from <= 0.5 && end_of(p) >= 0.5 ? 1 : 0, r.hi * (1 + 1e-13));
    if (p->from == 0 || end_of(p) == 1) r.lo = 0;
    return r;
  }
  for (size_t i = 0, n = stretches(p); i < n; i++) {
    skf_weight_piece piece;
    if (piece_of(p, i, &piece)) include_piece(&r, piece.c);
  }
  return r;
}

skf_weight_range skf_element_weights(const skf_element *e) {
  skf_weight_range r = e->profile ? range_of(e->profile) : (skf_weight_range){1, 1};
  double w = e->strength;
  return w < 0 ? (skf_weight_range){w * r.hi, w * r.lo} : (skf_weight_range){w * r.lo, w * r.hi};
}
