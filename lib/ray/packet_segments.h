/* SPDX-License-Identifier: MIT */
/* First crossings in a leaf with segments, four lanes in a vector. Along a ray f = F - iso lies between parabolas: from
   a place where f and its slope are known, |f''| <= bend. The lower one of |f| is followed to its root, up to where no
   crossing can be, again and again; near a crossing both have a root and f is monotonic up to the farther one, so that
   there is exactly one crossing up to there, which Newton's steps refine. f'' may jump. */
#ifndef SKF_RAY_PACKET_SEGMENTS_H
#define SKF_RAY_PACKET_SEGMENTS_H

#include "ray/packet_ways.h"

/* f and its derivative */
typedef struct skf_slope {
  skf_vd f, df;
} skf_slope;

/* Upper bound of |f''| from u to u + h. Of a point m'^2 = D - 4 m2 m all along the ray, and m^2 (c2 + c3 m) has the
   second derivative 2 c2 (D - 6 m2 m) + 6 c3 m (D - 5 m2 m) where m > 0; m is concave. */
SKF_INLINE skf_vd bend_from(const skf_leaf *leaf, const skf_ways *ways, int v, skf_vd u, skf_vd h) {
  skf_vd zero = vd_set(0), sum = vd_set(1e-290), two = vd_set(2), four = vd_set(4), six = vd_set(6);
  for (uint32_t i = 0; i < leaf->count; i++) {
    const skf_blob *b = leaf->blobs + i;
    const skf_way *w = &ways->of[i][v];
    skf_vd m = w->m0 + u * (w->m1 - u * w->m2), dm = w->m1 - (u + u) * w->m2, end = m + h * (dm - h * w->m2);
    skf_vd most = m + h * vd_max(dm, zero), least = vd_max(vd_min(m, end), zero), bound;
    if (b->length > 0) {
      skf_vd y = vd_sqrt(vd_max(most, zero)), last = dm - (h + h) * w->m2;
      skf_vd steep = vd_max(vd_abs(dm), vd_abs(last)) + two * y * vd_abs(w->x1), moment = vd_set(b->moment) * y;
      skf_vd up = vd_set(4) * steep * steep, down = vd_set(16. / 3 * b->per) * y * y;
      if (b->c3 > 0) up *= vd_set(b->c2) + vd_set(3 * b->c3), down *= vd_set(b->c2 + 1.5 * b->c3);
      bound = vd_min(moment * vd_max(up, down), vd_set(skf_blob_bend(b)));
    } else {
      skf_vd D = dm * dm + four * w->m2 * m, six_m2 = six * w->m2, s = vd_set(b->strength);
      skf_vd up = two * (D - six_m2 * least), down = two * (six_m2 * most - D);
      if (b->c3 > 0) {
        skf_vd c2 = vd_set(b->c2), c3 = vd_set(b->c3), thirty = vd_set(30);
        up = c2 * up + c3 * six * D * most;
        down = c2 * down + c3 * thirty * w->m2 * most * most;
      }
      bound = s * vd_max(up, down);
    }
    sum += vd_select(most > zero, bound, zero);
  }
  return sum;
}

SKF_INLINE skf_slope slope_at(const skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, int v, skf_vd u) {
  skf_vd zero = vd_set(0), f = vd_set(-p->tracer->iso), df = zero;
  for (uint32_t i = 0; i < leaf->count; i++) {
    const skf_blob *b = leaf->blobs + i;
    const skf_way *w = &ways->of[i][v];
    skf_vd m = vd_max(w->m0 + u * (w->m1 - u * w->m2), zero), dm = w->m1 - (u + u) * w->m2;
    if (b->length > 0) {
      skf_beside at = beside(b, w->x0 + u * w->x1, m);
      skf_vd s = vd_set(b->moment);
      f += s * at.F, df += s * (at.by_m * dm + at.by_x * w->x1);
    } else if (leaf->soft) {
      skf_vd s = vd_set(b->strength) * m, c2 = vd_set(b->c2), c3m = vd_set(b->c3) * m;
      f += s * m * (c2 + c3m), df += s * dm * (vd_set(2) * c2 + vd_set(3) * c3m);
    } else {
      skf_vd s = vd_set(b->strength) * m;
      f += s * m, df += (s + s) * dm;
    }
  }
  return (skf_slope){f, df};
}

/* Where the lanes are; `lo` to `hi` brackets a crossing at about `u`, with f at lo. */
typedef struct skf_course {
  skf_vd u[VECTORS], lo[VECTORS], hi[VECTORS], f[VECTORS], side[VECTORS];
  skf_vi on[VECTORS], closing[VECTORS], hit[VECTORS], clear[VECTORS]; /* closing: a crossing is certain */
} skf_course;

