/* SPDX-License-Identifier: MIT */
/* Latitude, longitude and height on a body's ellipsoid of revolution, oblate or prolate (GeographicLib). */
#ifndef SKF_ADAPT_GEO_H
#define SKF_ADAPT_GEO_H

#include "skelfield/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct skf_geo skf_geo;

/* SKF_ERR_UNSUPPORTED where the build has no GeographicLib; SKF_ERR_RANGE for semi-axes that are not positive;
   SKF_ERR_DEGENERATE for a meridian along the axis. */
skf_status skf_geo_new(const skf_ellipsoid *ellipsoid, skf_geo **out);
void skf_geo_free(skf_geo *geo);

/* A place [rad, rad, L]: latitude north of the equator, longitude east of the meridian in (-pi, pi], height along the
   ellipsoid's normal. Deep inside, below the centres of curvature, the latitude is one of several. */
typedef struct skf_place {
  double latitude, longitude, height;
} skf_place;

/* Unit vectors at a place, body frame. */
typedef struct skf_horizon {
  skf_vec3 east, north, up;
} skf_horizon;

/* Both in the body's frame; horizon may be NULL. SKF_ERR_RANGE for what is not finite. */
skf_status skf_geo_place(const skf_geo *geo, skf_vec3 point, skf_place *out);
skf_status skf_geo_point(const skf_geo *geo, skf_place place, skf_vec3 *out, skf_horizon *horizon);

#ifdef __cplusplus
}
#endif
#endif
