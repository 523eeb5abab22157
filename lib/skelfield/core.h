/* SPDX-License-Identifier: MIT */
/* Values that every room shares: status codes, vectors, boxes, progress. */
#ifndef SKELFIELD_CORE_H
#define SKELFIELD_CORE_H

#include <stdbool.h>
#include <stddef.h>

#if defined(SKF_BUILD)
#define SKF_API __attribute__((visibility("default")))
#else
#define SKF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Every status code with its text. */
#define SKF_STATUS_LIST(X)                                                                                             \
  X(SKF_OK, "success")                                                                                                 \
  X(SKF_ERR_NOMEM, "out of memory")                                                                                    \
  X(SKF_ERR_ARG, "invalid argument")                                                                                   \
  X(SKF_ERR_RANGE, "value out of range")                                                                               \
  X(SKF_ERR_DEGENERATE, "degenerate geometry")                                                                         \
  X(SKF_ERR_PARSE, "malformed input")                                                                                  \
  X(SKF_ERR_IO, "input or output failed")                                                                              \
  X(SKF_ERR_UNSUPPORTED, "not supported by this build or for this input")                                              \
  X(SKF_ERR_UNBOUNDED, "the surface is unbounded")                                                                     \
  X(SKF_ERR_EMPTY, "there is no surface")                                                                              \
  X(SKF_ERR_CONVERGENCE, "no convergence")                                                                             \
  X(SKF_ERR_CAPACITY, "the caller's array is too small")                                                               \
  X(SKF_ERR_CANCELLED, "cancelled")

typedef enum skf_status {
#define SKF_STATUS_ENUM(code, text) code,
  SKF_STATUS_LIST(SKF_STATUS_ENUM)
#undef SKF_STATUS_ENUM
      SKF_STATUS_COUNT
} skf_status;

/* Text for a status; never NULL. */
SKF_API const char *skf_status_text(skf_status status);

/* Version of the library, "major.minor.patch". */
SKF_API const char *skf_version(void);

/* Point or vector, Cartesian, right-handed, in the scene's unit of length. */
typedef struct skf_vec3 {
  double x, y, z;
} skf_vec3;

/* Axis-aligned box; empty when lo > hi in any coordinate. */
typedef struct skf_box {
  skf_vec3 lo, hi;
} skf_box;

/* What went wrong and where: `line` is 1-based, 0 when no line applies; `file` names another file than the one that was
   asked for, one that it refers to, or is empty. */
typedef struct skf_error {
  skf_status status;
  long line;
  char text[256];
  char file[512];
} skf_error;

/* Long work calls `report(user, done)` with done in [0, 1] from one thread now and then; a non-zero return asks it to
   stop with SKF_ERR_CANCELLED. `report` may be NULL. */
typedef struct skf_progress {
  int (*report)(void *user, double done);
  void *user;
} skf_progress;

#ifdef __cplusplus
}
#endif
#endif
