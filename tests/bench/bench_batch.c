/* SPDX-License-Identifier: MIT */
/* Batches through the public interface, one thread unless told: ns and cycles of a value with its gradient for each
   vector form, beside the closed form at each point; the same textbook formula with the functions of libm, of glibc's
   vector library and of SLEEF (1 ulp), straightforwardly and once more with the geometry that keeps the digits next to
   the body, and the largest relative errors of all against long double; the cost of a batch of one point; batches in
   main memory; two threads. Interleaved samples of a core at rest (quiet.h); it only reports. With arguments, of the
   table only the rows whose names contain one of them ("cauchy arc"). */
#include "core/vec3.h"
#include "field/batch.h"
#include "num/gauss.h"
#include "quiet.h"
#include "simd/vec.h"
#include "skelfield/field.h"
#include "units.h"
#include <omp.h>
#include <stdio.h>
#include <string.h>
#ifdef SKF_HAVE_SLEEF
#include <sleef.h>
#endif

enum {
  POINTS = 1024,
  PAD = 24,
  RUNS = 30,
  SECONDS = 3,
  IN_A_ROW = 4,
  HUGE_POINTS = 2000000,
  FORMULA_NODES = 24,
  FORMULAS = 22
};

static double p[3][POINTS + PAD], F[4][POINTS + PAD]; /* padded: rows a multiple of 4096 bytes apart disturb */
static long double exact[4][POINTS];

typedef struct library {
  void (*prepare)(const skf_element *e);
  void (*run[FORMULAS][2])(size_t n); /* straightforwardly; carefully, or NULL */
} library;

/* In the order of `run` */
static const struct {
  skf_kernel_type kernel;
  skf_shape shape;
  bool circle;
} formulas[FORMULAS] = {{SKF_INVERSE, SKF_SEGMENT},
                        {SKF_CAUCHY, SKF_SEGMENT},
                        {SKF_INVERSE, SKF_TRIANGLE},
                        {SKF_CAUCHY, SKF_ARC},
                        {SKF_GAUSSIAN, SKF_POINT},
                        {SKF_GAUSSIAN, SKF_SEGMENT},
                        {SKF_INVERSE_SQUARED, SKF_SEGMENT},
                        {SKF_INVERSE_SQUARED, SKF_ARC},
                        {SKF_GAUSSIAN, SKF_PLANE},
                        {SKF_INVERSE_SQUARED, SKF_PLANE},
                        {SKF_CAUCHY, SKF_TRIANGLE},
                        {SKF_GAUSSIAN, SKF_TRIANGLE},
                        {SKF_INVERSE_SQUARED, SKF_TRIANGLE},
                        {SKF_METABALL, SKF_SEGMENT},
                        {SKF_GAUSSIAN, SKF_ARC},
                        {SKF_METABALL, SKF_ARC},
                        {SKF_QUARTIC, SKF_ARC},
                        {SKF_SOFT_OBJECT, SKF_ARC},
                        {SKF_GAUSSIAN, SKF_ARC, true},
                        {SKF_METABALL, SKF_TRIANGLE},
                        {SKF_QUARTIC, SKF_TRIANGLE},
                        {SKF_SOFT_OBJECT, SKF_TRIANGLE}};

#define V               long double
#define REAL            long double
#define NAME(x)         exact_##x
#define LOAD(p)         ((long double)*(p))
#define STORE(p, v)     (*(p) = (v))
#define SELECT(m, a, b) ((m) ? (a) : (b))
#define OUT             exact
#define SQRT            sqrtl
#define LOG             logl
#define LOG1P           log1pl
#define EXP             expl
#define ERF             erfl
#define ACOS            acosl
#define ATAN            atanl
#define ATAN2           atan2l
#define SIN             sinl
#define COS             cosl
#include "formula.h"

#define V               double
#define REAL            double
#define NAME(x)         libm_##x
#define LOAD(p)         (*(p))
#define STORE(p, v)     (*(p) = (v))
#define SELECT(m, a, b) ((m) ? (a) : (b))
#define OUT             F
#define SQRT            sqrt
#define LOG             log
#define LOG1P           log1p
#define EXP             exp
#define ERF             erf
#define ACOS            acos
#define ATAN            atan
#define ATAN2           atan2
#define SIN             sin
#define COS             cos
#include "formula.h"

