/* SPDX-License-Identifier: MIT */
#include "ray/blob.h"

skf_blob skf_blob_of(const skf_element *e) {
  double R = e->kernel.param, c3 = 0;
  bool quartic = e->kernel.type == SKF_QUARTIC, soft = e->kernel.type == SKF_SOFT_OBJECT;
  skf_blob b = {.per = 0};
  if (e->primitive.shape != SKF_POINT || (!quartic && !soft)) return b;
  if (!(R > 1e-100 && R < 1e100 && e->strength > 1e-100 && e->strength < 1e100)) return b;
  if (soft) c3 = 4. / 9;
  return (skf_blob){e->primitive.point.at, 1 / (R * R), e->strength, 1 - c3, c3, R};
}
