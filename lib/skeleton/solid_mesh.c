/* SPDX-License-Identifier: MIT */
/* From any list of triangles to a closed, oriented mesh, or to the reason why there is none. */
#include "core/alloc.h"
#include "num/exact.h"
#include "skeleton/solid.h"
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

skf_status skf_solid_refuse(skf_error *e, skf_status status, const char *format, ...) {
  if (!e) return status;
  va_list args;
  va_start(args, format);
  *e = (skf_error){.status = status};
  vsnprintf(e->text, sizeof e->text, format, args);
  va_end(args);
  return status;
}

static skf_status no_memory(skf_error *e) { return skf_solid_refuse(e, SKF_ERR_NOMEM, "out of memory"); }

/* A place as text: files number their vertices differently, or not at all. */
typedef struct place {
  char text[80];
} place;

static place show(skf_vec3 p) {
  place s;
  snprintf(s.text, sizeof s.text, "(%.9g, %.9g, %.9g)", p.x, p.y, p.z);
  return s;
}

static uint64_t hash_of(skf_vec3 p) {
  double x[3] = {p.x + 0.0, p.y + 0.0, p.z + 0.0}; /* -0 is 0 */
  uint64_t h = 0, b[3];
  memcpy(b, x, sizeof b);
  for (int k = 0; k < 3; k++) h = (h ^ b[k]) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
  return h;
}

/* map[i]: the first vertex with the coordinates of vertex i. */
static skf_status join(const skf_vec3 *v, size_t nv, unsigned *map) {
  size_t size = 16;
  while (size < 2 * nv) size *= 2;
  unsigned *table = skf_alloc(size, sizeof *table); /* index + 1 */
  if (!table) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < nv; i++) {
    size_t k = hash_of(v[i]) & (size - 1);
    for (; table[k]; k = (k + 1) & (size - 1)) {
      skf_vec3 u = v[table[k] - 1];
      if (u.x == v[i].x && u.y == v[i].y && u.z == v[i].z) break;
    }
    if (!table[k]) table[k] = (unsigned)i + 1;
    map[i] = table[k] - 1;
  }
  skf_free(table);
  return SKF_OK;
}

/* Only what is exactly flat: the field of any other sliver is well defined. */
static bool has_area(const skf_vec3 *v, const unsigned t[3]) {
  skf_dd3 n = dd3_cross(dd3_diff(v[t[1]], v[t[0]]), dd3_diff(v[t[2]], v[t[1]]));
  skf_vec3 e = v3_sub(v[t[1]], v[t[0]]), f = v3_sub(v[t[2]], v[t[1]]);
  return v3_norm(dd3_round(n)) > 1e-26 * fmax(v3_norm2(e), v3_norm2(f));
}

void skf_solid_mesh_free(skf_solid_mesh *m) {
  skf_free(m->v), skf_free(m->f);
  *m = (skf_solid_mesh){0};
}

/* Numbers the vertices that are used; map[i] becomes their new number. */
static void compact(const skf_vec3 *v, size_t nv, unsigned *map, skf_solid_mesh *out) {
  unsigned char *used = (unsigned char *)(out->v + nv); /* room behind the vertices */
  memset(used, 0, nv);
  for (size_t i = 0; i < out->nf; i++)
    for (int k = 0; k < 3; k++) used[out->f[i][k]] = 1;
  for (size_t i = 0; i < nv; i++) {
    if (map[i] != i) continue;
    if (used[i])
      out->v[out->nv] = v[i], map[i] = (unsigned)out->nv++;
    else
      out->unused++;
  }
  for (size_t i = 0; i < out->nf; i++)
    for (int k = 0; k < 3; k++) out->f[i][k] = map[out->f[i][k]];
}

skf_status skf_solid_clean(const skf_vec3 *v, size_t nv, const unsigned (*f)[3], size_t nf, skf_solid_mesh *out,
                           skf_error *e) {
  *out = (skf_solid_mesh){0};
  if (nf == 0) return skf_solid_refuse(e, SKF_ERR_DEGENERATE, "no faces, expected a closed mesh");
  if (nv >= 0x7fffffff || nf >= 0x7fffffff / 3)
    return skf_solid_refuse(e, SKF_ERR_CAPACITY, "more than 700 million faces");
  for (size_t i = 0; i < nv; i++)
    if (!v3_finite(v[i])) return skf_solid_refuse(e, SKF_ERR_RANGE, "vertex %zu (from 0) is not finite", i);
  unsigned *map = skf_alloc(nv, sizeof *map);
  out->v = skf_alloc(nv + nv / sizeof(skf_vec3) + 1, sizeof *out->v);
  out->f = skf_alloc(nf, sizeof *out->f);
  skf_status s = map && out->v && out->f ? join(v, nv, map) : SKF_ERR_NOMEM;
  for (size_t i = 0; i < nf && !s; i++) {
    for (int k = 0; k < 3; k++)
      if (f[i][k] >= nv) s = skf_solid_refuse(e, SKF_ERR_RANGE, "face %zu (from 0) has no vertex %u", i, f[i][k]);
    if (s) break;
    unsigned *t = out->f[out->nf];
    for (int k = 0; k < 3; k++) t[k] = map[f[i][k]];
    if (has_area(v, t))
      out->nf++;
    else
      out->dropped++;
  }
  if (!s) {
    for (size_t i = 0; i < nv; i++) out->joined += map[i] != i;
    compact(v, nv, map, out);
    if (!out->nf) s = skf_solid_refuse(e, SKF_ERR_DEGENERATE, "no face has an area, expected a closed mesh");
  }
  skf_free(map);
  if (s == SKF_ERR_NOMEM) no_memory(e);
  if (s) skf_solid_mesh_free(out);
  return s;
}

