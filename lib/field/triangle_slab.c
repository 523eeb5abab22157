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

/* A triangle with one side on Y = Y0 from x1, of length L, and its apex at (apex, Y0 + H). */
typedef struct slab {
  skf_compact_kind kind;
  double R, z, rm;
  double Y0, H, x1, L, apex;
  int breaks;
  double at[12]; /* in (0, 1) of H */
} slab;

static void cut(slab *s, double t) {
  if (!(t > 0 && t < 1)) return;
  int i = s->breaks++;
  for (; i > 1 && s->at[i - 1] > t; i--) s->at[i] = s->at[i - 1];
  s->at[i] = t;
}

/* Where the side from (x, Y0) to the apex crosses the rim. */
static void cut_side(slab *s, double x) {
  double k = s->apex - x, qa = k * k + s->H * s->H, qb = x * k + s->Y0 * s->H;
  double qc = (x - s->rm) * (x + s->rm) + s->Y0 * s->Y0, D = qb * qb - qa * qc;
  if (!(D > 0)) return;
  double q = -(qb + copysign(sqrt(D), qb));
  cut(s, q / qa);
  if (q != 0) cut(s, qc / q);
}

static void slice(const slab *s, double t, double Y, double w, bool cut_left, bool cut_right, moments *m) {
  double chord = sqrt(fmax((s->rm - Y) * (s->rm + Y), 0)), xl = s->x1 + (s->apex - s->x1) * t, wide = s->L * (1 - t);
  double b = cut_left ? -chord : xl, len = cut_right ? chord - b : xl + wide - b;
  if (!cut_left && !cut_right) len = wide;
  if (!(len > 0)) return;
  double R2 = s->R * s->R, l[SKF_PANEL_NODES], wl[SKF_PANEL_NODES];
  if (s->kind != SKF_COMPACT_CONE) {
    const skf_gauss_node *g = skf_gauss_rule(4);
    for (int i = 0; i < 4; i++) {
      double x = b + 0.5 * len * (1 + g[i].x), y = (chord - x) * (chord + x) / R2;
      add(m, 0.5 * len * g[i].w * w, skf_compact_at(s->kind, y, 0, s->R), x, Y);
    }
    return;
  }
  double c = hypot(Y, s->z), delta = fmax(c, fmax(1e-3 * skf_edge_nearest(b, b + len), 1e-9 * s->L)), total = 0;
  skf_panels p = skf_panels_over(b, b + len, delta);
  for (int pass = 0; pass < 2; pass++) /* the panels' total length first: they end short by rounding */
    for (int k = 0; k < p.count; k++) {
      skf_panel_nodes(&p, k, l, wl);
      for (int i = 0; i < SKF_PANEL_NODES; i++) {
        if (!pass)
          total += wl[i];
        else
          add(m, wl[i] * w * (len / total),
              skf_compact_at(s->kind, (chord - l[i]) * (chord + l[i]) / R2, hypot(c, l[i]), s->R), l[i], Y);
      }
    }
}

/* Between two breaks. Next to the top of the disc the chord goes like a root: Y = rm sin(theta). */
static void band(const slab *s, double t1, double t2, moments *m) {
  const skf_gauss_node *g = skf_gauss_rule(20);
  double tm = 0.5 * (t1 + t2), Ym = s->Y0 + tm * s->H, Y1 = s->Y0 + t1 * s->H, Y2 = s->Y0 + t2 * s->H, rm = s->rm;
  if (fabs(Ym) >= rm) return;
  double chord = sqrt((rm - Ym) * (rm + Ym)), xl = s->x1 + (s->apex - s->x1) * tm, xr = xl + s->L * (1 - tm);
  bool left = xl<-chord, right = xr> chord;
  if (fmax(xl, -chord) >= fmin(xr, chord)) return;
  bool top = (left || right) && fmin(rm - fabs(Y1), rm - fabs(Y2)) < fabs(Y2 - Y1);
  double th1 = atan2(Y1, sqrt(fmax((rm - Y1) * (rm + Y1), 0))), th2 = atan2(Y2, sqrt(fmax((rm - Y2) * (rm + Y2), 0)));
  for (int i = 0; i < 20; i++) {
    if (top) {
      double th = 0.5 * (th1 + th2) + 0.5 * (th2 - th1) * g[i].x, Y = rm * sin(th);
      slice(s, (Y - s->Y0) / s->H, Y, 0.5 * fabs(th2 - th1) * g[i].w * rm * cos(th), left, right, m);
    } else {
      double t = tm + 0.5 * (t2 - t1) * g[i].x;
      slice(s, t, s->Y0 + t * s->H, 0.5 * (t2 - t1) * g[i].w * fabs(s->H), left, right, m);
    }
  }
}

static void slab_moments(slab *s, moments *m) {
  s->at[0] = 0;
  s->breaks = 1;
  cut_side(s, s->x1);
  cut_side(s, s->x1 + s->L);
  for (int i = -2; i <= 2; i++) cut(s, (0.5 * i * s->rm - s->Y0) / s->H);
  s->at[s->breaks] = 1;
  for (int i = 0; i < s->breaks; i++) band(s, s->at[i], s->at[i + 1], m);
}

