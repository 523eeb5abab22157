/* SPDX-License-Identifier: MIT */
/* What each integrator's accuracy costs, and what contact costs and finds. notebooks-c/run executes this file. */
// %% [markdown]
// # Orbits and contact
//
// Which integrator reaches which accuracy at which cost? And when a particle meets a surface, is the contact found, is
// it exact, and what does looking for it cost? This notebook measures both in this build, on the machine that runs it,
// on three worlds of `data/`: the donut, the cigar, and the cross, which turns. Every claim in a sentence is required:
// when it does not hold, the notebook fails. Times are only shown, since machines differ.

// %%
#include "figure.h"
#include "random.h"
#include "skelfield/skelfield.h"
#include <time.h>
#if __has_include(<gsl/gsl_odeiv2.h>)
#define HAVE_GSL 1
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#else
#define HAVE_GSL 0
#endif

/* One orbit of one world, in SI units. */
typedef struct course {
  const char *name, *file, *told;
  size_t particle; /* of the scene */
  double end, drawn;
  const skf_field *field;
  skf_world *world;
  double gain, rate; /* acceleration = gain grad F in the body's frame, which turns about z with this rate */
  skf_state start;
  skf_vec3 goal;    /* the place at the end, by the reference */
  double certainty; /* how far two references are apart there */
} course;
enum { COURSES = 3 };
course courses[COURSES] = {
    {"donut", "data/donut.yaml", "the bow: 5 turns over the top and through the hole", 1, 110783.14, 22156.6},
    {"cigar", "data/cigar.yaml", "over the ends of the cigar for four days", 1, 345600, 60000},
    {"cross", "data/cross.yaml", "against the turn of the cross for eight days", 1, 691200, 200000},
};

double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// %% [markdown]
// ## Three orbits
//
// They bend hard and none is chaotic. The donut's bow goes over the top of the ring and dives through its hole; the
// cigar's polar orbit passes low above both ends; above the cross the force itself turns.

// %%
void read_course(course *c) {
  skf_scene *scene;
  skf_error problem;
  if (skf_scene_read(c->file, &scene, &problem)) nb_fail("%s, line %ld: %s", c->file, problem.line, problem.text);
  const skf_body *b = scene->bodies;
  const skf_particle *p = scene->particles + c->particle;
  nb_require(scene->body_count == 1 && (b->spin.rate == 0 || b->spin.axis.z == 1) && !p->launch.given);
  c->field = b->field, c->gain = scene->G * b->rho, c->rate = b->spin.rate;
  c->start = (skf_state){0, p->position, p->velocity};
  skf_attractor body = {c->field, b->iso, c->gain, b->spin};
  nb_require(skf_world_new(&body, 1, &c->world) == SKF_OK);
  printf("%s: %s\n", c->name, c->told);
}

// %%
for (int i = 0; i < COURSES; i++) read_course(courses + i);

// %%
/* Places along the first part of the course as the program's `map` reads them. */
void write_orbit(const course *c, const char *path) {
  enum { ROWS = 3000 };
  FILE *f = fopen(path, "w");
  skf_flight *flight;
  skf_state s;
  double from, to = 0;
  nb_require(f && skf_flight_new(c->world, &(skf_flight_options){.tolerance = 1e-12}, &c->start, &flight) == SKF_OK);
  fprintf(f, "t,particle,x,y,z,vx,vy,vz\n");
  for (int i = 0; i <= ROWS; i++) {
    double t = c->drawn * i / ROWS;
    while (to < t && !skf_flight_step(flight, NULL, NULL)) skf_flight_span(flight, &from, &to);
    nb_require(skf_flight_at(flight, t, &s) == SKF_OK);
    fprintf(f, "%.17g,%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", t, c->name, s.position.x, s.position.y, s.position.z,
            s.velocity.x, s.velocity.y, s.velocity.z);
  }
  skf_flight_free(flight);
  nb_require(fclose(f) == 0);
}
void map_orbit(const course *c, const char *plane, const char *extent) {
  char path[64];
  snprintf(path, sizeof path, "%s.csv", c->name), write_orbit(c, path);
  nb_run("skelfield map %s -o %s.png --plane %s --quantity potential --no-contours --colormap cividis --orbits %s"
         " --extent=%s --size 800x600",
         c->file, c->name, plane, path, extent);
  snprintf(path, sizeof path, "%s.png", c->name), nb_show(path);
}

// %%
map_orbit(&courses[0], "y=0", "-2.4e7,2.4e7,-1.7e7,1.7e7");
map_orbit(&courses[1], "z=0", "-3.2e7,3.2e7,-2.3e7,2.3e7");
map_orbit(&courses[2], "z=0", "-4.5e7,4.5e7,-3.2e7,3.2e7");

// %% [markdown]
// ## The reference
//
// Errors are distances at the end from where the particle should be, relative to its distance from the origin at the
// start. Where should it be? Two integrators that have nothing in common but the field, the 15th-order Gauss-Radau and
// the 12th-order Nystrom pair, both at the end of double precision: where they agree, one of them is the reference, and
// the difference is as far down as errors can be told. The field's own gradient is exact to about 1e-15 (see
// `02-accuracy-and-speed.c`).

// %%
double separation(skf_vec3 a, skf_vec3 b) { return v3_norm(v3_sub(a, b)); }

/* The place at the end; false when the integrator gives up. */
bool fly(const course *c, skf_flight_options how, skf_vec3 *end, skf_flight_report *report) {
  skf_flight *f;
  skf_state at;
  double from, to = 0;
  if (skf_flight_new(c->world, &how, &c->start, &f)) return false;
  skf_status s = SKF_OK;
  while (to < c->end && !s) s = skf_flight_step(f, NULL, NULL), skf_flight_span(f, &from, &to);
  if (!s) s = skf_flight_at(f, c->end, &at);
  *report = skf_flight_get_report(f);
  *end = at.position;
  skf_flight_free(f);
  return s == SKF_OK;
}

