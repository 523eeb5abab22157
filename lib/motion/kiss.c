/* SPDX-License-Identifier: MIT */
/* Places where two solids touch, by Newton's method on F_a = F_b = iso, grad F_a + mu grad F_b = 0. */
#include "motion/collider.h"
#include <float.h>

/* Of the coordinates: a gap that Newton's method closes to this is closed. */
#define CLOSED (64 * DBL_EPSILON)
/* Over the size of a: makes the equations solvable where the two are equally deep along a line, as a ring on a plane.
 */
#define DAMPING 1e-7

enum { MOST = 5, ROUNDS = 30 };

/* Solves n equations by elimination with row pivots; false when singular. */
static bool solve(int n, double A[MOST][MOST], double x[MOST]) {
  for (int k = 0; k < n; k++) {
    int p = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(A[i][k]) > fabs(A[p][k])) p = i;
    if (!(fabs(A[p][k]) > 0)) return false;
    for (int j = 0; j < n && p != k; j++) {
      double s = A[k][j];
      A[k][j] = A[p][j], A[p][j] = s;
    }
    double s = x[k];
    x[k] = x[p], x[p] = s;
    for (int i = k + 1; i < n; i++) {
      double m = A[i][k] / A[k][k];
      for (int j = k; j < n; j++) A[i][j] -= m * A[k][j];
      x[i] -= m * x[k];
    }
  }
  for (int k = n; k-- > 0;) {
    for (int j = k + 1; j < n; j++) x[k] -= A[k][j] * x[j];
    x[k] /= A[k][k];
  }
  return true;
}

static skf_vec3 row(const double h[6], int i) {
  return i == 0 ? v3(h[0], h[1], h[2]) : i == 1 ? v3(h[1], h[3], h[4]) : v3(h[2], h[4], h[5]);
}

static skf_vec3 times(const double h[6], skf_vec3 v) {
  return v3(v3_dot(row(h, 0), v), v3_dot(row(h, 1), v), v3_dot(row(h, 2), v));
}

/* Both fields at a place of a at one time; what is of b is turned into the frame of a. */
typedef struct pair {
  double fa, fb;
  skf_vec3 ga, gb, w;  /* gradients; velocity of a's material at p against b's, frame of a */
  double ha[6], hb[6]; /* hb in the frame of b */
  skf_pose pa, pb;
  skf_vec3 x, spin; /* inertial place; angular velocity of a against b, frame of a */
} pair;

static skf_vec3 to_a(const pair *s, skf_vec3 v) { return quat_turn(s->pa.q, -1, quat_turn(s->pb.q, 1, v)); }
static skf_vec3 to_b(const pair *s, skf_vec3 v) { return quat_turn(s->pb.q, -1, quat_turn(s->pa.q, 1, v)); }

static skf_vec3 speed_of(const skf_rigid_motion *m, const skf_pose *pose, double t, skf_vec3 x) {
  skf_vec3 v = v3_mad(m->velocity, t - m->t, m->acceleration);
  return v3_add(v, v3_cross(m->angular_velocity, v3_sub(x, pose->position)));
}

static void look(const skf_duel *d, double t, skf_vec3 p, pair *s) {
  s->pa = skf_rigid_at(&d->ma, t), s->pb = skf_rigid_at(&d->mb, t);
  s->x = skf_pose_point(&s->pa, p);
  s->fa = skf_field_tensor_at(d->a->field, v3_add(p, d->a->origin), &s->ga, s->ha) - d->a->iso;
  s->fb =
      skf_field_tensor_at(d->b->field, v3_add(skf_pose_inverse(&s->pb, s->x), d->b->origin), &s->gb, s->hb) - d->b->iso;
  s->gb = to_a(s, s->gb);
  skf_vec3 w = v3_sub(speed_of(&d->ma, &s->pa, t, s->x), speed_of(&d->mb, &s->pb, t, s->x));
  s->w = quat_turn(s->pa.q, -1, w);
  s->spin = quat_turn(s->pa.q, -1, v3_sub(d->ma.angular_velocity, d->mb.angular_velocity));
}

/* The rows of grad F_a + mu grad F_b = 0, divided by |grad F_a|: by p, by mu, by t. */
static void opposite(const pair *s, double mu, double scale, double A[MOST][MOST], double r[MOST]) {
  skf_vec3 moved = to_a(s, times(s->hb, to_b(s, s->w))); /* as b's field passes by, and as it turns against a */
  moved = v3_sub(moved, v3_cross(s->spin, s->gb));
  for (int j = 0; j < 3; j++) {
    skf_vec3 e = {j == 0, j == 1, j == 2}, column = v3_mad(row(s->ha, j), mu, to_a(s, times(s->hb, to_b(s, e))));
    for (int i = 0; i < 3; i++) A[i][j] = v3_get(column, i) * scale;
  }
  for (int i = 0; i < 3; i++) {
    A[i][3] = v3_get(s->gb, i) * scale, A[i][4] = mu * v3_get(moved, i) * scale;
    r[i] = -(v3_get(s->ga, i) + mu * v3_get(s->gb, i)) * scale;
  }
}

