/* SPDX-License-Identifier: MIT */
/* Entries of a skeleton that are curves, cut into arcs: bezier, helix, spiral. */
#include "core/alloc.h"
#include "core/vec3.h"
#include "scene/skeleton.h"

/* Cuts the entry's curve: first to count, then to keep. */
typedef skf_status cut_fn(const skf_entry *e, skf_primitive *pieces, size_t capacity, size_t *count);

static skf_status cut_bezier(const skf_entry *e, skf_primitive *pieces, size_t capacity, size_t *count) {
  return skf_bezier_cut(e->control, e->tolerance, pieces, capacity, count);
}

static skf_status cut_helix(const skf_entry *e, skf_primitive *pieces, size_t capacity, size_t *count) {
  return skf_helix_cut(&e->helix, e->tolerance, pieces, capacity, count);
}

static skf_status keep(skf_reader *r, const skf_entry *e, cut_fn *cut, size_t n, skf_pieces *into) {
  skf_primitive *p = skf_alloc(n, sizeof *p);
  if (!p) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  skf_status s = cut(e, p, n, &n);
  for (size_t i = 0; i < n && !s; i++) s = skf_add_piece(r, e, p + i, into);
  skf_free(p);
  return s;
}

static skf_status bad_tolerance(skf_reader *r, const skf_entry *e, const char *size) {
  return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, e->map, "tolerance"),
                       "tolerance is out of range for this %s, expected 1e-10 to 0.1 of its %s", e->name, size);
}

static skf_status overflow(skf_reader *r, const skf_entry *e) {
  return skf_error_set(r->error, SKF_ERR_RANGE, e->kind->line, "size of the %s overflows, expected a proper %s",
                       e->name, e->name);
}

skf_status skf_expand_bezier(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  size_t n = 0;
  skf_status s = cut_bezier(e, NULL, 0, &n);
  if (s == SKF_ERR_DEGENERATE || (!s && !n))
    return skf_error_set(r->error, SKF_ERR_DEGENERATE, e->kind->line,
                         "four equal points in a bezier, expected a proper bezier");
  if (s) return e->tolerance > 0 ? bad_tolerance(r, e, "polygon's length") : overflow(r, e);
  return keep(r, e, cut_bezier, n, into);
}

/* What the ranges of the keys do not tell. */
static skf_status check_helix(skf_reader *r, const skf_entry *e) {
  const skf_helix *h = &e->helix;
  skf_vec3 n = v3_unit(h->axis), s = v3_unit(h->start);
  const char *axis = e->name[0] == 'h' ? "axis" : "normal", *wrong = NULL, *where = axis;
  if (!(v3_norm(n) > 0))
    wrong = "is the zero vector, expected a direction";
  else if (!(v3_norm(v3_cross(n, s)) > 1e-12))
    where = "start", wrong = "is zero or parallel to the axis, expected another direction";
  else if (!(fmax(h->radius, h->end_radius) > 0))
    where = "radius", wrong = "is 0 at both ends, expected a radius > 0";
  else if (h->logarithmic && !(fmin(h->radius, h->end_radius) > 0))
    where = "radius", wrong = "is 0 at an end of a logarithmic spiral, expected both > 0";
  else if (h->pitch == 0 && h->radius == h->end_radius && h->turns > 1)
    where = "turns", wrong = "is more than 1 for a circle, expected a pitch or another end_radius";
  if (!wrong) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, e->map, where), "%s of a %s %s", where, e->name,
                       wrong);
}

skf_status skf_expand_helix(skf_reader *r, const skf_entry *given, skf_pieces *into) {
  skf_entry e = *given;
  if (e.helix.end_radius < 0) e.helix.end_radius = e.helix.radius;
  size_t n = 0;
  skf_status s = check_helix(r, &e);
  if (s) return s;
  s = cut_helix(&e, NULL, 0, &n);
  if (!s) return keep(r, &e, cut_helix, n, into);
  double size = fmax(e.helix.radius, e.helix.end_radius);
  bool fits = e.tolerance == 0 || (e.tolerance >= 1e-10 * size && e.tolerance <= 0.1 * size);
  return fits ? overflow(r, &e) : bad_tolerance(r, &e, "larger radius");
}

static skf_status read_law(skf_reader *r, const skf_node *value, void *into) {
  static const char *const words[] = {"archimedean", "logarithmic"};
  int chosen = 0;
  skf_status s = skf_read_choice(r, value, "law", words, 2, &chosen);
  ((skf_entry *)into)->helix.logarithmic = chosen;
  return s;
}

static const skf_range turns = {0, SKF_HELIX_TURNS, true};

#define TOLERANCE(doc)                                                                                                 \
  { "tolerance", "L", doc, SKF_KEY_NUMBER, false, .offset = offsetof(skf_entry, tolerance), .range = &skf_positive }
#define IN_HELIX(member) .offset = offsetof(skf_entry, helix.member)

const skf_key skf_bezier_keys[SKF_BEZIER_KEYS] = {
    {"points", "L", "from, two handles, to", SKF_KEY_VECTORS, true, .offset = offsetof(skf_entry, control), .count = 4},
    TOLERANCE("distance of pieces and curve (default: 1e-6 of the points' polygon)"),
};

const skf_key skf_helix_keys[SKF_HELIX_KEYS] = {
    {"center", "L", "on its axis, beside its start", SKF_KEY_VECTOR, true, IN_HELIX(center)},
    {"axis", "1", "about which it turns, right-handed", SKF_KEY_VECTOR, true, IN_HELIX(axis)},
    {"start", "1", "direction of its start from the centre; projected, normalised", SKF_KEY_VECTOR, true,
     IN_HELIX(start)},
    {"radius", "L", "at its start", SKF_KEY_NUMBER, true, IN_HELIX(radius), .range = &skf_not_negative},
    {"pitch", "L", "rise along the axis in a turn; negative: it sinks, left-handed", SKF_KEY_NUMBER, true,
     IN_HELIX(pitch)},
    {"turns", "1", "how many", SKF_KEY_NUMBER, true, IN_HELIX(turns), .range = &turns},
    {"end_radius", "L", "at its end, grows evenly (default: radius)", SKF_KEY_NUMBER, false, IN_HELIX(end_radius),
     .range = &skf_not_negative},
    TOLERANCE("distance of pieces and curve (default: 1e-6 of the larger radius)"),
};

const skf_key skf_spiral_keys[SKF_SPIRAL_KEYS] = {
    {"center", "L", "its centre", SKF_KEY_VECTOR, true, IN_HELIX(center)},
    {"normal", "1", "about which it turns, right-handed", SKF_KEY_VECTOR, true, IN_HELIX(axis)},
    {"start", "1", "direction of its start from the centre; projected, normalised", SKF_KEY_VECTOR, true,
     IN_HELIX(start)},
    {"radius", "L", "at its start", SKF_KEY_NUMBER, true, IN_HELIX(radius), .range = &skf_not_negative},
    {"end_radius", "L", "at its end", SKF_KEY_NUMBER, true, IN_HELIX(end_radius), .range = &skf_not_negative},
    {"turns", "1", "how many", SKF_KEY_NUMBER, true, IN_HELIX(turns), .range = &turns},
    {"law", NULL, "the radius grows evenly with the angle, or by a factor (default: archimedean)", SKF_KEY_OTHER,
     .read = read_law, .form = "archimedean or logarithmic"},
    TOLERANCE("distance of pieces and curve (default: 1e-6 of the larger radius)"),
};
