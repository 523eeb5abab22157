/* SPDX-License-Identifier: MIT */
/* Contacts on many flights: what the search costs, and whether it misses any. Takes the number of particles (default:
   2000; a tenth of them at the urchin), how often to time them (default: 3; 0: only the certified search, once) and a
   world (default: all). It prints, for each world, the time of the same flights without contact, with the fast and with
   the certified search (one thread, CPU time, minimum of the interleaved runs); how many touch; how many are inside at
   the end; the largest |F - iso| / iso and the smallest inward normal speed of all contacts; and, on a sample, how many
   contacts a search by brute force finds that the certified one does not, with 1000 places in each step. */
#include "core/vec3.h"
#include "random.h"
#include "skelfield/motion.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BRUTE = 1000, SPIKES = 60, SAMPLE = 1000 };

static size_t particles = 2000;
static int runs = 3;
static const char *only;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct tally {
  size_t steps, hits, inside, grazing, missed, late;
  double level, inward;
} tally;

typedef struct arena {
  const char *name;
  const skf_world *world;
  double iso, far, speed, time;
} arena;

static skf_state shot(const arena *a, uint64_t *seed) {
  skf_vec3 from = v3_scale(a->far * rnd(seed, 0.6, 1), rnd_unit(seed)), to = rnd_vec(seed, 0.5 * a->far);
  return (skf_state){0, from, v3_scale(a->speed * rnd(seed, 0.3, 1), v3_unit(v3_sub(to, from)))};
}

/* Whether the last step, up to t, has a place inside. */
static bool is_inside(skf_flight *f, const arena *a, double t) {
  double from, to;
  skf_flight_span(f, &from, &to);
  if (to > t) to = t;
  for (int i = 1; i < BRUTE; i++) {
    skf_state s;
    if (skf_flight_at(f, from + (to - from) * i / BRUTE, &s)) return false;
    if (skf_world_level(a->world, 0, s.t, s.position) > 1e-12 * a->iso) return true;
  }
  return false;
}

static void judge(const arena *a, const skf_contact *c, tally *n) {
  skf_vec3 v = v3_sub(c->before, skf_world_surface_velocity(a->world, c->body, c->position));
  n->hits++;
  n->level = fmax(n->level, fabs(skf_world_level(a->world, c->body, c->t, c->position)) / a->iso);
  n->inward = fmin(n->inward, -v3_dot(v, c->normal));
}

/* One flight to t = end; returns when it ended. */
static double fly(const arena *a, const skf_state *s, skf_flight_options o, double end, bool brute, tally *n) {
  skf_flight *f;
  double from, to = 0;
  skf_contact c;
  bool touched = false;
  if (skf_flight_new(a->world, &o, s, &f)) exit(1);
  while (to < end && !touched && !skf_flight_step(f, &c, &touched)) {
    skf_flight_span(f, &from, &to);
    if (touched) to = c.t;
    if (touched && n) judge(a, &c, n);
    if (brute && is_inside(f, a, touched ? c.t : end)) n->missed++;
  }
  skf_flight_report r = skf_flight_get_report(f);
  if (n) n->steps += r.steps, n->grazing += r.grazing;
  skf_state last;
  if (n && !skf_flight_at(f, touched ? c.t : end, &last))
    n->inside += skf_world_level(a->world, 0, last.t, last.position) > 1e-12 * a->iso;
  skf_flight_free(f);
  return touched ? c.t : end;
}