#ifdef SKF_HAVE_LIBMVEC
__m256d _ZGVdN4v_erf(__m256d), _ZGVdN4v_log(__m256d), _ZGVdN4v_log1p(__m256d), _ZGVdN4v_exp(__m256d),
    _ZGVdN4v_sin(__m256d), _ZGVdN4v_cos(__m256d), _ZGVdN4v_acos(__m256d), _ZGVdN4v_atan(__m256d),
    _ZGVdN4vv_atan2(__m256d, __m256d);
#define V               skf_vd
#define REAL            double
#define NAME(x)         glibc_##x
#define LOAD            vd_load
#define STORE           vd_store
#define SELECT(m, a, b) vd_select(m, a, b)
#define OUT             F
#define SQRT            vd_sqrt
#define LOG(x)          ((skf_vd)_ZGVdN4v_log((__m256d)(x)))
#define LOG1P(x)        ((skf_vd)_ZGVdN4v_log1p((__m256d)(x)))
#define ERF(x)          ((skf_vd)_ZGVdN4v_erf((__m256d)(x)))
#define EXP(x)          ((skf_vd)_ZGVdN4v_exp((__m256d)(x)))
#define ATAN(x)         ((skf_vd)_ZGVdN4v_atan((__m256d)(x)))
#define ATAN2(y, x)     ((skf_vd)_ZGVdN4vv_atan2((__m256d)(y), (__m256d)(x)))
#define SIN(x)          ((skf_vd)_ZGVdN4v_sin((__m256d)(x)))
#define COS(x)          ((skf_vd)_ZGVdN4v_cos((__m256d)(x)))
#define ACOS(x)         ((skf_vd)_ZGVdN4v_acos((__m256d)(x)))
#include "formula.h"
#endif

#ifdef SKF_HAVE_SLEEF
#define V               skf_vd
#define REAL            double
#define NAME(x)         sleef_##x
#define LOAD            vd_load
#define STORE           vd_store
#define SELECT(m, a, b) vd_select(m, a, b)
#define OUT             F
#define SQRT            vd_sqrt
#define LOG(x)          ((skf_vd)Sleef_logd4_u10avx2((__m256d)(x)))
#define LOG1P(x)        ((skf_vd)Sleef_log1pd4_u10avx2((__m256d)(x)))
#define ERF(x)          ((skf_vd)Sleef_erfd4_u10avx2((__m256d)(x)))
#define EXP(x)          ((skf_vd)Sleef_expd4_u10avx2((__m256d)(x)))
#define ATAN(x)         ((skf_vd)Sleef_atand4_u10avx2((__m256d)(x)))
#define ATAN2(y, x)     ((skf_vd)Sleef_atan2d4_u10avx2((__m256d)(y), (__m256d)(x)))
#define SIN(x)          ((skf_vd)Sleef_sind4_u10avx2((__m256d)(x)))
#define COS(x)          ((skf_vd)Sleef_cosd4_u10avx2((__m256d)(x)))
#define ACOS(x)         ((skf_vd)Sleef_acosd4_u10avx2((__m256d)(x)))
#include "formula.h"
#endif

static const struct {
  const char *name;
  const library *library;
} libraries[] = {
    {"libm", &libm_library},
#ifdef SKF_HAVE_LIBMVEC
    {"glibc", &glibc_library},
#endif
#ifdef SKF_HAVE_SLEEF
    {"SLEEF", &sleef_library},
#endif
};
enum { LIBRARIES = sizeof libraries / sizeof *libraries };

static quiet_state quiet;
static void keep(double *best, double ns) { *best = fmin(*best, ns); }

static skf_field *make(const char *isa, const skf_element *e, size_t n) {
  skf_field *f = NULL;
  setenv("SKELFIELD_ISA", isa, 1);
  if (skf_field_new(e, n, &f)) exit(1);
  return f;
}

static void eval(const skf_field *f, size_t n) {
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const g[3] = {F[1], F[2], F[3]};
  skf_field_eval(f, n, in, F[0], g, NULL);
}

/* Largest relative errors of F and the gradient */
typedef struct error {
  double F, g;
} error;

static error compare(void) {
  error e = {0, 0};
  for (int i = 0; i < POINTS; i++) {
    long double d = 0, g = 0;
    for (int k = 1; k < 4; k++) {
      d += (F[k][i] - exact[k][i]) * (F[k][i] - exact[k][i]);
      g += exact[k][i] * exact[k][i];
    }
    e.F = fmax(e.F, (double)fabsl((F[0][i] - exact[0][i]) / exact[0][i]));
    e.g = fmax(e.g, (double)sqrtl(d / g));
  }
  return e;
}

