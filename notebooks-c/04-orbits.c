/* SPDX-License-Identifier: MIT */
/* What each integrator's accuracy costs. notebooks-c/run executes this file. */
// %% [markdown]
// # Orbits
//
// Which integrator reaches which accuracy at which cost? This notebook measures it in this build, on the machine that
// runs it, on three worlds of `data/`: the donut, the cigar, and the cross, which turns. Every claim in a sentence is
// required: when it does not hold, the notebook fails. Times are only shown, since machines differ. What contact costs
// and finds is in `05-contact.c`.

// %%
#include "course.h"
#include "figure.h"
#if __has_include(<gsl/gsl_odeiv2.h>)
#define HAVE_GSL 1
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#else
#define HAVE_GSL 0
#endif

// %% [markdown]
// ## Three orbits
//
// They bend hard and none is chaotic. The donut's bow goes over the top of the ring and dives through its hole; the
// cigar's polar orbit passes low above both ends; above the cross the force itself turns.

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