/* The side of the surface on which a lane is; those that begin on it go to that to which f goes. */
SKF_INLINE skf_vi take_sides(const skf_ways *ways, int v, skf_slope at, skf_course *c) {
  skf_vd zero = vd_set(0), one = vd_set(1);
  skf_vi known = c->side[v] != zero, begins = ~known & ~(vd_abs(at.f) > ways->noise[v]);
  skf_vd own = vd_select(begins, at.df, at.f);
  c->side[v] = vd_select(known, c->side[v], vd_select(own > zero, one, -one));
  return begins;
}

/* One step of a vector's lanes. */
SKF_INLINE void step(const skf_leaf *leaf, const skf_ways *ways, int v, skf_slope at, skf_vd shift, skf_vi begins,
                     skf_course *c) {
  skf_vd zero = vd_set(0), two = vd_set(2), four = vd_set(4), noise = ways->noise[v], u = c->u[v];
  skf_vd phi = c->side[v] * at.f, g = c->side[v] * at.df, gg = g * g, rest = ways->length[v] - u;
  skf_vd per_slope = vd_set(1) / at.df, newton = at.f * per_slope;
  skf_vi on = c->on[v], closing = c->closing[v], open = on & ~closing, down = g < zero;
  /* how far to look ahead */
  skf_vd h = vd_select(down & ~begins, vd_min(two * vd_abs(newton), rest), rest);
  skf_vd B = bend_from(leaf, ways, v, u, h);
  /* refine a crossing, */
  skf_vi close = on & closing & ~(B * newton * newton > vd_abs(at.df) * shift);
  /* find out that there is one: the upper parabola's root is before 2 / (1 + sqrt(1/2)) high / |g|, */
  skf_vd low = vd_max(phi - noise, zero), high = phi + two * noise, across = vd_set(1.1716) * high * vd_abs(per_slope);
  skf_vi crosses = open & ~begins & (low > zero) & down & (gg > four * B * high) & (across <= h);
  c->lo[v] = vd_select(crosses, u, c->lo[v]), c->hi[v] = vd_select(crosses, u + across, c->hi[v]);
  c->f[v] = vd_select(crosses, at.f, c->f[v]);
  /* or go on to the lower parabola's root */
  skf_vd root = vd_sqrt(gg + two * B * low);
  skf_vd stride = vd_select(down, two * low, g + root) / vd_select(down, root - g, B);
  skf_vi moves = open & ~crosses & ~begins & (low > zero);
  if (vi_any(begins)) { /* from the surface to where it is highest */
    skf_vd leave = vd_min(g / B, rest);
    moves |= open & begins & (leave * (g - vd_set(0.5) * B * leave) > four * noise);
    stride = vd_select(begins, leave, stride);
  }
  skf_vi through = moves & (stride >= rest);
  skf_vd refined = clamped(u - newton, c->lo[v], c->hi[v]);
  c->u[v] = vd_select(on, vd_select(closing | crosses, refined, u + vd_min(stride, h)), u);
  c->closing[v] = closing | crosses;
  c->hit[v] |= close, c->clear[v] |= through;
  c->on[v] = (on & closing & ~close) | crosses | (moves & ~through);
}

SKF_INLINE void follow(skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, unsigned lanes, skf_course *c) {
  enum { STEPS = 24 };
  unsigned busy = lanes;
  for (int v = 0; v < VECTORS; v++) {
    c->u[v] = quiet_until(leaf, ways, v), c->lo[v] = c->hi[v] = c->f[v] = vd_set(0), c->side[v] = sides_of(p, v),
    c->on[v] = lanes_on(lanes, v);
    c->closing[v] = c->hit[v] = c->clear[v] = vi_set(0);
  }
  for (int i = 0; i < STEPS && busy; i++) {
    p->looks += (size_t)__builtin_popcount(busy);
    busy = 0;
    for (int v = 0; v < VECTORS; v++) {
      if (!vi_any(c->on[v])) continue;
      skf_slope at = slope_at(p, leaf, ways, v, c->u[v]);
      skf_vi begins = i ? vi_set(0) : take_sides(ways, v, at, c);
      step(leaf, ways, v, at, vd_load(p->shift + SKF_LANES * v), begins, c);
      busy |= (unsigned)vi_bits(c->on[v]) << (SKF_LANES * v);
    }
  }
}

#endif