static int formula_of(const skf_element *e) {
  bool circle = e->primitive.shape == SKF_ARC && e->primitive.arc.sweep > 6;
  for (int i = 0; i < FORMULAS; i++)
    if (formulas[i].kernel == e->kernel.type && formulas[i].shape == e->primitive.shape && formulas[i].circle == circle)
      return i;
  return -1;
}

static void title(const char *name, const skf_element *e) {
  printf("%-16s %-12s", skf_kernel_get(e->kernel.type)->name, name);
}

/* The errors of what lies in F, in `exact` the formula */
static void print_error(void) {
  error e = compare();
  printf("  %7.1e %7.1e", e.F, e.g);
}

/* One sample, between two loops that tell whether it may be kept */
static void sample(quiet_series *s, const skf_field *f, void (*run)(size_t), size_t n, int in_a_row) {
  quiet_start(&quiet);
  for (int k = 0; k < in_a_row; k++)
    if (f)
      eval(f, n);
    else
      run(n);
  const double cycles = quiet_stop(&quiet);
  quiet_keep(s, cycles / in_a_row / (double)n, quiet_probe(&quiet));
}

/* All that is measured of a row */
typedef struct timing {
  quiet_series scalar, vector, other[2][LIBRARIES];
} timing;

static bool all_enough(const timing *t, int ways) {
  bool enough = quiet_enough(&t->scalar) && quiet_enough(&t->vector);
  for (int k = 0; k < ways * LIBRARIES; k++) enough &= quiet_enough(&t->other[k % ways][k / ways]);
  return enough;
}

static void measure(timing *t, const skf_field *scalar, const skf_field *vector, int formula, int ways) {
  quiet_clear(&t->scalar), quiet_clear(&t->vector);
  for (int k = 0; k < 2 * LIBRARIES; k++) quiet_clear(&t->other[k % 2][k / 2]);
  const double end = quiet_now(CLOCK_MONOTONIC) + SECONDS * 1e9;
  for (int r = 0; r < RUNS || (!all_enough(t, ways) && quiet_now(CLOCK_MONOTONIC) < end); r++) {
    quiet_wait(&quiet, end);
    sample(&t->vector, vector, NULL, POINTS, IN_A_ROW);
    for (int k = 0; k < ways * LIBRARIES; k++)
      sample(&t->other[k % ways][k / ways], NULL, libraries[k / ways].library->run[formula][k % ways], POINTS,
             k / ways ? IN_A_ROW : 1);
    if (r % 2 == 0) sample(&t->scalar, scalar, NULL, POINTS / 16, 1);
  }
}

static void table_row(const char *name, const skf_element *e, size_t n) {
  timing t;
  int formula = n == 1 ? formula_of(e) : -1, ways = formula < 0 ? 0 : libraries[0].library->run[formula][1] ? 2 : 1;
  skf_field *a = make("scalar", e, n), *b = make("avx2", e, n);
  for (int i = 0; i < LIBRARIES; i++) libraries[i].library->prepare(e);
  measure(&t, a, b, formula, ways);
  double scalar = quiet_median(&t.scalar) / (double)n, vector = quiet_median(&t.vector) / (double)n;
  title(name, e);
  printf(" %8.1f %8.2f %7.2f %7.1f", scalar * quiet.cycle_ns, vector * quiet.cycle_ns, vector, scalar / vector);
  if (ways) {
    exact_library.prepare(e);
    exact_library.run[formula][0](POINTS);
  }
  for (int way = 0; way < ways; way++) {
    if (way) printf("\n%-29s %8s %8s %7s %7s", "  carefully", "", "", "", "");
    for (int i = 0; i < LIBRARIES; i++) printf("  %7.2f", quiet_median(&t.other[way][i]) / vector);
    eval(b, POINTS);
    print_error();
    for (int i = 0; i < LIBRARIES; i++) {
      libraries[i].library->run[formula][way](POINTS);
      print_error();
    }
  }
  printf("%s\n", all_enough(&t, ways) ? "" : "  *");
  skf_field_free(a);
  skf_field_free(b);
}

/* Whether the element has a vector form */
static bool has_form(const skf_element *e) {
  skf_prepared q;
  skf_prepare(e, &q);
  return skf_batch_form_of(skf_batch_get(skf_isa_pick()), &q) != SKF_FORM_COUNT;
}

static bool wanted(const char *kernel, const char *name, int words, char **word) {
  char both[64];
  snprintf(both, sizeof both, "%s %s", kernel, name);
  for (int i = 0; i < words; i++)
    if (strstr(both, word[i])) return true;
  return words == 0;
}

