/* SPDX-License-Identifier: MIT */
#include "field/profiled.h"
#include "field/weight.h"
#include "num/gauss.h"

void skf_march_plain(const skf_march *m, double lo, double length, int n) {
  const skf_gauss_node *node = skf_gauss_rule(n);
  for (int j = 0; j < n; j++) {
    double u = 0.5 * (1 + node[j].x), v = 0.5 * (1 - node[j].x);
    m->at(m->context, lo + length * u, u, v, 0.5 * length * node[j].w);
  }
}

/* Where the way is short beside delta or its own distance one rule does: its ellipse of convergence has axes of sum 4.
   Else x = delta sinh y, in panels of y: the function's branch points come to lie at +-i pi / 2. */
void skf_march_graded(const skf_march *m, double lo, double hi, double length, double delta) {
  enum { NODES = 16 };
  if (length <= fmax(lo, delta)) {
    skf_march_plain(m, lo, length, NODES);
    return;
  }
  double from = asinh(lo / delta), span = asinh(hi / delta) - from;
  int panels = (int)ceil(span / 1.6);
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  for (int i = 0; i < panels; i++)
    for (int j = 0; j < NODES; j++) {
      double y = from + span * (i + 0.5 * (1 + node[j].x)) / panels, x = delta * sinh(y);
      double dx = 0.5 * span / panels * node[j].w * delta * cosh(y);
      m->at(m->context, x, (x - lo) / length, (hi - x) / length, dx);
    }
}

void skf_profiled(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  (e->primitive.shape == SKF_SEGMENT ? skf_profiled_segment : skf_profiled_arc)(e, x, order, v);
}
