/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where particles touch a body: contacts counted in bins of latitude and longitude, as a picture and as a table. */
#ifndef SKF_TOOLS_CONTACT_MAP_H
#define SKF_TOOLS_CONTACT_MAP_H

#include "adapt/geo.h"
#include "picture.h"

/* Bins between two latitudes: fewer towards the poles, so that all are about equally large. */
typedef struct contact_band {
  size_t first; /* bin; its western edge is at longitude -180 degrees */
  int count;
} contact_band;

typedef struct contact_map {
  const char *picture_path, *table_path; /* NULL: not wanted */
  const skf_scene *scene;
  const skf_world *world;
  size_t body;
  skf_geo *geo;
  double step; /* [deg] of latitude */
  int band_count;
  contact_band *bands; /* from the south */
  size_t bin_count, contacts;
  long *count;   /* of each bin */
  double *speed; /* sum of speeds relative to the ground [L/T] */
  bool by_speed; /* what the picture shows */
  const skf_plot *plot;
  const skf_picture_format *format;
  cli_out picture, table;
  bool picture_open, table_open;
} contact_map;

/* From the command line: CLI_DONE without work when neither file is wanted, or another status after the message. */
int contact_map_new(contact_map *m, const cli *c, const skf_scene *scene, const skf_world *world);
bool contact_map_wanted(const contact_map *m);
int contact_map_open(contact_map *m);
/* A contact in the inertial frame. */
void contact_map_add(contact_map *m, const skf_contact *contact);
/* Writes what is open, or leaves nothing of it. */
int contact_map_close(contact_map *m, bool keep);
void contact_map_free(contact_map *m);

/* Edges of a bin [deg], and its share of the sphere. */
typedef struct contact_bin {
  double south, north, west, east, share;
} contact_bin;
contact_bin contact_map_bin(const contact_map *m, int band, int i);
/* The picture as the bytes of a file. */
int contact_map_draw(const contact_map *m, unsigned char **bytes, size_t *n);

#endif