static void report(const arena *a, size_t count) {
  static const skf_flight_options how[] = {
      {.contact = SKF_CONTACT_NONE},
      {.contact = SKF_CONTACT_STOP, .search = SKF_SEARCH_FAST},
      {.contact = SKF_CONTACT_STOP, .search = SKF_SEARCH_CERTIFIED},
  };
  double best[3] = {INFINITY, INFINITY, INFINITY}, *end = calloc(count, sizeof *end);
  tally n[3] = {{.inward = INFINITY}, {.inward = INFINITY}, {.inward = INFINITY}}, brute = {.inward = INFINITY};
  for (int run = -1; run < runs; run++)
    for (int k = run < 0 ? 2 : 0; k < 3; k++) {
      uint64_t seed = 5;
      double start = now();
      for (size_t i = 0; i < count; i++) {
        skf_state s = shot(a, &seed);
        if (skf_world_level(a->world, 0, 0, s.position) > 0) continue;
        if (run < 0)
          end[i] = fly(a, &s, how[2], a->time, false, &n[2]);
        else
          fly(a, &s, how[k], end[i], false, run == 0 && k == 1 ? &n[1] : NULL);
      }
      if (run >= 0) best[k] = fmin(best[k], now() - start);
    }
  uint64_t seed = 5;
  size_t sample = count / 100 < SAMPLE ? count / 100 : SAMPLE;
  for (size_t i = 0; i < sample; i++) {
    skf_state s = shot(a, &seed);
    if (skf_world_level(a->world, 0, 0, s.position) > 0) continue;
    fly(a, &s, how[2], end[i], true, &brute);
  }
  printf(
      "%-8s %zu steps, %zu touch, %zu grazing, |F - iso| / iso <= %.1e, inward normal speed >= %.1e, %zu inside at the "
      "end; brute force on %zu: %zu missed\n",
      a->name, n[2].steps, n[2].hits, n[2].grazing, n[2].level, n[2].inward, n[2].inside, sample, brute.missed);
  if (runs > 0)
    printf("         none %7.1f ns a step, fast x %.2f (%zu touch), certified x %.2f\n",
           1e9 * best[0] / (double)n[2].steps, best[1] / best[0], n[1].hits, best[2] / best[0]);
  fflush(stdout);
  free(end);
}

static void arena_of(const char *name, const skf_element *e, size_t count, double iso, double gain, double far,
                     double speed, double time, size_t flights) {
  skf_field *field;
  skf_world *world;
  if (only && strcmp(only, name) != 0) return;
  if (skf_field_new(e, count, &field)) return;
  if (skf_world_new(&(skf_attractor){field, iso, gain, {{0, 0, 1}, {0, 0, 0}, 0}}, 1, &world)) return;
  report(&(arena){name, world, iso, far, speed, time}, flights);
  skf_world_free(world);
  skf_field_free(field);
}

int main(int argc, char **argv) {
  if (argc > 1) particles = (size_t)strtoul(argv[1], NULL, 10);
  if (argc > 2) runs = atoi(argv[2]);
  if (argc > 3) only = argv[3];
  skf_element ring = {{.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, 2 * SKF_PI}}, {SKF_INVERSE, 0}, 1};
  arena_of("donut", &ring, 1, 7.38278, 1, 4, 1.5, 20, particles);
  skf_element cross[2] = {{{.shape = SKF_SEGMENT, .segment = {{-2, 0, 0}, {2, 0, 0}}}, {SKF_CAUCHY, 3}, 1},
                          {{.shape = SKF_SEGMENT, .segment = {{0, -1.5, 0}, {0, 1.5, 0}}}, {SKF_CAUCHY, 3}, 1}};
  arena_of("cross", cross, 2, 0.1, 1, 4, 1, 20, particles);
  skf_element urchin[SPIKES];
  for (int i = 0; i < SPIKES; i++) { /* spikes 0.007 thick, steps of about 1 */
    double z = -1 + (i + 0.5) * 2.0 / SPIKES, phi = 2.399963 * i, r = sqrt(1 - z * z);
    urchin[i] = (skf_element){
        {.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {r * cos(phi), r * sin(phi), z}}}, {SKF_CAUCHY, 100}, 1};
  }
  arena_of("urchin", urchin, SPIKES, 0.01, 1, 4, 1, 20, particles / 10);
  return 0;
}
