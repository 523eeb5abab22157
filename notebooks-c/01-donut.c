/* SPDX-License-Identifier: MIT */
/* The donut planet, explained and flown. notebooks-c/run executes this file and makes a page of it. */
// %% [markdown]
// # A planet with a hole
//
// Take a circle of mass and let it pull like Newton's gravity: every point of the circle adds 1/r to a field F, and the
// force is the field's gradient. Where F has one fixed value lies the ground, and because it is an equipotential, a
// stone on it stays where it is. That is a donut planet. This notebook reads one from `data/donut.yaml`, checks its
// gravity against what can be worked out by hand, and then flies through the hole.
//
// Every claim here is required: when one does not hold, the notebook fails.

// %%
#include "skelfield/skelfield.h"

skf_scene *scene;
skf_error problem;

// %%
if (skf_scene_read("data/donut.yaml", &scene, &problem)) nb_fail("line %ld: %s", problem.line, problem.text);
nb_run("skelfield info data/donut.yaml");

// %% [markdown]
// ## Gravity on the axis
//
// From a point on the axis, at height z, all of the circle is equally far away: √(R² + z²). So the potential is that of
// a single mass at that distance, U = −G M / √(R² + z²), and the pull along the axis is −G M z / (R² + z²)^(3/2):
// nothing in the middle, strongest at z = R/√2, and like any planet's from far away.

// %%
double R, GM;
skf_world *world;
double relative(double got, double want) { return fabs(got - want) / fabs(want); }

// %%
const skf_body *donut = scene->bodies;
R = donut->elements[0].primitive.arc.radius;
GM = scene->G * donut->mass;
skf_attractor pull = {.field = donut->field, .iso = donut->iso, .gain = scene->G * donut->rho};
nb_require(skf_world_new(&pull, 1, &world) == SKF_OK);

double worst = 0;
printf("   height [km]    potential [J/kg]   pull [m/s^2]\n");
for (int k = 0; k <= 60; k++) {
  double z = 1e4 * pow(10, k * 0.1), r = hypot(R, z);
  skf_vec3 a;
  double U = skf_world_at(world, 0, (skf_vec3){0, 0, z}, &a);
  worst = fmax(worst, fmax(relative(U, -GM / r), relative(a.z, -GM * z / (r * r * r))));
  if (k % 6 == 0) printf("%14.6g %19.12g %14.8g\n", z / 1000, U, a.z);
}
printf("largest relative difference from the closed form: %.1e\n", worst);
nb_require(worst < 1e-14);

// %% [markdown]
// ## Gravity off the axis
//
// Beside the axis, at a distance k from it and a height z, the potential of a circle is 2πR / AGM(p, q), where p and q
// are the least and the largest distance to the circle and AGM is the arithmetic-geometric mean of Gauss. It takes five
// lines:

// %%
double agm(double p, double q) {
  while (fabs(p - q) > 1e-15 * q) {
    double mean = (p + q) / 2;
    q = sqrt(p * q), p = mean;
  }
  return p;
}

// %%
double worst = 0;
for (int i = 0; i < 2000; i++) {
  double k = R * 3 * fmod(i * 0.6180339887498949, 1), z = R * 2 * (fmod(i * 0.7548776662466927, 1) - 0.5);
  double F = skf_field_at(scene->bodies->field, (skf_vec3){k * cos(i), k * sin(i), z}, NULL);
  worst = fmax(worst, relative(F, 2 * M_PI * R / agm(hypot(k - R, z), hypot(k + R, z))));
}
printf("largest relative difference at 2000 places: %.1e\n", worst);
nb_require(worst < 1e-13);

// %% [markdown]
// The potential in a plane through the axis. The white ring is the ground. Inside the hole there is a saddle: along the
// axis a traveller is pulled back to the middle, across it to the nearer ground.

// %%
nb_run("skelfield map data/donut.yaml -o potential.png --plane y=0 --quantity potential --size 1100x825");
nb_show("potential.png");

// %% [markdown]
// ## Where is the ground?
//
// Rays against the surface give every crossing, with a certificate that none was missed.

// %%
skf_tracer *ground;

// %%
const skf_body *donut = scene->bodies;
nb_require(skf_tracer_new(donut->field, donut->iso, &ground) == SKF_OK);
skf_ray_report report = {0};
skf_hit hits[8];
size_t count;
skf_ray across = {.origin = {-3e7, 0, 0}, .direction = {1, 0, 0}, .t_max = INFINITY};
nb_require(skf_tracer_all(ground, &across, 8, hits, &count, &report) == SKF_OK);
nb_require(count == 4);
for (size_t i = 0; i < count; i++) printf("%s at x = %.9g km\n", hits[i].entering ? "in " : "out", hits[i].at.x / 1000);
printf("the hole is %.9g km wide\n", (hits[2].at.x - hits[1].at.x) / 1000);

bool found;
skf_ray down = {.origin = {0, 0, 3e7}, .direction = {0, 0, -1}, .t_max = INFINITY};
nb_require(skf_tracer_first(ground, &down, hits, &found, &report) == SKF_OK);
nb_require(!found && report.grazing == 0);
printf("a stone down the axis meets no ground\n");

