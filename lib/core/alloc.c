/* SPDX-License-Identifier: MIT */
#include "core/alloc.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

static long countdown; /* only touched by the tests that make allocations fail */

void skf_alloc_fail_after(long k) { countdown = k; }

static bool refused(size_t n, size_t size) {
  if (countdown > 0 && --countdown == 0) return true;
  return size != 0 && n > SIZE_MAX / size;
}

/* Not zeroed. */
static void *in_large_pages(size_t n) {
  void *p = aligned_alloc(SKF_LARGE, n * SKF_LARGE);
#ifdef __linux__
  if (p) (void)madvise(p, n * SKF_LARGE, MADV_HUGEPAGE); /* it may say no */
#endif
  return p;
}

void *skf_alloc(size_t n, size_t size) {
  if (refused(n, size)) return NULL;
  if (n * size < SKF_LARGE) return calloc(n ? n : 1, size ? size : 1);
  if (n * size > SIZE_MAX - SKF_LARGE) return NULL;
  void *p = in_large_pages((n * size + SKF_LARGE - 1) / SKF_LARGE);
  return p ? memset(p, 0, n * size) : NULL;
}

void *skf_alloc_large(size_t n) { return refused(n, SKF_LARGE) ? NULL : in_large_pages(n); }

void *skf_realloc(void *old, size_t n, size_t size) {
  return refused(n, size) ? NULL : realloc(old, n && size ? n * size : 1);
}

char *skf_strdup(const char *text) {
  size_t n = strlen(text) + 1;
  char *copy = skf_alloc(n, 1);
  if (copy) memcpy(copy, text, n);
  return copy;
}

void skf_free(void *p) { free(p); }