static void table(int words, char **word) {
  printf(
      "ns per value and gradient: closed form, vector form, its cycles and ratio; how many times longer the same "
      "formula takes\nwith each library; largest relative errors of F and gradient: ours and theirs. Medians of quiet "
      "samples (*: the core was\nshared nearly all of the time, the least of all)\n");
  printf("%-29s %8s %8s %7s %7s", "", "closed", "vector", "cycles", "ratio");
  for (int i = 0; i < LIBRARIES; i++) printf("  %7s", libraries[i].name);
  printf("  %15s", "errors");
  for (int i = 0; i < LIBRARIES; i++) printf("  %15s", libraries[i].name);
  printf("\n");
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      for (int other = 0; other <= (s == SKF_ARC || s == SKF_PLANE); other++) {
        skf_element e[64] = {{unit((skf_shape)s, other), {.type = (skf_kernel_type)k, .param = 1.5}, 1}};
        char many[32];
        const char *kernel = skf_kernel_get((skf_kernel_type)k)->name;
        const char *shape = skf_shape_get((skf_shape)s)->name;
        if (other) shape = s == SKF_ARC ? "circle" : "tilted plane";
        if (!has_form(e)) continue;
        if (wanted(kernel, shape, words, word)) table_row(shape, e, 1);
        if (s != SKF_POINT && !(k == SKF_INVERSE && (s == SKF_SEGMENT || s == SKF_TRIANGLE))) continue;
        for (int i = 1; i < 64; i++) {
          e[i] = e[0];
          if (s == SKF_POINT) e[i].primitive.point.at.x += 0.01 * i;
          if (s == SKF_SEGMENT) e[i].primitive.segment.from.z += 0.01 * i;
          if (s == SKF_TRIANGLE) e[i].primitive.triangle.vertices[0].z += 0.01 * i;
        }
        snprintf(many, sizeof many, "64 %ss", skf_shape_get((skf_shape)s)->name);
        if (wanted(kernel, many, words, word)) table_row(many, e, 64);
      }
}

/* The goals of the design: pairs whose costs beside the kernel are reported too. */
static const struct {
  skf_kernel_type kernel;
  skf_shape shape;
} chosen[] = {{SKF_INVERSE, SKF_POINT},  {SKF_QUARTIC, SKF_POINT}, {SKF_INVERSE, SKF_SEGMENT},
              {SKF_CAUCHY, SKF_SEGMENT}, {SKF_CAUCHY, SKF_ARC},    {SKF_INVERSE, SKF_TRIANGLE}};
enum { CHOSEN = sizeof chosen / sizeof *chosen };

static skf_element body(int i) {
  return (skf_element){unit(chosen[i].shape, false), {.type = chosen[i].kernel, .param = 1.5}, 1};
}

/* A call for one point, and the form alone on the points that it is padded to */
static void one_point(void) {
  enum { CALLS = 64 };
  printf("\nbatch of one point, ns: call, kernel, the rest; skf_field_at\n");
  for (int i = 0; i < CHOSEN; i++) {
    skf_element e = body(i);
    skf_field *f = make("avx2", &e, 1);
    skf_prepared q;
    skf_batch b;
    skf_vec3 g;
    quiet_series call, kernel, at;
    volatile double total = 0;
    const double *const in[3] = {p[0], p[1], p[2]};
    double *const out[4] = {F[0], F[1], F[2], F[3]};
    skf_prepare(&e, &q);
    if (skf_batch_new(skf_batch_get(skf_isa_pick()), &q, 1, &b)) exit(1);
    quiet_clear(&call), quiet_clear(&kernel), quiet_clear(&at);
    const double end = quiet_now(CLOCK_MONOTONIC) + SECONDS * 1e9;
    for (int r = 0; r < RUNS || (!quiet_enough(&at) && quiet_now(CLOCK_MONOTONIC) < end); r++) {
      quiet_wait(&quiet, end);
      quiet_start(&quiet);
      for (int k = 0; k < CALLS; k++) eval(f, 1);
      double c = quiet_stop(&quiet);
      quiet_keep(&call, c, quiet_probe(&quiet));
      quiet_start(&quiet);
      for (int k = 0; k < CALLS; k++) b.ops->form[b.tile->form].one(b.tile, SKF_BATCH_PAD, in, out);
      c = quiet_stop(&quiet);
      quiet_keep(&kernel, c, quiet_probe(&quiet));
      quiet_start(&quiet);
      for (int k = 0; k < CALLS; k++) total += skf_field_at(f, v3(p[0][k], p[1][k], p[2][k]), &g);
      c = quiet_stop(&quiet);
      quiet_keep(&at, c, quiet_probe(&quiet));
    }
    const double ns = quiet.cycle_ns / CALLS, all = quiet_median(&call) * ns, inner = quiet_median(&kernel) * ns;
    title(skf_shape_get(chosen[i].shape)->name, &e);
    printf(" %8.0f %8.0f %8.0f %8.0f\n", all, inner, all - inner, quiet_median(&at) * ns);
    skf_batch_free(&b);
    skf_field_free(f);
  }
}

