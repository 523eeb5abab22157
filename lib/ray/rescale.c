/* SPDX-License-Identifier: MIT */
#include "ray/rescale.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include "field/envelope.h"
#include "field/extreme.h"
#include <stdlib.h>

/* Fourth powers of lengths, times anything of a field, keep within the range of doubles up to 2^+-this. */
enum { PLAIN = 100 };

static int exponent(double a) {
  int power;
  frexp(a, &power);
  return power;
}

static bool may_scale(const skf_element *e) {
  bool plane = e->primitive.shape == SKF_PLANE;
  return e->primitive.shape != SKF_SOLID && e->kernel.type != SKF_USER_KERNEL &&
         !(plane && e->kernel.type == SKF_INVERSE_SQUARED);
}

/* Of the primitives, the kernels, and the places where kernels without a length of their own reach iso; 0: has none. */
static double size_of(const skf_field *f, double iso) {
  double size = 0, inverse = 0, squared = 0;
  skf_box all = box_empty();
  for (size_t i = 0; i < skf_field_size(f); i++) {
    const skf_element *e = skf_field_element(f, i);
    bool plane = e->primitive.shape == SKF_PLANE;
    skf_vec3 p = plane ? e->primitive.plane.through : v3(0, 0, 0);
    all = box_join(all, plane ? (skf_box){p, p} : skf_primitive_bounds(&e->primitive));
    size = fmax(size, skf_kernel_width(e->kernel));
    double sum = plane ? 0 : fabs(e->strength) * skf_primitive_measure(&e->primitive);
    if (e->kernel.type == SKF_INVERSE) inverse += sum;
    if (e->kernel.type == SKF_INVERSE_SQUARED) squared += sum;
  }
  for (int i = 0; i < 3; i++) size = fmax(size, 0.5 * v3_get(all.hi, i) - 0.5 * v3_get(all.lo, i));
  if (iso != 0) size = fmax(size, fmax(inverse / fabs(iso), sqrt(squared / fabs(iso))));
  return isfinite(size) ? size : 0;
}

/* Whether x 2^power keeps all its digits. */
static bool fits(double x, int power) {
  int e = exponent(x) + power;
  return e > -1000 && e < 1000;
}

skf_status skf_rescale(const skf_field *f, double iso, int *power, double *copied_iso, skf_field **copy) {
  size_t n = skf_field_size(f);
  double size = size_of(f, iso);
  int length = -exponent(size), value = iso != 0 ? -exponent(iso) : -2000;
  *power = 0, *copied_iso = iso, *copy = NULL;
  if (!(size > 0) || abs(length) <= PLAIN) return SKF_OK;
  for (size_t i = 0; i < n; i++) {
    const skf_element *e = skf_field_element(f, i);
    if (!may_scale(e)) return SKF_OK;
    int own = -exponent(e->strength) + skf_element_dimension(e) * length; /* makes its strength 1 */
    if (iso == 0 && e->strength != 0) value = value == -2000 || own < value ? own : value;
  }
  skf_element *all = skf_alloc(n, sizeof *all);
  if (!all) return SKF_ERR_NOMEM;
  bool good = n > 0 && value > -2000;
  for (size_t i = 0; i < n && good; i++) {
    skf_element *e = all + i;
    *e = *skf_field_element(f, i);
    int by = value - skf_element_dimension(e) * length;
    good = e->strength == 0 || fits(e->strength, by);
    e->strength = ldexp(e->strength, by);
    skf_element_scale(e, length);
    good = good && skf_primitive_check(&e->primitive, NULL) == SKF_OK;
  }
  skf_status s = good ? skf_field_new(all, n, copy) : SKF_OK;
  skf_free(all);
  if (s == SKF_ERR_NOMEM) return s;
  if (*copy) *power = length, *copied_iso = ldexp(iso, value);
  return SKF_OK;
}