// %%
for (int i = 0; i < COURSES; i++) {
  course *c = courses + i;
  skf_flight_report r;
  skf_vec3 other;
  nb_require(fly(c, (skf_flight_options){.integrator = "gauss-radau", .tolerance = 1e-15}, &c->goal, &r));
  double drift = fmax(fmax(r.energy_drift, r.jacobi_drift), 0);
  nb_require(fly(c, (skf_flight_options){.integrator = "rkn12", .tolerance = 1e-15}, &other, &r));
  c->certainty = separation(c->goal, other) / v3_norm(c->start.position);
  printf("%s: the two end %.1e apart; the invariant of the reference drifts by %.1e\n", c->name, c->certainty, drift);
  nb_require(c->certainty < 2e-12 && drift < 1e-14);
}

// %% [markdown]
// ## All integrators
//
// Adaptive ones at tolerances from 1e-3 to 3e-15, those with fixed steps with ever shorter ones; runs whose error is
// larger than the orbit are left out. Beside them, where GSL
// is installed, four of GSL's: its Runge-Kutta-Fehlberg 4(5), its Prince-Dormand 8(9), its Bulirsch-Stoer, which is
// implicit and gets the exact Jacobian from the field's Hessian, and its Adams. They call the same field for the same
// right-hand side, with the same tolerance relative to the size of the orbit and of the speed.

// %%
enum { MOST = 24, RUNS = 24 };
typedef struct result {
  double error, evaluations, ms;
} result;
typedef struct entrant {
  const char *name;
  bool adaptive, gsl;
  int order;
  look look;
  result results[COURSES][RUNS];
  int count[COURSES];
} entrant;
entrant entrants[MOST];
int entrant_count;

/* A course as GSL sees it: six numbers, place and velocity. */
typedef struct task {
  const course *course;
  size_t evaluations;
} task;

#if HAVE_GSL
int derivatives(double t, const double y[], double f[], void *user) {
  task *k = user;
  const course *o = k->course;
  double c = cos(o->rate * t), s = sin(o->rate * t);
  skf_vec3 g;
  k->evaluations++;
  skf_field_at(o->field, v3(c * y[0] + s * y[1], c * y[1] - s * y[0], y[2]), &g);
  f[0] = y[3], f[1] = y[4], f[2] = y[5];
  f[3] = o->gain * (c * g.x - s * g.y), f[4] = o->gain * (s * g.x + c * g.y), f[5] = o->gain * g.z;
  return GSL_SUCCESS;
}

/* d f / d y, from the Hessian turned like the body, and d f / d t, which is how that turn changes the force. */
int jacobian(double t, const double y[], double J[], double dfdt[], void *user) {
  task *k = user;
  const course *o = k->course;
  double c = cos(o->rate * t), s = sin(o->rate * t), h[6], w = o->rate;
  skf_vec3 g;
  k->evaluations++;
  skf_field_tensor_at(o->field, v3(c * y[0] + s * y[1], c * y[1] - s * y[0], y[2]), &g, h);
  double H[3][3] = {{h[0], h[1], h[2]}, {h[1], h[3], h[4]}, {h[2], h[4], h[5]}};
  double R[3][3] = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}}, T[3][3] = {{0}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) T[i][j] += o->gain * R[i][a] * H[a][b] * R[j][b];
  memset(J, 0, 36 * sizeof *J);
  for (int i = 0; i < 3; i++) J[6 * i + 3 + i] = 1;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) J[6 * (3 + i) + j] = T[i][j];
  double a[3] = {o->gain * (c * g.x - s * g.y), o->gain * (s * g.x + c * g.y), 0};
  const double turned[3] = {-w * a[1], w * a[0], 0}, moved[3] = {-w * y[1], w * y[0], 0};
  for (int i = 0; i < 3; i++) {
    dfdt[i] = 0, dfdt[3 + i] = turned[i];
    for (int j = 0; j < 3; j++) dfdt[3 + i] -= T[i][j] * moved[j];
  }
  return GSL_SUCCESS;
}

bool fly_gsl(const course *c, const char *name, double tolerance, skf_vec3 *end, size_t *evaluations) {
  const gsl_odeiv2_step_type *type = strcmp(name, "gsl rkf45") == 0   ? gsl_odeiv2_step_rkf45
                                     : strcmp(name, "gsl rk8pd") == 0 ? gsl_odeiv2_step_rk8pd
                                     : strcmp(name, "gsl bsimp") == 0 ? gsl_odeiv2_step_bsimp
                                                                      : gsl_odeiv2_step_msadams;
  skf_vec3 x = c->start.position, v = c->start.velocity;
  double y[6] = {x.x, x.y, x.z, v.x, v.y, v.z}, t = 0, L = v3_norm(x), V = v3_norm(v);
  const double scale[6] = {L, L, L, V, V, V};
  task k = {c, 0};
  gsl_odeiv2_system system = {derivatives, jacobian, 6, &k};
  gsl_set_error_handler_off();
  gsl_odeiv2_driver *d =
      gsl_odeiv2_driver_alloc_scaled_new(&system, type, 1e-3 * L / V, tolerance, tolerance, 1, 0, scale);
  nb_require(d);
  gsl_odeiv2_driver_set_nmax(d, 100000);
  int status = gsl_odeiv2_driver_apply(d, &t, c->end, y);
  gsl_odeiv2_driver_free(d);
  *end = v3(y[0], y[1], y[2]), *evaluations = k.evaluations;
  return status == GSL_SUCCESS;
}
#else
bool fly_gsl(const course *c, const char *name, double tolerance, skf_vec3 *end, size_t *evaluations) { return false; }
#endif

