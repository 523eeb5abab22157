/* SPDX-License-Identifier: MIT */
/* Particles that fly through fields, and where they touch. */
#ifndef SKELFIELD_MOTION_H
#define SKELFIELD_MOTION_H

#include "skelfield/ray.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Uniform rotation about a fixed axis; the body's frame is the inertial frame at t = 0. */
typedef struct skf_spin {
  skf_vec3 axis, about; /* axis need not be a unit vector */
  double rate;          /* [rad/T]; 0: no rotation */
} skf_spin;

/* What happens where a particle reaches a surface from outside. */
typedef enum skf_contact_mode {
  SKF_CONTACT_NONE,   /* nothing: the particle flies through */
  SKF_CONTACT_STOP,   /* it stays at this place of the inertial frame, with velocity 0 */
  SKF_CONTACT_BOUNCE, /* it rebounds, with restitution and Coulomb friction; see skf_outcome */
  SKF_CONTACT_STICK,  /* it stays at this place of the body, and turns with it */
  SKF_CONTACT_ABSORB, /* it is gone: its state is NAN from then on */
  SKF_CONTACT_PASS,   /* it flies through, each entry is told */
  SKF_CONTACT_COUNT
} skf_contact_mode;

/* How contacts are looked for. */
typedef enum skf_search {
  /* No contact is missed and none invented, up to rounding of F and of the places, on the path that the integrator's
     dense output describes: pieces of the path are passed where bounds on the field keep the surface away from them,
     and halved where they do not. What touches a surface too closely to decide is counted as `grazing`. Needs bounds
     (skf_field_has_bound). */
  SKF_SEARCH_CERTIFIED,
  /* The same down to eighths of a step, which are then decided by F and its slope at their ends and where a cubic
     through those peaks. Finds what stays inside for an eighth of a step; promises nothing for what is thinner, such as
     spikes. A contact that it finds is as exact as a certified one. At most 15 pieces a step: cheaper than certified
     where paths run close to surfaces that turn or are thin, else as dear (tests/bench/bench_contact.c: 1.0 to 1.2
     times the flight without contact, certified 1.1). Fields without bounds are sampled at nine places of each step. */
  SKF_SEARCH_FAST
} skf_search;

/* ---- Integrators ---- */

/* A registered integrator. Adaptive ones find the joins of compact kernels (where a soft object or metaball ends), by
   steps no longer than those leave and by what their error tells: 8 to 17 refused steps at each. Fixed steps pass
   over joins, however deep: there the order is lost, and a symplectic integrator's energy may jump; such steps are
   counted in skf_flight_report. */
typedef struct skf_integrator_info {
  const char *name, *doc;
  int order;       /* error of a step is O(h^(order + 1)) */
  int dense_order; /* error of the position between the ends of a step is O(h^(dense_order + 1)) */
  bool adaptive;   /* steps follow the tolerance; else they are all of the length `step` */
} skf_integrator_info;

SKF_API size_t skf_integrator_count(void);
/* Row i of the registry, the default one first; NULL when out of range. */
SKF_API const skf_integrator_info *skf_integrator_get(size_t i);
/* By name; NULL or "" is the default. NULL when there is none of that name. */
SKF_API const skf_integrator_info *skf_integrator_find(const char *name);

/* ---- The world: bodies that attract ---- */

/* A body as particles see it. The field is borrowed and lives in the body's frame. */
typedef struct skf_attractor {
  const skf_field *field;
  double iso;  /* its surface is F = iso, inside F > iso */
  double gain; /* G rho: acceleration = gain grad F, potential energy per unit mass = -gain F */
  skf_spin spin;
} skf_attractor;

/* What else accelerates particles, in the inertial frame. */
typedef enum skf_force_type {
  SKF_FORCE_PUSH,         /* a = push: the radiation pressure of a far source on a ball, a uniform field */
  SKF_FORCE_DRAG,         /* a = -k d (v - u) */
  SKF_FORCE_DRAG_SQUARED, /* a = -k d |v - u| (v - u) */
  SKF_FORCE_USER          /* a = what `eval` gives */
} skf_force_type;