/* A corner in the plane: abscissa along the longest edge, distance across it from p'. */
typedef struct corner {
  double x, Y;
} corner;

typedef struct parts {
  skf_compact_kind kind;
  double R, z, rm, small;
  int count;
  moments *m;
} parts;

/* Splits at the middle corner's height, so that both pieces have a side along X. */
static void leaf_slabs(const parts *p, const corner v[3], double area) {
  corner a = v[0], b = v[1], c = v[2], swap;
  if (a.Y > b.Y) swap = a, a = b, b = swap;
  if (b.Y > c.Y) swap = b, b = c, c = swap;
  if (a.Y > b.Y) swap = a, a = b, b = swap;
  double H = c.Y - a.Y;
  if (!(H > 0 && area > 0)) return;
  double L = 2 * area / H, x = fmin(b.x, a.x + (c.x - a.x) * ((b.Y - a.Y) / H));
  slab s = {.kind = p->kind, .R = p->R, .z = p->z, .rm = p->rm, .Y0 = b.Y, .x1 = x, .L = L};
  if (b.Y > a.Y) s.H = a.Y - b.Y, s.apex = a.x, slab_moments(&s, p->m);
  if (c.Y > b.Y) s.H = c.Y - b.Y, s.apex = c.x, slab_moments(&s, p->m);
}

static void whole(const parts *p, const skf_vec3 a[3], double area, int n) {
  const skf_gauss_node *g = skf_gauss_rule(n);
  for (int i = 0; i < n; i++) {
    double xi = 0.5 * (1 + g[i].x), wi = 0.5 * area * g[i].w * xi;
    skf_vec3 start = v3_add(v3_scale(1 - xi, a[0]), v3_scale(xi, a[1]));
    for (int j = 0; j < n; j++) {
      skf_vec3 X = v3_mad(start, 0.5 * xi * (1 + g[j].x), v3_sub(a[2], a[1]));
      double y = (p->R * p->R - v3_norm2(X)) / (p->R * p->R);
      if (y > 0) add(p->m, wi * g[j].w, skf_compact_at(p->kind, y, v3_norm(X), p->R), X.x, X.y);
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
    a[i] = v3(v[i].x, v[i].Y, -p->z);
    reach = fmax(reach, v3_norm(a[i]));
    len[i] = hypot(v[(i + 1) % 3].x - v[i].x, v[(i + 1) % 3].Y - v[i].Y);
    if (len[i] > len[k]) k = i;
  }
  double dist = skf_triangle_distance(a);
  if (dist >= p->R) return;
  bool far = len[k] <= 0.8 * dist, done = len[k] < p->small || ++p->count > MAX_PARTS;
  if (reach <= p->R && (far || done)) {
    whole(p, a, area, far ? skf_quad_order(dist, len[k]) : 3);
    return;
  }
  if (far || done) {
    leaf_slabs(p, v, area);
    return;
  }
  corner b = v[k], c = v[(k + 1) % 3], d = v[(k + 2) % 3], mid = {0.5 * (b.x + c.x), 0.5 * (b.Y + c.Y)};
  bisect(p, (corner[]){b, mid, d}, 0.5 * area);
  bisect(p, (corner[]){mid, c, d}, 0.5 * area);
}

void skf_compact_slabs(skf_compact_kind kind, double R, const skf_triangle_view *g, int order, skf_value *v) {
  const skf_triangle_plan *T = g->T;
  int i = T->longest;
  double z = g->z, d = g->d[i], height = T->twice / T->diam;
  if (fabs(z) >= R) return;
  moments m = {0};
  double rm = sqrt((R - fabs(z)) * (R + fabs(z)));
  if (kind == SKF_COMPACT_CONE) {
    parts p = {kind, R, z, rm, 1e-7 * fmin(height, R), 0, &m};
    bisect(&p, (corner[]){{g->l1[i], -d}, {g->l2[i], -d}, {skf_triangle_apex(g), height - d}}, T->area);
  } else {
    slab s = {.kind = kind,
              .R = R,
              .z = z,
              .rm = rm,
              .Y0 = -d,
              .H = height,
              .x1 = g->l1[i],
              .L = T->diam,
              .apex = skf_triangle_apex(g)};
    slab_moments(&s, &m);
  }
  /* q - p = (X, -Y, -z) in (t, m, n) */
  v->F = m.h;
  v->g = v3_add(v3_scale(-m.g[1], T->t[i]), v3_add(v3_scale(m.g[2], T->m[i]), v3_scale(z * m.g[0], T->n)));
  if (order < 2) return;
  skf_triangle_rotate(
      T, (double[]){m.g[0] + m.k[3], -m.k[4], -z * m.k[1], m.g[0] + m.k[5], z * m.k[2], m.g[0] + z * z * m.k[0]}, v->h);
}