/* One run; the time is the smallest of several for a short one. */
bool try(const course *c, const entrant *e, double tolerance, double step, result *r) {
  r->ms = INFINITY;
  double spent = 0;
  for (int i = 0; i < 5 && spent < 0.02; i++) {
    skf_vec3 end;
    size_t evaluations;
    skf_flight_report report;
    double before = seconds();
    bool done = e->gsl ? fly_gsl(c, e->name, tolerance, &end, &evaluations)
                       : fly(c, (skf_flight_options){.integrator = e->name, .tolerance = tolerance, .step = step}, &end,
                             &report);
    double took = seconds() - before;
    if (!done) return false;
    spent += took;
    r->ms = fmin(r->ms, 1e3 * took);
    r->evaluations = (double)(e->gsl ? evaluations : report.evaluations);
    r->error = fmax(separation(end, c->goal) / v3_norm(c->start.position), 1e-16);
  }
  return isfinite(r->error);
}

void measure(entrant *e, int which) {
  const course *c = courses + which;
  result *r = e->results[which];
  int *n = e->count + which;
  if (e->adaptive) {
    for (double digits = 3; digits < 15; digits += digits < 12 ? 1 : 0.5)
      if (try(c, e, pow(10, -digits), 0, r + *n) && r[*n].error < 1) ++*n;
    return;
  }
  for (double steps = 60; *n < RUNS; steps *= M_SQRT2) {
    if (!try(c, e, 0, c->end / ceil(steps), r + *n) || r[*n].error > 1) continue;
    ++*n;
    if (r[*n - 1].evaluations > 2e5 || r[*n - 1].error < 3 * c->certainty + 1e-13) break;
  }
}

// %% [markdown]
// Colours and marks: our adaptive ones thick, our fixed steps thin, GSL's dashed.

// %%
const double colors[12][4] = {{0.05, 0.32, 0.70, 1}, {0.85, 0.33, 0.05, 1}, {0.70, 0.05, 0.20, 1},
                              {0.42, 0.42, 0.45, 1}, {0.12, 0.60, 0.65, 1}, {0.25, 0.70, 0.35, 1},
                              {0.60, 0.45, 0.80, 1}, {0.60, 0.50, 0.10, 1}, {0.10, 0.45, 0.15, 1},
                              {0.80, 0.40, 0.65, 1}, {0.35, 0.15, 0.55, 1}, {0.1, 0.1, 0.1, 1}};
void enter(const char *name, int order, bool adaptive, bool gsl) {
  entrant *e = entrants + entrant_count;
  nb_require(entrant_count < MOST);
  const int corners[4] = {9, 4, 3, 4};
  int kind = entrant_count % 4;
  *e = (entrant){.name = name, .order = order, .adaptive = adaptive, .gsl = gsl};
  e->look = (look){.width = gsl ? 1.6 : adaptive ? 3 : 1.6, .radius = kind == 2 ? 6 : 4.5, .corners = corners[kind]};
  e->look.turn = kind == 1 ? M_PI / 4 : 0;
  e->look.dashed = gsl;
  memcpy(e->look.rgba, gsl ? ink : colors[entrant_count % 12], sizeof e->look.rgba);
  entrant_count++;
}

// %%
for (size_t i = 0; i < skf_integrator_count(); i++) {
  const skf_integrator_info *info = skf_integrator_get(i);
  enter(info->name, info->order, info->adaptive, false);
}
if (HAVE_GSL) {
  enter("gsl rkf45", 5, true, true);
  enter("gsl rk8pd", 8, true, true);
  enter("gsl bsimp", 0, true, true);
  enter("gsl msadams", 0, true, true);
} else {
  printf("GSL is not installed: its curves and rows are left out.\n");
}
for (int i = 0; i < entrant_count; i++)
  for (int k = 0; k < COURSES; k++) measure(entrants + i, k);

// %%
void draw_work(int which, const char *path) {
  skf_canvas *c = canvas(1300, 640);
  const axis error = {1e-16, 10, true}, evaluations = {50, 1e6, true}, ms = {1e-2, 1e3, true};
  char title[96];
  snprintf(title, sizeof title, "%s: error at the end against evaluations of the field", courses[which].name);
  axes left = axes_new(c, evaluations, error, (const double[]){90, 50, 560, 570}, title, "evaluations",
                       "distance from the reference, relative");
  axes right =
      axes_new(c, ms, error, (const double[]){640, 50, 1110, 570}, "against processor time", "milliseconds", "");
  for (int i = entrant_count; i-- > 0;) {
    const entrant *e = entrants + i;
    double x[2][RUNS], y[RUNS];
    for (int j = 0; j < e->count[which]; j++) {
      const result *r = e->results[which] + j;
      x[0][j] = r->evaluations, x[1][j] = r->ms, y[j] = r->error;
    }
    curve(&left, x[0], y, (size_t)e->count[which], &e->look);
    curve(&right, x[1], y, (size_t)e->count[which], &e->look);
  }
  for (int i = 0; i < entrant_count; i++) legend(c, 1132, 62 + 27 * i, &entrants[i].look, entrants[i].name);
  show(c, path);
}

// %%
draw_work(0, "work-donut.png");
draw_work(1, "work-cigar.png");
draw_work(2, "work-cross.png");

// %% [markdown]
// Straight lines are powers of the step: the steeper, the higher the order. Adaptive ones bend down where their
// tolerance ends and rounding begins.
//
// What an error costs, read off these curves: evaluations and milliseconds for 1e-6 and 1e-10.

// %%
/* By straight lines between runs in the logarithms; NAN when it is not reached. */
result cost_of(const entrant *e, int which, double error) {
  const result *r = e->results[which];
  for (int j = 1; j < e->count[which]; j++) {
    if (!(r[j].error <= error && r[j - 1].error > error)) continue;
    double share = log(r[j - 1].error / error) / log(r[j - 1].error / r[j].error);
    return (result){error, r[j - 1].evaluations * pow(r[j].evaluations / r[j - 1].evaluations, share),
                    r[j - 1].ms * pow(r[j].ms / r[j - 1].ms, share)};
  }
  return (result){NAN, NAN, NAN};
}
void write_cost(FILE *f, const entrant *e, int which, double error) {
  result r = cost_of(e, which, error);
  if (isnan(r.error))
    fprintf(f, " — |");
  else
    fprintf(f, " %.0f · %.2g ms |", r.evaluations, r.ms);
}
const entrant *named(const char *name) {
  for (int i = 0; i < entrant_count; i++)
    if (strcmp(entrants[i].name, name) == 0) return entrants + i;
  nb_fail("no integrator %s", name);
}

