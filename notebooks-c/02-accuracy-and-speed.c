/* SPDX-License-Identifier: MIT */
/* How exact and how fast the fields are, pair by pair. notebooks-c/run executes this file and makes a page of it. */
// %% [markdown]
// # How exact, how fast
//
// Every kernel on every primitive has a closed form or an expansion with a bound, for the field, its gradient and its
// Hessian. This notebook measures all of them in this build, on the machine that runs it: the error against an oracle
// that shares nothing but the divergence theorem with the library, region by region, and the time of an evaluation. The
// places are drawn with a fixed seed. What is claimed is required: when a pair misses its target, the notebook fails.
//
// The oracle (`tests/field/oracle.h`) integrates the kernel and its derivatives over the primitive with 113-bit numbers
// and Gauss rules that are graded towards every singularity. It takes a millisecond for each place, and it agrees with
// independent 40-digit values to the last digit of a double.
//
// Errors are relative: of F to |F|, of the gradient to the larger of |∇F| and |F| / L, of the Hessian to the larger of
// its norm and |F| / L², with L the larger of the primitive's size and its distance. Where eight units in the last
// place of the point's own coordinates (or two of π in an arc's sweep) move the field by more than the target, no
// formula can do better, and that movement is the target: such places are counted, and they are left out of the worst
// errors.

// %%
#include "field/cases.h"
#include "figure.h"
#include <time.h>

enum { PER_REGION = 24 };
typedef struct pair_errors {
  field_error worst[CASE_REGIONS], all;
  int places, limited;
} pair_errors;
pair_errors measured[SKF_KERNEL_COUNT][SKF_SHAPE_COUNT];
const field_error target = {1e-12, 1e-11, 1e-10};

bool within(field_error e, field_error limit) { return e.F <= limit.F && e.g <= limit.g && e.h <= limit.h; }
field_error larger(field_error a, field_error b) {
  return (field_error){fmax(a.F, b.F), fmax(a.g, b.g), fmax(a.h, b.h)};
}
const char *kernel_name(int k) { return skf_kernel_get((skf_kernel_type)k)->name; }
const char *shape_name(int s) { return skf_shape_get((skf_shape)s)->name; }

/* The vector form where there is one: places come in batches. */
field_result evaluate(const skf_field *f, skf_vec3 x) {
  double p[3][4], F[4], g[3][4], h[6][4];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++) p[i][j] = v3_get(x, i);
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {g[0], g[1], g[2]}, *const out6[6] = {h[0], h[1], h[2], h[3], h[4], h[5]};
  nb_require(skf_field_eval(f, 4, in, F, out, out6) == SKF_OK);
  field_result r = {.F = F[1]};
  for (int i = 0; i < 3; i++) r.g[i] = g[i][1];
  for (int i = 0; i < 6; i++) r.h[i] = h[i][1];
  return r;
}
void measure(const field_case *c, case_region r, pair_errors *to) {
  skf_field *f;
  nb_require(skf_field_new(&c->element, 1, &f) == SKF_OK);
  field_result got = evaluate(f, c->x);
  skf_field_free(f);
  oracle_value want = oracle(&c->element, c->x);
  if (!(fabsq(want.F) > 1e-280Q)) return;
  field_error e = case_error(c, &want, &got);
  to->places++;
  if (within(e, target)) {
    to->worst[r] = larger(to->worst[r], e);
    to->all = larger(to->all, e);
    return;
  }
  to->limited++;
  if (!within(e, larger(target, case_moves(c, &want, oracle))))
    nb_fail("%s %s %s: errors %.1e %.1e %.1e", kernel_name(c->element.kernel.type),
            shape_name(c->element.primitive.shape), case_region_name[r], e.F, e.g, e.h);
}

// %%
uint64_t seed = 20261127;
int places = 0;
for (int k = 0; k < SKF_KERNEL_COUNT; k++)
  for (int s = 0; s < SKF_SOLID; s++)
    for (int i = 0; i < PER_REGION * CASE_REGIONS; i++) {
      field_case c;
      case_region r = (case_region)(i % CASE_REGIONS);
      if (r == CASE_RIM && !skf_kernel_get((skf_kernel_type)k)->compact) continue;
      if (case_draw(&seed, (skf_kernel_type)k, (skf_shape)s, r, &c)) measure(&c, r, &measured[k][s]);
    }
