/* SPDX-License-Identifier: MIT */
/* Gauss-Legendre rules on [-1, 1], correctly rounded. */
#ifndef SKF_NUM_GAUSS_H
#define SKF_NUM_GAUSS_H

#define SKF_GAUSS_MAX 32

typedef struct skf_gauss_node {
  double x, w;
} skf_gauss_node;

/* The n nodes of the rule with n nodes, ascending; 1 <= n <= SKF_GAUSS_MAX. */
const skf_gauss_node *skf_gauss_rule(int n);

#endif