// %%
FILE *f = fopen("cost.md", "w");
nb_require(f);
fprintf(f, "| |");
for (int k = 0; k < COURSES; k++) fprintf(f, " %s 1e-6 | %s 1e-10 |", courses[k].name, courses[k].name);
fprintf(f, "\n|---|---|---|---|---|---|---|\n");
for (int i = 0; i < entrant_count; i++) {
  fprintf(f, "| %s |", entrants[i].name);
  for (int k = 0; k < COURSES; k++) write_cost(f, entrants + i, k, 1e-6), write_cost(f, entrants + i, k, 1e-10);
  fprintf(f, "\n");
}
nb_require(fclose(f) == 0);
nb_show("cost.md");

// %% [markdown]
// What is required of these figures, all of it in evaluations and errors, which do not depend on the machine:
//
// * at tolerance 1e-12 each adaptive integrator ends within 1e-11 of the reference;
// * fixed steps converge with their order: the middle one of the slopes between the runs whose errors are between 1e-2
//   and 1e-9 is no more than 0.2 below it;
// * rkn12 takes fewer evaluations to an error of 1e-10 than any other adaptive one, GSL's among them.

// %%
double middle_slope(const entrant *e, int which) {
  double slopes[RUNS];
  int n = 0;
  const result *r = e->results[which];
  for (int j = 1; j < e->count[which]; j++) {
    if (!(r[j - 1].error < 1e-2 && r[j].error > 1e-9)) continue;
    double slope = log(r[j - 1].error / r[j].error) / log(r[j].evaluations / r[j - 1].evaluations);
    int at = n++;
    for (; at > 0 && slopes[at - 1] > slope; at--) slopes[at] = slopes[at - 1];
    slopes[at] = slope;
  }
  return n ? slopes[n / 2] : NAN;
}
void require_error(const char *name, double tolerance, double most) {
  for (int k = 0; k < COURSES; k++) {
    result r;
    nb_require(try(courses + k, named(name), tolerance, 0, &r));
    printf("%-12s at %.0e on the %s: %.1e\n", name, tolerance, courses[k].name, r.error);
    nb_require(r.error < most);
  }
}

// %%
for (int i = 0; i < entrant_count; i++)
  if (entrants[i].adaptive && !entrants[i].gsl) require_error(entrants[i].name, 1e-12, 1e-11);

// %%
printf("%-12s %6s %8s %8s %8s   (measured orders)\n", "", "order", "donut", "cigar", "cross");
for (int i = 0; i < entrant_count; i++) {
  const entrant *e = entrants + i;
  if (e->adaptive) continue;
  printf("%-12s %6d", e->name, e->order);
  for (int k = 0; k < COURSES; k++) {
    double slope = middle_slope(e, k);
    printf(" %8.1f", slope);
    nb_require(slope > e->order - 0.2);
  }
  printf("\n");
}

// %%
for (int k = 0; k < COURSES; k++)
  for (int i = 0; i < entrant_count; i++) {
    double best = cost_of(named("rkn12"), k, 1e-10).evaluations, n = cost_of(entrants + i, k, 1e-10).evaluations;
    nb_require(!entrants[i].adaptive || !(n < best));
    if (entrants[i].adaptive && n > best)
      printf("%s: %s takes %.1f times the evaluations of rkn12 to 1e-10\n", courses[k].name, entrants[i].name,
             n / best);
  }

// %% [markdown]
// ## Energy in the long run
//
// One thousand turns around the cigar: the error of the energy relative to its scale, at the end of each turn's steps.
// Leapfrog is the coarsest and stays where it began; a Runge-Kutta pair at a moderate tolerance is more exact for long
// and loses energy all the time; gauss-radau at its finest makes a random walk of roundings.

// %%
enum { TURNS = 1000 };
typedef struct drift {
  const char *name;
  double tolerance, steps; /* a turn */
  double t[TURNS], error[TURNS];
  look look;
} drift;
drift drifts[4] = {{"leapfrog", 0, 100}, {"kahan-li8", 0, 16}, {"dop853", 1e-8, 0}, {"gauss-radau", 1e-12, 0}};

/* The largest error of the energy in each turn. */
void follow(const course *c, double turn, drift *d) {
  skf_flight *f;
  skf_flight_options how = {.integrator = d->name, .tolerance = d->tolerance, .step = d->steps ? turn / d->steps : 0};
  skf_invariants first = skf_world_invariants(c->world, &c->start);
  double from, to = 0;
  nb_require(skf_flight_new(c->world, &how, &c->start, &f) == SKF_OK);
  for (int i = 0; i < TURNS; i++) {
    d->t[i] = i + 1, d->error[i] = 1e-17;
    while (to < turn * (i + 1)) {
      skf_state s;
      nb_require(skf_flight_step(f, NULL, NULL) == SKF_OK);
      skf_flight_span(f, &from, &to);
      nb_require(skf_flight_at(f, to, &s) == SKF_OK);
      double e = skf_world_invariants(c->world, &s).energy - first.energy;
      d->error[i] = fmax(d->error[i], fabs(e) / first.scale);
    }
  }
  skf_flight_free(f);
}