/* A side of a face, waiting for the others of its edge. */
typedef struct side {
  unsigned hi, at; /* the greater vertex; 3 * face + corner */
} side;

/* Every bucket holds the sides whose lesser vertex it is, sorted by the greater one. */
static void sort_bucket(side *s, size_t n) {
  for (size_t i = 1; i < n; i++) {
    side x = s[i];
    size_t j = i;
    for (; j > 0 && (s[j - 1].hi > x.hi || (s[j - 1].hi == x.hi && s[j - 1].at > x.at)); j--) s[j] = s[j - 1];
    s[j] = x;
  }
}

static bool is_along(const skf_solid_mesh *m, unsigned at, unsigned lo) { return m->f[at / 3][at % 3] == lo; }

static bool is_twice(const skf_solid_mesh *m, unsigned lo, unsigned a, unsigned b) {
  return is_along(m, a, lo) == is_along(m, b, lo) && m->f[a / 3][(a + 2) % 3] == m->f[b / 3][(b + 2) % 3];
}

/* One edge with n sides: as many must run one way as the other, of different faces. */
static skf_status match(const skf_solid_mesh *m, unsigned lo, const side *s, size_t n, skf_solid_pair *out,
                        skf_error *e) {
  size_t along = 0, against = 0;
  for (size_t i = 0; i < n; i++) is_along(m, s[i].at, lo) ? along++ : against++;
  if (along != against) {
    const char *why = n % 2 ? "is not closed" : "has faces of inconsistent orientation";
    const char *also = m->dropped ? " (faces without area were left out)" : "";
    return skf_solid_refuse(e, SKF_ERR_DEGENERATE, "%s at the edge from %s to %s, which has %zu face%s%s", why,
                            show(m->v[lo]).text, show(m->v[s->hi]).text, n, n == 1 ? "" : "s", also);
  }
  for (size_t i = 2; i < n; i++)
    for (size_t j = 0; j < i; j++)
      if (is_twice(m, lo, s[i].at, s[j].at))
        return skf_solid_refuse(e, SKF_ERR_DEGENERATE, "has a face twice at the edge from %s to %s",
                                show(m->v[lo]).text, show(m->v[s->hi]).text);
  for (size_t i = 0, j = 0, k = 0; k < along; k++, i++, j++) {
    while (!is_along(m, s[i].at, lo)) i++;
    while (is_along(m, s[j].at, lo)) j++;
    out[k] = (skf_solid_pair){lo, s->hi, s[i].at, s[j].at};
  }
  return SKF_OK;
}

skf_status skf_solid_pairs(const skf_solid_mesh *m, skf_solid_pair **out, size_t *count, skf_error *e) {
  size_t n = 3 * m->nf;
  side *sides = skf_alloc(n, sizeof *sides);
  size_t *start = skf_alloc(m->nv + 2, sizeof *start);
  *out = skf_alloc(n / 2 + 1, sizeof **out);
  *count = 0;
  skf_status s = sides && start && *out ? SKF_OK : no_memory(e);
  for (size_t i = 0; i < n && !s; i++) {
    unsigned a = m->f[i / 3][i % 3], b = m->f[i / 3][(i + 1) % 3];
    start[(a < b ? a : b) + 2]++;
  }
  for (size_t i = 2; i < m->nv + 2 && !s; i++) start[i] += start[i - 1];
  for (size_t i = 0; i < n && !s; i++) {
    unsigned a = m->f[i / 3][i % 3], b = m->f[i / 3][(i + 1) % 3], lo = a < b ? a : b;
    sides[start[lo + 1]++] = (side){a < b ? b : a, (unsigned)i};
  }
  for (unsigned v = 0; v < m->nv && !s; v++) {
    sort_bucket(sides + start[v], start[v + 1] - start[v]);
    for (size_t i = start[v], j; i < start[v + 1] && !s; i = j) {
      for (j = i + 1; j < start[v + 1] && sides[j].hi == sides[i].hi;) j++;
      s = match(m, v, sides + i, j - i, *out + *count, e);
      *count += (j - i) / 2;
    }
  }
  skf_free(sides), skf_free(start);
  if (s) skf_free(*out), *out = NULL;
  return s;
}

