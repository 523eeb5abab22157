/* SPDX-License-Identifier: MIT */
/* Rebounds of particles that attract each other: restitution, Coulomb friction, and how they end in sliding or rest
   instead of endless small bounces. They step together, and slide by hops; others do as slide.c says. */
#include "motion/contact.h"
#include "motion/view.h"

/* Hops are as high as this share of the body's size: a slide along a body takes some thousand of them. */
#define HOP 1e-6
/* A rebound that would rise less than this many times the rounding of the surface is not followed any further. */
#define LOW 16
/* The same without loss of energy, as a share of the size: only a particle that was put down without any speed rests.
 */
#define LOW_ELASTIC 1e-14

/* The gap seen from the body: how fast a particle that slides with velocity w (inertial, relative to the material)
   would sink into the surface, [L/T^2], and its acceleration along the surface; the length by which the body is
   measured, and the rounding of the surface. */
typedef struct ground {
  double pull, drag, size, fuzz;
} ground;

static ground feel(const skf_world *world, const skf_world_body *b, skf_clock t, skf_vec3 p, skf_vec3 n, skf_vec3 w) {
  skf_turn r = skf_turn_at(b, t);
  skf_vec3 a, g, q = skf_turn_point(&r, -1, p), v = skf_turn_vector(&r, -1, w);
  double h[6], F = skf_field_tensor_at(b->is.field, q, &g, h);
  if (!skf_world_force(world, t, &p, &a, NULL)) a = v3(0, 0, 0);
  skf_vec3 omega = v3_scale(b->rate, b->axis);
  a = v3_sub(a, v3_scale(2, v3_cross(omega, w)));
  a = v3_sub(a, v3_cross(omega, skf_body_velocity(b, p)));
  double curve = h[0] * v.x * v.x + h[3] * v.y * v.y + h[5] * v.z * v.z +
                 2 * (h[1] * v.x * v.y + h[2] * v.x * v.z + h[4] * v.y * v.z);
  double out = v3_dot(a, n), size = v3_dist(q, b->center) + b->radius;
  if (b->radius == 0) size = fabs(F) / v3_norm(g);
  return (ground){curve / v3_norm(g) - out, v3_norm(v3_mad(a, -out, n)), size,
                  skf_view_noise(b, F, g, q, p) / v3_norm(g)};
}

/* What friction leaves of a velocity along the surface, after a normal impulse. */
static skf_vec3 rub(skf_vec3 along, double loss) {
  double slip = v3_norm(along);
  return loss < slip ? v3_scale(1 - loss / slip, along) : v3(0, 0, 0);
}

skf_outcome skf_contact_rebound(const skf_world *world, const skf_world_body *b, const skf_flight_options *options,
                                skf_clock t, skf_vec3 p, skf_vec3 n, skf_vec3 before, bool *hops, skf_vec3 *after) {
  skf_vec3 ground_speed = skf_body_velocity(b, p), w = v3_sub(before, ground_speed);
  double in = fmax(-v3_dot(w, n), 0), e = options->restitution, mu = options->friction, up = e * in;
  skf_vec3 slip = v3_mad(w, -v3_dot(w, n), n), along = rub(slip, mu * (in + up));
  skf_outcome outcome = SKF_OUTCOME_BOUNCE;
  ground f = feel(world, b, t, p, n, along);
  double hop = f.pull > 0 ? sqrt(2 * f.pull * (e < 1 ? HOP : LOW_ELASTIC) * f.size) : 0;
  double low = f.pull > 0 && e < 1 ? sqrt(2 * f.pull * LOW * f.fuzz) : hop;
  bool goes_on = *hops && in < 2 * hop && up < hop;
  *hops = false;
  if (up < low || goes_on) { /* the impulse of a hop is that of the weight while it lasts: so is its friction */
    along = rub(slip, mu * (in + hop));
    bool held = v3_norm(along) <= hop && f.drag <= mu * f.pull;
    outcome = held ? SKF_OUTCOME_REST : SKF_OUTCOME_SLIDE;
    up = held ? 0 : hop;
    if (held) along = v3(0, 0, 0);
    *hops = !held;
  }
  *after = v3_add(ground_speed, v3_mad(along, up, n));
  return outcome;
}

const char *skf_outcome_name(skf_outcome outcome) {
  static const char *const names[SKF_OUTCOME_COUNT] = {"stop", "stick", "bounce", "slide", "rest", "absorb", "pass"};
  return (unsigned)outcome < SKF_OUTCOME_COUNT ? names[outcome] : "unknown";
}
