/* SPDX-License-Identifier: MIT */
#include "ray/blob.h"
#include <float.h>

skf_blob skf_blob_of(const skf_element *e) {
  double R = e->kernel.param, c3 = 0, length = 0;
  bool quartic = e->kernel.type == SKF_QUARTIC, soft = e->kernel.type == SKF_SOFT_OBJECT;
  skf_vec3 at = e->primitive.point.at, axis = {0, 0, 0};
  skf_blob b = {.per = 0};
  if ((!quartic && !soft) || e->profile) return b;
  if (e->primitive.shape == SKF_SEGMENT) {
    skf_segment s = e->primitive.segment;
    at = s.from, axis = v3_unit(v3_sub(s.to, s.from)), length = v3_dist(s.from, s.to);
    if (!(length > 1e-8 * R && length < 1e8 * R)) return b;
  } else if (e->primitive.shape != SKF_POINT) {
    return b;
  }
  if (!(R > 1e-100 && R < 1e100 && e->strength > 1e-100 && e->strength < 1e100)) return b;
  if (soft) c3 = 4. / 9;
  return (skf_blob){at,   1 / (R * R), e->strength, 1 - c3, c3,         R,
                    axis, length,      0.5 * R * R, 1 / R,  length / R, e->strength * R};
}

/* A segment's field is at most 16/15 strength R m^(5/2), that of an endless one, and strength length m^2. */
double skf_blob_quiet(const skf_blob *b, double iso) {
  if (!(iso > 0)) return 0;
  double measure = b->length > 0 ? b->length : 1, square = sqrt(iso / (b->strength * measure));
  double endless = b->length > 0 ? pow(0.9375 * iso / b->moment, 0.4) : 0;
  return 0.999 * fmax(square, endless);
}

/* Not of NaNs: without a call. */
static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

/* Beside a segment, at x along it and where m = 1 - h^2 / R^2; all lengths in units of R, without the strength. */
static double beside(const skf_blob *b, double x, double length, double m) {
  if (!(m > 0)) return 0;
  double y = sqrt(m), lo = larger(-x, -y), hi = smaller(length - x, y), ll = lo * lo, hh = hi * hi;
  if (!(lo < hi)) return 0;
  double F = b->c2 * (hi * (m * m - hh * (2. / 3 * m - 0.2 * hh)) - lo * (m * m - ll * (2. / 3 * m - 0.2 * ll)));
  if (!(b->c3 > 0)) return F;
  double to = hi * (m * m * m - hh * (m * m - hh * (0.6 * m - hh / 7)));
  double from = lo * (m * m * m - ll * (m * m - ll * (0.6 * m - ll / 7)));
  return F + b->c3 * (to - from);
}

/* The field falls with the distance from the axis, and along it with that from the middle. */
bool skf_segment_range(const skf_blob *b, const skf_cube *c, double *lo, double *hi) {
  skf_vec3 v = v3_sub(c->center, b->at), a = b->axis;
  double along = v3_dot(v, a), wide = c->half * (fabs(a.x) + fabs(a.y) + fabs(a.z)) * (1 + 1e-12), R = b->R;
  if (along + wide < -R || along - wide > b->length + R) return false;
  skf_vec3 q = v3_mad(v, -along, a);
  double h = v3_norm(q), slack = 1e-12 * (R + fabs(along)), in = c->half * (fabs(q.x) + fabs(q.y) + fabs(q.z));
  double near = h > 0 ? larger(h - in / h - slack, 0) : 0, far = h + c->radius + slack;
  if (!(near < R)) return false;
  double x = along * b->per_R, w = wide * b->per_R + 1e-12 * fabs(x), L = b->span, middle = 0.5 * L, s = b->moment;
  double best = smaller(larger(middle, x - w), x + w), most = beside(b, best, L, 1 - near * near * b->per);
  if (!(most > 0)) return false;
  double m = 1 - far * far * b->per;
  *hi += s * (most + 64 * DBL_EPSILON);
  if (m > 0) *lo += s * larger(smaller(beside(b, x - w, L, m), beside(b, x + w, L, m)) - 64 * DBL_EPSILON, 0);
  return true;
}
