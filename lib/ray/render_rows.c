/* SPDX-License-Identifier: MIT */
/* Pictures of one ray through each pixel's centre: what it meets, what light is there, what that looks like. */
#include "ray/render_rows.h"

/* Neighbours get distant shares. */
int skf_share_of(int x, int y) {
  static const unsigned char order[SKF_BLOCK][SKF_BLOCK] = {
      {0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
  return order[y % SKF_BLOCK][x % SKF_BLOCK];
}

/* The part of a beam that light asks for. */
static skf_beam light_beam(int x, int y) {
  return (skf_beam){.time = 0.5, .share = skf_share_of(x, y), .jitter = {skf_hashed(x, y, 1), skf_hashed(x, y, 2)}};
}

skf_beam skf_camera_beam(const skf_picture *r, double px, double py) {
  skf_beam b = light_beam((int)px, (int)py);
  b.weight = 1, b.height = 1 - py / r->s->height;
  skf_view_row(&r->stage.view, r->s->width, r->s->height, px, py, 1, &b);
  return b;
}

void skf_light_places(const skf_picture *r, size_t n, const skf_sight *const *at, const skf_beam *beams,
                      float *const *lit) {
  int times = r->s->quality == SKF_RENDER_FINE ? 4 : 1;
  if (r->s->quality != SKF_RENDER_DRAFT) {
    skf_light_many(&r->stage, n, at, beams, 2 * times, times, false, lit);
    return;
  }
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < r->stride; k++) lit[i][k] = 1;
}

bool skf_alike(const skf_sight *a, const skf_sight *b) {
  if (a->body != b->body || a->inside != b->inside) return false;
  if (a->body == SKF_NOTHING) return true;
  if (!(v3_dot(a->normal, b->normal) > 0.9)) return false;
  skf_vec3 way = v3_sub(b->at, a->at);
  double off = v3_dot(way, a->normal), square = v3_norm2(way);
  return 4 * off * off <= square || fabs(off) <= 0.5 * sqrt(square) + 1e-12 * a->t;
}

/* The mean over a block of pixels that starts at (x0, y0) and holds (x, y), of those like it; hard light stays. */
static void smooth_light(const skf_picture *r, const float *from, int x, int y, int x0, int y0, float *out) {
  int w = r->s->width, h = r->s->height, n = 0, stride = r->stride;
  size_t own = (size_t)y * w + x;
  if (r->sights[own].body == SKF_NOTHING) return;
  float sum[SKF_LIT] = {0};
  for (int j = y0; j < y0 + SKF_BLOCK; j++)
    for (int i = x0; i < x0 + SKF_BLOCK; i++) {
      size_t k = (size_t)j * w + i;
      if (i < 0 || j < 0 || i >= w || j >= h || !skf_alike(r->sights + own, r->sights + k)) continue;
      for (int c = 0; c < stride; c++) sum[c] += from[k * stride + c];
      n++;
    }
  for (int c = 0; c < stride; c++) {
    bool keep = n == 0 || (c && r->stage.hard[(c - 1) / 3]); /* n = 0: no normal */
    out[c] = keep ? from[own * stride + c] : sum[c] / (float)n;
  }
}

static int smaller(int a, int b) { return a < b ? a : b; }

/* Beams from pixel x on, n of them; light is not asked for along them. */
static void set_out(const skf_picture *r, int x, int y, int n, skf_beam *beams) {
  const skf_beam first = {.time = 0.5, .weight = 1, .height = 1 - (y + 0.5) / r->s->height};
  for (int i = 0; i < n; i++) beams[i] = first;
  skf_view_row(&r->stage.view, r->s->width, r->s->height, x + 0.5, y + 0.5, n, beams);
}

static void see(const skf_picture *r, int x, int y, int n, skf_beam *beams, skf_sight *out) {
  set_out(r, x, y, n, beams);
  skf_look_many(&r->stage, (size_t)n, beams, out);
}

void skf_row_sight(skf_picture *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x += SKF_MANY) {
    skf_beam beams[SKF_MANY];
    see(r, x, y, w - x < SKF_MANY ? w - x : SKF_MANY, beams, r->sights + (size_t)y * w + x);
  }
}

void skf_row_cost(skf_picture *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x++) {
    skf_beam beam = skf_camera_beam(r, x + 0.5, y + 0.5);
    skf_ray_report report = {0};
    size_t k = (size_t)y * w + x;
    skf_look_along(&r->stage, &beam, &report);
    if (r->evaluations) r->evaluations[k] = (float)report.evaluations;
    if (r->cells) r->cells[k] = (float)report.cells;
  }
}