// %% [markdown]
// ## Down the hole
//
// Dropped from 20 000 km above the middle, a stone falls through and comes back. Energy alone gives the time that
// takes: T = 4 ∫ dz / √(2 (U(z₀) − U(z))), and with z = z₀ sin s
// a sum over equal steps of s converges at once.

// %%
double period(double z0) {
  int n = 200;
  double sum = 0;
  for (int i = 0; i < n; i++) {
    double z = z0 * sin(M_PI / 2 * (i + 0.5) / n), gain = 2 * GM * (1 / hypot(R, z) - 1 / hypot(R, z0));
    sum += sqrt((z0 - z) * (z0 + z) / gain);
  }
  return 4 * sum * M_PI / 2 / n;
}
skf_flight_report fly(skf_state start, double t_end, skf_state *end) {
  skf_flight_options options = {.tolerance = 1e-13, .contact = SKF_CONTACT_STOP};
  skf_flight *flight;
  double from, to = start.t;
  if (skf_flight_new(world, &options, &start, &flight)) nb_fail("the flight cannot start");
  while (to < t_end) {
    if (skf_flight_step(flight, NULL, NULL)) nb_fail("the flight broke off");
    skf_flight_span(flight, &from, &to);
  }
  if (skf_flight_at(flight, t_end, end)) nb_fail("no state at the end");
  skf_flight_report report = skf_flight_get_report(flight);
  skf_flight_free(flight);
  return report;
}

// %%
double z0 = 2e7, T = period(z0);
skf_state end;
skf_flight_report report = fly((skf_state){.position = {0, 0, z0}}, 10 * T, &end);
printf("one fall there and back takes %.6f s\n", T);
printf("after ten of them the stone is %.2g m below its start and moves with %.2g m/s\n", z0 - end.position.z,
       end.velocity.z);
printf("%zu steps, energy kept to %.1e, %zu contacts\n", report.steps, report.energy_drift, report.contacts);
nb_require(report.contacts == 0 && report.energy_drift < 1e-12);
nb_require(fabs(z0 - end.position.z) < 1e-9 * z0 && end.position.x == 0 && end.position.y == 0);

// %% [markdown]
// ## The bow
//
// A stranger orbit: it rises beside the planet, goes over the top, dives through the middle of the hole, rises on the
// other side, and does the same back. Four times from start to middle is one turn, 22 156.628 s. By symmetry it closes;
// its speed and its period, given here to ten digits, leave a third of a metre to each turn.

// %%
skf_state start = {.position = {1.8e7, 0, 0}, .velocity = {0, 0, 2180.766668}}, end;
for (int turn = 1; turn <= 3; turn++) {
  skf_flight_report report = fly(start, turn * 22156.628, &end);
  double miss = sqrt(pow(end.position.x - start.position.x, 2) + pow(end.position.z, 2));
  printf("after turn %d: %.3g m from the start, energy kept to %.1e\n", turn, miss, report.energy_drift);
  nb_require(report.contacts == 0 && report.energy_drift < 1e-12);
  nb_require(miss < 0.5 * turn);
}

// %% [markdown]
// ## Falling onto it
//
// The program flies all particles of the scene. A stone at rest hits the ground, and a stone that was thrown from the
// outer equator comes down again; the contact log has where, when and how fast.

// %%
nb_run("skelfield simulate data/donut.yaml -o run.csv --contacts contacts.csv");
nb_run("cut -d, -f1-6,13 contacts.csv");
nb_run("skelfield map data/donut.yaml -o orbits.png --plane y=0 --quantity acceleration --log --no-contours"
       " --colormap magma --extent=-2.7e7,2.7e7,-2.1e7,2.1e7 --orbits run.csv --contacts contacts.csv --size 1100x825");
nb_show("orbits.png");

// %% [markdown]
// ## A shape with a handle
//
// A mesh of the ground tells its topology: vertices − edges + triangles is 0, so the genus is 1, which is what a hole
// is.

// %%
skf_mesh mesh = {0};
skf_mesh_measure measure;
nb_require(skf_mesh_field(scene->bodies->field, scene->bodies->iso, NULL, &mesh, NULL) == SKF_OK);
nb_require(skf_mesh_measure_of(&mesh, &measure) == SKF_OK);
printf("%zu vertices, %zu edges, %zu triangles: Euler's number is %ld, the genus %ld\n", mesh.vertex_count,
       measure.edges, mesh.triangle_count, measure.euler, measure.genus);
printf("volume %.5g m^3, mean density %.4g kg/m^3\n", measure.volume, scene->bodies->mass / measure.volume);
nb_require(measure.closed &&measure.manifold &&measure.outward &&measure.components == 1 && measure.genus == 1);
nb_require(relative(measure.volume, 8.72497e20) < 5e-3); // by quadrature; the mesh lies inside
skf_mesh_free(&mesh);

// %%
nb_run("skelfield render data/donut.yaml -o snapshot.png --size 900x600");
nb_show("snapshot.png");