// %%
for (int i = 0; i < 4; i++) {
  follow(courses + 1, 15500, drifts + i);
  drifts[i].look = named(drifts[i].name)->look, drifts[i].look.corners = 0, drifts[i].look.width = 2;
  printf("%-12s first ten turns %.1e, all %.1e\n", drifts[i].name, drifts[i].error[9], drifts[i].error[TURNS - 1]);
}
skf_canvas *c = canvas(1180, 560);
axes g = axes_new(c, (axis){1, TURNS, true}, (axis){1e-17, 1e-2, true}, (const double[]){100, 50, 880, 490},
                  "largest error of the energy in a turn", "turns", "relative error of the energy");
for (int i = 0; i < 4; i++) {
  curve(&g, drifts[i].t, drifts[i].error, TURNS, &drifts[i].look);
  char name[64];
  if (drifts[i].steps > 0)
    snprintf(name, sizeof name, "%s, %.0f steps a turn", drifts[i].name, drifts[i].steps);
  else
    snprintf(name, sizeof name, "%s, %.0e", drifts[i].name, drifts[i].tolerance);
  legend(c, 900, 62 + 27 * i, &drifts[i].look, name);
}
show(c, "energy.png");

// %% [markdown]
// # Contact
//
// ## Certified and fast
//
// The certified search passes a piece of the path only where bounds on the field keep the surface away from it, so it
// misses nothing. The fast one stops at eighths of a step and looks at their ends. How much does the fast one miss? A
// ball has a closed form: particles fly straight, in steps of length 1, past a ball of radius R, at distances between 0
// and 2 R from its centre. Those below R hit, at a time that Pythagoras knows.

// %%
enum { THROWS = 600, RADII = 13 };
typedef struct tally {
  double radius, hits, found[2],
      late[2]; /* certified, fast; late: error of the time, relative to the flight's length */
  int invented;
} tally;
tally balls[RADII];

/* First contact of a flight until t_end. */
bool lands(const skf_world *w, skf_flight_options how, skf_state start, double t_end, skf_contact *at) {
  skf_flight *f;
  double from, to = 0;
  bool touched = false;
  nb_require(skf_flight_new(w, &how, &start, &f) == SKF_OK);
  while (to < t_end && !touched) {
    nb_require(skf_flight_step(f, at, &touched) == SKF_OK);
    skf_flight_span(f, &from, &to);
  }
  skf_flight_free(f);
  return touched && at->t <= t_end;
}

void throw_at_ball(tally *n) {
  const skf_search searches[2] = {SKF_SEARCH_CERTIFIED, SKF_SEARCH_FAST};
  skf_element ball = {{.shape = SKF_POINT}, {SKF_INVERSE, 0}, 1};
  skf_field *field;
  skf_world *w;
  uint64_t seed = 11;
  nb_require(skf_field_new(&ball, 1, &field) == SKF_OK);
  nb_require(skf_world_new(&(skf_attractor){.field = field, .iso = 1 / n->radius}, 1, &w) == SKF_OK);
  for (int i = 0; i < THROWS; i++) {
    skf_vec3 along = rnd_unit(&seed), across = v3_unit(v3_cross(along, rnd_unit(&seed)));
    double miss = n->radius * rnd(&seed, 0, 2), far = rnd(&seed, 6, 7), deep = n->radius * n->radius - miss * miss;
    skf_state start = {0, v3_mad(v3_scale(miss, across), -far, along), along};
    n->hits += deep > 0;
    for (int k = 0; k < 2; k++) {
      skf_contact at;
      if (!lands(w, (skf_flight_options){.max_step = 1, .contact = SKF_CONTACT_STOP, .search = searches[k]}, start, 12,
                 &at))
        continue;
      n->found[k] += deep > 0, n->invented += !(deep > 0);
      if (deep > 0) n->late[k] = fmax(n->late[k], fabs(at.t - (far - sqrt(deep))) / far);
    }
  }
  skf_world_free(w), skf_field_free(field);
}

// %%
printf("%10s %6s %10s %6s   %s\n", "radius", "hits", "certified", "fast", "worst error of the time");
for (int i = 0; i < RADII; i++) {
  balls[i].radius = pow(10, -0.5 * i);
  throw_at_ball(balls + i);
  const tally *n = balls + i;
  printf("%10.2e %6.0f %10.0f %6.0f   %.1e %.1e\n", n->radius, n->hits, n->found[0], n->found[1], n->late[0],
         n->late[1]);
  nb_require(n->found[0] == n->hits && n->invented == 0 && n->late[0] < 1e-13);
}

// %%
skf_canvas *c = canvas(900, 460);
axes g = axes_new(c, (axis){1e-6, 1, true}, (axis){0, 1.1, false}, (const double[]){100, 50, 680, 390},
                  "share of the hits that are found", "radius of the ball / length of a step", "share found");
look looks[2] = {{{0.05, 0.32, 0.70, 1}, 2.5, 9, 0, 5}, {{0.85, 0.33, 0.05, 1}, 2.5, 4, M_PI / 4, 5}};
for (int k = 0; k < 2; k++) {
  double x[RADII], y[RADII];
  for (int i = 0; i < RADII; i++) x[i] = balls[i].radius, y[i] = balls[i].found[k] / balls[i].hits;
  curve(&g, x, y, RADII, looks + k);
  legend(c, 702, 62 + 27 * k, looks + k, k ? "fast" : "certified");
}
show(c, "balls.png");

// %% [markdown]
// ## What it costs, and how exact it is
//
// Some hundred particles thrown at each of three bodies, in all directions, on curved paths, with the default
// integrator at its default tolerance. The donut and the cross have their gravity, and the cross turns; the urchin's 60
// spines are needles. Times are those of the flights without contact, up to where they touch, and as multiples of it
// those of the same flights with the fast and with the certified search. The fast one is no faster where a bound on the
// field tells at once that a whole step, or an eighth, is far from the ground.
//
// Every landing must lie on the surface to rounding of F, and go inwards there; none may be inside at the end; and
// every tenth flight is looked at again by brute force, at 500 places of each step.

