/* SPDX-License-Identifier: MIT */
/* A picture in the making, row by row, pass by pass. */
#ifndef SKF_RAY_RENDER_ROWS_H
#define SKF_RAY_RENDER_ROWS_H

#include "ray/render.h"

typedef struct skf_picture {
  skf_stage stage;
  const skf_render_scene *s;
  skf_sight *sights; /* NULL where rows are finished one by one */
  int stride;        /* floats of a lit place */
  float *raw, *lit;  /* from each pixel's own rays, smoothed twice in the end; smoothed once */
  unsigned char *marks;
  float *rgb, *depth;
  float *evaluations, *cells;
  skf_progress progress;
  double done, share; /* of the whole work: before this pass, in it */
  int rows;           /* finished in this pass */
  bool stop;
} skf_picture;

/* Pixels look for sky and lights in a part of the directions each; those of a block share them out, and smoothing over
   a block brings all of them together. */
enum { SKF_BLOCK = 4 };

/* ---- render_rows.c ---- */
typedef void skf_row(skf_picture *r, int y);
/* One after the other: what is seen, its light, that smoothed twice, its colours. */
skf_row skf_row_sight, skf_row_light, skf_row_smooth, skf_row_smooth_again, skf_row_shade;
/* All of them at once, for drafts. */
skf_row skf_row_draft;
/* What a stop left unpainted, which begins with NAN. */
skf_row skf_row_fill;
skf_row skf_row_cost;

/* Through a place of the picture, in the middle of the lens and of the shutter's time. */
skf_beam skf_camera_beam(const skf_picture *r, double px, double py);
/* Which share of the directions a pixel has. */
int skf_share_of(int x, int y);
/* Whether two pixels see one smooth piece of surface. */
bool skf_alike(const skf_sight *a, const skf_sight *b);
/* The light on n <= SKF_MANY places, with the quality's number of rays. */
void skf_light_places(const skf_picture *r, size_t n, const skf_sight *const *at, const skf_beam *beams,
                      float *const *lit);
void skf_put(skf_picture *r, size_t k, const double rgb[3]);

/* ---- render_refine.c ---- */
/* Before any pixel changes: which ones more rays go through; and these rays. */
skf_row skf_row_mark, skf_row_refine;
/* Many rays through each pixel, through lens and shutter. */
skf_row skf_row_scatter;

#endif
