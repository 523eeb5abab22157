/* SPDX-License-Identifier: MIT */
#include "field/far_piece.h"
#include "core/alloc.h"
#include "num/gauss.h"
#include "skeleton/shape.h"
#include <string.h>

bool skf_far_piece_add(far_pieces *list, const far_piece *piece) {
  if (list->count == list->capacity) {
    size_t more = list->capacity ? 2 * list->capacity : 1024;
    far_piece *at = skf_realloc(list->at, more, sizeof *at);
    if (!at) return false;
    list->at = at, list->capacity = more;
  }
  return list->at[list->count++] = *piece, true;
}

static skf_vec3 between(skf_vec3 a, skf_vec3 b, double t) { return v3_mad(a, t, v3_sub(b, a)); }

/* Where the line from a to b meets the plane, on the plane. */
static skf_vec3 meet(skf_vec3 a, skf_vec3 b, int axis, double where) {
  double x = v3_get(a, axis), y = v3_get(b, axis);
  skf_vec3 p = between(a, b, (where - x) / (y - x));
  *v3_at(&p, axis) = where;
  return p;
}

static int cut_triangle(const skf_triangle *t, int axis, double where, skf_primitive parts[3]) {
  int alone = 0, above = 0, n = 0;
  bool up[3];
  for (int i = 0; i < 3; i++) above += up[i] = v3_get(t->vertices[i], axis) > where;
  if (above == 0 || above == 3) return 0;
  while (up[alone] != (above == 1)) alone++;
  skf_vec3 a = t->vertices[alone], b = t->vertices[(alone + 1) % 3], c = t->vertices[(alone + 2) % 3];
  skf_vec3 p = meet(a, b, axis, where), q = meet(a, c, axis, where);
  const skf_triangle part[3] = {{{a, p, q}}, {{p, b, c}}, {{p, c, q}}};
  for (int i = 0; i < 3; i++) { /* a vertex on the plane leaves parts without area */
    parts[n] = (skf_primitive){.shape = SKF_TRIANGLE, .triangle = part[i]};
    if (skf_primitive_measure(parts + n) > 0 && skf_primitive_check(parts + n, NULL) == SKF_OK) n++;
  }
  return n;
}

/* Where the circle meets the plane; in the middle where it only comes close. */
static int cut_arc(const skf_arc *a, int axis, double where, skf_primitive parts[3]) {
  skf_arc_axes axes = skf_arc_frame(a);
  double u = a->radius * v3_get(axes.e, axis), v = a->radius * v3_get(axes.f, axis), size = hypot(u, v);
  double cosine = (where - v3_get(a->center, axis)) / size, at = 0.5 * a->sweep;
  if (fabs(cosine) < 1) {
    for (int i = 0; i < 2; i++) {
      double t = atan2(v, u) + (i ? -1 : 1) * acos(cosine);
      t -= 2 * SKF_PI * floor(t / (2 * SKF_PI));
      if (t > 1e-9 * a->sweep && t < (1 - 1e-9) * a->sweep) at = t;
    }
  }
  parts[0] = parts[1] = (skf_primitive){.shape = SKF_ARC, .arc = *a};
  parts[0].arc.sweep = at, parts[1].arc.sweep = a->sweep - at;
  parts[1].arc.start = v3_mad(v3_scale(cos(at), axes.e), sin(at), axes.f);
  return 2;
}

int skf_far_piece_cut(const skf_primitive *p, int axis, double where, skf_primitive parts[3]) {
  if (p->shape == SKF_ARC) return cut_arc(&p->arc, axis, where, parts);
  if (p->shape == SKF_TRIANGLE) return cut_triangle(&p->triangle, axis, where, parts);
  skf_vec3 a = p->segment.from, b = p->segment.to, m = meet(a, b, axis, where);
  parts[0] = (skf_primitive){.shape = SKF_SEGMENT, .segment = {a, m}};
  parts[1] = (skf_primitive){.shape = SKF_SEGMENT, .segment = {m, b}};
  return skf_primitive_check(parts, NULL) || skf_primitive_check(parts + 1, NULL) ? 0 : 2;
}