/* The sum of both curvatures of F along the surfaces, e and f being tangents. */
static double curvature(const pair *s, skf_vec3 e, skf_vec3 f) {
  return v3_dot(e, times(s->ha, f)) / v3_norm(s->ga) + v3_dot(to_b(s, e), times(s->hb, to_b(s, f))) / v3_norm(s->gb);
}

static bool is_summit(const pair *s) {
  skf_vec3 n = v3_unit(s->ga), e = v3_perp(n), f = v3_cross(n, e);
  double x = curvature(s, e, e), m = curvature(s, e, f), y = curvature(s, f, f);
  double flat = 1e-6 * (fabs(x) + fabs(m) + fabs(y));
  return x <= flat && y <= flat && x * y - m * m >= -flat * (fabs(x) + fabs(y));
}

static void describe(const pair *s, double t, skf_vec3 p, skf_kiss *out) {
  double a = v3_norm(s->ga), b = v3_norm(s->gb);
  skf_vec3 n = v3_unit(v3_sub(v3_scale(1 / b, s->gb), v3_scale(1 / a, s->ga)));
  *out = (skf_kiss){t, p, s->x, quat_turn(s->pa.q, 1, n), v3_dot(s->w, n), s->fa / a + s->fb / b, is_summit(s)};
}

static bool is_opposite(const pair *s) {
  double a = v3_norm(s->ga), b = v3_norm(s->gb);
  return v3_norm(v3_add(v3_scale(1 / a, s->ga), v3_scale(1 / b, s->gb))) < 1e-6;
}

bool skf_kiss_in_time(const skf_duel *d, double t, skf_vec3 p, double reach, double duration, skf_kiss *out) {
  pair s;
  skf_vec3 start = p;
  double mu = 0, begin = t, last = INFINITY;
  for (int i = 0; i < ROUNDS; i++) {
    double A[MOST][MOST] = {{0}}, r[MOST];
    look(d, t, p, &s);
    double a = v3_norm(s.ga), b = v3_norm(s.gb);
    if (!(a > 0 && b > 0 && isfinite(a) && isfinite(b))) return false;
    if (i == 0) mu = a / b;
    opposite(&s, mu, 1 / a, A, r);
    for (int j = 0; j < 3; j++) A[3][j] = v3_get(s.ga, j) / a, A[4][j] = v3_get(s.gb, j) / b;
    A[4][4] = v3_dot(s.gb, s.w) / b;
    r[3] = -s.fa / a, r[4] = -s.fb / b;
    if (!solve(5, A, r)) return false;
    double step = v3_norm(v3(r[0], r[1], r[2])), share = fmin(1, fmin(reach / step, duration / fabs(r[4])));
    if (!isfinite(step) || !isfinite(r[4])) return false;
    p = v3_mad(p, share, v3(r[0], r[1], r[2])), mu += share * r[3], t += share * r[4];
    if (v3_dist(p, start) > 4 * reach || fabs(t - begin) > 4 * duration) return false;
    double size = step + fabs(r[4]) * v3_norm(s.w);
    if (i > 3 && size >= 0.5 * last && size < 1e-9 * reach) break;
    if (size == 0) break;
    last = size;
  }
  look(d, t, p, &s);
  describe(&s, t, p, out);
  double scale = v3_norm(p) + v3_norm(s.x) + reach;
  double a = v3_norm(s.ga), b = v3_norm(s.gb);
  return mu > 0 && is_opposite(&s) && fabs(s.fa) < CLOSED * a * scale && fabs(s.fb) < CLOSED * b * scale;
}

bool skf_kiss_at(const skf_duel *d, double t, skf_vec3 p, double reach, skf_kiss *out) {
  pair s;
  skf_vec3 start = p;
  double mu = 0, last = INFINITY;
  for (int i = 0; i < ROUNDS; i++) {
    double A[MOST][MOST] = {{0}}, r[MOST];
    look(d, t, p, &s);
    double a = v3_norm(s.ga), b = v3_norm(s.gb);
    if (!(a > 0 && b > 0 && isfinite(a) && isfinite(b))) return false;
    if (i == 0) mu = a / b;
    opposite(&s, mu, 1 / a, A, r);
    for (int j = 0; j < 3; j++) A[3][j] = v3_get(s.ga, j) / a - v3_get(s.gb, j) / b;
    for (int j = 0; j < 3; j++) A[j][j] -= DAMPING / d->a->radius;
    A[3][3] = 0;
    r[3] = -(s.fa / a - s.fb / b);
    if (!solve(4, A, r)) return false;
    double step = v3_norm(v3(r[0], r[1], r[2])), share = fmin(1, reach / step);
    if (!isfinite(step)) return false;
    p = v3_mad(p, share, v3(r[0], r[1], r[2])), mu += share * r[3];
    if (v3_dist(p, start) > 4 * reach) return false;
    if (step == 0 || (i > 3 && step >= 0.5 * last && step < 1e-9 * reach)) break;
    last = step;
  }
  look(d, t, p, &s);
  describe(&s, t, p, out);
  return mu > 0 && is_opposite(&s);
}