double skf_solid_winding(skf_vec3 a, skf_vec3 b, skf_vec3 c) {
  double la = v3_norm(a), lb = v3_norm(b), lc = v3_norm(c), y = v3_dot(a, v3_cross(b, c));
  double x = la * lb * lc + v3_dot(a, b) * lc + v3_dot(b, c) * la + v3_dot(c, a) * lb;
  return atan2(y, x) / (2 * SKF_PI);
}

static size_t root_of(unsigned *parent, size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* A component, at its root vertex. */
typedef struct component {
  skf_box box;
  double volume;
} component;

/* How often the others wind around a vertex of component c: only those whose box holds it can. */
static double winding_of_others(const skf_solid_mesh *m, const unsigned *parent, const component *all, size_t c) {
  double sum = 0;
  skf_vec3 p = m->v[c];
  for (size_t i = 0; i < m->nf; i++) {
    const unsigned *t = m->f[i];
    size_t k = parent[t[0]];
    const skf_box *b = &all[k].box;
    if (k == c || p.x < b->lo.x || p.y < b->lo.y || p.z < b->lo.z || p.x > b->hi.x || p.y > b->hi.y || p.z > b->hi.z)
      continue;
    sum += skf_solid_winding(v3_sub(m->v[t[0]], p), v3_sub(m->v[t[1]], p), v3_sub(m->v[t[2]], p));
  }
  return sum;
}

static bool is_held(const component *all, size_t nv, const unsigned *parent, size_t c) {
  for (size_t k = 0; k < nv; k++) {
    const skf_box *a = &all[k].box, *b = &all[c].box;
    if (parent[k] == k && k != c && a->lo.x <= b->lo.x && a->lo.y <= b->lo.y && a->lo.z <= b->lo.z &&
        a->hi.x >= b->hi.x && a->hi.y >= b->hi.y && a->hi.z >= b->hi.z)
      return true;
  }
  return false;
}

/* The total has been found positive, so a single component faces out. */
static skf_status judge(const skf_solid_mesh *m, const unsigned *parent, const component *all, size_t c, skf_error *e) {
  double around = is_held(all, m->nv, parent, c) ? winding_of_others(m, parent, all, c) : 0;
  if (all[c].volume < 0 && around < 0.5)
    return skf_solid_refuse(e, SKF_ERR_DEGENERATE,
                            "the component at %s faces inward and is no cavity of another one (volume %.6g)",
                            show(m->v[c]).text, all[c].volume);
  if (all[c].volume > 0 && around > 0.5)
    return skf_solid_refuse(e, SKF_ERR_DEGENERATE, "the component at %s lies inside of another one's material",
                            show(m->v[c]).text);
  return SKF_OK;
}

skf_status skf_solid_components(const skf_solid_mesh *m, const skf_solid_pair *pairs, size_t count, size_t *components,
                                skf_error *e) {
  unsigned *parent = skf_alloc(m->nv, sizeof *parent);
  component *all = skf_alloc(m->nv, sizeof *all);
  skf_status s = parent && all ? SKF_OK : no_memory(e);
  size_t n = 0;
  double total = 0, absolute = 0;
  for (size_t v = 0; v < m->nv && !s; v++) parent[v] = (unsigned)v, all[v].box = box_empty();
  for (size_t i = 0; i < count && !s; i++) {
    size_t a = root_of(parent, pairs[i].lo), b = root_of(parent, pairs[i].hi);
    parent[a < b ? b : a] = (unsigned)(a < b ? a : b);
  }
  for (size_t v = 0; v < m->nv && !s; v++) {
    parent[v] = (unsigned)root_of(parent, v);
    all[parent[v]].box = box_add(all[parent[v]].box, m->v[v]);
    n += parent[v] == v;
  }
  for (size_t i = 0; i < m->nf && !s; i++) {
    const unsigned *t = m->f[i];
    skf_vec3 o = m->v[parent[t[0]]];
    double part = v3_dot(v3_sub(m->v[t[0]], o), v3_cross(v3_sub(m->v[t[1]], o), v3_sub(m->v[t[2]], o))) / 6;
    all[parent[t[0]]].volume += part, total += part, absolute += fabs(part);
  }
  if (!s && isfinite(absolute) && !(fabs(total) > 1e-14 * absolute)) /* less is rounding */
    s = skf_solid_refuse(e, SKF_ERR_DEGENERATE, "has no volume");
  if (!s && !isfinite(absolute)) s = skf_solid_refuse(e, SKF_ERR_RANGE, "has a volume that overflows");
  if (!s && total < 0) s = skf_solid_refuse(e, SKF_ERR_DEGENERATE, "faces inward (its volume is %.9g)", total);
  for (size_t v = 0; v < m->nv && !s && n > 1; v++)
    if (parent[v] == v) s = judge(m, parent, all, v, e);
  *components = n;
  skf_free(parent), skf_free(all);
  return s;
}
