/* SPDX-License-Identifier: MIT */
/* What contact costs and finds. notebooks-c/run executes this file. */
// %% [markdown]
// # Contact
//
// When a particle meets a surface, is the contact found, is it exact, and what does looking for it cost? This notebook
// measures it in this build, on the machine that runs it. Every claim in a sentence is required: when it does not hold,
// the notebook fails. Times are only shown, since machines differ.

// %%
#include "course.h"
#include "figure.h"
#include "random.h"

// %%
for (int i = 0; i < COURSES; i++) read_course(courses + i);

// %% [markdown]
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