/* The loop that only multiplies, its rounds dealt out to the threads: what two of them gain here and now */
static double control(int threads, long rounds) {
  const double t = quiet_now(CLOCK_MONOTONIC);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int k = 0; k < threads; k++) quiet_multiply(rounds / threads);
  return quiet_now(CLOCK_MONOTONIC) - t;
}

/* Many points, in main memory and by two threads: CPU time of one, wall-clock time of both */
static void large(void) {
  enum { SIZES = 3, REPEAT = 9 };
  static const size_t size[SIZES] = {HUGE_POINTS, 131072, 16384};
  double *room = malloc(7 * (size_t)HUGE_POINTS * sizeof *room);
  if (!room) return;
  for (size_t i = 0; i < 3 * (size_t)HUGE_POINTS; i++) room[i] = p[i % 3][i / 3 % POINTS];
  for (size_t i = 3 * (size_t)HUGE_POINTS; i < 7 * (size_t)HUGE_POINTS; i++) room[i] = 0;
  const double *const in[3] = {room, room + HUGE_POINTS, room + 2 * (size_t)HUGE_POINTS};
  double *const out[4] = {room + 3 * (size_t)HUGE_POINTS, room + 4 * (size_t)HUGE_POINTS,
                          room + 5 * (size_t)HUGE_POINTS, room + 6 * (size_t)HUGE_POINTS};
  printf(
      "\nmany points, ns each: CPU time of one thread, wall-clock time of one and of two; speed-up, in brackets that "
      "of a loop\nthat only multiplies, as long, in between\n");
  for (int i = 0; i < CHOSEN; i++) {
    skf_element e = body(i);
    skf_field *f = make("avx2", &e, 1);
    title(skf_shape_get(chosen[i].shape)->name, &e);
    for (int k = 0; k < SIZES; k++) {
      double ns[2] = {INFINITY, INFINITY}, loop[2] = {INFINITY, INFINITY}, own = INFINITY;
      const int repeat = k == 0 ? REPEAT : (int)(HUGE_POINTS / size[k]) * 2;
      long rounds = 1000;
      for (int r = 0; r < 2 * repeat; r++) {
        omp_set_num_threads(r % 2 + 1);
        double t = quiet_now(CLOCK_MONOTONIC), c = quiet_cpu();
        skf_field_eval(f, size[k], in, out[0], out + 1, NULL);
        if (r % 2 == 0) keep(&own, quiet_cpu() - c);
        keep(&ns[r % 2], quiet_now(CLOCK_MONOTONIC) - t);
        if (r == 0) rounds = (long)(own / (5 * quiet.cycle_ns));
        keep(&loop[r % 2], control(r % 2 + 1, rounds));
      }
      const double n = (double)size[k];
      printf("  %zu: %.2f %.2f %.2f %.2f (%.2f)", size[k], own / n, ns[0] / n, ns[1] / n, ns[0] / ns[1],
             loop[0] / loop[1]);
    }
    printf("\n");
    skf_field_free(f);
  }
  omp_set_num_threads(1);
  free(room);
}

int main(int argc, char **argv) {
  if (skf_batch_get(skf_isa_pick()) == &skf_batch_scalar) return puts("no vector forms on this machine") < 0;
  omp_set_num_threads(1);
  unsigned long long seed = 1;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < POINTS + PAD; i++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      p[k][i] = 3 * ((double)(seed >> 11) * 0x1p-53) - 1.5;
    }
  quiet = quiet_begin();
  table(argc - 1, argv + 1);
  if (argc == 1) one_point(), large();
  printf("\nclock %.2f GHz, %.0f %% of the samples quiet\n", 1 / quiet.cycle_ns, 100 * quiet.quiet / quiet.probed);
  return 0;
}
