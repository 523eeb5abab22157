/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between the files of `skelfield render`. */
#ifndef SKF_TOOLS_RENDER_JOB_H
#define SKF_TOOLS_RENDER_JOB_H

#include "picture.h"
#include "run_csv.h"

typedef enum render_mode { RENDER_SURFACE, RENDER_OFFSET, RENDER_COST } render_mode;

/* One picture, from the command line to its bytes. */
typedef struct render_job {
  const cli *c;
  skf_scene *scene;
  const skf_plot *plot; /* NULL where nothing is drawn or read */
  const skf_picture_format *format;
  run_data run;
  run_bodies_data moved;
  render_mode mode;
  int bits;    /* of a channel: 8 or 16 */
  double time; /* of the spins [T] */
  bool skeleton;
  int frames;   /* 0: one picture */
  bool video;   /* an AVI file */
  double until; /* time of the last frame */
  skf_render_scene what;
  skf_render_body *bodies;
  skf_tracer **tracers;    /* of each body */
  skf_offsets **offsets;   /* of each body, and of its skeleton behind them */
  skf_offset **items;      /* what they are made of */
  unsigned char **look_of; /* of those items */
  skf_element **kept;      /* the elements that they are around */
  skf_look **looks;        /* of bodies that are seen through, or skeletons */
  size_t body_count;
  float *rgb, *depth;
  bool cut;       /* interrupted */
  char label[40]; /* of the progress bar */
} render_job;

/* ---- render_scene.c: from the scene to what is rendered; CLI_DONE, or a status after the message ---- */
int render_images(render_job *j);
int render_bodies(render_job *j);
int render_camera(render_job *j);
void render_ground(render_job *j);
/* Turns the bodies to the job's time. */
void render_spin(render_job *j);
/* Frees all but the scene and the run. */
void render_release(render_job *j);

/* ---- render_output.c ---- */
/* Whether the picture is a PNG or PPM without paths or axes, which needs no drawing module. */
bool render_is_plain(const render_job *j);
/* Traces it, with the paths up to the job's time, or draws its cost map; its bytes go back with render_give_back. */
int render_picture(render_job *j, unsigned char **bytes, size_t *n);
void render_give_back(const render_job *j, unsigned char *bytes);

/* ---- render_film.c ---- */
int render_film_parse(render_job *j);
int render_film(render_job *j);

#endif