// %%
typedef struct arena {
  const char *name;
  const skf_world *world;
  double iso, far, aim, speed, time; /* from 0.6 to 1 of far, at a place in a cube, with 0.3 to 1 of speed */
  size_t throws, steps, hits[2], inside, missed, grazing, gone; /* hits: certified, fast */
  double ms[3], inward, depth[1000]; /* without contact, fast, certified; least speed; |F - iso| / iso */
} arena;
arena arenas[3];

skf_state thrown(const arena *a, uint64_t *seed) {
  skf_vec3 from = v3_scale(a->far * rnd(seed, 0.6, 1), rnd_unit(seed)), to = rnd_vec(seed, a->aim);
  return (skf_state){0, from, v3_scale(a->speed * rnd(seed, 0.3, 1), v3_unit(v3_sub(to, from)))};
}
double level(const arena *a, double t, skf_vec3 p) { return skf_world_level(a->world, 0, t, p) / a->iso; }

/* Whether the last step of a flight, up to t, has a place inside. */
bool dips(skf_flight *f, const arena *a, double t) {
  double from, to;
  skf_flight_span(f, &from, &to);
  to = fmin(to, t);
  for (int i = 1; i < 500; i++) {
    skf_state s;
    nb_require(skf_flight_at(f, from + (to - from) * i / 500, &s) == SKF_OK);
    if (level(a, s.t, s.position) > 1e-12) return true;
  }
  return false;
}

/* One flight up to `end` or its first contact; returns when that was. */
double throw_once(arena *a, skf_state start, skf_flight_options how, double end, bool first, bool brute) {
  skf_flight *f;
  skf_contact at;
  skf_state last;
  bool touched = false;
  double from, to = 0;
  nb_require(skf_flight_new(a->world, &how, &start, &f) == SKF_OK);
  while (to < end && !touched) {
    nb_require(skf_flight_step(f, &at, &touched) == SKF_OK);
    skf_flight_span(f, &from, &to);
    if (brute) a->missed += dips(f, a, touched ? at.t : end);
  }
  double stop = touched && at.t < end ? at.t : end;
  if (first) {
    nb_require(skf_flight_at(f, stop, &last) == SKF_OK);
    a->inside += level(a, stop, last.position) > 1e-12;
    skf_flight_report r = skf_flight_get_report(f);
    a->steps += r.steps, a->grazing += r.grazing;
    if (touched && at.t < end) {
      skf_vec3 speed = v3_sub(at.before, skf_world_surface_velocity(a->world, 0, at.position));
      a->inward = fmin(a->inward, -v3_dot(speed, at.normal) / v3_norm(speed));
      a->depth[a->hits[0]++] = fabs(level(a, at.t, at.position));
    }
  }
  skf_flight_free(f);
  return stop;
}

void throw_all(arena *a) {
  const skf_flight_options how[3] = {{.contact = SKF_CONTACT_NONE},
                                     {.contact = SKF_CONTACT_STOP, .search = SKF_SEARCH_FAST},
                                     {.contact = SKF_CONTACT_STOP, .search = SKF_SEARCH_CERTIFIED}};
  static double end[1000];
  for (int k = 0; k < 3; k++) a->ms[k] = INFINITY;
  a->inward = INFINITY;
  for (int run = 0; run < 3; run++)
    for (int k = 2; k >= 0; k--) {
      uint64_t seed = 5;
      double before = seconds();
      for (size_t i = 0; i < a->throws; i++) {
        skf_state s = thrown(a, &seed);
        if (level(a, 0, s.position) > 0) continue;
        double stop = throw_once(a, s, how[k], run || k < 2 ? end[i] : a->time, !run && k == 2, false);
        if (!run && k == 2) end[i] = stop;
      }
      if (run) a->ms[k] = fmin(a->ms[k], 1e3 * (seconds() - before));
    }
  uint64_t seed = 5;
  for (size_t i = 0; i < a->throws; i++) {
    skf_state s = thrown(a, &seed);
    if (level(a, 0, s.position) > 0) continue;
    a->gone++;
    double stop = throw_once(a, s, how[1], a->time, false, false);
    a->hits[1] += stop < a->time;
    if (i % 10 == 0) throw_once(a, s, how[2], a->time, false, true);
  }
}

// %%
enum { SPINES = 60 };
skf_element urchin[SPINES];
for (int i = 0; i < SPINES; i++) { /* 0.007 thick */
  double z = -1 + (i + 0.5) * 2.0 / SPINES, phi = 2.399963 * i, r = sqrt(1 - z * z);
  urchin[i] = (skf_element){
      {.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {r * cos(phi), r * sin(phi), z}}}, {SKF_CAUCHY, 100}, 1};
}
skf_field *needles;
skf_world *w;
nb_require(skf_field_new(urchin, SPINES, &needles) == SKF_OK);
nb_require(skf_world_new(&(skf_attractor){.field = needles, .iso = 0.01, .gain = 1e-3}, 1, &w) == SKF_OK);
arenas[0] = (arena){"donut", courses[0].world, 7.38278, 4e7, 2e7, 6000, 3e4, 400};
arenas[1] = (arena){"cross", courses[2].world, 6.64209, 4e7, 2e7, 5000, 3e4, 400};
arenas[2] = (arena){"urchin", w, 0.01, 4, 0.6, 1, 20, 100};
for (int k = 0; k < 3; k++) throw_all(arenas + k);

// %%
printf("%-8s %8s %8s | %9s %8s %10s | %8s %8s %8s | %8s %8s\n", "", "flights", "steps", "none [ms]", "fast",
       "certified", "landings", "(fast)", "grazing", "depth", "inward");
for (int k = 0; k < 3; k++) {
  arena *a = arenas + k;
  double deepest = 0;
  for (size_t i = 0; i < a->hits[0]; i++) deepest = fmax(deepest, a->depth[i]);
  printf("%-8s %8zu %8zu | %9.1f %8.2f %10.2f | %8zu %8zu %8zu | %8.1e %8.1e\n", a->name, a->gone, a->steps, a->ms[0],
         a->ms[1] / a->ms[0], a->ms[2] / a->ms[0], a->hits[0], a->hits[1], a->grazing, deepest, a->inward);
  nb_require(a->hits[0] > 20 && a->hits[1] <= a->hits[0]);
  nb_require(a->inside == 0 && a->missed == 0 && deepest < 1e-12 && a->inward > 0);
}

