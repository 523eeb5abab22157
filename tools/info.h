/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `skelfield info` tells about a body, before it is words or JSON. */
#ifndef SKF_TOOLS_INFO_H
#define SKF_TOOLS_INFO_H

#include "cli.h"
#include "skelfield/handles.h"

typedef struct info_kernel {
  size_t count;
  double least, most; /* of its parameter */
} info_kernel;

typedef struct info_body {
  const skf_body *body;
  size_t count[SKF_SHAPE_COUNT];
  double measure[SKF_SHAPE_COUNT]; /* sum of mu */
  double total;                    /* sum of w mu, mu weighted by profiles */
  size_t profiled;                 /* primitives with a profile */
  bool massless;                   /* neither given nor to be had from a total that is not finite: a plane's */
  double mass, gm;                 /* rho times total, or as given; NAN where massless */
  skf_box skeleton;
  skf_status surface; /* SKF_OK: region holds; SKF_ERR_UNBOUNDED, SKF_ERR_EMPTY or another failure */
  bool around;        /* the surface encloses the outside, see skf_surface_region */
  skf_box region;
  info_kernel kernels[SKF_KERNEL_COUNT];
  bool pairs[SKF_KERNEL_COUNT][SKF_SHAPE_COUNT];
} info_body;

void info_gather(const skf_scene *scene, const skf_body *body, info_body *out);
/* "bounded", "unbounded", "none", or a failure's text. */
const char *info_surface(const info_body *b);
const char *info_contact(skf_contact_mode mode);

void info_text(FILE *f, const skf_scene *scene, const char *path);
void info_json(FILE *f, const skf_scene *scene, const char *path);

#endif
