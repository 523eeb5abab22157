/* SPDX-License-Identifier: MIT */
/* A YAML document as a tree whose every node knows its line. */
#ifndef SKF_SCENE_YAML_H
#define SKF_SCENE_YAML_H

#include "skelfield/core.h"
#include <stdint.h>

typedef enum skf_node_type { SKF_NODE_SCALAR, SKF_NODE_LIST, SKF_NODE_MAP } skf_node_type;

/* The children of a map are key, value, key, value, ... */
typedef struct skf_node {
  unsigned char type;   /* skf_node_type */
  bool plain;           /* a scalar without quotes */
  int line;             /* where it starts, from 1 */
  int count;            /* of children; pairs in a map */
  uint32_t first, next; /* first child, next sibling; 0: none */
  uint32_t text;        /* of a scalar, in the pool */
} skf_node;

typedef struct skf_yaml {
  skf_node *nodes; /* nodes[0] is the root */
  char *pool;
  size_t node_count, node_capacity, pool_size, pool_capacity;
} skf_yaml;

/* Reads one document. An alias becomes a copy of what its anchor names, with the lines of that; merge keys are merged.
   What aliases stand for is bounded, so that small files stay cheap; tags, further documents and deep nesting are
   refused. On failure *out is empty. */
skf_status skf_yaml_read(const char *text, size_t length, skf_yaml *out, skf_error *error);
void skf_yaml_free(skf_yaml *yaml);

static inline const char *skf_node_text(const skf_yaml *y, const skf_node *n) { return y->pool + n->text; }
static inline const skf_node *skf_node_first(const skf_yaml *y, const skf_node *n) {
  return n->first ? y->nodes + n->first : NULL;
}
static inline const skf_node *skf_node_next(const skf_yaml *y, const skf_node *n) {
  return n->next ? y->nodes + n->next : NULL;
}

/* Text of the user's that is fit for a one-line message: short, no control characters. */
typedef struct skf_shown {
  char text[48];
} skf_shown;
skf_shown skf_show(const char *text);
/* The same in quotes, or "empty". */
skf_shown skf_quote(const char *text);

/* Fills *error, unless it is NULL, and returns status. */
skf_status skf_error_set(skf_error *error, skf_status status, long line, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
