/* SPDX-License-Identifier: MIT */
/* Kernels of finite support where the edge sums cancel: slices parallel to one side, clipped by the support. */
#include "field/triangle_compact.h"

/* Moments over the triangle, with X along the longest edge and Y across it from p', of h; g = h'/r times 1, X, Y; and
   k = (h'/r)'/r times 1, X, Y, X^2, X Y, Y^2. */
typedef struct moments {
  double h, g[3], k[6];
} moments;

static void add(moments *m, double w, skf_compact_node p, double X, double Y) {
  m->h += w * p.h;
  p.g *= w;
  m->g[0] += p.g;
  m->g[1] += p.g * X;
  m->g[2] += p.g * Y;
  p.k *= w;
  m->k[0] += p.k;
  m->k[1] += p.k * X;
  m->k[2] += p.k * Y;
  m->k[3] += p.k * X * X;
  m->k[4] += p.k * X * Y;
  m->k[5] += p.k * Y * Y;
}

/* A triangle with one side on eta = e0 from x1, of length L, and its apex at (apex, e0 + H). eta is the distance from
   the longest edge, Y = eta - d that from p'. The disc spans top[0] < eta < top[1]. */
typedef struct slab {
  skf_compact_kind kind;
  double R, z, d, top[2];
  double e0, H, x1, L, apex;
  int breaks;
  double at[12]; /* in (0, 1) of H */
} slab;

static double chord2(const slab *s, double eta) { return (eta - s->top[0]) * (s->top[1] - eta); }

static void cut(slab *s, double t) {
  if (!(t > 0 && t < 1)) return;
  int i = s->breaks++;
  for (; i > 1 && s->at[i - 1] > t; i--) s->at[i] = s->at[i - 1];
  s->at[i] = t;
}

/* Where the side from (x, e0) to the apex crosses the rim. */
static void cut_side(slab *s, double x) {
  double k = s->apex - x, qa = k * k + s->H * s->H, qb = x * k + (s->e0 - s->d) * s->H;
  double qc = x * x - chord2(s, s->e0), D = qb * qb - qa * qc;
  if (!(D > 0)) return;
  double q = -(qb + copysign(sqrt(D), qb));
  cut(s, q / qa);
  if (q != 0) cut(s, qc / q);
}

static void cone_line(const slab *s, double b, double len, double chord, double Y, double w, moments *m) {
  double l[SKF_PANEL_NODES], wl[SKF_PANEL_NODES], R2 = s->R * s->R, total = 0, c = sqrt(Y * Y + s->z * s->z);
  double delta = fmax(c, fmax(1e-3 * skf_edge_nearest(b, b + len), 1e-9 * s->L));
  skf_panels p = skf_panels_over(b, b + len, delta);
  for (int pass = 0; pass < 2; pass++) /* the panels' total length first: they end short by rounding */
    for (int k = 0; k < p.count; k++) {
      skf_panel_nodes(&p, k, l, wl);
      for (int i = 0; i < SKF_PANEL_NODES; i++) {
        double y = (chord - l[i]) * (chord + l[i]) / R2, r = sqrt(c * c + l[i] * l[i]);
        if (pass)
          add(m, wl[i] * w * (len / total), skf_compact_at(s->kind, y, r, s->R), l[i], Y);
        else
          total += wl[i];
      }
    }
}

static void slice(const slab *s, double eta, double w, bool cut_left, bool cut_right, moments *m) {
  double t = (eta - s->e0) / s->H, wide = s->L * (1 - t), xl = s->x1 + (s->apex - s->x1) * t;
  double chord = sqrt(fmax(chord2(s, eta), 0)), b = cut_left ? -chord : xl, len = cut_right ? chord - b : xl + wide - b;
  if (!cut_left && !cut_right) len = wide;
  if (!(len > 0)) return;
  if (s->kind == SKF_COMPACT_CONE) {
    cone_line(s, b, len, chord, eta - s->d, w, m);
    return;
  }
  const skf_gauss_node *g = skf_gauss_rule(4);
  for (int i = 0; i < 4; i++) {
    double x = b + 0.5 * len * (1 + g[i].x), y = (chord - x) * (chord + x) / (s->R * s->R);
    add(m, 0.5 * len * g[i].w * w, skf_compact_at(s->kind, y, 0, s->R), x, eta - s->d);
  }
}