// %%
skf_canvas *c = canvas(900, 460);
axes g = axes_new(c, (axis){1e-17, 1e-12, true}, (axis){0, 1, false}, (const double[]){100, 50, 680, 390},
                  "how far landings are from the surface", "|F - iso| / iso", "share of the landings");
for (int k = 0; k < 3; k++) {
  arena *a = arenas + k;
  double x[200], y[200];
  for (int i = 0; i < 200; i++) {
    x[i] = 1e-17 * pow(1e5, i / 199.0), y[i] = 0;
    for (size_t j = 0; j < a->hits[0]; j++) y[i] += a->depth[j] <= x[i];
    y[i] /= (double)a->hits[0];
  }
  look l = {.width = 2.5};
  memcpy(l.rgba, colors[k], sizeof l.rgba);
  curve(&g, x, y, 200, &l);
  legend(c, 702, 62 + 27 * k, &l, a->name);
}
show(c, "depth.png");

// %% [markdown]
// ## Bouncing, and coming to rest
//
// A ball that is dropped from a height H onto a floor with restitution e bounces for ever, in a finite time: √(2H/g) (1
// + e) / (1 − e). The program follows the bounces until they are invisible, then the particle rests.

// %%
double gravity = 9.81;
skf_world *floor_world(double slope) { /* a floor z <= 0; gravity turned by the slope */
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, -1}, {0, 0, 1}}}, {SKF_CAUCHY, 1}, 1};
  skf_field *field;
  skf_world *w;
  nb_require(skf_field_new(&plane, 1, &field) == SKF_OK);
  skf_force weight = {.type = SKF_FORCE_PUSH, .push = {gravity * sin(slope), 0, -gravity * cos(slope)}};
  double iso = skf_field_at(field, v3(0, 0, 0), NULL);
  nb_require(skf_world_new_with(&(skf_attractor){.field = field, .iso = iso}, 1, &weight, 1, &w) == SKF_OK);
  return w; /* with the field, for as long as the notebook runs */
}

// %%
skf_world *floor = floor_world(0);
printf("restitution  bounces   rests after      closed form   difference\n");
for (double e = 0.2; e < 0.95; e += 0.15) {
  skf_flight *f;
  skf_contact at;
  skf_state start = {0, {0, 0, 1}, {0, 0, 0}};
  skf_flight_options how = {.contact = SKF_CONTACT_BOUNCE, .restitution = e};
  double from, to = 0, rest = NAN, want = sqrt(2 / gravity) * (1 + e) / (1 - e);
  int bounces = 0;
  nb_require(skf_flight_new(floor, &how, &start, &f) == SKF_OK);
  while (isnan(rest) && to < 2 * want) {
    bool touched;
    nb_require(skf_flight_step(f, &at, &touched) == SKF_OK);
    skf_flight_span(f, &from, &to);
    if (touched && at.outcome == SKF_OUTCOME_REST)
      rest = at.t;
    else
      bounces += touched;
  }
  printf("%11.2f %8d %13.9f %16.9f %12.1e\n", e, bounces, rest, want, rest / want - 1);
  nb_require(fabs(rest / want - 1) < 1e-2);
  skf_flight_free(f);
}

// %% [markdown]
// ## Sliding
//
// On a slope of 20° a particle that is let go slides if its friction μ is below tan 20° = 0.364, by ½ g (sin θ − μ cos
// θ) t²; and with a speed v uphill of more friction it stops after v² / 2g (μ cos θ + sin θ). In the program a slide is
// a row of hops, each a millionth of the body's size high, whose impulses carry the friction: the dots are what it
// does, the lines the closed form.

// %%
enum { INSTANTS = 25 };
typedef struct slide {
  double friction, speed, t[INSTANTS], s[INSTANTS], closed[INSTANTS];
} slide;
slide slides[6] = {{0, 0}, {0.1, 0}, {0.2, 0}, {0.3, 0}, {0.45, 3}, {0.6, 3}};

/* Along the slope, by the closed form: it slows down or speeds up until it stands. */
double slid(double slope, double friction, double speed, double t) {
  double a = gravity * (sin(slope) - friction * cos(slope));
  if (a < 0) t = fmin(t, -speed / a);
  return speed * t + 0.5 * a * t * t;
}

void follow_slide(skf_world *w, double slope, slide *n) {
  skf_flight *f;
  skf_state start = {0, {0, 0, 1e-9}, {n->speed, 0, 0}}, s;
  skf_flight_options how = {.contact = SKF_CONTACT_BOUNCE, .restitution = 0, .friction = n->friction};
  double from, to = 0;
  nb_require(skf_flight_new(w, &how, &start, &f) == SKF_OK);
  for (int i = 0; i < INSTANTS; i++) {
    double t = n->t[i] = 1.5 * i / (INSTANTS - 1);
    while (to < t) {
      nb_require(skf_flight_step(f, NULL, NULL) == SKF_OK);
      skf_flight_span(f, &from, &to);
    }
    nb_require(skf_flight_at(f, t, &s) == SKF_OK);
    n->s[i] = s.position.x, n->closed[i] = slid(slope, n->friction, n->speed, t);
  }
  skf_flight_free(f);
}

// %%
double slope = 20 * M_PI / 180;
skf_world *w = floor_world(slope);
skf_canvas *c = canvas(1000, 520);
axes g = axes_new(c, (axis){0, 1.5, false}, (axis){0, 4, false}, (const double[]){90, 50, 720, 450},
                  "sliding down a slope of 20 degrees", "time [s]", "way along the slope [m]");