#define SKF_FORCE_AT_REST ((size_t)-1)

/* The medium that drags has velocity u, that of the material of a body that turns, or 0; and density d, 1 everywhere or
   exp(-(|p - center| - radius) / scale_height), `center` being in that body's frame. */
typedef struct skf_force {
  skf_force_type type;
  skf_vec3 push;       /* [L/T^2] */
  double k;            /* >= 0 [1/T], squared: [1/L] */
  size_t body;         /* that the medium turns with, or SKF_FORCE_AT_REST */
  double scale_height; /* 0: the same density everywhere [L] */
  double radius;       /* where it is 1 [L] */
  skf_vec3 center;
  /* Called on several threads at once; not finite where the force is not known. v is set only where `velocity` says
     that the force depends on it. */
  void (*eval)(const void *user, double t, skf_vec3 p, skf_vec3 v, skf_vec3 *a);
  const void *user;
  bool velocity;
} skf_force;

/* Whether an integrator takes a force; skf_flight_new refuses it otherwise. False when there is none of that name. */
SKF_API bool skf_integrator_takes(const char *name, const skf_force *force);

/* Immutable, safe to share between threads. */
typedef struct skf_world skf_world;

/* Copies the bodies. SKF_ERR_ARG without a field, SKF_ERR_RANGE for numbers that are not finite, SKF_ERR_DEGENERATE for
   a spin without an axis, SKF_ERR_NOMEM. */
SKF_API skf_status skf_world_new(const skf_attractor *bodies, size_t n, skf_world **out);
/* The same with other forces, which are copied; SKF_ERR_ARG also for a body, a type or a callback that is not there.
   Where there are any, no constant of the motion is known. Forces that depend on the velocity need an integrator that
   takes them, see skf_flight_new; what rests does not feel those. */
SKF_API skf_status skf_world_new_with(const skf_attractor *bodies, size_t n, const skf_force *forces,
                                      size_t force_count, skf_world **out);
SKF_API void skf_world_free(skf_world *world);
SKF_API size_t skf_world_size(const skf_world *world);

/* Acceleration [L/T^2], drag not in it, and potential energy per unit mass [L^2/T^2] in the inertial frame at time t; a
   may be NULL, and is NAN where the force is not finite. */
SKF_API double skf_world_at(const skf_world *world, double t, skf_vec3 p, skf_vec3 *a);

/* From the inertial frame to the frame of a body at time t, and back. */
SKF_API skf_vec3 skf_world_to_body(const skf_world *world, size_t body, double t, skf_vec3 p);
SKF_API skf_vec3 skf_world_from_body(const skf_world *world, size_t body, double t, skf_vec3 p);
/* Velocity of the body's material at p (inertial frame). */
SKF_API skf_vec3 skf_world_surface_velocity(const skf_world *world, size_t body, skf_vec3 p);
/* F - iso of a body at an inertial point. */
SKF_API double skf_world_level(const skf_world *world, size_t body, double t, skf_vec3 p);

/* Position [L] and velocity [L/T] in the inertial frame at time t [T]. */
typedef struct skf_state {
  double t;
  skf_vec3 position, velocity;
} skf_state;

/* A state as it is in the frame of a body, which turns: the velocity is relative to that frame; and back. To rounding
   of the angle, which is taken from t to 1e-16 however many turns there have been. */
SKF_API skf_state skf_world_state_to_body(const skf_world *world, size_t body, const skf_state *state);
SKF_API skf_state skf_world_state_from_body(const skf_world *world, size_t body, const skf_state *state);
/* A direction, inertial at time t, as it is in a body's frame. */
SKF_API skf_vec3 skf_world_direction_to_body(const skf_world *world, size_t body, double t, skf_vec3 v);

/* Constants of the motion that the world has; those that it has not are NAN. Per unit mass. */
typedef struct skf_invariants {
  double energy;         /* kinetic + potential: nothing spins [L^2/T^2] */
  double jacobi;         /* energy - omega . angular momentum about the axis: all bodies spin alike */
  double axial_momentum; /* about the common axis, where every body is symmetric about it [L^2/T] */
  double scale;          /* kinetic + |potential|: what an error of energy is relative to */
} skf_invariants;
SKF_API skf_invariants skf_world_invariants(const skf_world *world, const skf_state *state);

