/* SPDX-License-Identifier: MIT */
/* Stands in where the build has no GeographicLib: it refuses. */
#include "adapt/geo.h"

skf_status skf_geo_new(const skf_ellipsoid *ellipsoid, skf_geo **out) {
  (void)ellipsoid;
  *out = NULL;
  return SKF_ERR_UNSUPPORTED;
}

void skf_geo_free(skf_geo *geo) { (void)geo; }

skf_status skf_geo_place(const skf_geo *geo, skf_vec3 point, skf_place *out) {
  (void)geo, (void)point;
  *out = (skf_place){0, 0, 0};
  return SKF_ERR_UNSUPPORTED;
}

skf_status skf_geo_point(const skf_geo *geo, skf_place place, skf_vec3 *out, skf_horizon *horizon) {
  (void)geo, (void)place, (void)horizon;
  *out = (skf_vec3){0, 0, 0};
  return SKF_ERR_UNSUPPORTED;
}
