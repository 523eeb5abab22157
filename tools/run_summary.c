/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_summary.h"
#include <float.h>
#include <math.h>

/* The worst particle of a drift. */
typedef struct worst {
  double drift;
  size_t particle;
} worst;

typedef struct total {
  size_t steps, rejected, evaluations, grazing, joins;
  worst energy, jacobi, momentum;
} total;

static void take(worst *w, double drift, size_t i) {
  if (!isnan(drift) && !(drift <= w->drift)) *w = (worst){drift, i};
}

static total add(const skf_scene *scene, const skf_flight_report *r) {
  total t = {.energy = {NAN, 0}, .jacobi = {NAN, 0}, .momentum = {NAN, 0}};
  for (size_t i = 0; i < scene->particle_count; i++) {
    t.steps += r[i].steps;
    t.rejected += r[i].rejected;
    t.evaluations += r[i].evaluations;
    t.grazing += r[i].grazing;
    t.joins += r[i].joins;
    take(&t.energy, r[i].energy_drift, i);
    take(&t.jacobi, r[i].jacobi_drift, i);
    take(&t.momentum, r[i].momentum_drift, i);
  }
  return t;
}

/* What the tolerance promises after so many steps: each may be off by it, and rounding walks at random. */
static double promise(const skf_scene *scene, const skf_flight_report *r) {
  double n = (double)r->steps;
  return n * scene->simulation.tolerance + 64 * DBL_EPSILON * sqrt(n + 1);
}

static bool together(const skf_scene *scene) {
  for (size_t i = 0; i < scene->particle_count; i++)
    if (scene->particles[i].mass != 0) return true;
  return false;
}

static void tell(const skf_scene *scene, const skf_flight_report *r, const char *what, const worst *w) {
  if (isnan(w->drift)) return;
  const char *name = scene->particles[w->particle].name;
  if (together(scene))
    cli_say("  %s of all particles with a mass together kept to %.2g", what, w->drift);
  else
    cli_say("  %s kept to %.2g%s%s%s", what, w->drift, w->drift > 0 ? " (worst: " : "", w->drift > 0 ? name : "",
            w->drift > 0 ? ")" : "");
  bool promised = skf_integrator_find(scene->simulation.integrator)->adaptive; /* else it oscillates with the step */
  if (promised && w->drift > promise(scene, r + w->particle))
    cli_say("skelfield: warning: the drift of %s of particle '%s', %.2g, is more than the tolerance promises, %.2g",
            what, name, w->drift, promise(scene, r + w->particle));
}

static void tell_json(const run_summary *sum, const skf_scene *scene, const total *t) {
  cli_json j = {.file = stdout};
  json_open(&j, NULL, '{');
  json_integer(&j, "particles", (long)scene->particle_count);
  json_integer(&j, "rows", (long)sum->rows);
  json_number(&j, "t", sum->t);
  json_string(&j, "integrator", skf_integrator_find(scene->simulation.integrator)->name);
  if (scene->simulation.step > 0)
    json_number(&j, "step", scene->simulation.step);
  else
    json_number(&j, "tolerance", scene->simulation.tolerance);
  json_integer(&j, "steps", (long)t->steps);
  json_integer(&j, "refused_steps", (long)t->rejected);
  json_integer(&j, "evaluations", (long)t->evaluations);
  json_integer(&j, "contacts", (long)sum->contacts);
  json_integer(&j, "grazing", (long)t->grazing);
  json_integer(&j, "steps_over_joins", (long)t->joins);
  json_number(&j, "energy_drift", t->energy.drift);
  json_number(&j, "jacobi_drift", t->jacobi.drift);
  json_number(&j, "axial_momentum_drift", t->momentum.drift);
  json_close(&j, '}');
}

void run_summary_tell(const run_summary *sum, const skf_scene *scene, const skf_flight_report *reports, bool json) {
  total t = add(scene, reports);
  const skf_simulation *sim = &scene->simulation;
  cli_say("%zu particle%s to t = %.9g in %zu rows (%s, %s %.3g)", scene->particle_count,
          scene->particle_count == 1 ? "" : "s", sum->t, sum->rows, skf_integrator_find(sim->integrator)->name,
          sim->step > 0 ? "step" : "tolerance", sim->step > 0 ? sim->step : sim->tolerance);
  cli_say("  %zu steps (%zu refused), %zu force evaluations, %zu contact%s", t.steps, t.rejected, t.evaluations,
          sum->contacts, sum->contacts == 1 ? "" : "s");
  tell(scene, reports, "energy", &t.energy);
  tell(scene, reports, "Jacobi constant", &t.jacobi);
  tell(scene, reports, "angular momentum about the axis", &t.momentum);
  if (t.grazing)
    cli_say("  %zu piece%s of path graze%s a surface too closely to decide, taken as a miss", t.grazing,
            t.grazing == 1 ? "" : "s", t.grazing == 1 ? "s" : "");
  if (t.joins)
    cli_say(
        "skelfield: warning: %zu step%s of one length pass%s over joins, where kernels end: the order of %s is lost "
        "there",
        t.joins, t.joins == 1 ? "" : "s", t.joins == 1 ? "es" : "", skf_integrator_find(sim->integrator)->name);
  if (json) tell_json(sum, scene, &t);
}