/* The same quantities of a motion, constant or not, per unit mass. */
typedef struct skf_quantities {
  double energy;             /* kinetic + potential, that of pushes included [L^2/T^2] */
  double jacobi;             /* energy - omega . angular momentum about the axis; NAN unless all bodies spin alike */
  skf_vec3 angular_momentum; /* about a point of the axis of symmetry, else of the axis of spin, else the origin */
  double axial_momentum;     /* its component along the axis of symmetry; NAN when there is none [L^2/T] */
} skf_quantities;
SKF_API skf_quantities skf_world_quantities(const skf_world *world, const skf_state *state);

/* ---- Flights: one particle ---- */

typedef struct skf_flight_options {
  const char *integrator; /* NULL: default */
  double tolerance;       /* relative error per step, in (0, 0.1]; 0: 1e-12 */
  double max_step;        /* [T], of adaptive integrators; 0: none, as for the others */
  skf_contact_mode contact;
  double restitution, friction; /* of a bounce: restitution in [0, 1], friction >= 0 */
  skf_search search;
  bool approach; /* keep the closest approach to each body: see skf_flight_approach */
  double step;   /* [T] > 0, for integrators that are not adaptive, which know no tolerance; 0 for the others */
} skf_flight_options;

typedef enum skf_outcome {
  SKF_OUTCOME_STOP,   /* stays in space from now on */
  SKF_OUTCOME_STICK,  /* stays on the body from now on */
  SKF_OUTCOME_BOUNCE, /* rebounds */
  SKF_OUTCOME_SLIDE,  /* rebounds too low to tell; slides along the surface from now on: see skf_flight_step */
  SKF_OUTCOME_REST,   /* comes to rest on the body and stays there */
  SKF_OUTCOME_ABSORB, /* is gone from now on */
  SKF_OUTCOME_PASS,   /* enters the body as if it were not there */
  SKF_OUTCOME_COUNT
} skf_outcome;
/* "stop", "stick", "bounce", "slide", "rest", "absorb", "pass" */
SKF_API const char *skf_outcome_name(skf_outcome outcome);

/* One contact, in the inertial frame. */
typedef struct skf_contact {
  double t;
  size_t particle, body;
  skf_vec3 position, normal; /* outward unit normal */
  skf_vec3 before, after;    /* velocity before and after the contact */
  skf_outcome outcome;
} skf_contact;

/* Where a particle came closest to a body: the place of its path, up to its first contact, where F - iso of that body
   is largest, and the first of several; any place inside, if it comes there. Found by branch and bound with the field's
   bounds: nowhere on the path is F - iso larger by more than rounding, unless F hardly changes along a step, as on a
   circular orbit: there the search ends after 20,000 places. Its time and place are good to rounding where F has a
   maximum along the path whose curvature tells. The surface's distance from it is estimated to first order. */
typedef struct skf_approach {
  double t;
  skf_vec3 position; /* inertial */
  double level;      /* F - iso [per kernel]; 0 at a contact, positive inside */
  /* -level / |grad F| [L]; 0 inside. Means nothing where the gradient vanishes, as far from compact kernels: INFINITY
     where it is 0. */
  double distance;
} skf_approach;

/* What a flight cost and how well it kept its invariants; a drift is NAN where the world has no such invariant.
   Drifts are the largest between two contacts, relative to the scale of skf_invariants (momentum: to |r| |v|). */
typedef struct skf_flight_report {
  size_t steps, rejected, evaluations, contacts;
  size_t bounds;  /* enclosures computed in the search for contacts */
  size_t grazing; /* pieces of path that touch a surface too closely to decide; taken as a miss */
  size_t joins;   /* steps of a fixed length that have passed over a join, see skf_integrator_info; 0 for the others */
  double h_min, h_max;
  double energy_drift, jacobi_drift, momentum_drift;
} skf_flight_report;