for (int k = 0; k < 6; k++) {
  double worst = 0;
  slide *n = slides + k;
  follow_slide(w, slope, n);
  for (int i = 0; i < INSTANTS; i++) worst = fmax(worst, fabs(n->s[i] - n->closed[i]));
  look drawn = {.width = 1.6}, marks = {.corners = 9, .radius = 4};
  memcpy(drawn.rgba, colors[k], sizeof drawn.rgba), memcpy(marks.rgba, colors[k], sizeof marks.rgba);
  curve(&g, n->t, n->closed, INSTANTS, &drawn);
  curve(&g, n->t, n->s, INSTANTS, &marks);
  char name[64];
  snprintf(name, sizeof name, "friction %.2f, from %.0f m/s", n->friction, n->speed);
  legend(c, 745, 62 + 27 * k, &marks, name);
  printf("%s: at most %.1e m from the closed form\n", name, worst);
  nb_require(worst < 3e-3);
}
show(c, "slides.png");

// %% [markdown]
// ## Those that miss
//
// A flight also tells its closest approach to each body: where F is largest on its path, found by branch and bound, so
// that nothing between the steps is overlooked. Past a point mass G M = 1 Kepler's hyperbola has it in closed form:
// from the energy E and the angular momentum h, the eccentricity is e = √(1 + 2 E h²) and the distance r = h² / (1 +
// e).

// %%
double pericenter(const skf_state *s) {
  double E = 0.5 * v3_norm2(s->velocity) - 1 / v3_norm(s->position), h2 = v3_norm2(v3_cross(s->position, s->velocity));
  return h2 / (1 + sqrt(1 + 2 * E * h2));
}

// %%
skf_element mass = {{.shape = SKF_POINT}, {SKF_INVERSE, 0}, 1};
skf_field *field;
skf_world *w;
double worst = 0, nearest = INFINITY;
uint64_t seed = 3;
nb_require(skf_field_new(&mass, 1, &field) == SKF_OK);
nb_require(skf_world_new(&(skf_attractor){.field = field, .iso = 1e6, .gain = 1}, 1, &w) == SKF_OK);
for (int i = 0; i < 200; i++) {
  skf_vec3 along = rnd_unit(&seed), across = v3_unit(v3_cross(along, rnd_unit(&seed)));
  double miss = pow(10, rnd(&seed, -2, 1)), from, to = 0;
  skf_state start = {0, v3_mad(v3_scale(miss, across), -20, along), v3_scale(rnd(&seed, 1, 3), along)};
  skf_flight *f;
  skf_approach at;
  nb_require(skf_flight_new(w, &(skf_flight_options){.tolerance = 1e-14, .approach = true}, &start, &f) == SKF_OK);
  while (to < 40) {
    nb_require(skf_flight_step(f, NULL, NULL) == SKF_OK);
    skf_flight_span(f, &from, &to);
  }
  nb_require(skf_flight_approach(f, 0, &at) == SKF_OK);
  double want = pericenter(&start);
  nearest = fmin(nearest, want), worst = fmax(worst, fabs(v3_norm(at.position) - want));
  skf_flight_free(f);
}
printf("200 hyperbolas from a distance of 20; the nearest passes at %.1e; all are within %.1e of the closed form\n",
       nearest, worst);
nb_require(worst < 1e-13);

// %% [markdown]
// And the bow: it is closest, as the potential measures it, in the middle of the donut's hole.

// %%
enum { PLACES = 4000 };
double bow_t[PLACES + 1], bow_level[PLACES + 1];
skf_approach bow_nearest;
void watch_bow(const course *o) {
  skf_flight *f;
  double from, to = 0, end = 22156.628;
  nb_require(skf_flight_new(o->world, &(skf_flight_options){.approach = true}, &o->start, &f) == SKF_OK);
  for (int i = 0; i <= PLACES; i++) {
    skf_state s;
    double t = end * i / PLACES;
    for (; to < t; skf_flight_span(f, &from, &to)) nb_require(skf_flight_step(f, NULL, NULL) == SKF_OK);
    nb_require(skf_flight_at(f, t, &s) == SKF_OK);
    bow_t[i] = t / 3600, bow_level[i] = skf_world_level(o->world, 0, t, s.position);
  }
  nb_require(skf_flight_approach(f, 0, &bow_nearest) == SKF_OK);
  skf_flight_free(f);
}

// %%
watch_bow(courses);
double highest = -INFINITY;
for (int i = 0; i <= PLACES; i++) highest = fmax(highest, bow_level[i]);
printf("closest after %.3f s: F - iso = %.12g; at %d places of the path it is %.12g at most\n", bow_nearest.t,
       bow_nearest.level, PLACES, highest);
nb_require(bow_nearest.level > highest - 1e-14 * fabs(highest) && bow_nearest.level - highest < 1e-5);

// %%
skf_canvas *c = canvas(900, 460);
axes g = axes_new(c, (axis){0, 6.2, false}, (axis){-4, 0.5, false}, (const double[]){90, 50, 860, 390},
                  "the bow: F - iso along the path", "time [h]", "F - iso");
look path = {.width = 2, .rgba = {0.05, 0.32, 0.70, 1}},
     here = {.corners = 9, .radius = 6, .rgba = {0.85, 0.33, 0.05, 1}};
look ground = {.width = 1.6, .dashed = true, .rgba = {0.1, 0.1, 0.12, 1}};
double at = bow_nearest.t / 3600;
curve(&g, (const double[]){0, 6.2}, (const double[]){0, 0}, 2, &ground);
curve(&g, bow_t, bow_level, PLACES + 1, &path);
curve(&g, &at, &bow_nearest.level, 1, &here);
label(c, 100, pixel(&g.y, 0) - 14, 0, 15, ink, "ground");
label(c, pixel(&g.x, at) + 12, pixel(&g.y, bow_nearest.level) - 14, 0, 15, ink, "closest approach");
show(c, "bow.png");