printf("%-16s %-9s %9s %9s %9s %8s %8s\n", "", "", "F", "gradient", "Hessian", "places", "limited");
for (int k = 0; k < SKF_KERNEL_COUNT; k++)
  for (int s = 0; s < SKF_SOLID; s++) {
    const pair_errors *m = &measured[k][s];
    printf("%-16s %-9s %9.1e %9.1e %9.1e %8d %8d\n", kernel_name(k), shape_name(s), m->all.F, m->all.g, m->all.h,
           m->places, m->limited);
    nb_require(m->places > PER_REGION);
    places += m->places;
  }
printf("%d places, every one within 1e-12 in F, 1e-11 in the gradient, 1e-10 in the Hessian, or what eight ulps move\n",
       places);

// %% [markdown]
// ## Where the errors are
//
// The worst error of F by pair and region, as a power of ten. The regions: at 1e-9 to 0.1 sizes from the body; the same
// from a segment's or arc's end, or a triangle's edge or corner; on an axis, an extension line or in the plane; at 0.1
// to 10 sizes; at 10 to a million sizes; just within the end of a finite support. In all of them sizes go from 1e-7 to
// 1e7, coordinates are up to a million sizes from the origin, kernels from 1e-4 of the body to 1e4 of it, slivers down
// to 1e-6, arcs from a millionth of a turn to a billionth less than a full one.

// %%
skf_canvas *c = canvas(1100, 980);
unsigned char rgb[256][3];
nb_require(plot->colormap("viridis", rgb));
const double left = 260, top = 60, wide = 130, tall = 25;
for (int r = 0; r < CASE_REGIONS; r++) label(c, left + (r + 0.5) * wide, top - 22, 0.5, 17, ink, case_region_name[r]);
for (int k = 0, row = 0; k < SKF_KERNEL_COUNT; k++)
  for (int s = 0; s < SKF_SOLID; s++, row++) {
    double y = top + row * tall + 4 * k;
    char text[64];
    snprintf(text, sizeof text, "%s %s", kernel_name(k), shape_name(s));
    label(c, left - 12, y + tall / 2, 1, 16, ink, text);
    for (int r = 0; r < CASE_REGIONS; r++) {
      double e = measured[k][s].worst[r].F, digits = e > 0 ? log10(e) : -17, x = left + r * wide;
      if (e == 0) { /* not there: rims are for finite supports */
        box(c, x, y, x + wide - 2, y + tall - 2, faint);
        continue;
      }
      const unsigned char *at = rgb[(int)(255 * fmin(1, fmax(0, (digits + 16.5) / 4.5)))];
      box(c, x, y, x + wide - 2, y + tall - 2, (const double[4]){at[0] / 255., at[1] / 255., at[2] / 255., 1});
      snprintf(text, sizeof text, "%.1f", digits);
      label(c, x + wide / 2, y + tall / 2, 0.5, 15, digits > -14 ? ink : paper, text);
    }
  }
show(c, "errors.png");

// %% [markdown]
// ## What the textbook's formulas give
//
// The same segments with the formulas that everyone writes first: the difference of two logarithms for 1/r, the
// difference of two error functions for a Gaussian, two arc tangents for a Cauchy kernel, all correct on paper.

// %%
double textbook(int kernel, double s, const skf_segment *g, skf_vec3 x) {
  skf_vec3 e = v3_sub(g->to, g->from), d = v3_sub(x, g->from);
  double L = v3_norm(e), t = v3_dot(d, e) / L, h2 = v3_norm2(d) - t * t, u = t, v = t - L;
  if (kernel == SKF_INVERSE) return log(u + sqrt(u * u + h2)) - log(v + sqrt(v * v + h2));
  if (kernel == SKF_GAUSSIAN) return exp(-s * s * h2) * sqrt(M_PI) / (2 * s) * (erf(s * u) - erf(s * v));
  double P2 = 1 + s * s * h2, P = sqrt(P2);
  return (u / (P2 + s * s * u * u) - v / (P2 + s * s * v * v)) / (2 * P2) +
         (atan(s * u / P) - atan(s * v / P)) / (2 * s * P2 * P);
}

