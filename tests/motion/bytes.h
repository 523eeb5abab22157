/* SPDX-License-Identifier: MIT */
/* What is saved, in memory. */
#ifndef SKF_TESTS_MOTION_BYTES_H
#define SKF_TESTS_MOTION_BYTES_H

#include "check.h"
#include "skelfield/core.h"
#include <string.h>

/* A file in memory. */
typedef struct bytes {
  char *data;
  size_t n, at, room;
} bytes;

static inline skf_status put(void *user, const void *from, size_t n) {
  bytes *b = user;
  if (b->n + n > b->room) b->data = realloc(b->data, b->room = 2 * (b->n + n));
  assert_non_null(b->data);
  memcpy(b->data + b->n, from, n);
  b->n += n;
  return SKF_OK;
}

static inline skf_status get(void *user, void *to, size_t n) {
  bytes *b = user;
  if (b->at + n > b->n) return SKF_ERR_IO;
  memcpy(to, b->data + b->at, n);
  b->at += n;
  return SKF_OK;
}

#endif