typedef struct skf_flight skf_flight;

/* SKF_ERR_ARG for an unknown integrator or options out of range, SKF_ERR_RANGE for a start that is not finite,
   SKF_ERR_UNSUPPORTED for forces that depend on the velocity with an integrator other than gauss-radau and dop853, for
   any forces with hermite4, and for certified contact and for approaches where a body's field has no bounds
   (skf_field_has_bound). */
SKF_API skf_status skf_flight_new(const skf_world *world, const skf_flight_options *options, const skf_state *start,
                                  skf_flight **out);
SKF_API void skf_flight_free(skf_flight *flight);

/* Takes one step of the integrator's own choosing, which ends early at a contact; *contact, if given, is then filled
   and *touched set. SKF_ERR_CONVERGENCE when the force is not finite or the step shrinks to nothing: the flight then
   stays where it was. A flight that slides goes on by Gauss-Radau steps to the same tolerance, whatever the integrator:
   on the surface, or the groove of two, under all forces, the reaction, and friction times that against the slip; its
   states are on the ground to rounding and have no speed off it. It takes off where the reaction would pull, which is
   looked for in 16 places of a step. A rebound is too low to tell below 16 times the rounding of F - iso as a height,
   about 1e-13 of the distance from the skeleton. Particles that attract each other (skf_run: gm) slide by hops of 1e-6
   of the body's size instead. */
SKF_API skf_status skf_flight_step(skf_flight *flight, skf_contact *contact, bool *touched);
/* Times between which the last step is known: skf_flight_at works there. */
SKF_API void skf_flight_span(const skf_flight *flight, double *from, double *to);
/* The state at a time in that span, from the dense output; after a contact at its end for t = to. */
SKF_API skf_status skf_flight_at(skf_flight *flight, double t, skf_state *out);
SKF_API skf_flight_report skf_flight_get_report(const skf_flight *flight);
/* The closest approach to a body in the steps so far. SKF_ERR_ARG without option `approach` or before the first step;
   a body without a surface has one, too. */
SKF_API skf_status skf_flight_approach(const skf_flight *flight, size_t body, skf_approach *out);

/* ---- One piece of path ---- */

/* p(t) = position + velocity (t - t0) + acceleration (t - t0)^2 / 2, t0 being `t`: straight without acceleration. */
typedef struct skf_ballistic {
  double t;
  skf_vec3 position, velocity, acceleration;
} skf_ballistic;

typedef enum skf_touching {
  SKF_TOUCHING_NONE,
  SKF_TOUCHING_AT_START, /* it begins on a surface, to rounding, and does not leave it outwards at once */
  SKF_TOUCHING_LATER
} skf_touching;

/* The first contact in t0 <= t <= t1, that is where F - iso of a body goes from negative to positive along the path;
   one that begins inside has none until it has left. Contacts are events of the motion: a later t0 or an earlier t1
   changes none of those between, but for rounding of their times. *contact, if given, is filled where there is one,
   with after = before. *grazing, if given, grows by the pieces that could not be decided. SKF_ERR_RANGE (not finite, t1
   < t0), SKF_ERR_UNSUPPORTED (no bounds) or SKF_ERR_NOMEM. */
SKF_API skf_status skf_world_touch(const skf_world *world, const skf_ballistic *motion, double t0, double t1,
                                   skf_search search, skf_touching *touching, skf_contact *contact, size_t *grazing);

/* ---- Runs: many particles, rows of output ---- */

/* Processes that share a run, each with the particles rank, rank + size, ...: results do not depend on how many there
   are. All make the same calls with the same world, run and options in the same order; functions of runs are then
   meetings of all, and every one returns the same status. The one of rank 0 alone has the sink, receives the others'
   rows (unless they have sinks of their own) and contacts and writes and reads what is saved. A progress that asks to
   stop stops its own process, the others at the end of their window unless theirs ask, too. A message is received by
   one call with its n, in order; both functions may wait, are called by one thread at a time, outside of parallel
   regions, and end the run by another status than SKF_OK, which others may not learn of. */