// %%
const int kernels[3] = {SKF_INVERSE, SKF_GAUSSIAN, SKF_CAUCHY};
uint64_t seed = 271;
printf("%-10s %-14s %14s %14s %12s   (relative error of F)\n", "segment", "", "worst textbook", "median", "worst here");
for (int i = 0; i < 3; i++)
  for (int r = 0; r < CASE_RIM; r++) {
    double errors[400], ours = 0, kept = 0;
    int n = 0;
    while (n < 400) {
      field_case c;
      if (!case_draw(&seed, (skf_kernel_type)kernels[i], SKF_SEGMENT, (case_region)r, &c)) continue;
      skf_field *f;
      nb_require(skf_field_new(&c.element, 1, &f) == SKF_OK);
      double F = skf_field_at(f, c.x, NULL), want = (double)oracle(&c.element, c.x).F;
      skf_field_free(f);
      if (!(want > 1e-280)) continue;
      double e = fabs(textbook(kernels[i], c.element.kernel.param, &c.element.primitive.segment, c.x) - want) / want;
      ours = fmax(ours, fabs(F - want) / want);
      int at = n++;
      if (!(e < INFINITY)) e = INFINITY;
      for (; at > 0 && errors[at - 1] > e; at--) errors[at] = errors[at - 1];
      errors[at] = e;
    }
    printf("%-10s %-14s %14.1e %14.1e %12.1e\n", kernel_name(kernels[i]), case_region_name[r], errors[399], errors[200],
           ours);
    nb_require(ours < 1e-12);
  }

// %% [markdown]
// Others switch to quadrature away from the body. KEMField of the KATRIN experiment integrates a charged wire with 16
// nodes beyond 2 of its lengths and with 4 nodes beyond 27.7 (recorded from its source, 2026). Such a switch is as good
// as a form that needs none, if it comes where this one does:

// %%
double quadrature(const skf_segment *g, skf_vec3 x, int n) { /* Gauss-Legendre, its nodes by Newton's method */
  double sum = 0;
  for (int i = 0; i < n; i++) {
    double t = cos(M_PI * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int pass = 0; pass < 8; pass++) {
      double p0 = 1, p1 = t;
      for (int k = 2; k <= n; k++) {
        double p2 = ((2 * k - 1) * t * p1 - (k - 1) * p0) / k;
        p0 = p1, p1 = p2;
      }
      slope = n * (t * p1 - p0) / (t * t - 1);
      t -= p1 / slope;
    }
    skf_vec3 q = v3_mad(g->from, 0.5 * (1 + t), v3_sub(g->to, g->from));
    sum += v3_dist(g->from, g->to) / ((1 - t * t) * slope * slope) / v3_dist(x, q);
  }
  return sum;
}

// %%
const double beyond[4] = {2, 5, 27.7, 100};
uint64_t seed = 16;
for (int i = 0; i < 4; i++) {
  double rule = 0, ours = 0;
  for (int j = 0; j < 300; j++) {
    skf_element e = {.kernel.type = SKF_INVERSE, .strength = 1};
    e.primitive = (skf_primitive){.shape = SKF_SEGMENT, .segment = {v3(0, 0, 0), rnd_unit(&seed)}};
    skf_vec3 x = v3_mad(skf_primitive_point(&e.primitive, 0.5, 0), beyond[i], rnd_unit(&seed));
    skf_field *f;
    nb_require(skf_field_new(&e, 1, &f) == SKF_OK);
    double want = (double)oracle(&e, x).F;
    rule = fmax(rule, fabs(quadrature(&e.primitive.segment, x, beyond[i] < 27 ? 16 : 4) - want) / want);
    ours = fmax(ours, fabs(skf_field_at(f, x, NULL) - want) / want);
    skf_field_free(f);
  }
  printf("at %5.1f lengths: %2d nodes %.1e, here %.1e\n", beyond[i], beyond[i] < 27 ? 16 : 4, rule, ours);
  nb_require(ours < 1e-15);
}

// %% [markdown]
// ## How long an evaluation takes
//
// Nanoseconds for F with its gradient, on one core, at 2000 places in a box of four sizes around a primitive of size 1
// with a kernel as wide as it: the closed form at one point after the other, a batch in vectors where the processor has
// them, and a batch in floats for pictures. Also F, gradient and Hessian at one point. Smallest of several interleaved
// runs, in this process's own processor time; a busy machine still makes figures of ten per cent more.

// %%
enum { POINTS = 2000, RUNS = 9 };
typedef struct pair_times {
  double one, batch, floats, tensor;
} pair_times;
pair_times taken[SKF_KERNEL_COUNT][SKF_SHAPE_COUNT];
double px[3][POINTS], pF[POINTS], pg[3][POINTS];
float fx[3][POINTS], fF[POINTS], fg[3][POINTS];

