/* SPDX-License-Identifier: MIT */
/* Integrals along an edge, each free of cancellation. */
#include "field/triangle_parts.h"

static double log_beyond(double l1, double l2, double r1, double r2) { /* 0 <= l1 < l2 */
  return log1p((l2 - l1) * (1 + (l1 + l2) / (r1 + r2)) / (l1 + r1));
}

double skf_edge_log(double l1, double l2, double c2, double r1, double r2) {
  if (l1 >= 0 && l1 + r1 > 0) return log_beyond(l1, l2, r1, r2);
  if (l2 <= 0 && r2 - l2 > 0) return log_beyond(-l2, -l1, r2, r1);
  double c = sqrt(c2);
  return c > 0 ? asinh(l2 / c) + asinh(-l1 / c) : INFINITY;
}

double skf_edge_angle(double d, double l1, double l2) { return d == 0 ? 0 : atan2(d * (l2 - l1), d * d + l1 * l2); }

static double solid(double d, double l, double c2, double az, double r) {
  double den = c2 + az * r;
  return den > 0 ? atan(d * l / den) : 0;
}

double skf_edge_solid(double d, double z, double c2, double l1, double r1, double l2, double r2) {
  return solid(d, l2, c2, fabs(z), r2) - solid(d, l1, c2, fabs(z), r1);
}

/* Both ends well on one side: with s l = E cot(phi) the integrand is (sin(phi) / E)^(2 k), positive and entire. 12
   nodes give 1e-17 up to phi = pi / 2. */
static void powers_beyond(double E, double s, double l1, double l2, double width, int count, double out[3]) {
  const skf_gauss_node *g = skf_gauss_rule(12);
  double phi2 = atan2(E, s * fmax(fabs(l1), fabs(l2)));
  out[0] = width / (s * E);
  out[1] = out[2] = 0;
  for (int i = 0; i < 12; i++) {
    double q = sin(phi2 + 0.5 * width * (1 + g[i].x)) / E;
    out[1] += g[i].w * q * q;
    out[2] += g[i].w * q * q * q * q;
  }
  for (int k = 1; k < count; k++) out[k] *= 0.5 * out[0];
}

void skf_edge_powers(double E, double s, double l1, double l2, int count, double out[3]) {
  double near = skf_edge_nearest(l1, l2), L = l2 - l1, s2 = s * s;
  E = fmax(E, 1e-100 * s * near); /* the limit E -> 0 for an edge whose line holds the point */
  double width = atan2(s * L * E, E * E + s2 * l1 * l2);
  if (count > 1 && near > 0 && !(s * near < 0.5 * E && s * L > 0.25 * E)) {
    powers_beyond(E, s, l1, l2, width, count, out);
    return;
  }
  double E2 = E * E, q1 = E2 + s2 * l1 * l1, q2 = E2 + s2 * l2 * l2;
  out[0] = width / (s * E);
  if (count > 1) {
    double rational = l1 < 0 && l2 > 0 ? l2 / q2 - l1 / q1 : L * (E2 - s2 * l1 * l2) / (q1 * q2);
    out[1] = (rational + out[0]) / (2 * E2);
  }
  if (count > 2) out[2] = ((l2 / (q2 * q2) - l1 / (q1 * q1)) + 3 * out[1]) / (4 * E2);
}

double skf_panel_scale(double d, double l1, double l2) {
  return fmax(fmax(fabs(d), 1e-3 * skf_edge_nearest(l1, l2)), 1e-300);
}

skf_panels skf_panels_over(double l1, double l2, double delta) {
  double T = l1 < 0 && l2 > 0 ? asinh(l2 / delta) - asinh(l1 / delta)
                              : skf_edge_log(l1, l2, delta * delta, hypot(l1, delta), hypot(l2, delta));
  if (T < 0.25) return (skf_panels){1, true, l1, l2 - l1, delta};
  int count = (int)ceil(T / 1.6);
  return (skf_panels){count, false, asinh(l1 / delta), T / count, delta};
}

void skf_panel_nodes(const skf_panels *p, int panel, double l[SKF_PANEL_NODES], double w[SKF_PANEL_NODES]) {
  const skf_gauss_node *g = skf_gauss_rule(SKF_PANEL_NODES);
  double mid = p->start + (panel + 0.5) * p->step, half = 0.5 * p->step;
  for (int i = 0; i < SKF_PANEL_NODES; i++) {
    double t = mid + half * g[i].x;
    l[i] = p->plain ? t : p->delta * sinh(t);
    w[i] = half * g[i].w * (p->plain ? 1 : sqrt(p->delta * p->delta + l[i] * l[i]));
  }
}