/* The rows of a block from y on. Pixels with the same share of the directions ask together: their rays are parallel. */
void skf_row_light(skf_picture *r, int y) {
  int w = r->s->width;
  if (y % SKF_BLOCK) return;
  for (int k = 0; k < SKF_BLOCK * SKF_BLOCK; k++) {
    int row = y + k / SKF_BLOCK;
    if (row >= r->s->height) return;
    skf_beam beams[SKF_MANY];
    const skf_sight *at[SKF_MANY];
    float *lit[SKF_MANY];
    size_t n = 0;
    for (int x = k % SKF_BLOCK; x < w; x += SKF_BLOCK) {
      size_t i = (size_t)row * w + x;
      if (r->sights[i].body == SKF_NOTHING) continue;
      beams[n] = light_beam(x, row), at[n] = r->sights + i, lit[n++] = r->raw + i * r->stride;
      if (n == SKF_MANY) skf_light_places(r, n, at, beams, lit), n = 0;
    }
    skf_light_places(r, n, at, beams, lit);
  }
}

/* One block is not centred on its pixel; two, shifted either way, are. */
void skf_row_smooth(skf_picture *r, int y) {
  for (int x = 0; x < r->s->width; x++) {
    size_t k = (size_t)y * r->s->width + x;
    smooth_light(r, r->raw, x, y, x - 1, y - 1, r->lit + k * r->stride);
  }
}

void skf_row_smooth_again(skf_picture *r, int y) {
  for (int x = 0; x < r->s->width; x++) {
    size_t k = (size_t)y * r->s->width + x;
    smooth_light(r, r->lit, x, y, x - 2, y - 2, r->raw + k * r->stride);
  }
}

void skf_put(skf_picture *r, size_t k, const double rgb[3]) {
  for (int c = 0; c < 3; c++) r->rgb[3 * k + c] = (float)rgb[c];
}

void skf_row_shade(skf_picture *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x += SKF_MANY) {
    skf_beam beams[SKF_MANY];
    int n = w - x < SKF_MANY ? w - x : SKF_MANY;
    size_t k = (size_t)y * w + x;
    double rgb[SKF_MANY][3];
    set_out(r, x, y, n, beams);
    skf_radiance_many(&r->stage, (size_t)n, beams, r->sights + k, r->raw + k * r->stride, (size_t)r->stride, rgb);
    for (int i = 0; i < n; i++) skf_put(r, k + i, rgb[i]);
  }
}

/* Beams through the pixels of a square, no more than `most` to a side, in the order in which they go through the octree
   together: 4 x 2 beside each other. Returns how many, and each one's pixel. */
static int tile(const skf_picture *r, int x, int y, int most, skf_beam *beams, size_t *pixel) {
  enum { WIDE = 4, HIGH = 2 };
  int n = 0, right = smaller(x + most, r->s->width), bottom = smaller(y + most, r->s->height);
  for (int top = y; top < bottom; top += HIGH)
    for (int left = x; left < right; left += WIDE)
      for (int j = top; j < smaller(top + HIGH, bottom); j++) {
        int m = smaller(WIDE, right - left);
        set_out(r, left, j, m, beams + n);
        for (int i = 0; i < m; i++) pixel[n++] = (size_t)j * r->s->width + left + i;
      }
  return n;
}

/* The rows of tiles from y on. */
void skf_row_draft(skf_picture *r, int y) {
  enum { SIDE = 8 };
  float lit[SKF_LIT];
  if (y % SIDE) return;
  for (int k = 0; k < SKF_LIT; k++) lit[k] = 1;
  for (int x = 0; x < r->s->width; x += SIDE) {
    skf_beam beams[SIDE * SIDE];
    skf_sight sights[SIDE * SIDE];
    size_t pixel[SIDE * SIDE];
    double rgb[SIDE * SIDE][3];
    int n = tile(r, x, y, SIDE, beams, pixel);
    skf_look_many(&r->stage, (size_t)n, beams, sights);
    skf_radiance_many(&r->stage, (size_t)n, beams, sights, lit, 0, rgb);
    for (int i = 0; i < n; i++) {
      skf_put(r, pixel[i], rgb[i]);
      if (r->depth && sights[i].body >= 0) r->depth[pixel[i]] = (float)sights[i].t;
    }
  }
}

void skf_row_fill(skf_picture *r, int y) {
  int w = r->s->width;
  if (!isnan(r->rgb[3 * (size_t)y * w])) return;
  if (r->sights) {
    skf_row_shade(r, y);
    return;
  }
  for (int x = 0; x < w; x++) {
    const skf_sight nothing = {.body = SKF_NOTHING, .t = INFINITY};
    double rgb[3];
    skf_beam beam = skf_camera_beam(r, x + 0.5, y + 0.5);
    skf_radiance(&r->stage, &beam, &nothing, NULL, rgb);
    skf_put(r, (size_t)y * w + x, rgb);
  }
}