double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
skf_field *typical(int k, int s) {
  const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)k);
  skf_element e = {.kernel = {(skf_kernel_type)k, info->compact ? 2 : info->param ? 1 : 0}, .strength = 1};
  skf_primitive *p = &e.primitive;
  p->shape = (skf_shape)s;
  if (s == SKF_POINT) p->point.at = v3(0.1, 0, 0.2);
  if (s == SKF_SEGMENT) p->segment = (skf_segment){v3(-0.5, 0.1, 0), v3(0.45, -0.1, 0.2)};
  if (s == SKF_ARC) p->arc = (skf_arc){v3(0, 0, 0.1), v3(0.1, 0.2, 1), v3(1, 0, 0), 0.5, 4};
  if (s == SKF_TRIANGLE) p->triangle = (skf_triangle){{v3(-0.5, -0.3, 0), v3(0.5, -0.2, 0.1), v3(0, 0.6, -0.1)}};
  if (s == SKF_PLANE) p->plane = (skf_plane){v3(0, 0, 0.1), v3(0.1, 0.3, 1)};
  skf_field *f;
  nb_require(skf_field_new(&e, 1, &f) == SKF_OK);
  return f;
}
double one_by_one(const skf_field *f, bool tensor) {
  double start = seconds(), h[6];
  skf_vec3 g;
  for (int i = 0; i < POINTS; i++) {
    skf_vec3 x = {px[0][i], px[1][i], px[2][i]};
    pF[i] = tensor ? skf_field_tensor_at(f, x, &g, h) : skf_field_at(f, x, &g);
  }
  return (seconds() - start) / POINTS;
}
double in_batch(const skf_field *f) {
  const double *const in[3] = {px[0], px[1], px[2]};
  double *const out[3] = {pg[0], pg[1], pg[2]}, start = seconds();
  nb_require(skf_field_eval(f, POINTS, in, pF, out, NULL) == SKF_OK);
  return (seconds() - start) / POINTS;
}
double in_floats(const skf_field_f32 *f) {
  const float *const in[3] = {fx[0], fx[1], fx[2]};
  float *const out[3] = {fg[0], fg[1], fg[2]};
  double start = seconds();
  nb_require(skf_field_f32_eval(f, POINTS, in, fF, out) == SKF_OK);
  return (seconds() - start) / POINTS;
}

// %%
uint64_t seed = 5;
for (int i = 0; i < POINTS; i++)
  for (int k = 0; k < 3; k++) fx[k][i] = (float)(px[k][i] = rnd(&seed, -2, 2));
for (int k = 0; k < SKF_KERNEL_COUNT; k++)
  for (int s = 0; s < SKF_SOLID; s++) {
    pair_times t = {1, 1, 1, 1};
    skf_field *f = typical(k, s);
    skf_field_f32 *f32;
    nb_require(skf_field_f32_new(f, v3(0, 0, 0), 1, &f32) == SKF_OK);
    for (int run = 0; run < RUNS; run++) {
      t.one = fmin(t.one, one_by_one(f, false));
      t.batch = fmin(t.batch, in_batch(f));
      t.floats = fmin(t.floats, in_floats(f32));
      t.tensor = fmin(t.tensor, one_by_one(f, true));
    }
    skf_field_f32_free(f32);
    skf_field_free(f);
    taken[k][s] = t;
  }
printf("%-16s %-9s %11s %11s %8s %11s %14s   [ns]\n", "", "", "one point", "batch", "ratio", "floats", "with Hessian");
for (int k = 0; k < SKF_KERNEL_COUNT; k++)
  for (int s = 0; s < SKF_SOLID; s++) {
    pair_times t = taken[k][s];
    printf("%-16s %-9s %11.1f %11.2f %8.1f %11.2f %14.1f\n", kernel_name(k), shape_name(s), 1e9 * t.one, 1e9 * t.batch,
           t.one / t.batch, 1e9 * t.floats, 1e9 * t.tensor);
  }

// %%
void tick(skf_canvas *c, double x, double y0, double y1, const char *text) {
  plot->stroke(c, (const double[][2]){{x, y0}, {x, y1}}, 2, false, 1, faint);
  label(c, x, y0 - 14, 0.5, 16, ink, text);
}

