/* SPDX-License-Identifier: MIT */
/* Times on a core that may be shared. While a neighbour's thread runs on the same core, code that keeps the arithmetic
   units busy takes up to twice as long, code that waits for its own results hardly more, so that ratios are wrong both
   ways. So around each sample a short loop is timed that only multiplies and adds, in registers; samples are kept
   where it ran at its full speed before and after, and their median is what counts. Cycles are counted where the system
   lets us, else a chain of dependent additions tells the clock. */
#ifndef SKF_BENCH_QUIET_H
#define SKF_BENCH_QUIET_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>
#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

enum { QUIET_ROUNDS = 8000, QUIET_CHAIN = 20000, QUIET_KEPT = 64, QUIET_ENOUGH = 9 };

typedef struct quiet_state {
  int counter;           /* of this thread's cycles outside of the kernel, or < 0 */
  double cycle_ns;       /* the shortest yet */
  double read, best;     /* cycles: of reading the counter; of the loop at its full speed */
  bool good;             /* the last loop ran at full speed */
  double probed, quiet;  /* loops, and those at full speed */
  double clock, counted; /* when a sample began */
} quiet_state;

/* Cycles of the samples of one thing that were kept, the last ones; the least of all */
typedef struct quiet_series {
  int kept;
  double cycles[QUIET_KEPT], least;
} quiet_series;

static double quiet_now(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}
static double quiet_cpu(void) { return quiet_now(CLOCK_THREAD_CPUTIME_ID); }

static void quiet_open(quiet_state *q) {
  q->counter = -1;
#ifdef __linux__
  struct perf_event_attr a = {.type = PERF_TYPE_HARDWARE, .config = PERF_COUNT_HW_CPU_CYCLES};
  a.size = sizeof a, a.exclude_kernel = 1, a.exclude_hv = 1;
  q->counter = (int)syscall(SYS_perf_event_open, &a, 0, -1, -1, 0);
#endif
}

static double quiet_count(const quiet_state *q) {
  unsigned long long count = 0;
#ifdef __linux__
  if (q->counter >= 0 && read(q->counter, &count, sizeof count) != sizeof count) count = 0;
#endif
  return (double)count;
}

static void quiet_start(quiet_state *q) {
  q->clock = quiet_cpu();
  q->counted = quiet_count(q);
}
/* Cycles since then */
static double quiet_stop(const quiet_state *q) {
  const double counted = quiet_count(q) - q->counted;
  return (q->counter >= 0 ? counted : (quiet_cpu() - q->clock) / q->cycle_ns) - q->read;
}

/* Additions that wait for each other */
static void quiet_chain(int n) {
  unsigned long a = 1;
  for (int i = 0; i < n; i++) {
#ifdef __x86_64__
    __asm__ volatile("add $1, %0\n add $1, %0\n add $1, %0\n add $1, %0\n add $1, %0" : "+r"(a));
#else
    for (int k = 0; k < 5; k++) {
      a++;
      __asm__ volatile("" : "+r"(a));
    }
#endif
  }
}

/* The clock, from so many that reading the time does not count */
static void quiet_clock(quiet_state *q) {
  const double t = quiet_cpu();
  quiet_chain(QUIET_CHAIN);
  const double each = (quiet_cpu() - t) / (5 * QUIET_CHAIN);
  if (each > 0.1) q->cycle_ns = fmin(q->cycle_ns, each); /* a guest's clock of CPU time may stand still */
}

/* Ten chains of products and sums, among them additions of whole numbers: twice as much as half a core takes in */
static void quiet_multiply(long n) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("fma")) {
    long a = 0, b = 0, c = 0;
#define QUIET_TWO(x, y)                                                                                                \
  "vfmadd231pd %%ymm10, %%ymm11, %%ymm" #x "\n add $1, %1\n vfmadd231pd %%ymm10, %%ymm11, %%ymm" #y                    \
  "\n add $1, %2\n add $1, %3\n"
    __asm__ volatile("vxorpd %%ymm10, %%ymm10, %%ymm10\n vxorpd %%ymm11, %%ymm11, %%ymm11\n 1:\n" QUIET_TWO(0, 1)
                         QUIET_TWO(2, 3) QUIET_TWO(4, 5) QUIET_TWO(6, 7) QUIET_TWO(8, 9) "dec %0\n jnz 1b\n vzeroupper"
                     : "+r"(n), "+r"(a), "+r"(b), "+r"(c)
                     :
                     : "cc", "xmm0", "xmm1", "xmm2", "xmm3", "xmm4", "xmm5", "xmm6", "xmm7", "xmm8", "xmm9", "xmm10",
                       "xmm11");
#undef QUIET_TWO
    return;
  }
#endif
  volatile double sink;
  double a[10] = {0};
  for (; n > 0; n--)
    for (int k = 0; k < 10; k++) a[k] = a[k] * 0.5 + 1;
  for (int k = 0; k < 10; k++) sink = a[k];
  (void)sink;
}

/* The loop, between two samples; whether the sample before it may be kept. */
static bool quiet_probe(quiet_state *q) {
  const bool before = q->good;
  if (q->counter < 0) quiet_clock(q);
  quiet_start(q);
  quiet_multiply(QUIET_ROUNDS);
  const double cycles = quiet_stop(q);
  q->best = fmin(q->best, cycles);
  q->good = cycles < 1.08 * q->best;
  q->probed++, q->quiet += q->good;
  return before && q->good;
}

/* Waits for a core at rest, asleep in between, until the wall clock shows `end`. */
static void quiet_wait(quiet_state *q, double end) {
  const struct timespec pause = {0, 300000};
  for (quiet_probe(q); !q->good && quiet_now(CLOCK_MONOTONIC) < end; quiet_probe(q)) nanosleep(&pause, NULL);
}

/* Two multipliers give 5 cycles a round; where there are less, the best of the run is what counts. */
static quiet_state quiet_begin(void) {
  quiet_state q = {.cycle_ns = INFINITY, .best = INFINITY};
  quiet_open(&q);
  for (int k = 0; k < 100; k++) quiet_clock(&q);
  double none = INFINITY;
  for (int k = 0; k < 100; k++) quiet_start(&q), none = fmin(none, quiet_stop(&q));
  q.read = none;
  for (int k = 0; k < 1000; k++) quiet_probe(&q);
  if (q.best < 9.8 * QUIET_ROUNDS) q.best = fmin(q.best, 5. * QUIET_ROUNDS);
  q.probed = q.quiet = 0;
  return q;
}

static void quiet_clear(quiet_series *s) { s->kept = 0, s->least = INFINITY; }

/* After quiet_probe, which tells `good` */
static void quiet_keep(quiet_series *s, double cycles, bool good) {
  if (!(cycles > 0)) return;
  s->least = fmin(s->least, cycles);
  if (good) s->cycles[s->kept++ % QUIET_KEPT] = cycles;
}

static int quiet_order(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}
/* The median of those that were kept; where they are too few, the least of all samples */
static bool quiet_enough(const quiet_series *s) { return s->kept >= QUIET_ENOUGH; }
static double quiet_median(const quiet_series *s) {
  double sorted[QUIET_KEPT];
  const int n = s->kept < QUIET_KEPT ? s->kept : QUIET_KEPT;
  if (!quiet_enough(s)) return s->least;
  for (int i = 0; i < n; i++) sorted[i] = s->cycles[i];
  qsort(sorted, (size_t)n, sizeof *sorted, quiet_order);
  return sorted[n / 2];
}

#endif