typedef struct skf_team {
  size_t rank, size; /* rank < size; of size 1 it needs no functions */
  skf_status (*send)(void *user, size_t to, const void *bytes, size_t n);
  skf_status (*receive)(void *user, size_t from, void *bytes, size_t n);
  void *user;
} skf_team;

typedef struct skf_run {
  size_t count;           /* particles */
  const skf_state *start; /* all at the same t */
  double t_end, every;    /* rows at start + k every, and at t_end; every 0: only the two ends */
  skf_flight_options flight;
  const skf_team *team; /* NULL: this process alone; copied */
  /* G times the mass of each particle [L^3/T^2], or NULL: none attracts anything. Those that attract move with all
     others by one clock, with the default integrator, in one process and without approaches only, else
     SKF_ERR_UNSUPPORTED; the report of the first particle has the drifts of all those together, the others' are NAN. */
  const double *gm;
  double softening; /* of their pull, -G m / sqrt(r^2 + softening^2); of the bodies' there is none [L] */
} skf_run;

/* Receives what a run makes, from one thread, in order of time; contacts of the same time by particle, and all contacts
   up to a time before the row of that time. A status other than SKF_OK ends the run with that status: at once, or at
   the end of a window where it is that of another process. */
typedef struct skf_run_sink {
  skf_status (*row)(void *user, double t, const skf_state *states);
  skf_status (*contact)(void *user, const skf_contact *contact);
  void *user;
  /* Each process of the team has a sink, whose rows are of its own particles; they are never gathered. Contacts go to
     that of rank 0 all the same. Alike for all processes, and in all calls for a runner. */
  bool own;
} skf_run_sink;

/* Where a run failed. */
typedef struct skf_run_failure {
  size_t particle;
  double t;
} skf_run_failure;

/* Runs on OpenMP's threads; results do not depend on their number. reports: NULL or one a particle. failure: NULL, or
   filled when the status is SKF_ERR_CONVERGENCE; rows before that time have been delivered. */
SKF_API skf_status skf_run_all(const skf_world *world, const skf_run *run, const skf_run_sink *sink,
                               const skf_progress *progress, skf_flight_report *reports, skf_run_failure *failure);

/* A run in pieces: it can stop between any two steps, be saved, and go on with the same bits, in this process or in
   another one. */
typedef struct skf_runner skf_runner;

/* The particles at their start. The world and run->start are borrowed. Errors of skf_flight_new; failure as below. */
SKF_API skf_status skf_runner_new(const skf_world *world, const skf_run *run, skf_runner **out,
                                  skf_run_failure *failure);
SKF_API void skf_runner_free(skf_runner *runner);
/* Goes on to the end. SKF_ERR_CANCELLED when the progress asks to stop: call it again to go on. */
SKF_API skf_status skf_runner_fly(skf_runner *runner, const skf_run_sink *sink, const skf_progress *progress,
                                  skf_run_failure *failure);
/* One report a particle, for the process of rank 0; SKF_OK but for what the team returns. */
SKF_API skf_status skf_runner_reports(const skf_runner *runner, skf_flight_report *reports);
/* The same for closest approaches up to the first contact, but not after t_end: out[i * bodies + b] is that of particle
   i to body b, NAN in a run of no time. SKF_ERR_ARG without option `approach`. */
SKF_API skf_status skf_runner_approaches(const skf_runner *runner, skf_approach *out);
/* Everything that the rest of the run depends on, as bytes for the same build of the library, about 1.9 kB a particle
   with the default integrator, and 56 bytes for each row that waits; what has been delivered is not among them. A
   status of `write` other than SKF_OK ends it. A team may be of another size when it loads them. */
SKF_API skf_status skf_runner_save(const skf_runner *runner,
                                   skf_status (*write)(void *user, const void *bytes, size_t n), void *user);
/* The same into a new runner of the same world and run; SKF_ERR_PARSE when they are of another one, and then, as after
   a status of `read`, it is to be freed. */
SKF_API skf_status skf_runner_load(skf_runner *runner, skf_status (*read)(void *user, void *bytes, size_t n),
                                   void *user);

#ifdef __cplusplus
}
#endif
#endif