// %%
skf_canvas *c = canvas(1100, 1000);
const double left = 260, right = 1060, top = 70, tall = 25, bottom = top + 35 * tall + 24;
const double pale[4] = {0.62, 0.74, 0.88, 1}, dark[4] = {0.12, 0.32, 0.6, 1};
const char *ticks[5] = {"1 ns", "10 ns", "100 ns", "1 µs", "10 µs"};
for (int i = 0; i < 5; i++) tick(c, left + (right - left) * (i + 0.3) / 4.3, top, bottom, ticks[i]);
label(c, left, 24, 0, 17, ink, "F and gradient: one point (light) and a batch (dark), shorter is faster");
for (int k = 0, row = 0; k < SKF_KERNEL_COUNT; k++)
  for (int s = 0; s < SKF_SOLID; s++, row++) {
    double y = top + row * tall + 4 * k, ns[2] = {1e9 * taken[k][s].one, 1e9 * taken[k][s].batch};
    char text[64];
    snprintf(text, sizeof text, "%s %s", kernel_name(k), shape_name(s));
    label(c, left - 12, y + tall / 2, 1, 16, ink, text);
    for (int i = 0; i < 2; i++) {
      double end = left + (right - left) * fmin(1, fmax(0, (log10(ns[i]) + 0.3) / 4.3));
      box(c, left, y + 3 + 5 * i, end, y + tall - 5 - 5 * i, i ? dark : pale);
    }
  }
show(c, "times.png");

// %% [markdown]
// ## The cost where it is hard
//
// The switches of the closed forms: the slowest of the places that the errors above were measured at, one point at a
// time, for each pair. Slivers and finite supports that cut them are what costs most.

// %%
uint64_t seed = 77;
for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
  printf("%-16s", kernel_name(k));
  for (int s = 0; s < SKF_PLANE; s++) {
    double slowest = 0;
    for (int i = 0; i < 40 * CASE_REGIONS; i++) {
      field_case c;
      skf_field *f;
      skf_vec3 g;
      if (!case_draw(&seed, (skf_kernel_type)k, (skf_shape)s, (case_region)(i % CASE_REGIONS), &c)) continue;
      nb_require(skf_field_new(&c.element, 1, &f) == SKF_OK);
      double best = 1;
      for (int run = 0; run < 3; run++) {
        double start = seconds();
        for (int j = 0; j < 10; j++) skf_field_at(f, c.x, &g);
        best = fmin(best, (seconds() - start) / 10);
      }
      skf_field_free(f);
      slowest = fmax(slowest, best);
    }
    printf(" %10s %8.2f", shape_name(s), 1e6 * slowest);
  }
  printf("   [us]\n");
}

// %% [markdown]
// ## Beside others
//
// Recorded on one machine (AMD EPYC, Zen 3, two cores, AVX2, glibc 2.36, gcc 12), not measured by this notebook; the
// benchmarks of `meson test --benchmark` measure ours beside glibc's and SLEEF's vector functions in one run.

// %%
const char *const peers[][4] = {
    {"who", "what", "figure", "from"},
    {"---", "---", "---", "---"},
    {"esa/polyhedral-gravity-model 3.3.1", "potential, acceleration and tensor of a polyhedron, per point and face",
     "446 to 562 ns, median 540 ns", "own timing of its release build, Eros with 14 744 faces, 2026"},
    {"glibc's vector functions (libmvec)", "the straightforward formula of each pair, AVX2",
     "1.2 to 1.9 times as fast as SLEEF's", "own timing, 2026"},
    {"KEMField (KATRIN)", "charged wires: closed form near, 16 nodes beyond 2 lengths, 4 beyond 27.7",
     "as exact as here where it switches, see above", "its source"},
    {"magpylib", "closed forms of magnets", "12 to 14 digits, asked for by its users", "its issue 374"},
    {"fatiando/choclo", "prisms: the logarithm cancels, NaN at corners", "repaired case by case",
     "its pull requests 27 and 30"},
};
FILE *f = fopen("peers.md", "w");
nb_require(f);
for (size_t i = 0; i < sizeof peers / sizeof *peers; i++)
  for (int k = 0; k < 4; k++) fprintf(f, "| %s%s", peers[i][k], k < 3 ? " " : " |\n");
nb_require(fclose(f) == 0);
nb_show("peers.md");
