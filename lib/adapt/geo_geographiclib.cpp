/* SPDX-License-Identifier: MIT */
/* GeographicLib::Geocentric behind a C interface: flattening (a - c) / a, negative for a prolate ellipsoid. */
#include "adapt/geo.h"
#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <new>
#include <vector>

namespace {
const double degree = 3.14159265358979323846 / 180;

skf_vec3 cross(skf_vec3 a, skf_vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double dot(skf_vec3 a, skf_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
skf_vec3 scaled(double s, skf_vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
skf_vec3 sum(skf_vec3 a, skf_vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
bool finite(skf_vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/* Unit vector; false for zero. */
bool unit(skf_vec3 *a) {
  double n = std::hypot(a->x, a->y, a->z);
  if (!(n > 0) || !std::isfinite(n)) return false;
  *a = {a->x / n, a->y / n, a->z / n};
  return true;
}
} // namespace

struct skf_geo {
  GeographicLib::Geocentric earth;
  skf_vec3 center, x, y, z; /* body frame */

  skf_vec3 inward(skf_vec3 p) const {
    skf_vec3 d = sum(p, scaled(-1, center));
    return {dot(d, x), dot(d, y), dot(d, z)};
  }
  skf_vec3 outward(skf_vec3 d) const { return sum(scaled(d.x, x), sum(scaled(d.y, y), scaled(d.z, z))); }
};

extern "C" skf_status skf_geo_new(const skf_ellipsoid *e, skf_geo **out) {
  *out = nullptr;
  double a = e->equatorial, c = e->polar;
  if (!(a > 0) || !(c > 0) || !std::isfinite(a) || !std::isfinite(c) || !finite(e->center)) return SKF_ERR_RANGE;
  skf_vec3 z = e->axis, x = e->meridian;
  if (!unit(&z) || !unit(&x)) return SKF_ERR_DEGENERATE;
  skf_vec3 y = cross(z, x);
  if (!(dot(y, y) > 1e-24) || !unit(&y))
    return SKF_ERR_DEGENERATE; /* 1e-12 rad: below, rounding chooses the meridian */
  x = cross(y, z);
  try {
    *out = new skf_geo{GeographicLib::Geocentric(a, (a - c) / a), e->center, x, y, z};
    return SKF_OK;
  } catch (const std::bad_alloc &) {
    return SKF_ERR_NOMEM;
  } catch (...) { /* GeographicErr: a shape that it does not take */
    return SKF_ERR_RANGE;
  }
}

extern "C" void skf_geo_free(skf_geo *geo) { delete geo; }

extern "C" skf_status skf_geo_place(const skf_geo *geo, skf_vec3 point, skf_place *out) {
  if (!finite(point)) return SKF_ERR_RANGE;
  try {
    skf_vec3 d = geo->inward(point);
    double latitude, longitude, height;
    geo->earth.Reverse(d.x, d.y, d.z, latitude, longitude, height);
    *out = {latitude * degree, longitude * degree, height};
    return SKF_OK;
  } catch (...) { return SKF_ERR_RANGE; }
}

extern "C" skf_status skf_geo_point(const skf_geo *geo, skf_place p, skf_vec3 *out, skf_horizon *horizon) {
  double latitude = p.latitude / degree, longitude = p.longitude / degree;
  if (!std::isfinite(longitude) || !std::isfinite(p.height) || !(std::fabs(latitude) <= 90 * (1 + 1e-15)))
    return SKF_ERR_RANGE;
  latitude = std::fmax(-90, std::fmin(90, latitude));
  try {
    std::vector<double> m(9); /* columns: east, north, up */
    skf_vec3 d;
    geo->earth.Forward(latitude, longitude, p.height, d.x, d.y, d.z, m);
    *out = sum(geo->center, geo->outward(d));
    if (horizon)
      *horizon = {geo->outward({m[0], m[3], m[6]}), geo->outward({m[1], m[4], m[7]}), geo->outward({m[2], m[5], m[8]})};
    return SKF_OK;
  } catch (const std::bad_alloc &) { return SKF_ERR_NOMEM; } catch (...) {
    return SKF_ERR_RANGE;
  }
}