/* Points are gathered until there are FAR_GATHER. */
typedef struct sink {
  const far_ops *ops;
  const far_layout *l;
  const far_harmonic *harmonic;
  skf_vec3 center;
  double per, *tensor;
  int count;
  double x[4][FAR_GATHER]; /* and weights */
} sink;

static void flush_polynomials(const sink *s) {
  double T[3][FAR_GATHER][FAR_ORDER + FAR_PAD];
  int n = s->l->order;
  for (int i = 0; i < FAR_GATHER; i++) {
    for (int k = 0; k < 3; k++) far_chebyshev(s->x[k][i], n, T[k][i]);
    for (int a = 0; a < n; a++) T[0][i][a] *= s->x[3][i];
    for (int c = n; c < FAR_ORDER + FAR_PAD; c++) T[2][i][c] = 0;
  }
  s->ops->points(s->l, T, s->tensor);
}

static void flush(sink *s) {
  for (int i = s->count; i < FAR_GATHER; i++) s->x[0][i] = s->x[1][i] = s->x[2][i] = s->x[3][i] = 0;
  if (s->count && s->harmonic)
    s->ops->gather(s->harmonic, s->x, s->tensor);
  else if (s->count)
    flush_polynomials(s);
  s->count = 0;
}

static void add_point(sink *s, skf_vec3 q, double weight) {
  int i = s->count++;
  for (int k = 0; k < 3; k++) s->x[k][i] = s->per * (v3_get(q, k) - v3_get(s->center, k));
  s->x[3][i] = weight;
  if (s->count == FAR_GATHER) flush(s);
}

/* Nodes along a curve of half-length h: the integrand's singularities are at least `gap` away. */
static int nodes(double h, double gap, double accuracy) {
  double d = gap / h, rho = d + sqrt(d * d + 1), n = ceil(0.5 * log(40 / accuracy) / log(rho)) + 1;
  return n > SKF_GAUSS_MAX ? SKF_GAUSS_MAX : (int)n;
}

static void add_piece(sink *s, const skf_primitive *p, double strength, double gap, double accuracy) {
  double measure = skf_primitive_measure(p), weight = strength * measure;
  skf_box box = skf_primitive_bounds(p);
  if (p->shape == SKF_POINT) {
    add_point(s, p->point.at, strength);
  } else if (p->shape == SKF_TRIANGLE) {
    int n = nodes(0.5 * box_diagonal(box), gap, accuracy);
    const skf_gauss_node *g = skf_gauss_rule(n);
    const skf_vec3 *v = p->triangle.vertices;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) {
        double u = 0.5 * (g[i].x + 1), t = 0.5 * (g[j].x + 1);
        skf_vec3 q = between(v[0], between(v[1], v[2], t), u);
        add_point(s, q, 0.5 * weight * g[i].w * g[j].w * u);
      }
  } else {
    int parts = p->shape == SKF_ARC ? (int)ceil(p->arc.sweep / 1.6) : 1;
    int n = nodes(0.5 * measure / parts * (p->shape == SKF_ARC ? 1.3 : 1), gap, accuracy);
    const skf_gauss_node *g = skf_gauss_rule(n);
    for (int k = 0; k < parts; k++)
      for (int i = 0; i < n; i++) {
        double t = (k + 0.5 * (g[i].x + 1)) / parts;
        add_point(s, skf_primitive_point(p, t, 0), 0.5 * weight / parts * g[i].w);
      }
  }
}

void skf_far_moments(const far_ops *ops, const far_layout *l, const far_harmonic *harmonic, const far_piece *piece,
                     size_t n, const skf_prepared *elements, skf_vec3 center, double per, double gap, double accuracy,
                     double *tensor) {
  sink s = {.ops = ops, .l = l, .harmonic = harmonic, .center = center, .per = per, .tensor = tensor};
  for (size_t i = 0; i < n; i++) add_piece(&s, &piece[i].primitive, elements[piece[i].element].strength, gap, accuracy);
  flush(&s);
}
