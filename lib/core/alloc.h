/* SPDX-License-Identifier: MIT */
/* Allocation that can be made to fail on purpose, for the tests. */
#ifndef SKF_CORE_ALLOC_H
#define SKF_CORE_ALLOC_H

#include "skelfield/core.h"

/* Zeroed array of n items; NULL when memory is out or n * size overflows. n = 0 gives a valid pointer. From SKF_LARGE
   bytes on it is in large pages where the system has them, since many small ones take longer to come than to be filled.
 */
enum { SKF_LARGE = 1 << 21 };
void *skf_alloc(size_t n, size_t size);
/* n times SKF_LARGE bytes, not zeroed, for what will fill them. */
void *skf_alloc_large(size_t n);
/* Resizes, keeping the old block on failure. */
void *skf_realloc(void *old, size_t n, size_t size);
char *skf_strdup(const char *text);
void skf_free(void *p);

/* Tests: the k-th allocation from now on fails (0: none does). Not for use with threads. */
void skf_alloc_fail_after(long k);

#endif