/* Between two breaks. Next to the top of the disc the chord goes like a root: eta = top +- q^2. */
static void band(const slab *s, double t1, double t2, moments *m) {
  const skf_gauss_node *g = skf_gauss_rule(20);
  double tm = 0.5 * (t1 + t2), e1 = s->e0 + t1 * s->H, e2 = s->e0 + t2 * s->H, c2 = chord2(s, s->e0 + tm * s->H);
  if (!(c2 > 0)) return;
  double chord = sqrt(c2), xl = s->x1 + (s->apex - s->x1) * tm, xr = xl + s->L * (1 - tm);
  bool left = xl<-chord, right = xr> chord;
  if (fmax(xl, -chord) >= fmin(xr, chord)) return;
  bool low = s->e0 + tm * s->H < s->d;
  double top = low ? s->top[0] : s->top[1], h1 = fmax(low ? e1 - top : top - e1, 0),
         h2 = fmax(low ? e2 - top : top - e2, 0);
  bool root = (left || right) && fmin(h1, h2) < fabs(e2 - e1);
  double q1 = sqrt(h1), q2 = sqrt(h2);
  for (int i = 0; i < 20; i++) {
    double q = 0.5 * (q1 + q2) + 0.5 * (q2 - q1) * g[i].x;
    if (root)
      slice(s, low ? top + q * q : top - q * q, fabs(q2 - q1) * q * g[i].w, left, right, m);
    else
      slice(s, s->e0 + (tm + 0.5 * (t2 - t1) * g[i].x) * s->H, 0.5 * (t2 - t1) * g[i].w * fabs(s->H), left, right, m);
  }
}

static void slab_moments(slab *s, moments *m) {
  double rm = 0.5 * (s->top[1] - s->top[0]);
  s->at[0] = 0;
  s->breaks = 1;
  cut_side(s, s->x1);
  cut_side(s, s->x1 + s->L);
  cut(s, (s->top[0] - s->e0) / s->H);
  cut(s, (s->top[1] - s->e0) / s->H);
  for (int i = -1; i <= 1; i++) cut(s, (s->d + 0.5 * i * rm - s->e0) / s->H);
  s->at[s->breaks] = 1;
  for (int i = 0; i < s->breaks; i++) band(s, s->at[i], s->at[i + 1], m);
}

/* A corner in the plane: abscissa along the longest edge, distance from it. */
typedef struct corner {
  double x, eta;
} corner;

typedef struct parts {
  slab disc; /* kind, R, z, d, top */
  double small;
  int count;
  moments *m;
} parts;

/* Splits at the middle corner's height, so that both pieces have a side along X. */
static void leaf_slabs(const parts *p, const corner v[3], double area) {
  corner a = v[0], b = v[1], c = v[2], swap;
  if (a.eta > b.eta) swap = a, a = b, b = swap;
  if (b.eta > c.eta) swap = b, b = c, c = swap;
  if (a.eta > b.eta) swap = a, a = b, b = swap;
  double H = c.eta - a.eta;
  if (!(H > 0 && area > 0)) return;
  slab s = p->disc;
  s.e0 = b.eta;
  s.L = 2 * area / H;
  s.x1 = fmin(b.x, a.x + (c.x - a.x) * ((b.eta - a.eta) / H));
  if (b.eta > a.eta) s.H = a.eta - b.eta, s.apex = a.x, slab_moments(&s, p->m);
  if (c.eta > b.eta) s.H = c.eta - b.eta, s.apex = c.x, slab_moments(&s, p->m);
}

static void whole(const parts *p, const skf_vec3 a[3], double area, int n) {
  const skf_gauss_node *g = skf_gauss_rule(n);
  double R = p->disc.R;
  for (int i = 0; i < n; i++) {
    double xi = 0.5 * (1 + g[i].x), wi = 0.5 * area * g[i].w * xi;
    skf_vec3 start = v3_add(v3_scale(1 - xi, a[0]), v3_scale(xi, a[1]));
    for (int j = 0; j < n; j++) {
      skf_vec3 X = v3_mad(start, 0.5 * xi * (1 + g[j].x), v3_sub(a[2], a[1]));
      double y = (chord2(&p->disc, X.y + p->disc.d) - X.x * X.x) / (R * R);
      if (y > 0) add(p->m, wi * g[j].w, skf_compact_at(p->disc.kind, y, v3_norm(X), R), X.x, X.y);
    }
  }
}

#define MAX_PARTS 20000

/* The cone's kink at r = 0: bisect until a part is as far as its size. */
static void bisect(parts *p, const corner v[3], double area) {
  skf_vec3 a[3];
  double reach = 0, len[3];
  int k = 0;
  for (int i = 0; i < 3; i++) {
    a[i] = v3(v[i].x, v[i].eta - p->disc.d, -p->disc.z);
    reach = fmax(reach, v3_norm(a[i]));
    len[i] = hypot(v[(i + 1) % 3].x - v[i].x, v[(i + 1) % 3].eta - v[i].eta);
    if (len[i] > len[k]) k = i;
  }
  double dist = skf_triangle_distance(a);
  if (dist >= p->disc.R) return;
  bool far = len[k] <= 0.8 * dist, done = len[k] < p->small || ++p->count > MAX_PARTS;
  if (reach <= p->disc.R && (far || done)) {
    whole(p, a, area, far ? skf_quad_order(dist, len[k]) : 3);
    return;
  }
  if (far || done) {
    leaf_slabs(p, v, area);
    return;
  }
  corner b = v[k], c = v[(k + 1) % 3], d = v[(k + 2) % 3], mid = {0.5 * (b.x + c.x), 0.5 * (b.eta + c.eta)};
  bisect(p, (corner[]){b, mid, d}, 0.5 * area);
  bisect(p, (corner[]){mid, c, d}, 0.5 * area);
}

void skf_compact_slabs(skf_compact_kind kind, const skf_disc *disc, const skf_triangle_view *g, int order,
                       skf_value *v) {
  const skf_triangle_plan *T = g->T;
  int i = T->longest;
  double z = g->z, d = g->d[i], height = T->twice / T->diam;
  moments m = {0};
  double base2 = skf_disc_chord2(disc, g, i), apex = skf_triangle_apex(g);
  slab s = {.kind = kind, .R = disc->R, .z = z, .d = d, .H = height, .x1 = g->l1[i], .L = T->diam, .apex = apex};
  /* the roots of base2 + 2 d eta - eta^2 */
  double far = d + copysign(disc->rm, d), near = -base2 / far;
  s.top[0] = fmin(far, near);
  s.top[1] = fmax(far, near);
  if (kind == SKF_COMPACT_CONE) {
    parts p = {s, 1e-7 * fmin(height, disc->R), 0, &m};
    bisect(&p, (corner[]){{g->l1[i], 0}, {g->l2[i], 0}, {apex, height}}, T->area);
  } else {
    slab_moments(&s, &m);
  }
  /* q - p = (X, -Y, -z) in (t, m, n) */
  v->F = m.h;
  v->g = v3_add(v3_scale(-m.g[1], T->t[i]), v3_add(v3_scale(m.g[2], T->m[i]), v3_scale(z * m.g[0], T->n)));
  if (order < 2) return;
  skf_triangle_rotate(
      T, (double[]){m.g[0] + m.k[3], -m.k[4], -z * m.k[1], m.g[0] + m.k[5], z * m.k[2], m.g[0] + z * z * m.k[0]}, v->h);
}
